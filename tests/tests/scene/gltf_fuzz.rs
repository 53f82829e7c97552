//! glTF files with random bytes and random JSON changed: whatever comes of them, nobody panics, hangs or takes much memory.

use gridwalk_scene::generate::Random;
use gridwalk_scene::{Animation, AnimationOptions, LoadOptions, Motion, Pose, open};
use serde_json::{Value, json};

use super::folder;
use super::fuzz::{assert_mixed, fuzz, mutated};
use super::gltf::{Maker, glb};

/// A small file with a bit of everything.
fn everything() -> Maker {
    let mut maker = Maker::with_material(json!({
        "alphaMode": "MASK", "normalTexture": { "index": 0 }, "emissiveFactor": [1, 1, 1],
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2, 2] } } },
            "metallicRoughnessTexture": { "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2, 2] } } },
        }
    }));
    maker.texture(png::ColorType::Rgba, &[9, 8, 7, 255, 200, 0, 99, 3]);
    let (joints, weights) = (maker.accessor(&[0, 1, 0, 0].repeat(3), 5121, "VEC4", 3), maker.floats(&[0.5; 12], "VEC4"));
    let target = maker.floats(&[0.5; 9], "VEC3");
    let indices = maker.indices(&[0, 1, 2]);
    let primitive = &mut maker.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["JOINTS_0"] = json!(joints);
    primitive["attributes"]["WEIGHTS_0"] = json!(weights);
    primitive["targets"] = json!([{ "POSITION": target }]);
    primitive["indices"] = json!(indices);
    maker.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }]);
    maker.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "intensity": 2, "spot": {} }] } });
    maker.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "children": [1, 2] }, { "mesh": 0, "camera": 0, "rotation": [0, 0, 1, 0] },
        { "extensions": { "KHR_lights_punctual": { "light": 0 } }, "scale": [1, -2, 3] },
    ]);
    maker.json["skins"] = json!([{ "joints": [1, 2] }]);
    maker.animate(1, "rotation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    maker.animate(1, "weights", "CUBICSPLINE", &[0.0, 1.0], &[0.0, 0.5, 1.0, 0.0, 0.5, 1.0]);
    maker.animate(2, "translation", "STEP", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
    maker
}

/// What whoever plays an animation relies on.
fn play(animation: Animation) -> gridwalk_scene::Scene {
    let mut pose = Pose::default();
    for time in [0.0, 0.4, 1.0, 7.7, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        for (mesh, motion) in animation.motions.iter().enumerate() {
            animation.pose(mesh, time, &mut pose);
            if let Motion::Deformed(deformed) = motion {
                assert_eq!((pose.matrices.len(), pose.weights.len()), (deformed.matrix_count as usize, deformed.targets.len()));
                assert!(deformed.influences.iter().all(|influence| influence.joint < deformed.matrix_count));
                assert_eq!(deformed.influences.len(), deformed.influences_each as usize * deformed.positions.len());
                assert_eq!(deformed.positions.len(), animation.scene.meshes[mesh].positions.len());
                assert_eq!(deformed.normals.len(), deformed.positions.len());
                let counts = deformed.targets.iter().flat_map(|target| [target.positions.len(), target.normals.len()]);
                assert!(counts.into_iter().all(|count| count == 0 || count == deformed.positions.len()));
            }
        }
        assert_eq!(animation.lights(time).len(), animation.scene.lights.len());
        let camera = animation.camera(None, time).unwrap();
        assert!(camera.eye != camera.target && camera.target.iter().all(|value| value.is_finite()), "{camera:?}");
    }
    assert_eq!(animation.motions.len(), animation.scene.meshes.len());
    assert!(animation.duration.is_finite() && animation.duration >= 0.0);
    animation.scene
}

fn small() -> LoadOptions {
    LoadOptions { max_mesh_bytes: 1 << 20, max_texture_bytes: 1 << 20, max_texture_size: 1024, ..LoadOptions::default() }
}

#[test]
fn bytes() {
    let maker = everything();
    let files = [("a.glb", maker.glb()), ("a.gltf", maker.text())];
    let folder = folder(&[]);
    let count = 4000;
    let scenes = fuzz("glTF bytes", count, |random| {
        let (name, bytes) = &files[random.below(2) as usize];
        let path = folder.path().join(name);
        std::fs::write(&path, mutated(bytes, 3, random)).unwrap();
        open(&path, &small(), &AnimationOptions::default()).ok().map(play)
    });
    assert_mixed("glTF bytes", scenes, count);
}

/// All numbers and lists in a value.
fn places(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| places(value, &format!("{path}/{key}"), found)),
        Value::Array(list) => list.iter().enumerate().for_each(|(at, value)| places(value, &format!("{path}/{at}"), found)),
        _ => {}
    }
    if !path.is_empty() {
        found.push(path.to_owned());
    }
}

#[test]
fn values() {
    let maker = everything();
    let mut all = Vec::new();
    places(&maker.json, "", &mut all);
    let folder = folder(&[]);
    let path = folder.path().join("a.glb");
    let count = 6000;
    let scenes = fuzz("glTF values", count, |random| {
        let mut json = maker.json.clone();
        json["buffers"] = json!([{ "byteLength": maker.data.len() }]);
        for _ in 0..=random.below(3) {
            let place = &all[random.below(all.len() as u64) as usize];
            let other = all[random.below(all.len() as u64) as usize].clone();
            let other = json.pointer(&other).cloned().unwrap_or_default();
            let Some(value) = json.pointer_mut(place) else { continue };
            let numbers = [
                json!(0),
                json!(1),
                json!(2),
                json!(3),
                json!(7),
                json!(-1),
                json!(255),
                json!(5125),
                json!(5126),
                json!(65536),
                json!(u32::MAX),
                json!(u64::MAX),
                json!(1e30),
                json!(-0.5),
                json!(1e-30),
            ];
            match random.below(8) {
                0 => *value = other,
                1 => *value = json!([]),
                2 => *value = json!({}),
                3 => *value = json!("MAT4"),
                _ => *value = numbers[random.below(numbers.len() as u64) as usize].clone(),
            }
        }
        std::fs::write(&path, glb(&serde_json::to_vec(&json).unwrap(), &maker.data)).unwrap();
        open(&path, &small(), &AnimationOptions::default()).ok().map(play)
    });
    assert_mixed("glTF values", scenes, count);
}

#[test]
fn numbers() {
    // The JSON as it is, the buffer's bytes anything.
    let maker = everything();
    let folder = folder(&[]);
    let path = folder.path().join("a.glb");
    let count = 2000;
    let scenes = fuzz("glTF numbers", count, |random: &mut Random| {
        let mut data = maker.data.clone();
        for _ in 0..=random.below(20) {
            let at = random.below(data.len() as u64) as usize;
            data[at] = [0, 1, 255, 127, 128, random.next_u64() as u8][random.below(6) as usize];
        }
        let mut json = maker.json.clone();
        json["buffers"] = json!([{ "byteLength": data.len() }]);
        std::fs::write(&path, glb(&serde_json::to_vec(&json).unwrap(), &data)).unwrap();
        open(&path, &small(), &AnimationOptions::default()).ok().map(play)
    });
    assert_mixed("glTF numbers", scenes, count);
}
