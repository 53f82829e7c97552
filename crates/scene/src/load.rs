//! From a path to a scene.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::Scene;
use crate::animation::{CameraTrack, KeyTrack, LightTrack, MeshTrack, RigTrack};
use crate::assets::Assets;
use crate::files::{read_file, read_stream};
use crate::gltf::{self, Playing};
use crate::key_reader::{Cache, KeyReader, first_mesh};
use crate::mesh_file;
use crate::sequence::{Pattern, Range, Sequence, pattern_of};
use crate::transform::Edit;
use crate::{
    Animation, AnimationOptions, Background, DEFAULT_FPS, Error, Light, LoadOptions, Material, Mesh, Motion, RenderDefaults, Result,
};

/// Reads a scene: an `.obj` or `.ply` file, packed by gzip or not, a `.gltf` or `.glb` file, or a scene file (`.toml`), or a folder that
/// holds a `scene.toml`.
///
/// A scene without lights gets a key and a fill light and a soft gradient as background; one without cameras is framed automatically
/// ([`Scene::camera`]).
///
/// # Errors
/// Files that cannot be opened, are outside the scene's folder, too large, or malformed: see [`Error`]. Missing or unreadable materials
/// and textures are no errors; [`Scene::warnings`] lists them.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene> {
    open(path, options, &AnimationOptions::default()).map(|animation| animation.scene)
}

/// Reads a scene with all that moves in it. [`load`] gives the same scene at time 0.
///
/// A path such as `name.%04d.obj` or `name.####.obj` is a sequence: all files in its folder that have a number of so many digits or more in
/// that place, in the order of the numbers, [`DEFAULT_FPS`](crate::DEFAULT_FPS) of them a second. A number that is left out is an error when
/// its time comes.
///
/// # Errors
/// As [`load`]; a clip of an unknown name; a pattern that no file matches.
pub fn open(path: &Path, options: &LoadOptions, animation: &AnimationOptions) -> Result<Animation> {
    let inside = path.join("scene.toml");
    let path = if path.is_dir() { inside.as_path() } else { path };
    let opened = match (ending(path).as_deref(), pattern_of(path)?) {
        (Some("obj" | "ply" | "obj.gz" | "ply.gz"), Some((pattern, folder))) => open_sequence(pattern, &folder, options),
        (Some("obj" | "ply" | "obj.gz" | "ply.gz"), None) => {
            let bytes = read_file(path, options.max_mesh_bytes)?;
            load_mesh(&bytes, path, path.parent(), options).map(Animation::still)
        }
        (Some("gltf" | "glb"), _) => {
            let bytes = read_file(path, options.max_mesh_bytes)?;
            open_gltf(bytes, path, Some(&folder_of(path)), options, animation.clip.as_deref())
        }
        (Some("toml"), _) => crate::description::open(path, options),
        _ if path.exists() => Err(Error::UnknownFormat { path: path.to_owned() }),
        // A name that does not exist is told with its neighbours rather than by its ending.
        _ => read_file(path, 0).and(Err(Error::UnknownFormat { path: path.to_owned() })),
    }?;
    with_clip(opened, animation)
}

/// Refuses a clip that there is not.
fn with_clip(opened: Animation, animation: &AnimationOptions) -> Result<Animation> {
    match &animation.clip {
        Some(clip) if !opened.clips.iter().any(|known| known.name == *clip) => {
            let known = opened.clips.iter().map(|clip| clip.name.clone()).collect();
            Err(Error::UnknownClip { clip: clip.clone(), known })
        }
        _ => Ok(opened),
    }
}

/// The ending of a file's name, in small letters; with the one before where it says that the file is packed.
pub(crate) fn ending(path: &Path) -> Option<String> {
    let last = |path: &Path| path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    match last(path) {
        Some(packed) if packed == "gz" => Some(last(Path::new(path.file_stem()?)).map_or(packed, |inner| inner + ".gz")),
        ending => ending,
    }
}

fn open_sequence(pattern: Pattern, folder: &Path, options: &LoadOptions) -> Result<Animation> {
    let sequence = Sequence::numbered(pattern, folder, Range::default(), true).map_err(|message| Error::Sequence { message })?;
    let edit = Edit { name: Some(sequence.title()), ..Edit::default() };
    let track =
        KeyTrack { sequence: Arc::new(sequence), fps: DEFAULT_FPS, start: 0.0, looped: false, interpolate: true, edit, placed: None };
    let mut assets = Assets::new(Some(folder), options)?;
    let mut cache = Cache::new(options.max_key_cache_bytes);
    let mesh = first_mesh(&mut assets, &mut cache, &track)?;
    let mut animation = Animation::still(with_default_light(assets.scene(vec![mesh])));
    animation.motions = vec![Motion::Keys];
    animation.set_course(&[track.course()], None, None);
    animation.keys = Some(KeyReader::new(vec![Some(track.clone())], assets, cache, &animation.scene.warnings));
    animation.tracks.meshes = vec![MeshTrack::Keys(track)];
    Ok(animation)
}

/// A glTF file from memory. Files that it names are looked for below `folder`.
fn open_gltf(bytes: Vec<u8>, path: &Path, folder: Option<&Path>, options: &LoadOptions, clip: Option<&str>) -> Result<Animation> {
    let mut assets = Assets::new(folder, options)?;
    let root = assets.files.clone();
    let playing = Playing { clip, ..Playing::default() };
    let loaded = gltf::read(&mut assets, &bytes, &path.to_string_lossy(), root.root(), &playing)?;
    drop(bytes);
    let mut scene = assets.scene(loaded.meshes);
    scene.background = DEFAULT_BACKGROUND;
    scene.cameras = loaded.cameras;
    if loaded.lights.is_empty() {
        scene = with_default_light(scene);
    } else {
        scene.lights = loaded.lights;
    }
    let mut animation = Animation::still(scene);
    let rig = Arc::new(loaded.rig);
    let track = |number: usize| RigTrack { rig: rig.clone(), number };
    animation.clips = loaded.clips;
    animation.tracks.cameras = (0..rig.camera_count()).map(|at| CameraTrack::Rig(track(at))).collect();
    if rig.duration() > 0.0 {
        animation.tracks.lights = (0..rig.light_count()).map(|at| LightTrack::Rig(track(at))).collect();
        animation.set_course(&[rig.course()], None, None);
    }
    let moving = loaded.deformed.into_iter().enumerate().map(|(at, deformed)| RigTrack::mesh(&rig, at, deformed));
    (animation.tracks.meshes, animation.motions) = moving.unzip();
    Ok(animation)
}

/// Reads an OBJ, PLY or GLB stream, the first two packed by gzip or not, such as standard input. Materials and what a GLB file names are
/// looked for below `folder`; without one none is opened.
///
/// # Errors
/// As [`load`]; the file in messages is `-`.
pub fn load_reader(reader: &mut dyn Read, folder: Option<&Path>, options: &LoadOptions) -> Result<Scene> {
    open_reader(reader, folder, options, &AnimationOptions::default()).map(|animation| animation.scene)
}

/// Reads a stream with all that moves in it, which is that of a GLB. [`load_reader`] gives the same scene at time 0.
///
/// # Errors
/// As [`load_reader`]; a clip of an unknown name.
pub fn open_reader(reader: &mut dyn Read, folder: Option<&Path>, options: &LoadOptions, animation: &AnimationOptions) -> Result<Animation> {
    let path = Path::new("-");
    let bytes = read_stream(reader, path, options.max_mesh_bytes)?;
    let opened = if bytes.starts_with(b"glTF") {
        open_gltf(bytes, path, folder, options, animation.clip.as_deref())
    } else {
        load_mesh(&bytes, path, folder, options).map(Animation::still)
    }?;
    with_clip(opened, animation)
}

fn load_mesh(bytes: &[u8], path: &Path, folder: Option<&Path>, options: &LoadOptions) -> Result<Scene> {
    let mut assets = Assets::new(folder, options)?;
    let root = assets.files.clone();
    let mesh = mesh_file::parse(&mut assets, bytes, &path.to_string_lossy(), &stem(path), root.root())?;
    Ok(with_default_light(assets.scene(vec![mesh])))
}

/// A mesh from memory as a whole scene, such as those of [`generate`](crate::generate): the default material (whatever numbers
/// `mesh.materials` holds), the default light, and the automatic camera.
pub fn scene_of_mesh(mut mesh: Mesh) -> Scene {
    mesh.materials = vec![0; mesh.indices.len()];
    with_default_light(Scene { meshes: vec![mesh], materials: vec![Material::default()], ..empty() })
}

pub(crate) fn empty() -> Scene {
    Scene { up: [0.0, 1.0, 0.0], defaults: RenderDefaults::default(), ..Scene::default() }
}

/// The file's name without folder and ending.
pub(crate) fn stem(path: &Path) -> String {
    let stem = path.file_stem().map(Path::new);
    let stem =
        if ending(path).is_some_and(|ending| ending.ends_with(".gz")) { stem.and_then(Path::file_stem) } else { stem.map(Path::as_os_str) };
    stem.map_or_else(|| "mesh".to_owned(), |name| name.to_string_lossy().into_owned())
}

pub(crate) fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_owned).unwrap_or_default()
}

/// A key light from the upper left behind the default camera, a weak one from the other side, sky and ground.
pub(crate) fn with_default_light(mut scene: Scene) -> Scene {
    scene.lights = default_lights(scene.up);
    scene.ambient = DEFAULT_AMBIENT;
    scene.background = DEFAULT_BACKGROUND;
    scene
}

pub(crate) const DEFAULT_AMBIENT: [f32; 3] = [0.16, 0.17, 0.19];
pub(crate) const DEFAULT_BACKGROUND: Background = Background::Gradient { bottom: [0.34, 0.32, 0.30], top: [0.62, 0.72, 0.86] };

pub(crate) fn default_lights(up: [f32; 3]) -> Vec<Light> {
    use crate::vector::{add, normalised, scale};
    let (front, side) = crate::frame::front_and_side(up);
    let up = normalised(up.map(f64::from)).unwrap_or([0.0, 1.0, 0.0]);
    // Given as the direction towards the light; the light goes the other way.
    let towards = |right: f64, above: f64, before: f64| {
        let direction = add(add(scale(side, right), scale(up, above)), scale(front, before));
        normalised(scale(direction, -1.0)).unwrap_or([0.0, -1.0, 0.0]).map(|value| value as f32)
    };
    vec![
        Light::Directional { direction: towards(-0.25, 0.95, 0.75), irradiance: [2.3, 2.2, 2.05] },
        Light::Directional { direction: towards(0.9, 0.35, 0.25), irradiance: [0.42, 0.46, 0.55] },
    ]
}
