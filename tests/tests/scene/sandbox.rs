//! No file is opened that does not lie in the scene's folder, nor anything that is not a file.

use std::path::Path;

use gridwalk_scene::{Error, LoadOptions, Scene, load};

use super::{folder, png, without_folder};

const SECRET: &str = "newmtl m\nKd 0.125 0.25 0.5\n";

fn load_default(path: &Path) -> Scene {
    load(path, &LoadOptions::default()).unwrap()
}

/// Whether the scene holds what stands in the file that must not be opened.
fn leaked(scene: &Scene) -> bool {
    scene.materials.iter().any(|material| material.diffuse == [0.125, 0.25, 0.5]) || !scene.textures.is_empty()
}

fn triangle(library: &str) -> String {
    format!("mtllib {library}\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
}

#[test]
fn materials_outside_are_refused_however_they_are_spelled_and_opened_when_allowed() {
    let folder = folder(&[("outside/secret.mtl", SECRET.as_bytes()), ("scene/sub/x", b"")]);
    let scene = folder.path().join("scene/a.obj");
    let absolute = folder.path().join("outside/secret.mtl");
    let spellings = [
        absolute.to_string_lossy().into_owned(),
        "../outside/secret.mtl".to_owned(),
        "..\\outside\\secret.mtl".to_owned(),
        "sub/../../outside/secret.mtl".to_owned(),
        "./././../outside/SECRET.MTL".to_owned(),
        "../scene/../outside/secret.mtl".to_owned(),
    ];
    for spelling in &spellings {
        std::fs::write(&scene, triangle(spelling)).unwrap();
        let refused = load_default(&scene);
        assert!(!leaked(&refused), "{spelling}");
        assert!(refused.warnings[0].contains("materials are not read"), "{spelling}: {:?}", refused.warnings);
        // Negative control: the same file is found where it is allowed.
        let allowed = load(&scene, &LoadOptions { allow_external_paths: true, ..LoadOptions::default() }).unwrap();
        assert!(leaked(&allowed), "{spelling}: {:?}", allowed.warnings);
    }
    std::fs::write(&scene, triangle(&spellings[1])).unwrap();
    assert_eq!(
        without_folder(&load_default(&scene).warnings[0], folder.path()),
        "DIR/scene/a.obj:1: materials are not read: DIR/outside/secret.mtl lies outside the scene's folder DIR/scene; move it there, or allow it with --allow-external-paths"
    );
}

#[test]
fn textures_and_meshes_and_backgrounds_outside_are_refused() {
    let picture = png(png::ColorType::Grayscale, &[9]);
    let folder = folder(&[
        ("secret.png", &picture),
        ("secret.obj", b"v 0 0 0\n"),
        ("scene/a.mtl", b"newmtl m\nmap_Kd ../secret.png\n"),
        ("scene/a.obj", triangle("a.mtl").as_bytes()),
    ]);
    let scene = load_default(&folder.path().join("scene/a.obj"));
    assert!(!leaked(&scene));
    assert!(scene.warnings[0].contains("lies outside"), "{:?}", scene.warnings);
    for text in ["[[mesh]]\nfile = \"../secret.obj\"\n", "[background]\nimage = \"../secret.png\"\n"] {
        let path = folder.path().join("scene/scene.toml");
        std::fs::write(&path, text).unwrap();
        let error = load(&path, &LoadOptions::default()).unwrap_err();
        assert!(matches!(&error, Error::Description { line: 2, message, .. } if message.contains("lies outside")), "{error}");
        load(&path, &LoadOptions { allow_external_paths: true, ..LoadOptions::default() }).unwrap();
    }
}

#[test]
fn files_beyond_their_caps_are_refused() {
    let folder = folder(&[("a.mtl", SECRET.as_bytes()), ("a.obj", triangle("a.mtl").as_bytes())]);
    let path = folder.path().join("a.obj");
    let scene = load(&path, &LoadOptions { max_material_bytes: 10, ..LoadOptions::default() }).unwrap();
    assert!(!leaked(&scene));
    assert!(
        scene.warnings[0].ends_with("has 27 bytes, more than the limit of 10; raise the limit if this is meant"),
        "{:?}",
        scene.warnings
    );
    assert!(leaked(&load(&path, &LoadOptions { max_material_bytes: 27, ..LoadOptions::default() }).unwrap()));
    let error = load(&path, &LoadOptions { max_mesh_bytes: 10, ..LoadOptions::default() }).unwrap_err();
    assert!(matches!(error, Error::TooLarge { limit: 10, .. }), "{error}");
}

#[test]
fn names_that_are_not_there_are_told_with_a_neighbour() {
    let folder = folder(&[("teapot.obj", b"")]);
    let error = load(&folder.path().join("teepot.obj"), &LoadOptions::default()).unwrap_err();
    assert_eq!(without_folder(&error.to_string(), folder.path()), "DIR/teepot.obj does not exist: did you mean teapot.obj?");
    let error = load(&folder.path().join("teapot.xyz"), &LoadOptions::default()).unwrap_err();
    assert_eq!(without_folder(&error.to_string(), folder.path()), "DIR/teapot.xyz does not exist: did you mean teapot.obj?");
    let error = load(folder.path(), &LoadOptions::default()).unwrap_err();
    assert_eq!(without_folder(&error.to_string(), folder.path()), "DIR/scene.toml does not exist");
    std::fs::write(folder.path().join("teapot.xyz"), "").unwrap();
    let error = load(&folder.path().join("teapot.xyz"), &LoadOptions::default()).unwrap_err();
    assert_eq!(
        without_folder(&error.to_string(), folder.path()),
        "DIR/teapot.xyz: cannot tell the format by the ending; readable are .obj, .ply (also as .gz), .gltf, .glb and .toml"
    );
}

#[cfg(unix)]
#[test]
fn links_that_lead_outside_devices_and_pipes_are_refused() {
    use std::os::unix::fs::symlink;
    let folder = folder(&[("outside/secret.mtl", SECRET.as_bytes()), ("scene/inside.mtl", SECRET.as_bytes())]);
    let scene = folder.path().join("scene");
    symlink("../outside/secret.mtl", scene.join("file.mtl")).unwrap();
    symlink("../outside", scene.join("folder")).unwrap();
    symlink("inside.mtl", scene.join("good.mtl")).unwrap();
    symlink("loop.mtl", scene.join("loop.mtl")).unwrap();
    symlink("/dev/zero", scene.join("zero.mtl")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(scene.join("pipe.mtl")).status().unwrap().success());
    let path = scene.join("a.obj");
    for (library, opened) in [
        ("good.mtl", true),
        ("file.mtl", false),
        ("folder/secret.mtl", false),
        ("folder/SECRET.mtl", false),
        ("loop.mtl", false),
        ("zero.mtl", false),
        ("/dev/zero", false),
        ("pipe.mtl", false),
        ("PIPE.mtl", false),
    ] {
        std::fs::write(&path, triangle(library)).unwrap();
        let scene = load_default(&path);
        assert_eq!(leaked(&scene), opened, "{library}: {:?}", scene.warnings);
    }
    // With permission to leave the folder, what is no file is still not opened: one would never end, the other never begin.
    for library in ["/dev/zero", "zero.mtl", "pipe.mtl"] {
        std::fs::write(&path, triangle(library)).unwrap();
        let scene = load(&path, &LoadOptions { allow_external_paths: true, ..LoadOptions::default() }).unwrap();
        assert!(!leaked(&scene) && scene.warnings[0].contains("not a regular file"), "{library}: {:?}", scene.warnings);
    }
    for path in ["pipe.obj", "zero.obj"] {
        let path = scene.join(path);
        if path.ends_with("pipe.obj") {
            assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        } else {
            symlink("/dev/zero", &path).unwrap();
        }
        assert!(matches!(load(&path, &LoadOptions::default()), Err(Error::NotAFile { .. })));
    }
}
