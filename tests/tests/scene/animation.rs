//! Scenes that move: which key-frames make up a time, and what is read for them.

use std::path::Path;

use gridwalk_scene::{Animation, AnimationOptions, Error, Framing, KeyPair, LoadOptions, Motion, open};

use super::{folder, png, without_folder};

fn animation(path: &Path) -> Animation {
    open(path, &LoadOptions::default(), &AnimationOptions::default()).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn message(path: &Path, folder: &Path) -> String {
    match open(path, &LoadOptions::default(), &AnimationOptions::default()) {
        Ok(_) => panic!("{} was read", path.display()),
        Err(error) => without_folder(&error.to_string(), folder),
    }
}

/// A triangle whose corner at (1, 0, 0) lies at x.
fn triangle(x: f32) -> String {
    format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\nf 1 2 3\n")
}

fn pair(first: u32, second: u32, weight: f32) -> KeyPair {
    KeyPair { first, second, weight }
}

#[test]
fn a_pattern_finds_its_files_and_every_frame_its_key() {
    let texts: Vec<String> = (0..5).map(|key| triangle(1.0 + key as f32)).collect();
    let names: Vec<String> = (0..5).map(|key| format!("move.{:04}.obj", key + 8)).collect();
    let files: Vec<(&str, &[u8])> = names.iter().zip(&texts).map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
    let folder = folder(&files);
    std::fs::write(folder.path().join("move.13.obj"), "").unwrap();
    std::fs::write(folder.path().join("move.0013.ply"), "").unwrap();
    for pattern in ["move.%04d.obj", "move.####.obj", "move.%4d.obj"] {
        let moving = animation(&folder.path().join(pattern));
        assert!(matches!(moving.motions[..], [Motion::Keys]));
        assert_eq!((moving.key_count(0), moving.fps, moving.cyclic, moving.frame_count(moving.fps)), (5, 24.0, false, 5));
        assert_eq!(moving.scene.meshes[0].name, "move");
        let mut reader = moving.reader().unwrap();
        for frame in 0..5 {
            let keys = moving.keys_at(0, f64::from(frame) / moving.fps);
            assert_eq!(keys, pair(frame, frame, 0.0));
            let read = reader.read(0, frame).unwrap();
            assert_eq!(read.mesh.positions[1], [1.0 + frame as f32, 0.0, 0.0]);
            if frame == 0 {
                assert_eq!(read.mesh, moving.scene.meshes[0]);
            }
        }
        assert_eq!(moving.keys_at(0, 1.5 / 24.0), pair(1, 2, 0.5));
        assert_eq!(moving.keys_at(0, 99.0), pair(4, 4, 0.0));
        assert_eq!(moving.keys_at(0, -1.0), pair(0, 0, 0.0));
        assert_eq!(moving.keys_at(0, f64::NAN), pair(0, 0, 0.0));
    }
}

#[test]
fn a_file_of_exactly_that_name_goes_before_the_pattern() {
    let folder = folder(&[("a#.obj", triangle(1.0).as_bytes()), ("a1.obj", triangle(2.0).as_bytes())]);
    let still = animation(&folder.path().join("a#.obj"));
    assert!(matches!(still.motions[..], [Motion::Still]));
    assert_eq!((still.key_count(0), still.frame_count(24.0), still.scene.meshes[0].positions[1][0]), (0, 1, 1.0));
}

#[test]
fn a_missing_or_broken_key_frame_is_an_error_when_it_is_read_and_names_the_file() {
    let broken = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n".as_slice();
    let good = triangle(1.0);
    let folder = folder(&[("a1.obj", good.as_bytes()), ("a2.obj", broken), ("a4.obj", good.as_bytes())]);
    let moving = animation(&folder.path().join("a%d.obj"));
    assert_eq!(moving.key_count(0), 4);
    let mut reader = moving.reader().unwrap();
    let said: Vec<String> = (0..6)
        .map(|key| reader.read(0, key).map_or_else(|error| without_folder(&error.to_string(), folder.path()), |_| String::new()))
        .collect();
    assert_eq!(
        said,
        [
            "",
            "DIR/a2.obj:4: vertex 4 in \"4\" does not exist: 3 vertices so far, counted from 1, or from -1 backwards",
            "DIR/a3.obj does not exist, but its sequence goes from 1 to 4; put it there, or play only the part before it",
            "",
            "there is no key-frame 4; the mesh has 4 of them",
            "there is no key-frame 5; the mesh has 4 of them"
        ]
    );
    assert!(matches!(reader.read(1, 0), Err(Error::NoKeyFrame { count: 0, .. })));
    // The first one is an error at once.
    std::fs::remove_file(folder.path().join("a1.obj")).unwrap();
    assert!(message(&folder.path().join("a%d.obj"), folder.path()).starts_with("DIR/a2.obj:4: "));
}

#[test]
fn patterns_that_find_nothing_say_why() {
    let folder = folder(&[("walk.001.obj", triangle(1.0).as_bytes())]);
    let said = |name: &str| message(&folder.path().join(name), folder.path());
    assert_eq!(said("walk.%04d.obj"), "no file matches DIR/walk.%04d.obj; there is walk.001.obj: write %03d for its number");
    assert_eq!(said("run.###.obj"), "no file matches DIR/run.%03d.obj; the names must be the same but for a number of 3 digits or more");
    assert_eq!(said("w##.#.obj"), "\"w##.#.obj\" has two places for a number; a sequence has one");
    assert_eq!(said("walk.%03d.fbx"), "DIR/walk.%03d.fbx does not exist");
}

fn herd(text: &str) -> tempfile::TempDir {
    let keys: Vec<String> = (0..4).map(|key| triangle(1.0 + key as f32)).collect();
    folder(&[
        ("scene.toml", text.as_bytes()),
        ("keys/k0.obj", keys[0].as_bytes()),
        ("keys/k1.obj", keys[1].as_bytes()),
        ("keys/k2.obj", keys[2].as_bytes()),
        ("keys/k3.obj", keys[3].as_bytes()),
    ])
}

#[test]
fn a_described_sequence_loops_from_its_start_with_everything_else_applied() {
    let folder = herd(
        "[[material]]\nname = \"red\"\n[[mesh]]\nsequence = \"keys/k%d.obj\"\nfps = 8\nloop = true\nstart = 0.0625\nmaterial = \"red\"\n\
         scale = 2\ntranslate = [0, 0, 5]\n[[mesh]]\nsequence = [\"keys/k3.obj\", \"keys/k0.obj\"]\nfps = 4\nloop = true\ninterpolate = false\n\
         [[mesh]]\nshape = \"box\"\n",
    );
    let moving = animation(folder.path());
    assert!(matches!(moving.motions[..], [Motion::Keys, Motion::Keys, Motion::Still]));
    assert_eq!((moving.duration, moving.fps, moving.cyclic, moving.frame_count(8.0)), (0.5, 8.0, true, 4));
    let keys: Vec<KeyPair> = (0..5).map(|frame| moving.keys_at(0, f64::from(frame) / 8.0)).collect();
    assert_eq!(keys, [pair(0, 1, 0.5), pair(1, 2, 0.5), pair(2, 3, 0.5), pair(3, 0, 0.5), pair(0, 1, 0.5)]);
    let keys: Vec<KeyPair> = (0..5).map(|frame| moving.keys_at(1, f64::from(frame) / 8.0)).collect();
    assert_eq!(keys, [pair(0, 0, 0.0), pair(0, 0, 0.0), pair(1, 1, 0.0), pair(1, 1, 0.0), pair(0, 0, 0.0)]);
    // At time 0, half-way from the first to the second.
    assert_eq!(moving.scene.meshes[0].positions[1], [3.0, 0.0, 5.0]);
    assert_eq!((moving.scene.meshes[0].materials[0], moving.scene.meshes[0].name.as_str()), (1, "k"));
    assert_eq!(moving.scene.meshes[1].positions[1], [4.0, 0.0, 0.0]);
    let mut reader = moving.reader().unwrap();
    let read = reader.read(0, 2).unwrap();
    assert_eq!((read.mesh.positions[1], read.mesh.materials[0]), ([6.0, 0.0, 5.0], 1));
    assert!(read.read_ms > 0.0 && read.parse_ms > 0.0);
    // What the scene at time 0 and the other mesh read is still at hand.
    assert_eq!([(0, 0), (0, 1), (0, 3), (1, 0), (1, 1)].map(|(mesh, key)| reader.read(mesh, key).unwrap().read_ms), [0.0; 5]);
}

#[test]
fn every_rate_hits_the_key_frames_exactly() {
    let mut files: Vec<(String, String)> = Vec::new();
    for key in 0..48 {
        files.push((format!("a{key}.obj"), triangle(1.0)));
    }
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
    let folder = folder(&files);
    for (fps, looped) in [("23.976", true), ("12", false), ("29.97", true), ("24", true), ("0.1", false), ("1000", true)] {
        let text = format!("[[mesh]]\nsequence = \"a#.obj\"\nfps = {fps}\nloop = {looped}\n");
        std::fs::write(folder.path().join("scene.toml"), text).unwrap();
        let moving = animation(folder.path());
        let rate: f64 = fps.parse().unwrap();
        for frame in (0..2000_u32).chain(1_000_000..1_000_200) {
            let key = if looped { frame % 48 } else { frame.min(47) };
            assert_eq!(moving.keys_at(0, f64::from(frame) / rate), pair(key, key, 0.0), "{fps}, frame {frame}");
            // Twice the rate: every other frame is half-way.
            let between = moving.keys_at(0, f64::from(2 * frame + 1) / (2.0 * rate));
            let expected = if looped || frame < 47 { pair(key, (key + 1) % 48, 0.5) } else { pair(47, 47, 0.0) };
            assert!(
                between.first == expected.first && between.second == expected.second && (between.weight - expected.weight).abs() < 1e-5
            );
        }
        assert_eq!(moving.frame_count(rate), 48);
        assert_eq!(moving.frame_count(2.0 * rate), if looped { 96 } else { 95 });
        // Negative control: a hair off a key-frame is off it.
        assert!(moving.keys_at(0, 1.00001 / rate).weight > 0.0);
    }
}

#[test]
fn it_is_cyclic_only_where_all_that_moves_ends_together() {
    for (keys, cyclic, duration) in [
        ("loop = true\n[[mesh]]\nsequence = \"keys/k#.obj\"\nfps = 2\nloop = true\n", true, 2.0),
        ("loop = true\n[[mesh]]\nsequence = \"keys/k#.obj\"\nfps = 2\nloop = false\n", false, 1.5),
        ("loop = true\n[[mesh]]\nsequence = \"keys/k#.obj\"\nfps = 3\nloop = true\n", false, 4.0 / 3.0),
        ("start = 0.25\n", false, 0.5),
    ] {
        let folder = herd(&format!("[[mesh]]\nsequence = \"keys/k#.obj\"\nfps = 4\n{keys}"));
        let moving = animation(folder.path());
        assert_eq!((moving.cyclic, moving.duration), (cyclic, duration), "{keys}");
    }
}

#[test]
fn materials_and_textures_come_once() {
    let library = b"newmtl skin\nKd 1 0.5 0\nmap_Kd skin.png\nnewmtl bone\nKd 1 1 1\nmap_Kd bone.png\n".as_slice();
    let key = |materials: &str| format!("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{materials}");
    let files = [
        key("usemtl skin\nf 1 2 3\n"),
        key("usemtl skin\nf 1 2 3\n"),
        key("usemtl bone\nf 1 2 3\nusemtl skin\nf 1 3 2\n"),
        key("usemtl hide\nf 1 2 3\n"),
    ];
    let folder = folder(&[
        ("a.mtl", library),
        ("skin.png", &png(png::ColorType::Rgb, &[1, 2, 3])),
        ("bone.png", &png(png::ColorType::Rgb, &[9, 9, 9])),
        ("a0.obj", files[0].as_bytes()),
        ("a1.obj", files[1].as_bytes()),
        ("a2.obj", files[2].as_bytes()),
        ("a3.obj", files[3].as_bytes()),
    ]);
    let moving = animation(&folder.path().join("a#.obj"));
    assert_eq!((moving.scene.materials.len(), moving.scene.textures.len()), (2, 1));
    let mut reader = moving.reader().unwrap();
    let first = reader.read(0, 1).unwrap();
    assert_eq!((first.added_materials.len(), first.added_textures.len(), first.mesh.materials[0]), (0, 0, 1));
    let bone = reader.read(0, 2).unwrap();
    assert_eq!((bone.added_materials.len(), bone.added_textures.len()), (1, 1));
    assert_eq!((bone.added_materials[0].name.as_str(), bone.added_materials[0].diffuse_map), ("bone", Some(1)));
    assert_eq!(bone.mesh.materials, [2, 1]);
    let hide = reader.read(0, 3).unwrap();
    assert_eq!((hide.added_materials.len(), hide.mesh.materials[0], hide.warnings.len()), (0, 0, 1));
    let again = reader.read(0, 2).unwrap();
    assert_eq!((again.added_materials.len(), again.added_textures.len(), again.mesh), (0, 0, bone.mesh));
    // A second reader begins where the scene does.
    assert_eq!(moving.reader().unwrap().read(0, 2).unwrap().added_materials, bone.added_materials);
}

#[test]
fn without_room_every_file_is_read_anew() {
    let folder = herd("[[mesh]]\nsequence = \"keys/k#.obj\"\n");
    for (limit, anew) in [(0, true), (1 << 20, false)] {
        let options = LoadOptions { max_key_cache_bytes: limit, ..LoadOptions::default() };
        let moving = open(folder.path(), &options, &AnimationOptions::default()).unwrap();
        let mut reader = moving.reader().unwrap();
        let first = reader.read(0, 1).unwrap();
        let second = reader.read(0, 1).unwrap();
        assert_eq!((first.mesh, second.read_ms > 0.0), (second.mesh, anew));
    }
}

#[test]
fn a_clip_that_nobody_has_is_an_error() {
    let folder = herd("[[mesh]]\nsequence = \"keys/k#.obj\"\n");
    let mut wanted = AnimationOptions::default();
    wanted.clip = Some("walk".to_owned());
    let error = open(folder.path(), &LoadOptions::default(), &wanted).unwrap_err();
    assert_eq!(error.to_string(), "there is no clip \"walk\"; this scene has none: leave the clip out");
}

/// `count` triangles side by side.
fn row(count: usize) -> String {
    let mut text = String::new();
    for at in 0..count {
        text += &format!("v {at} 0 0\nv {at}.5 0 0\nv {at} 1 0\nf -3 -2 -1\n");
    }
    text
}

#[test]
fn faces_may_change_grow_and_vanish_and_come_back() {
    let counts = [2, 20, 0, 3, 3];
    let mut texts: Vec<String> = counts.iter().map(|&count| row(count)).collect();
    // As many vertices, other faces.
    texts[4] = texts[4].replacen("f -3 -2 -1", "f -3 -1 -2", 1);
    let folder = folder(&[]);
    for (key, text) in texts.iter().enumerate() {
        std::fs::write(folder.path().join(format!("a.{key}.obj")), text).unwrap();
    }
    for start in 0..counts.len() {
        // Half-way to the next key-frame; none of them has the same faces, so that the first one stands.
        let text = format!("[[mesh]]\nsequence = \"a.#.obj\"\nfps = 1\nloop = true\nstart = {start}.5\n");
        std::fs::write(folder.path().join("scene.toml"), text).unwrap();
        let moving = animation(folder.path());
        assert_eq!(moving.keys_at(0, 0.0), pair(start as u32, (start as u32 + 1) % 5, 0.5));
        let mut reader = moving.reader().unwrap();
        assert_eq!(moving.scene.meshes[0], reader.read(0, start as u32).unwrap().mesh);
        for (key, &count) in counts.iter().enumerate() {
            assert_eq!(reader.read(0, key as u32).unwrap().mesh.indices.len(), count);
        }
        // The empty one is told once.
        assert!(reader.read(0, 2).unwrap().warnings.is_empty());
    }
}

#[test]
fn key_frames_may_be_ply_in_any_packing_and_mixed_with_obj() {
    let ply = |x: f32| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
             property list uchar int vertex_index\nend_header\n0 0 0\n{x} 0 0\n0 1 0\n3 0 1 2\n"
        )
    };
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, ply(2.0).as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    let (plain, obj) = (ply(1.0), triangle(3.0));
    let folder = folder(&[
        ("a.1.ply", plain.as_bytes()),
        ("a.2.ply", &packed),
        ("b.07.ply.gz", &packed),
        ("c.obj", obj.as_bytes()),
        ("scene.toml", b"[[mesh]]\nsequence = [\"a.1.ply\", \"b.07.ply.gz\", \"c.obj\"]\nfps = 1\nstart = 1.5\n"),
    ]);
    let moving = animation(folder.path());
    assert_eq!((moving.scene.meshes[0].positions[1][0], moving.scene.meshes[0].name.as_str(), moving.duration), (2.5, "a.1", 0.5));
    let moving = animation(&folder.path().join("a.%d.ply"));
    assert_eq!((moving.key_count(0), moving.reader().unwrap().read(0, 1).unwrap().mesh.positions[1][0]), (2, 2.0));
    assert_eq!(animation(&folder.path().join("b.##.ply.gz")).key_count(0), 1);
}

#[test]
fn a_herd_parses_each_file_once_and_its_reader_goes_to_another_thread() {
    let mut text = String::new();
    for animal in 0..12 {
        text += &format!(
            "[[mesh]]\nsequence = \"keys/k#.obj\"\nloop = true\nstart = {}\ntranslate = [{animal}, 0, 0]\n",
            f64::from(animal) / 7.0
        );
    }
    let folder = herd(&text);
    let moving = animation(folder.path());
    let mut reader = moving.reader().unwrap();
    let parsed = std::thread::spawn(move || {
        let reads = (0..8).flat_map(|frame| (0..12).map(move |mesh| (mesh, frame % 4)));
        let parsed = reads.filter(|&(mesh, key)| reader.read(mesh, key).unwrap().read_ms > 0.0).count();
        (parsed, reader.read(11, 3).unwrap().mesh.positions)
    });
    // All four were read for the scene at time 0.
    assert_eq!(parsed.join().unwrap(), (0, vec![[11.0, 0.0, 0.0], [15.0, 0.0, 0.0], [11.0, 1.0, 0.0]]));
}

#[test]
fn the_automatic_camera_does_not_depend_on_the_frame() {
    let folder = herd("[[mesh]]\nsequence = \"keys/k#.obj\"\nfps = 1\n");
    let moving = animation(folder.path());
    let framing = Framing { azimuth: 70.0, ..Framing::default() };
    assert_eq!(moving.frame(&framing), moving.scene.frame(&framing));
    assert_eq!([moving.camera(None, 0.0), moving.camera(None, 3.0)], [moving.scene.camera(None); 2]);
    // Negative control: the last key-frame alone is framed from elsewhere.
    let last = folder.path().join("keys/k3.obj");
    assert_ne!(animation(&last).camera(None, 0.0), moving.camera(None, 3.0));
}

#[test]
fn names_lead_out_of_the_folder_no_more_than_those_of_other_meshes() {
    let text = triangle(1.0);
    let folder = folder(&[
        ("keys/k1.obj", text.as_bytes()),
        ("scene/inside.obj", text.as_bytes()),
        ("scene/scene.toml", b"[[mesh]]\nsequence = [\"inside.obj\", \"../keys/k1.obj\"]\n"),
    ]);
    let said = |error: &Error| without_folder(&error.to_string(), folder.path());
    let moving = animation(&folder.path().join("scene"));
    assert!(said(&moving.reader().unwrap().read(0, 1).unwrap_err()).contains("DIR/keys/k1.obj lies outside the scene's folder DIR/scene"));
    let allowed = LoadOptions { allow_external_paths: true, ..LoadOptions::default() };
    let moving = open(&folder.path().join("scene"), &allowed, &AnimationOptions::default()).unwrap();
    assert!(moving.reader().unwrap().read(0, 1).is_ok());
}
