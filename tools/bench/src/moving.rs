//! The animations that are measured.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use gridwalk_scene::{Animation, AnimationOptions, LoadOptions, Mesh};
use tempfile::TempDir;

use crate::scenes;

/// An animation by its name.
struct Known {
    name: &'static str,
    /// Below one of the folders that are searched, or a part of it that must be there.
    file: &'static str,
    make: Make,
}

enum Make {
    /// The file itself.
    Open,
    /// A pattern beside the file.
    Pattern(&'static str),
    /// Many of the sequence that the file begins, each at its own place and phase.
    Herd,
}

const KNOWN: [Known; 7] = [
    Known { name: "gallop", file: "elephant-gallop/elephant.0000.obj", make: Make::Pattern("elephant.%04d.obj") },
    Known { name: "herd", file: "elephant-gallop/elephant.0000.obj", make: Make::Herd },
    Known { name: "forest", file: "megaglest/forest/scene.toml", make: Make::Open },
    Known { name: "fox", file: "gltf/bevy-animated/Fox.glb", make: Make::Open },
    Known { name: "man", file: "gltf/CesiumMan/CesiumMan.glb", make: Make::Open },
    Known { name: "morph", file: "gltf/bevy-animated/MorphStressTest.gltf", make: Make::Open },
    Known { name: "engine", file: "gltf/2CylinderEngine/2CylinderEngine.glb", make: Make::Open },
];

/// An animation, with the folder of its files where these were made for it.
pub struct Moving {
    pub animation: Animation,
    pub folder: Option<TempDir>,
}

/// Finds or makes an animation.
///
/// # Errors
/// A name that is none, a file that is not there or cannot be read.
pub fn open(spec: &str, folders: &[PathBuf], seed: u64) -> Result<Moving> {
    if let Some((shape, count)) = spec.split_once(':')
        && let Some(scene) = scenes::make(shape, count, seed)
    {
        return swaying(&scenes::merged(&scene?.scene));
    }
    let Some(known) = KNOWN.iter().find(|known| known.name == spec) else {
        return Ok(Moving { animation: read(Path::new(spec))?, folder: None });
    };
    let found = folders.iter().map(|folder| folder.join(known.file)).find(|path| path.is_file());
    let Some(path) = found else {
        let searched: Vec<String> = folders.iter().map(|folder| folder.join(known.file).display().to_string()).collect();
        bail!("not found ({}); name the folder above it in GRIDWALK_SCENES", searched.join(", "));
    };
    match known.make {
        Make::Open => Ok(Moving { animation: read(&path)?, folder: None }),
        Make::Pattern(pattern) => Ok(Moving { animation: read(&path.with_file_name(pattern))?, folder: None }),
        Make::Herd => herd(&path.with_file_name("elephant.%04d.obj")),
    }
}

fn read(path: &Path) -> Result<Animation> {
    let options = LoadOptions { allow_external_paths: true, ..LoadOptions::default() };
    gridwalk_scene::open(path, &options, &AnimationOptions::default()).with_context(|| {
        let known = KNOWN.map(|known| known.name).join(", ");
        format!("neither a scene, nor a known name ({known}), nor a shape with a number of triangles")
    })
}

/// Twelve elephants, four abreast, no two in step.
fn herd(sequence: &Path) -> Result<Moving> {
    let sequence = std::path::absolute(sequence).context("where is the sequence?")?;
    let Some(sequence) = sequence.to_str() else { bail!("{}: not a name in UTF-8", sequence.display()) };
    let mut text = String::new();
    for animal in 0..12 {
        let (row, column) = (animal / 4, animal % 4);
        // 24 key-frames at 24 a second: five apart, so that neighbours differ much.
        let start = f64::from(animal * 5 % 24) / 24.0;
        let (x, z) = (f64::from(column) * 0.62, f64::from(row) * 1.25);
        // Writing to a string cannot fail.
        let _ =
            writeln!(text, "[[mesh]]\nsequence = {sequence:?}\nfps = 24\nloop = true\nstart = {start}\ntranslate = [{x:?}, 0.0, {z:?}]\n");
    }
    let folder = TempDir::new().context("no folder for the scene")?;
    let path = folder.path().join("scene.toml");
    fs::write(&path, text).with_context(|| format!("{}: cannot be written", path.display()))?;
    Ok(Moving { animation: read(&path)?, folder: Some(folder) })
}

/// Key-frames of a made scene.
const KEY_FRAMES: u32 = 12;

/// A mesh whose vertices sway, each with a phase by its place.
fn swaying(mesh: &Mesh) -> Result<Moving> {
    let folder = TempDir::new().context("no folder for the key-frames")?;
    let extent = mesh.bounds().map_or(1.0, |bounds| (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f32::max));
    let mut faces = String::new();
    for [a, b, c] in &mesh.indices {
        let _ = writeln!(faces, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    for key in 0..KEY_FRAMES {
        let turn = std::f32::consts::TAU * key as f32 / KEY_FRAMES as f32;
        let mut text = String::new();
        for [x, y, z] in &mesh.positions {
            let sway = 0.03 * extent * (turn + 9.0 * (x + y + z) / extent).sin();
            let _ = writeln!(text, "v {} {} {}", x + sway, y + 0.5 * sway, z);
        }
        let path = folder.path().join(format!("sway.{key:04}.obj"));
        fs::write(&path, text + &faces).with_context(|| format!("{}: cannot be written", path.display()))?;
    }
    Ok(Moving { animation: read(&folder.path().join("sway.%04d.obj"))?, folder: Some(folder) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_made_scene_moves() {
        let Moving { animation, folder } = open("sphere:200", &[], 1).unwrap();
        assert!(folder.is_some() && animation.frame_count(animation.fps) == u64::from(KEY_FRAMES));
        let mut reader = animation.reader().unwrap();
        let (first, second) = (reader.read(0, 0).unwrap().mesh, reader.read(0, 1).unwrap().mesh);
        assert_eq!(first.indices, second.indices);
        assert_ne!(first.positions, second.positions);
    }

    #[test]
    fn a_herd_is_twelve_sequences() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("elephant-gallop")).unwrap();
        for key in 0..2 {
            let path = folder.path().join(format!("elephant-gallop/elephant.{key:04}.obj"));
            fs::write(path, format!("v 0 0 0\nv 1 0 0\nv 0 {} 0\nf 1 2 3\n", key + 1)).unwrap();
        }
        let herd = open("herd", &[folder.path().to_owned()], 1).unwrap();
        assert_eq!(herd.animation.scene.meshes.len(), 12);
        assert!(format!("{:#}", open("gallop", &[], 1).err().unwrap()).contains("GRIDWALK_SCENES"));
    }
}
