//! Every option of `render` does something, and what it says.

use super::{decode_png, entries, folder, gridwalk, prepared, read_png, with_input, words};

#[test]
fn no_option_is_needed() {
    let folder = folder();
    let run = gridwalk(folder.path(), words("render two.obj")).expect(0);
    assert!(run.stdout.is_empty());
    assert!(run.stderr.contains("wrote two.png"), "where the picture went, which nobody asked for by name: {}", run.stderr);
    let (width, height, color, pixels) = read_png(&folder.path().join("two.png"));
    assert_eq!((width, height, color), (1024, 768, png::ColorType::Rgb));
    let middle = ((height / 2 * width + width / 2) * 3) as usize;
    assert_ne!(pixels[middle..middle + 3], pixels[..3], "the triangle stands in the middle, the background at the corner");
    assert_eq!(entries(folder.path()), ["two.obj", "two.png"]);
}

/// Each of these changes the picture, and the same twice does not.
#[test]
fn options_change_the_picture() {
    let folder = folder();
    let picture = |options: &str| {
        let run = gridwalk(folder.path(), words(&format!("render two.obj --size 40x30 -q -o - {options}"))).expect(0);
        assert_eq!(run.stderr, "", "-q says nothing");
        decode_png(&run.stdout)
    };
    let plain = picture("");
    assert_eq!(plain, picture(""), "the same input gives the same picture");
    for options in [
        "--azimuth 40",
        "--azimuth -40",
        "--elevation 30",
        "--zoom 2",
        "--fov 60 --azimuth 1",
        "--up +Z",
        "--up -0,1,0.5",
        "--ortho",
        "--eye 0.2,0.3,4",
        "--eye -1,0.3,4 --target 0.5,0,0",
        "--eye 0.2,0.3,4 --up x",
        "--exposure 1",
        "--exposure -1.5",
        "--tonemap aces",
        "--tonemap agx",
        "--tonemap neutral",
        "--tonemap reinhard",
        "--spp 4",
        "--transparent",
        "--heatmap steps --density 100",
        "--crop 10,5,20,10",
    ] {
        assert_ne!(plain, picture(options), "{options} changes nothing");
    }
    // The grid is not to be seen.
    for options in ["--density 2", "--resolution 5x6x7", "--resolution 9", "--overlap exact", "--overlap box", "--depth 0", "--device cpu"]
    {
        assert_eq!(plain, picture(options), "{options} is to be seen");
    }
    let (width, height, ..) = picture("--size 33,17");
    assert_eq!((width, height), (33, 17), "the last of two wins, and a comma serves");
}

#[test]
fn crop_is_a_part_of_the_whole() {
    let folder = folder();
    gridwalk(folder.path(), words("render two.obj --size 40x30 -o whole.png")).expect(0);
    gridwalk(folder.path(), words("render two.obj --size 40x30 --crop 10,5,20,12 -o part.png")).expect(0);
    let (_, _, _, whole) = read_png(&folder.path().join("whole.png"));
    let (width, height, _, part) = read_png(&folder.path().join("part.png"));
    assert_eq!((width, height), (20, 12));
    for row in 0..12 {
        let from = ((row + 5) * 40 + 10) * 3;
        assert_eq!(part[row * 60..row * 60 + 60], whole[from..from + 60], "row {row}");
    }
}

#[test]
fn transparent_has_no_background() {
    let folder = folder();
    gridwalk(folder.path(), words("render two.obj --size 40x30 --transparent -o a.png")).expect(0);
    let (_, _, color, pixels) = read_png(&folder.path().join("a.png"));
    assert_eq!(color, png::ColorType::Rgba);
    assert_eq!(pixels[3], 0, "nothing in the corner");
    assert_eq!(pixels[(15 * 40 + 20) * 4 + 3], 255, "the triangle in the middle");
}

#[test]
fn a_scene_from_standard_input() {
    let folder = folder();
    let run = with_input(folder.path(), words("render - --size 16x12 -q -o -"), super::TRIANGLES.as_bytes()).expect(0);
    gridwalk(folder.path(), words("render two.obj --size 16x12 -o file.png")).expect(0);
    assert_eq!(decode_png(&run.stdout).3, read_png(&folder.path().join("file.png")).3);
    with_input(folder.path(), words("render - --size 8x8"), super::TRIANGLES.as_bytes()).expect(0);
    assert!(entries(folder.path()).contains(&"stdin.png".to_owned()));
}

#[test]
fn cameras_by_name_and_number() {
    let folder = folder();
    let scene = "[[mesh]]\nfile = \"two.obj\"\n\
        [[camera]]\nname = \"front\"\neye = [0.3, 0.3, 5]\ntarget = [0.3, 0.3, 0]\n\
        [[camera]]\nname = \"side\"\neye = [5, 0.5, 3]\ntarget = [0.3, 0.3, 0]\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let picture = |options: &str| {
        decode_png(&gridwalk(folder.path(), words(&format!("render scene.toml --size 20x15 -o - {options}"))).expect(0).stdout)
    };
    assert_eq!(picture(""), picture("--camera front"), "the first is the default");
    assert_eq!(picture("--camera side"), picture("--camera 1"));
    assert_ne!(picture("--camera side"), picture("--camera front"));
    assert_ne!(picture("--camera side --fov 80"), picture("--camera side"));
    gridwalk(folder.path(), words("render scene.toml --camera sid")).fails(2, &["did you mean \"side\""]);
    let list = gridwalk(folder.path(), words("render scene.toml --list-cameras")).expect(0).text();
    assert_eq!(list.lines().map(|line| line.split('\t').next().unwrap()).collect::<Vec<_>>(), ["front", "side"]);
    assert_eq!(gridwalk(folder.path(), words("list cameras scene.toml")).expect(0).text(), list);
}

#[test]
fn exr_layers_are_what_was_asked_for() {
    use exr::prelude::{ReadChannels, ReadLayers};
    let folder = folder();
    let channels = |options: &str| {
        gridwalk(folder.path(), words(&format!("render two.obj --size 16x12 -o a.exr {options}"))).expect(0);
        let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let image = read.from_file(folder.path().join("a.exr")).unwrap();
        assert!(image.layer_data[0].attributes.software_name.as_ref().unwrap().to_string().starts_with("gridwalk "));
        assert!(image.layer_data[0].attributes.world_to_camera.is_some());
        image.layer_data[0].channel_data.list.iter().map(|channel| channel.name.to_string()).collect::<Vec<_>>()
    };
    assert_eq!(channels(""), ["A", "B", "G", "R"]);
    assert_eq!(channels("--aov Z,id"), ["A", "B", "G", "R", "Z", "id.material", "id.mesh", "id.prim"]);
    assert_eq!(channels("--aov depth --aov normal"), ["A", "B", "G", "N.X", "N.Y", "N.Z", "R", "Z"]);
    assert_eq!(
        channels("--aov all"),
        [
            "A",
            "B",
            "G",
            "N.X",
            "N.Y",
            "N.Z",
            "Ng.X",
            "Ng.Y",
            "Ng.Z",
            "P.X",
            "P.Y",
            "P.Z",
            "R",
            "Z",
            "albedo.B",
            "albedo.G",
            "albedo.R",
            "debug.cells",
            "debug.steps",
            "debug.tests",
            "id.material",
            "id.mesh",
            "id.prim",
            "uv.U",
            "uv.V"
        ]
    );
}

#[test]
fn statistics_are_a_table_on_standard_error() {
    let folder = folder();
    let run = gridwalk(folder.path(), words("render two.obj --size 16x12 --stats")).expect(0);
    assert!(run.stdout.is_empty());
    for row in ["device ", "driver ", "resolution ", "pairs ", "build ", "all map", "all cooperative", "trace ", "frame ", "wall clock"] {
        assert!(run.stderr.contains(row), "no row \"{row}\" in\n{}", run.stderr);
    }
}

#[test]
fn verbosity() {
    let folder = folder();
    let quiet = gridwalk(folder.path(), words("render two.obj --size 8x8 -q")).expect(0);
    assert_eq!(quiet.stderr, "");
    let talkative = gridwalk(folder.path(), words("render two.obj --size 8x8 -v")).expect(0);
    assert!(talkative.stderr.contains("info: wrote two.png"), "{}", talkative.stderr);
    assert!(!talkative.stderr.contains('\x1b'), "no colours where nobody sees them");
    assert!(!talkative.stderr.contains('\r') && !talkative.stderr.contains("rendering"), "no progress bar either");
    gridwalk(folder.path(), words("render two.obj --size 8x8 -q --log-file log.txt")).expect(0);
    let log = std::fs::read_to_string(folder.path().join("log.txt")).unwrap();
    assert!(log.contains("wrote two.png"), "{log}");
    gridwalk(folder.path(), words("render two.obj --log-file none/log.txt")).fails(7, &["none/log.txt"]);
}

/// A GPU goes without saying, a CPU does not.
#[test]
fn a_cpu_is_named_as_one() {
    let folder = folder();
    let devices = gridwalk(folder.path(), words("devices --json")).expect(0).json();
    let Some(cpu) = devices["devices"].as_array().unwrap().iter().find(|device| device["kind"] == "CPU") else {
        eprintln!("skipped: no device here is a CPU");
        return;
    };
    let run = gridwalk(folder.path(), ["render", "two.obj", "--size", "8x8", "--device", &cpu["index"].to_string()]).expect(0);
    assert!(run.stderr.contains("the device is the CPU"), "{}", run.stderr);
    let by_uuid = gridwalk(folder.path(), ["render", "two.obj", "--size", "8x8", "--json", "--device", cpu["uuid"].as_str().unwrap()]);
    assert_eq!(by_uuid.expect(0).json()["device_uuid"], cpu["uuid"]);
    let name = cpu["name"].as_str().unwrap().split(' ').next().unwrap().to_uppercase();
    let by_name = gridwalk(folder.path(), ["render", "two.obj", "--size", "8x8", "--json", "--device", &name]).expect(0);
    assert_eq!(by_name.json()["device"], cpu["name"]);
}

#[test]
fn validation_is_silent_or_absent() {
    let folder = folder();
    let run = gridwalk(folder.path(), words("render two.obj --size 8x8 --validate"));
    if run.status == 4 && run.stderr.contains("validation layer is not installed") {
        eprintln!("skipped: no validation layer here");
        return;
    }
    run.expect(0);
}

#[test]
fn external_files_only_when_allowed() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("inner")).unwrap();
    std::fs::write(folder.path().join("outer.mtl"), "newmtl red\nKd 1 0 0\n").unwrap();
    let scene = format!("mtllib ../outer.mtl\nusemtl red\n{}", super::TRIANGLES);
    std::fs::write(folder.path().join("inner/scene.obj"), scene).unwrap();
    let inside = gridwalk(folder.path(), words("info inner/scene.obj --json")).expect(0);
    assert!(inside.stderr.contains("outer.mtl"), "{}", inside.stderr);
    let allowed = gridwalk(folder.path(), words("info inner/scene.obj --json --allow-external-paths")).expect(0);
    assert_eq!(allowed.stderr, "");
    assert!(allowed.json()["materials"].as_array().unwrap().iter().any(|name| name == "red"));
}

/// Nothing is left of a picture that was not finished.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let folder = folder();
    for (signal, status) in [("INT", 130), ("TERM", 143)] {
        let mut child = prepared(folder.path(), words("render two.obj --spp 65536 -v")).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        // From here on it renders, for far longer than the test lasts.
        assert!(lines.any(|line| line.unwrap().contains("info: grid of")));
        let kill = std::process::Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
        assert!(kill.success());
        assert_eq!(child.wait().unwrap().code(), Some(status));
        assert_eq!(entries(folder.path()), ["two.obj"]);
    }
}
