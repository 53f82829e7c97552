//! The scenes that are measured.

use std::fs::File;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use gridwalk_scene::generate::{self, Random};
use gridwalk_scene::{Camera, Framing, LoadOptions, Mesh, Scene};

/// A scene by its name.
struct Known {
    name: &'static str,
    /// Below one of the folders that are searched.
    file: &'static str,
    /// Eye, target and angle of view, where the automatic frame would look from outside.
    view: Option<([f32; 3], [f32; 3], f32)>,
}

/// Sponza is seen from the ground floor's western end along the nave, so that every ray starts inside.
const KNOWN: [Known; 4] = [
    Known { name: "bunny", file: "bunny/bunny.obj", view: None },
    Known { name: "dragon", file: "dragon/dragon.obj", view: None },
    Known { name: "sponza", file: "crytek-sponza/sponza.obj", view: Some(([-1100.0, 260.0, -30.0], [300.0, 420.0, 60.0], 60.0)) },
    Known { name: "elephant", file: "elephant-gallop/elephant.0001.obj", view: None },
];

/// Triangles to measure, and whence they are seen.
pub struct Loaded {
    /// As asked for.
    pub name: String,
    /// One mesh with default material, without textures.
    pub scene: Scene,
    /// For square pictures.
    pub camera: Camera,
}

/// Finds or makes a scene.
///
/// # Errors
/// A name that is none, a file that is not there or cannot be read, a scene without triangles.
pub fn load(spec: &str, folders: &[PathBuf], seed: u64) -> Result<Loaded> {
    let known = KNOWN.iter().find(|known| known.name == spec);
    let scene = match (spec.split_once(':').and_then(|(shape, count)| make(shape, count, seed)), known) {
        (Some(made), _) => made?,
        (None, Some(known)) => {
            let found = folders.iter().map(|folder| folder.join(known.file)).find(|path| path.is_file());
            let Some(path) = found else {
                let searched: Vec<String> = folders.iter().map(|folder| folder.join(known.file).display().to_string()).collect();
                bail!(
                    "{spec}: not found ({}). Bring it with `cargo tool scenes get {spec}`, or name the folder above it in GRIDWALK_SCENES",
                    searched.join(", ")
                );
            };
            read(&path)?
        }
        (None, None) => read(Path::new(spec))?,
    };
    let triangles = scene.triangle_count();
    if triangles == 0 {
        bail!("{spec}: no triangles");
    }
    if u32::try_from(triangles).is_err() {
        bail!("{spec}: {triangles} triangles are too many");
    }
    let mut camera = match scene.cameras.is_empty() {
        true => scene.frame(&Framing { aspect: 1.0, up: scene.up, ..Framing::default() }),
        false => scene.camera(None).context("no camera")?,
    };
    if let Some((eye, target, fov)) = known.and_then(|known| known.view) {
        camera = Camera { eye, target, vertical_fov_degrees: fov, ..camera };
    }
    let scene = gridwalk_scene::scene_of_mesh(merged(&scene));
    Ok(Loaded { name: spec.to_owned(), scene, camera })
}

/// Where scenes are looked up by name: the folders given, those of `GRIDWALK_SCENES`, and the cache of `cargo tool scenes`.
pub fn folders(given: &[PathBuf]) -> Vec<PathBuf> {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let mut folders = given.to_vec();
    if let Some(list) = set("GRIDWALK_SCENES") {
        folders.extend(std::env::split_paths(&list));
    }
    let cache = set("GRIDWALK_CACHE")
        .map(PathBuf::from)
        .or_else(|| set("XDG_CACHE_HOME").map(|base| Path::new(&base).join("gridwalk")))
        .or_else(|| set("HOME").map(|home| Path::new(&home).join(".cache/gridwalk")));
    folders.extend(cache.map(|cache| cache.join("scenes")));
    folders
}

/// OBJ files are read as a stream, so that no material and no texture is opened.
fn read(path: &Path) -> Result<Scene> {
    let options = LoadOptions::default();
    let is_obj = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj"));
    let scene = if is_obj && path.is_file() {
        let mut file = File::open(path).with_context(|| format!("{}: cannot be opened", path.display()))?;
        gridwalk_scene::load_reader(&mut file, None, &options)
    } else {
        gridwalk_scene::load(path, &options)
    };
    scene.with_context(|| {
        let known = KNOWN.map(|known| known.name).join(", ");
        format!("{}: neither a scene file, nor a known name ({known}), nor a shape with a number of triangles", path.display())
    })
}

/// All meshes of a scene as one.
pub fn merged(scene: &Scene) -> Mesh {
    generate::merge(&scene.meshes)
}

/// `None` where `shape` is not the name of one.
///
/// # Errors
/// A number of triangles that is none.
pub fn make(shape: &str, count: &str, seed: u64) -> Option<Result<Scene>> {
    let make: fn(u32, u64) -> Mesh = match shape {
        // A sphere of n segments has about n² triangles.
        "sphere" => |count, _| generate::sphere([0.0; 3], 1.0, root(count)),
        "bumpy" => generate::bumpy_sphere,
        "terrain" => terrain,
        "soup" => generate::soup,
        "stadium" => |count, seed| generate::stadium(40.0, count, seed),
        _ => return None,
    };
    Some(
        count
            .parse()
            .with_context(|| format!("{shape}:{count}: not a number of triangles"))
            .map(|count| gridwalk_scene::scene_of_mesh(make(count, seed))),
    )
}

fn root(count: u32) -> u32 {
    f64::from(count).sqrt().round() as u32
}

/// Hills: a plane whose heights are six octaves of waves.
fn terrain(triangles: u32, seed: u64) -> Mesh {
    let mut mesh = generate::plane([2.0, 2.0], root(triangles / 2).max(1));
    let mut random = Random::new(seed);
    let waves: [([f32; 3], f32, f32); 18] = std::array::from_fn(|wave| {
        let pitch = f32::exp2((wave / 3) as f32);
        (random.direction().map(|value| value * 3.0 * pitch), random.range(0.0, 6.0), 0.09 / pitch)
    });
    for position in &mut mesh.positions {
        position[1] =
            waves.iter().map(|(wave, phase, height)| height * (wave[0] * position[0] + wave[2] * position[2] + phase).sin()).sum();
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_have_about_as_many_triangles_as_asked_for() {
        for shape in ["sphere", "bumpy", "terrain", "soup", "stadium"] {
            let loaded = load(&format!("{shape}:5000"), &[], 3).unwrap();
            let count = loaded.scene.triangle_count();
            assert!((4000..6500).contains(&count), "{shape}: {count}");
        }
    }

    #[test]
    fn errors_say_what_to_do() {
        let text = |spec: &str| format!("{:#}", load(spec, &[], 1).err().unwrap());
        assert!(text("bunny").contains("cargo tool scenes get bunny"));
        assert!(text("sphere:many").contains("not a number of triangles"));
        assert!(text("nowhere.obj").contains("nowhere.obj"));
    }

    #[test]
    fn names_are_looked_up_in_folders() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("bunny")).unwrap();
        std::fs::write(folder.path().join("bunny/bunny.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let loaded = load("bunny", &[PathBuf::from("nowhere"), folder.path().to_owned()], 1).unwrap();
        assert_eq!(loaded.scene.triangle_count(), 1);
    }
}
