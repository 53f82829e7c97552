//! The scenes that come with gridwalk.

use std::path::{Path, PathBuf};

use gridwalk_scene::{Background, LoadOptions, Scene, load};

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

fn scene(name: &str) -> Scene {
    load(&scenes().join(name), &LoadOptions::default()).unwrap()
}

#[test]
fn every_scene_loads_is_credited_and_small() {
    let mut total = 0;
    let mut names = Vec::new();
    for entry in std::fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let loaded = scene(&name);
        let expected: &[&str] =
            if name == "flat" { &["hard.obj:11896: a vertex is not finite; triangles at it are dropped (in 3 places)"] } else { &[] };
        assert_eq!(loaded.warnings, expected, "{name}");
        assert!(loaded.defaults.size.is_some() && loaded.camera(None).is_some(), "{name}");
        assert!(std::fs::read_to_string(path.join("CREDITS")).unwrap().contains("scene.toml"), "{name}");
        let mut folders = vec![path];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let entry = entry.unwrap();
                if entry.file_type().unwrap().is_dir() {
                    folders.push(entry.path());
                } else {
                    let bytes = entry.metadata().unwrap().len();
                    assert!(bytes < 3 << 20, "{:?}", entry.path());
                    total += bytes;
                }
            }
        }
        names.push(name);
    }
    names.sort();
    assert_eq!(names, ["cornell", "drops", "flat", "furniture", "masks", "mirrors", "teapot"]);
    assert!(total < 12 << 20, "{total} bytes");
}

#[test]
fn they_hold_what_they_are_there_for() {
    let teapot = scene("teapot");
    assert_eq!((teapot.meshes[0].name.as_str(), teapot.meshes[0].indices.len()), ("teapot", 3218));
    assert!(teapot.textures.len() == 2 && teapot.materials.iter().any(|material| material.illumination >= 3));
    let furniture = scene("furniture");
    assert_eq!(furniture.triangle_count(), 127_293);
    assert!(furniture.materials.iter().any(|material| material.opacity_map.is_some()), "the chair's seat");
    assert_eq!(scene("masks").materials.iter().filter(|material| material.opacity_map.is_some()).count(), 2, "both bushes have one leaf");
    assert!(matches!(scene("mirrors").background, Background::Equirectangular { width: 512, height: 256, .. }));
    assert!(scene("cornell").materials.iter().any(|material| material.emission != [0.0; 3]));
    let flat = scene("flat");
    assert!(flat.meshes[0].positions.as_flattened().iter().any(|value| !value.is_finite()));
    assert!(flat.bounds().unwrap().max.iter().all(|value| value.is_finite()));
}
