//! The scenes that are measured.

use std::fs::File;
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use gridwalk_scene::generate::{self, Random};
use gridwalk_scene::{Camera, Framing, LoadOptions, Mesh, Scene};

use crate::report::View;

/// A scene by its name.
struct Known {
    name: &'static str,
    source: Source,
    /// Where the automatic frame would look from outside.
    view: Option<View>,
    /// Which of its meshes, counted from 0, is the object that it is about, and whence that is seen.
    object: Option<(usize, View)>,
}

enum Source {
    /// A file below one of the folders that are searched.
    File(&'static str),
    /// A shape with a number of triangles.
    Made(&'static str),
}

const fn known(name: &'static str, file: &'static str) -> Known {
    Known { name, source: Source::File(file), view: None, object: None }
}

const fn view(eye: [f32; 3], target: [f32; 3], fov_degrees: f32) -> View {
    View { eye, target, fov_degrees }
}

/// Sponza is seen from the ground floor's western end along the nave, so that every ray starts inside; the teapot in the stadium from beside
/// it on the pitch.
const KNOWN: [Known; 8] = [
    known("bunny", "bunny/bunny.obj"),
    known("elephant", "elephant-gallop/elephant.0001.obj"),
    known("dragon", "dragon/dragon.obj"),
    Known { view: Some(view([-1100.0, 260.0, -30.0], [300.0, 420.0, 60.0], 60.0)), ..known("sponza", "crytek-sponza/sponza.obj") },
    Known { object: Some((1, view([0.42, 0.3, 0.5], [0.0, 0.08, 0.0], 22.0))), ..known("stadium", "stadium/scene.toml") },
    known("forest", "furniture/forest.toml"),
    known("army", "army/scene.toml"),
    Known { name: "soup", source: Source::Made("soup:262144"), view: None, object: None },
];

/// The scenes over which means are taken.
pub const FIVE: [&str; 5] = ["bunny", "elephant", "dragon", "sponza", "stadium"];

/// The scenes that are asked for, with `five` and `all` in place.
pub fn expand(specs: &[String]) -> Vec<String> {
    let names = |spec: &String| match spec.as_str() {
        "five" => FIVE.map(str::to_owned).to_vec(),
        "all" => KNOWN.map(|known| known.name.to_owned()).to_vec(),
        _ => vec![spec.clone()],
    };
    let default = ["bumpy:70000".to_owned()];
    let specs = if specs.is_empty() { &default } else { specs };
    specs.iter().flat_map(names).collect()
}

/// Triangles to measure, and whence they are seen.
pub struct Loaded {
    /// As asked for.
    pub name: String,
    /// One mesh with default material, without textures.
    pub scene: Scene,
    /// For square pictures.
    pub camera: Camera,
    /// What the scene is about, alone, where there is much else, and whence it is seen.
    pub object: Option<(Scene, Camera)>,
}

/// Finds or makes a scene.
///
/// # Errors
/// A name that is none, a file that is not there or cannot be read, a scene without triangles.
pub fn load(spec: &str, folders: &[PathBuf], seed: u64) -> Result<Loaded> {
    let known = KNOWN.iter().find(|known| known.name == spec);
    let made = |spec: &str| spec.split_once(':').and_then(|(shape, count)| make(shape, count, seed));
    let Made { scene, view, object } = match known {
        None => match made(spec) {
            Some(made) => made?,
            None => Made::plain(read(Path::new(spec))?),
        },
        Some(Known { source: Source::Made(spec), .. }) => made(spec).context("a shape that is none")??,
        Some(&Known { source: Source::File(file), view, object, .. }) => {
            let found = folders.iter().map(|folder| folder.join(file)).find(|path| path.is_file());
            let Some(path) = found else {
                let searched: Vec<String> = folders.iter().map(|folder| folder.join(file).display().to_string()).collect();
                // These have longer names there, which tell why they cannot be fetched.
                let name = match spec {
                    "elephant" => "elephant-gallop",
                    "sponza" => "crytek-sponza",
                    name => name,
                };
                bail!(
                    "{spec}: not found ({}). Bring it with `cargo tool scenes get {name}`, or name the folder above it in GRIDWALK_SCENES",
                    searched.join(", ")
                );
            };
            let scene = read(&path)?;
            let object = object.map(|(mesh, view)| {
                let triangles = |meshes: &[Mesh]| meshes.iter().map(|mesh| mesh.indices.len()).sum();
                let begin = triangles(scene.meshes.get(..mesh).unwrap_or_default());
                (begin..triangles(scene.meshes.get(..=mesh).unwrap_or_default()), view)
            });
            Made { scene, view, object }
        }
    };
    let triangles = scene.triangle_count();
    if triangles == 0 {
        bail!("{spec}: no triangles");
    }
    if u32::try_from(triangles).is_err() {
        bail!("{spec}: {triangles} triangles are too many");
    }
    let camera = match scene.cameras.is_empty() {
        true => scene.frame(&Framing { aspect: 1.0, up: scene.up, ..Framing::default() }),
        false => scene.camera(None).context("no camera")?,
    };
    let from = |View { eye, target, fov_degrees }| Camera { eye, target, vertical_fov_degrees: fov_degrees, ..camera };
    let camera = view.map_or(camera, from);
    let mesh = merged(&scene);
    let object = object.map(|(triangles, view)| (gridwalk_scene::scene_of_mesh(part(&mesh, triangles)), from(view)));
    let scene = gridwalk_scene::scene_of_mesh(mesh);
    Ok(Loaded { name: spec.to_owned(), scene, camera, object })
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
        let known: Vec<&str> = KNOWN.iter().map(|known| known.name).collect();
        let known = known.join(", ");
        format!("{}: neither a scene file, nor a known name ({known}), nor a shape with a number of triangles", path.display())
    })
}

/// All meshes of a scene as one.
pub fn merged(scene: &Scene) -> Mesh {
    generate::merge(&scene.meshes)
}

/// A scene that is made by number of triangles.
pub struct Made {
    /// The scene.
    pub scene: Scene,
    view: Option<View>,
    /// Triangles of the object that it is about, and whence that is seen.
    object: Option<(Range<usize>, View)>,
}

impl Made {
    fn plain(scene: Scene) -> Made {
        Made { scene, view: None, object: None }
    }
}

/// `None` where `shape` is not the name of one.
///
/// # Errors
/// A number of triangles that is none.
pub fn make(shape: &str, count: &str, seed: u64) -> Option<Result<Made>> {
    let plain: fn(u32, u64) -> Mesh = match shape {
        // A sphere of n segments has about n² triangles.
        "sphere" => |count, _| generate::sphere([0.0; 3], 1.0, root(count)),
        "bumpy" => generate::bumpy_sphere,
        "terrain" => terrain,
        "soup" => generate::soup,
        "stadium" => |count, seed| generate::stadium(40.0, count, seed),
        _ => return None,
    };
    let made = |count| {
        let made = Made::plain(gridwalk_scene::scene_of_mesh(plain(count, seed)));
        match shape {
            // The body comes first.
            "stadium" => {
                let triangles = 0..generate::bumpy_sphere(count, seed).indices.len();
                Made { object: Some((triangles, view([2.4, 2.2, 2.8], [0.0, 1.0, 0.0], 30.0))), ..made }
            }
            _ => made,
        }
    };
    Some(count.parse().map(made).with_context(|| format!("{shape}:{count}: not a number of triangles")))
}

/// Some of a mesh's triangles, with the vertices between the first and the last that they use.
fn part(mesh: &Mesh, triangles: Range<usize>) -> Mesh {
    let indices = mesh.indices.get(triangles).unwrap_or_default();
    let corners = || indices.iter().flatten().copied();
    let first = corners().min().unwrap_or(0);
    let vertices = first as usize..corners().max().map_or(0, |last| last as usize + 1);
    Mesh {
        name: mesh.name.clone(),
        positions: mesh.positions.get(vertices.clone()).unwrap_or_default().to_vec(),
        normals: mesh.normals.get(vertices.clone()).unwrap_or_default().to_vec(),
        uvs: mesh.uvs.get(vertices).unwrap_or_default().to_vec(),
        indices: indices.iter().map(|corners| corners.map(|corner| corner - first)).collect(),
        ..Mesh::default()
    }
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
            assert_eq!(loaded.object.is_some(), shape == "stadium");
        }
    }

    #[test]
    fn the_object_of_a_stadium_is_its_body() {
        let loaded = load("stadium:2000", &[], 3).unwrap();
        let (object, _) = loaded.object.unwrap();
        let (all, alone) = (&loaded.scene.meshes[0], &object.meshes[0]);
        assert_eq!(alone.indices.len(), all.indices.len() - 34, "two triangles of floor, sixteen walls of two");
        assert!(alone.positions.iter().all(|[x, y, z]| x.abs() < 1.5 && (-0.5..2.5).contains(y) && z.abs() < 1.5));
        let last = alone.indices.len() - 1;
        assert_eq!(
            alone.indices[last].map(|corner| alone.positions[corner as usize]),
            all.indices[last].map(|corner| all.positions[corner as usize])
        );
        let beyond = part(all, last + 1..all.indices.len());
        assert!(beyond.indices.len() == 34 && beyond.indices.iter().flatten().all(|&corner| (corner as usize) < beyond.positions.len()));
        assert_eq!(part(all, 3..3).positions.len(), 0);
    }

    #[test]
    fn names_for_several() {
        let expanded = expand(&["five".to_owned(), "torus.obj".to_owned()]);
        assert_eq!(expanded.len(), 6);
        assert!(expanded.starts_with(&FIVE.map(str::to_owned)) && expanded[5] == "torus.obj");
        assert_eq!(expand(&["all".to_owned()]).len(), KNOWN.len());
        assert_eq!(expand(&[]), ["bumpy:70000"]);
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
