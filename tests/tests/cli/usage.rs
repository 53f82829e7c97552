//! Status 2 to 5, and what the program says of mistakes.

use super::{folder, gridwalk, prepared, with_input, words};

#[test]
fn wrong_usage_is_status_2() {
    let folder = folder();
    for (line, said) in [
        ("", &["Usage"][..]),
        ("rendr two.obj", &["render"]),
        ("render", &["SCENE"]),
        ("render two.obj --sise 3x3", &["--size"]),
        ("render two.obj --size 3", &["1920x1080"]),
        ("render two.obj --size 0x3", &["1 to 65536"]),
        ("render two.obj --size 65536x65536", &["pixels"]),
        ("render two.obj --crop 1,2,3", &["x,y,width,height"]),
        ("render two.obj --size 8x8 --crop 4,4,8,8", &["crop"]),
        ("render two.obj --spp 0", &["--spp"]),
        ("render two.obj --depth -1", &["-1"]),
        ("render two.obj --density 0", &["above 0"]),
        ("render two.obj --density nan", &["above 0"]),
        ("render two.obj --density 4 --resolution 8", &["cannot be used with"]),
        ("render two.obj --resolution 0x1x1", &["1 to 4096"]),
        ("render two.obj --resolution 4096", &["cells"]),
        ("render two.obj --overlap sat", &["exact"]),
        ("render two.obj --eye 1,2", &["three numbers"]),
        ("render two.obj --target 1,2,3", &["--eye"]),
        ("render two.obj --eye 1,2,3 --target 1,2,3", &["stands on its target"]),
        ("render two.obj --eye 0,5,0 --target 0,0,0 --up +y", &["up direction"]),
        ("render two.obj --eye 1,2,3 --azimuth 5", &["cannot be used with"]),
        ("render two.obj --camera a --zoom 2", &["cannot be used with"]),
        ("render two.obj --camera nowhere", &["no camera \"nowhere\""]),
        ("render two.obj --up w", &["+Z"]),
        ("render two.obj --fov 180", &["degrees"]),
        ("render two.obj --zoom 0", &["above 0"]),
        ("render two.obj --exposure bright", &["number"]),
        ("render two.obj --tonemap agz", &["did you mean \"agx\""]),
        ("render two.obj -o a.exr --aov albdo", &["did you mean \"albedo\""]),
        ("render two.obj --aov N", &["--aov needs an EXR"]),
        ("render two.obj -o a.exr --heatmap steps", &["--heatmap is written as PNG"]),
        ("render two.obj -o a.png --heatmap stepz", &["steps"]),
        ("render two.obj -o a.jpg", &[".png or .exr"]),
        ("render two.obj -o a.png -o a.png", &["twice"]),
        ("render two.obj -o - --json", &["standard output"]),
        ("render two.obj --repeat 0", &["--repeat"]),
        ("render two.obj -q -v", &["cannot be used with"]),
        ("cast two.obj -o h.npz", &["--rays"]),
        ("cast two.obj --rays r.npy", &["--output"]),
        ("cast - --rays - -o h.npz", &["standard input"]),
        ("diff a.png", &["<B>"]),
        ("diff a.png b.png --threshold=-1", &["0 or above"]),
        ("diff a.png b.png --metric flip", &["ssim"]),
        ("list cameras", &["SCENE"]),
        ("list shaders", &["tonemaps"]),
        ("completions tcsh", &["bash"]),
    ] {
        gridwalk(folder.path(), words(line)).fails(2, said);
    }
    assert_eq!(super::entries(folder.path()), ["two.obj"], "wrong usage writes nothing");
}

#[test]
fn unusable_files_are_status_3() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 9\n");
    write("broken.toml", "[[mesh]]\nfile = 3\n");
    write("notes.txt", "hello");
    write("external.toml", "[[mesh]]\nfile = \"/etc/passwd\"\n");
    for (line, said) in [
        ("render tow.obj", &["tow.obj", "two.obj"][..]),
        ("render nothing/at/all.obj", &["nothing/at/all.obj"]),
        ("render broken.obj", &["broken.obj:5"]),
        ("render broken.toml", &["broken.toml:2"]),
        ("render notes.txt", &["notes.txt"]),
        ("render external.toml", &["--allow-external-paths"]),
        ("info broken.obj", &["broken.obj:5"]),
        ("cast two.obj --rays none.npy -o h.npz", &["none.npy"]),
        ("cast two.obj --rays two.obj -o h.npz", &["two.obj", "numpy.save"]),
        ("diff two.obj two.obj", &["PNG"]),
        ("diff a.png b.png", &["a.png"]),
    ] {
        gridwalk(folder.path(), words(line)).fails(3, said);
    }
    with_input(folder.path(), words("render -"), b"v 0 0\nf 1 1 1\n").fails(3, &["-:1"]);
    for name in super::entries(folder.path()) {
        assert!(!name.contains("part") && !name.ends_with("png") && !name.ends_with("npz"), "{name} was left");
    }
}

#[test]
fn max_size_bounds_what_is_read() {
    let folder = folder();
    let long = "# a line of forty characters, and no more\n".repeat(30_000);
    std::fs::write(folder.path().join("long.obj"), format!("{long}{}", super::TRIANGLES)).unwrap();
    gridwalk(folder.path(), words("info long.obj --max-size 1")).fails(3, &["long.obj", "limit"]);
    gridwalk(folder.path(), words("info long.obj --max-size 2")).expect(0);
}

#[test]
fn no_device_is_status_4() {
    let folder = folder();
    gridwalk(folder.path(), words("render two.obj --device voodoo2")).fails(4, &["voodoo2"]);
    gridwalk(folder.path(), words("render two.obj --device 99")).fails(4, &["99"]);
    let run = |line: &str, name: &str, value: &str| {
        let output = prepared(folder.path(), words(line)).env(name, value).output().unwrap();
        super::Run::new(format!("{name}={value} gridwalk {line}"), output)
    };
    run("render two.obj", "GRIDWALK_DEVICE", "voodoo2").fails(4, &["voodoo2"]);
    // The option goes before the variable.
    run("render two.obj --size 4x4 --device 0", "GRIDWALK_DEVICE", "voodoo2").expect(0);
    for line in ["render two.obj", "devices"] {
        let output = prepared(folder.path(), words(line))
            .env("VK_DRIVER_FILES", "/nonexistent.json")
            .env("VK_ICD_FILENAMES", "/nonexistent.json")
            .output()
            .unwrap();
        super::Run::new(format!("{line} without a driver"), output).fails(4, &[]);
    }
    assert_eq!(super::entries(folder.path()), ["two.obj", "two.png"]);
}

/// 2^28 cells of eight bytes, beside their scratch.
#[test]
fn too_much_memory_is_status_5() {
    let folder = folder();
    let run = gridwalk(folder.path(), words("render two.obj --size 4x4 --resolution 4096x4096x16"));
    if run.status == 0 {
        eprintln!("skipped: this device has room for 2^28 cells");
        return;
    }
    run.fails(5, &["error:"]);
    assert_eq!(super::entries(folder.path()), ["two.obj"]);
}
