//! Cameras, lights and meshes that a scene file moves.

use gridwalk_scene::{Animation, AnimationOptions, Camera, Deformed, Light, LoadOptions, Motion, Pose, open};

use super::{folder, without_folder};

const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn opened(text: &str) -> Result<Animation, String> {
    let folder = folder(&[("scene.toml", text.as_bytes()), ("a.obj", OBJ)]);
    open(folder.path(), &LoadOptions::default(), &AnimationOptions::default())
        .map_err(|error| without_folder(&error.to_string(), folder.path()))
}

fn described(text: &str) -> Animation {
    opened(text).unwrap_or_else(|error| panic!("{error}"))
}

fn near(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5)
}

#[test]
fn a_camera_goes_from_key_to_key() {
    let moving = described(
        "[[mesh]]\nfile = \"a.obj\"\n[[camera]]\nname = \"a\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\ninterpolation = \"linear\"\n\
         [[camera.key]]\ntime = 0.5\n[[camera.key]]\ntime = 1.5\neye = [4, 0, 5]\nfov = 55\n[[camera.key]]\ntime = 2.5\ntarget = [0, 2, 0]\n\
         [[camera]]\nname = \"b\"\neye = [1, 1, 1]\ntarget = [0, 0, 0]\n",
    );
    assert_eq!((moving.duration, moving.cyclic, moving.frame_count(2.0)), (2.5, false, 6));
    let at = |time: f64| moving.camera(None, time).unwrap();
    assert_eq!(at(0.0), moving.scene.cameras[0].camera);
    assert_eq!((at(0.0), at(0.5), at(-3.0)), (at(0.2), at(0.0), at(0.0)));
    let middle = at(1.0);
    assert_eq!((middle.eye, middle.target, middle.vertical_fov_degrees), ([2.0, 0.0, 5.0], [0.0; 3], 45.0));
    assert_eq!((at(2.0).target, at(2.0).eye, at(2.0).vertical_fov_degrees), ([0.0, 1.0, 0.0], [4.0, 0.0, 5.0], 55.0));
    assert_eq!(at(2.5), at(99.0));
    assert_eq!(moving.camera(Some("b"), 1.0), moving.camera(Some("b"), 0.0));
    assert_eq!(moving.camera(Some("c"), 1.0), None);
    assert!(moving.has_target(None) && moving.has_target(Some("b")));
}

#[test]
fn a_looped_camera_closes_and_the_first_key_may_complete_it() {
    let moving = described(
        "[[camera]]\nname = \"a\"\nloop = true\n[[camera.key]]\ntime = 0\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n[[camera.key]]\ntime = 1\neye = [5, 0, 0]\n\
         [[camera.key]]\ntime = 2\neye = [0, 0, 5]\n",
    );
    assert_eq!((moving.duration, moving.cyclic, moving.frame_count(10.0)), (2.0, true, 20));
    for frame in 0..40 {
        let time = f64::from(frame) / 10.0;
        assert_eq!(moving.camera(None, time), moving.camera(None, time % 2.0), "{time}");
    }
    assert_eq!(moving.camera(None, 2.0), moving.camera(None, 0.0));
    // Negative control.
    assert_ne!(moving.camera(None, 0.5), moving.camera(None, 0.0));
}

#[test]
fn a_camera_that_flies_through_its_target_or_over_its_top_stays_one() {
    let moving = described(
        "[[camera]]\nname = \"a\"\ninterpolation = \"linear\"\n[[camera.key]]\ntime = 0\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n\
         [[camera.key]]\ntime = 1\neye = [0, 0, -1]\n[[camera]]\nname = \"b\"\ninterpolation = \"linear\"\n[[camera.key]]\ntime = 0\n\
         eye = [1, 1, 0]\ntarget = [0, 0, 0]\n[[camera.key]]\ntime = 1\neye = [-1, 1, 0]\n",
    );
    let through = moving.camera(Some("a"), 0.5).unwrap();
    assert_eq!(through.eye, [0.0, 0.0, 1.0]);
    let over = moving.camera(Some("b"), 0.5).unwrap();
    assert_eq!((over.eye, over.up), ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]));
}

#[test]
fn a_turntable_moves_to_the_right_about_the_scenes_up() {
    let turning = |text: &str| described(&format!("[[mesh]]\nfile = \"a.obj\"\n[[camera]]\nname = \"a\"\n{text}"));
    let moving = turning("turntable = 8\neye = [1, 2, 5]\ntarget = [1, 0, 1]\n");
    assert_eq!((moving.duration, moving.cyclic, moving.frame_count(24.0)), (8.0, true, 192));
    let eye = |time: f64| moving.camera(None, time).unwrap().eye;
    assert_eq!(eye(0.0), [1.0, 2.0, 5.0]);
    assert!(near(eye(2.0), [5.0, 2.0, 1.0]) && near(eye(4.0), [1.0, 2.0, -3.0]) && near(eye(6.0), [-3.0, 2.0, 1.0]), "{:?}", eye(2.0));
    for turn in 0..100 {
        assert_eq!(moving.camera(None, 8.0 * f64::from(turn)), Some(moving.scene.cameras[0].camera));
    }
    let back = turning("turntable = -8\neye = [1, 2, 5]\ntarget = [1, 0, 1]\n");
    assert!(near(back.camera(None, 2.0).unwrap().eye, [-3.0, 2.0, 1.0]));
    assert_eq!(back.duration, 8.0);

    // From the automatic view, about an up of its own; the distance stays.
    let framed = described("up = [0, 0, 1]\n[[mesh]]\nfile = \"a.obj\"\n[[camera]]\nname = \"a\"\nazimuth = 40\nturntable = 4\n");
    let distance = |camera: Camera| camera.eye.iter().zip(&camera.target).map(|(eye, target)| (eye - target).powi(2)).sum::<f32>().sqrt();
    let (start, quarter) = (framed.camera(None, 0.0).unwrap(), framed.camera(None, 1.0).unwrap());
    assert!((distance(start) - distance(quarter)).abs() < 1e-5 && (start.eye[2] - quarter.eye[2]).abs() < 1e-5 && start.eye != quarter.eye);
}

#[test]
fn lights_keep_their_kind_and_go_from_key_to_key() {
    let moving = described(
        "[[light]]\nkind = \"point\"\nintensity = 4\ninterpolation = \"linear\"\n[[light.key]]\ntime = 0\nposition = [0, 1, 0]\n\
         [[light.key]]\ntime = 2\nposition = [2, 1, 0]\nintensity = [0, 8, 4]\n\
         [[light]]\nkind = \"directional\"\nirradiance = 2\ninterpolation = \"linear\"\nloop = true\n[[light.key]]\ntime = 0\ndirection = [0, -1, 0]\n\
         [[light.key]]\ntime = 1\ndirection = [3, 0, 0]\n\
         [[light]]\nkind = \"spot\"\nintensity = 1\ntarget = [0, 0, 0]\nouter = 20\ninterpolation = \"step\"\n[[light.key]]\ntime = 0\n\
         position = [0, 3, 0]\n[[light.key]]\ntime = 1\nposition = [3, 0, 0]\n[[light]]\nkind = \"point\"\nposition = [7, 7, 7]\nintensity = 1\n",
    );
    assert_eq!((moving.duration, moving.cyclic), (2.0, false));
    assert_eq!(moving.lights(0.0), moving.scene.lights);
    let half = 0.5_f32.sqrt();
    assert_eq!(moving.lights(1.0)[0], Light::Point { position: [1.0, 1.0, 0.0], intensity: [2.0, 6.0, 4.0] });
    assert!(matches!(moving.lights(1.25)[1], Light::Directional { direction, irradiance: [2.0, 2.0, 2.0] }
        if (direction[0] / direction[1] + 1.0).abs() < 1e-5 && (direction[0] - half).abs() < 1e-5 || direction[1] < -0.9));
    assert!(matches!(moving.lights(0.5)[1], Light::Directional { direction, .. } if near(direction, [half, -half, 0.0])));
    for (time, expected) in [(0.9, [0.0, -1.0, 0.0]), (1.0, [-1.0, 0.0, 0.0])] {
        assert!(
            matches!(moving.lights(time)[2], Light::Spot { direction, outer_degrees: 20.0, .. } if near(direction, expected)),
            "{time}"
        );
    }
    assert_eq!(moving.lights(1.7)[3], moving.scene.lights[3]);
}

/// The base of a deformed mesh through the first matrix of a pose.
fn posed(base: &Deformed, pose: &Pose) -> Vec<[f32; 3]> {
    assert_eq!((pose.matrices.len(), pose.weights.len(), base.matrix_count, base.influences.len()), (1, 0, 1, 0));
    let moved = |[x, y, z]: &[f32; 3]| pose.matrices[0].map(|row| row[0] * x + row[1] * y + row[2] * z + row[3]);
    base.positions.iter().map(moved).collect()
}

#[test]
fn a_mesh_with_keys_is_posed_by_one_matrix() {
    let moving = described(
        "[[mesh]]\nfile = \"a.obj\"\nscale = 2\ninterpolation = \"linear\"\nmatrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1]]\n\
         [[mesh.key]]\ntime = 0\ntranslate = [1, 0, 0]\n[[mesh.key]]\ntime = 1\nrotate = [0, 0, 90]\n[[mesh.key]]\ntime = 2\n\
         rotate = [0, 0, 180]\nscale = [4, 2, 2]\n[[mesh]]\nshape = \"box\"\n",
    );
    let Motion::Deformed(base) = &moving.motions[0] else { panic!("{:?}", moving.motions) };
    assert!(matches!(moving.motions[1], Motion::Still));
    assert_eq!((base.positions[1], base.normals.len()), ([1.0, 0.0, 1.0], 3));
    let mut pose = Pose::default();
    for (time, expected) in [
        (0.0, [[1.0, 0.0, 2.0], [3.0, 0.0, 2.0], [1.0, 2.0, 2.0]]),
        (1.0, [[1.0, 0.0, 2.0], [1.0, 2.0, 2.0], [-1.0, 0.0, 2.0]]),
        (2.0, [[1.0, 0.0, 2.0], [-3.0, 0.0, 2.0], [1.0, -2.0, 2.0]]),
        (9.0, [[1.0, 0.0, 2.0], [-3.0, 0.0, 2.0], [1.0, -2.0, 2.0]]),
    ] {
        moving.pose(0, time, &mut pose);
        let found = posed(base, &pose);
        assert!(found.iter().zip(expected).all(|(found, expected)| near(*found, expected)), "{time}: {found:?}");
        if time == 0.0 {
            assert_eq!(found, moving.scene.meshes[0].positions);
        }
    }
    moving.pose(1, 0.0, &mut pose);
    assert_eq!(pose, Pose::default());
    assert_eq!(moving.duration, 2.0);
}

#[test]
fn a_mirrored_mesh_is_wound_the_other_way_and_stays_so() {
    let moving =
        described("[[mesh]]\nfile = \"a.obj\"\nscale = [-1, 1, 1]\n[[mesh.key]]\ntime = 0\n[[mesh.key]]\ntime = 1\nscale = [-3, 1, 1]\n");
    assert_eq!((moving.scene.meshes[0].indices[0], moving.scene.meshes[0].normals[0]), ([0, 2, 1], [0.0, 0.0, 1.0]));
}

#[test]
fn the_scene_file_may_say_how_long_and_how_fast() {
    let text = "[animation]\nduration = 3\nfps = 12\n[[camera]]\nname = \"a\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nturntable = 1.5\n";
    let moving = described(text);
    assert_eq!((moving.duration, moving.fps, moving.cyclic, moving.frame_count(moving.fps)), (3.0, 12.0, true, 36));
    let moving = described(&text.replace("duration = 3", "duration = 2"));
    assert_eq!((moving.cyclic, moving.frame_count(moving.fps)), (false, 25));
    let still = described("[animation]\nduration = 2\n");
    assert_eq!((still.duration, still.fps, still.cyclic, still.frame_count(1.0)), (2.0, 24.0, false, 3));
}

/// The part of the documentation between two fences.
fn documented(number: usize) -> String {
    let text = include_str!("../../../crates/scene/src/lib.rs");
    let docs: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("//!")).map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
    docs.split(|line| line.starts_with("```")).nth(2 * number + 1).unwrap().join("\n")
}

#[test]
fn the_documented_scene_files_that_move_can_be_read() {
    let keys: Vec<String> = (0..24).map(|key| format!("elephant.{key:04}.obj")).collect();
    let mut files: Vec<(&str, &[u8])> = keys.iter().map(|name| (name.as_str(), OBJ)).collect();
    files.push(("wheel.obj", OBJ));
    let folder = folder(&files);
    for (number, motions, duration) in [(1, 1, 1.0), (2, 1, 12.0)] {
        std::fs::write(folder.path().join("scene.toml"), documented(number)).unwrap();
        let moving = open(folder.path(), &LoadOptions::default(), &AnimationOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(moving.motions.iter().filter(|motion| !matches!(motion, Motion::Still)).count(), motions);
        assert_eq!(moving.duration, duration);
        assert!(moving.scene.warnings.is_empty(), "{:?}", moving.scene.warnings);
    }
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let camera = "[[camera]]\nname = \"a\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";
    let point = "[[light]]\nkind = \"point\"\nposition = [0, 0, 5]\nintensity = 1\n";
    let mesh = "[[mesh]]\nfile = \"a.obj\"\n";
    let cases = [
        (format!("{camera}turntable = 0\n"), "5: a turntable needs seconds for a turn, below 0 to turn the other way"),
        (format!("{camera}turntable = 2\n[[camera.key]]\ntime = 0\n"), "5: a camera has keys or a turntable, not both"),
        (format!("{camera}loop = true\n"), "1: interpolation and loop of a camera belong to keys; a turntable goes on by itself"),
        (
            format!("{camera}interpolation = \"smoth\"\n[[camera.key]]\ntime = 0\n"),
            "5: no interpolation \"smoth\"; there are \"step\", \"linear\", \"smooth\"; did you mean \"smooth\"?",
        ),
        (
            format!("{camera}[[camera.key]]\ntime = 1\n[[camera.key]]\ntime = 1\n"),
            "1: the times of keys must be 0 or above, each later than the one before",
        ),
        (format!("{camera}[[camera.key]]\ntime = -1\n"), "1: the times of keys must be 0 or above, each later than the one before"),
        (format!("{camera}[[camera.key]]\ntime = nan\n"), "6: the number must be finite"),
        (
            format!("{camera}[[camera.key]]\ntime = 0\n[[camera.key]]\ntime = 1\neye = [0, 0, 0]\n"),
            "7: a camera's eye and target must differ, and up must not be [0, 0, 0]",
        ),
        (
            format!("{camera}[[camera.key]]\ntime = 0\n[[camera.key]]\ntime = 1\northographic_height = 2\n"),
            "7: a camera is orthographic in all its keys or in none; give the first one orthographic_height",
        ),
        (
            "[[camera]]\nname = \"a\"\n[[camera.key]]\ntime = 0\neye = [0, 0, 1]\n".to_owned(),
            "3: a camera needs eye and target, or neither (with azimuth, elevation, zoom from the automatic view)",
        ),
        (format!("{point}loop = true\n"), "1: interpolation and loop of a light belong to keys"),
        (format!("{point}[[light.key]]\ntime = 0\nirradiance = 1\n"), "5: a point light has no irradiance; give intensity"),
        (format!("{mesh}loop = true\n"), "1: loop belongs to a sequence, keys or a glTF file"),
        (format!("{mesh}start = 1\n"), "1: start belongs to a sequence or a glTF file"),
        (format!("{mesh}interpolation = \"step\"\n"), "3: interpolation of a mesh belongs to keys; a sequence has interpolate"),
        (
            format!("{mesh}[[mesh.key]]\ntime = 0\n[[mesh.key]]\ntime = 1\nscale = [1, -1, 1]\n"),
            "7: a scale must keep its sign from key to key: on the way it would flatten the mesh",
        ),
        (
            "[[mesh]]\nsequence = \"a.obj\"\n".to_owned(),
            "2: \"a.obj\" has no place for a number; write %04d or #### for it, or file = for a mesh that stands still",
        ),
        ("[[mesh]]\nsequence = []\n".to_owned(), "2: a sequence needs one file or more"),
        (
            "[[mesh]]\nsequence = 7\n".to_owned(),
            "2: invalid type: integer `7`, expected a pattern such as \"name.%04d.obj\", or a list of file names",
        ),
        (
            "[[mesh]]\nsequence = [\"a.obj\"]\nfirst = 1\n".to_owned(),
            "2: first and last belong to a pattern; leave names out of the list instead",
        ),
        (
            "[[mesh]]\nsequence = \"a%d.obj\"\nfirst = 3\nlast = 1\n".to_owned(),
            "2: DIR/a%d.obj begins at 3 and ends at 1; first must not be above last",
        ),
        (
            "[[mesh]]\nsequence = \"a%d.obj\"\nfirst = 0\nlast = 4294967295\n".to_owned(),
            "2: DIR/a%d.obj goes from 0 to 4294967295; at most 4294967295 key-frames are possible",
        ),
        ("[[mesh]]\nsequence = \"a%d.obj\"\nfps = 0\nfirst = 1\nlast = 2\n".to_owned(), "3: fps is 0; it must be above 0"),
        (
            "[[mesh]]\nsequence = \"a%d.obj\"\nfirst = 1\nlast = 2\n".to_owned(),
            "2: DIR/a1.obj does not exist, but its sequence goes from 1 to 2; put it there, or play only the part before it",
        ),
        (
            "[[mesh]]\nsequence = \"b%d.obj\"\n".to_owned(),
            "2: no file matches DIR/b%d.obj; the names must be the same but for a number of 1 digits or more",
        ),
        ("[[mesh]]\nsequence = \"sub/b%d.obj\"\n".to_owned(), "2: sub does not exist"),
        ("[[mesh]]\nsequence = \"../b%d.obj\"\n".to_owned(), "outside"),
        ("[[mesh]]\nfile = \"scene.toml\"\n".to_owned(), "2: scene.toml is a scene file; name its meshes here instead"),
        ("[animation]\nduration = 0\n".to_owned(), "2: duration is 0; it must be above 0"),
        ("[animation]\nfps = -1\n".to_owned(), "2: fps is -1; it must be above 0"),
    ];
    let mut wrong = String::new();
    for (text, expected) in cases {
        let found = opened(&text).map(|_| "no error".to_owned()).unwrap_or_else(|error| error.replace("DIR/scene.toml:", ""));
        let right = if expected == "outside" { found.contains("lies outside the scene's folder") } else { found == expected };
        if !right {
            wrong += &format!("{text}     found: {found}\n  expected: {expected}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
