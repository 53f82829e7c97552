//! The command line as it is meant: every default filled in, every name resolved, every contradiction found, before any work begins.

use std::path::{Path, PathBuf};

use gridwalk_render::gridwalk_scene::{Camera, Framing, LoadOptions, Scene};
use gridwalk_render::image::{Format, Overwrite, Tonemap};
use gridwalk_render::{Aov, Crop, DeviceSelector};

use super::low;
use crate::exit::{Failure, Result};
use crate::suggest;

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// OBJ text on standard input.
    Stdin,
    /// A file or folder.
    Path(PathBuf),
}

impl Source {
    pub fn new(path: &Path) -> Source {
        if path.as_os_str() == "-" { Source::Stdin } else { Source::Path(path.to_owned()) }
    }

    /// As messages and reports call it.
    pub fn name(&self) -> String {
        match self {
            Source::Stdin => "-".to_owned(),
            Source::Path(path) => path.display().to_string(),
        }
    }
}

/// Where a result goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// Standard output.
    Stdout,
    /// A file.
    Path(PathBuf),
}

impl Target {
    pub fn new(path: &Path) -> Target {
        if path.as_os_str() == "-" { Target::Stdout } else { Target::Path(path.to_owned()) }
    }

    /// As messages and reports call it.
    pub fn name(&self) -> String {
        match self {
            Target::Stdout => "-".to_owned(),
            Target::Path(path) => path.display().to_string(),
        }
    }
}

/// A picture file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    pub target: Target,
    pub format: Format,
}

/// What to tell about a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reports {
    pub stats: bool,
    pub json: bool,
    pub progress: bool,
}

/// How the grid is built, as far as the user says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    pub density: Option<f32>,
    pub resolution: Option<[u32; 3]>,
    pub overlap: Option<low::Overlap>,
}

/// Which device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    pub selector: DeviceSelector,
    pub validate: bool,
}

/// `gridwalk render`.
#[derive(Clone, Debug)]
pub struct Render {
    pub source: Source,
    pub load: LoadOptions,
    pub outputs: Vec<Output>,
    /// The user named the outputs.
    pub named: bool,
    pub overwrite: Overwrite,
    pub size: Option<[u32; 2]>,
    pub crop: Option<Crop>,
    pub transparent: bool,
    pub aovs: Vec<Aov>,
    pub heatmap: Option<low::Heatmap>,
    pub exposure: Option<f32>,
    pub tonemap: Option<Tonemap>,
    pub spp: Option<u32>,
    pub depth: Option<u32>,
    pub view: low::View,
    pub grid: Grid,
    pub device: Device,
    pub reports: Reports,
    pub repeat: Option<u32>,
}

/// `gridwalk cast`.
#[derive(Clone, Debug)]
pub struct Cast {
    pub source: Source,
    pub load: LoadOptions,
    pub rays: Source,
    /// Bytes of the rays at most.
    pub max_rays_bytes: u64,
    pub target: Target,
    pub overwrite: Overwrite,
    pub occlusion: bool,
    pub grid: Grid,
    pub device: Device,
    pub reports: Reports,
    pub repeat: Option<u32>,
}

/// 64 MiB a second fit through a pipe; nobody casts more rays at once than this without saying so.
const MAX_RAYS_BYTES: u64 = 8 << 30;

impl Render {
    /// Works out what is meant. `quiet` is that of the whole program.
    pub fn new(low: low::Render, quiet: bool) -> Result<Render> {
        let scene = low.scene.ok_or_else(|| Failure::usage("which scene? gridwalk render SCENE"))?;
        let source = Source::new(&scene);
        let outputs = outputs(&source, &low.output, low.heatmap.is_some())?;
        let has_exr = outputs.iter().any(|output| output.format == Format::Exr);
        let has_png = outputs.iter().any(|output| output.format == Format::Png);
        let to_stdout = outputs.iter().any(|output| output.target == Target::Stdout);
        if to_stdout && low.reports.json {
            return Err(Failure::usage("-o - and --json both want standard output; write the picture to a file"));
        }
        if !low.aov.is_empty() && !has_exr {
            return Err(Failure::usage("--aov needs an EXR to go into: add -o NAME.exr"));
        }
        if low.heatmap.is_some() && !has_png {
            return Err(Failure::usage("--heatmap is written as PNG: add -o NAME.png"));
        }
        Ok(Render {
            load: load_options(&low.limits),
            source,
            outputs,
            named: !low.output.is_empty(),
            overwrite: overwrite(low.overwrite),
            size: low.size,
            aovs: aovs(&low.aov, low.heatmap)?,
            transparent: low.transparent,
            crop: low.crop.map(|[x, y, width, height]| Crop { x, y, width, height }),
            heatmap: low.heatmap,
            exposure: low.exposure,
            tonemap: low.tonemap.as_deref().map(tonemap).transpose()?,
            spp: low.spp,
            depth: low.depth,
            view: low.view,
            grid: grid(&low.grid),
            device: device(low.device),
            reports: reports(&low.reports, quiet),
            repeat: low.repeat,
        })
    }
}

impl Cast {
    /// Works out what is meant. `quiet` is that of the whole program.
    pub fn new(low: low::Cast, quiet: bool) -> Result<Cast> {
        let (source, rays, target) = (Source::new(&low.scene), Source::new(&low.rays), Target::new(&low.output));
        if source == Source::Stdin && rays == Source::Stdin {
            return Err(Failure::usage("the scene and the rays cannot both come from standard input"));
        }
        if target == Target::Stdout && low.reports.json {
            return Err(Failure::usage("-o - and --json both want standard output; write the hits to a file"));
        }
        Ok(Cast {
            load: load_options(&low.limits),
            max_rays_bytes: low.limits.max_size.map_or(MAX_RAYS_BYTES, |mib| mib << 20),
            source,
            rays,
            target,
            overwrite: overwrite(low.overwrite),
            occlusion: low.occlusion,
            grid: grid(&low.grid),
            device: device(low.device),
            reports: reports(&low.reports, quiet),
            repeat: low.repeat,
        })
    }
}

/// The picture files: by default the scene's name with .png in the current folder.
fn outputs(source: &Source, paths: &[PathBuf], heatmap: bool) -> Result<Vec<Output>> {
    if paths.is_empty() {
        let stem = match source {
            Source::Stdin => "stdin".to_owned(),
            Source::Path(path) => scene_name(path),
        };
        let name = if heatmap { format!("{stem}-heatmap.png") } else { format!("{stem}.png") };
        return Ok(vec![Output { target: Target::Path(name.into()), format: Format::Png }]);
    }
    let mut outputs: Vec<Output> = Vec::new();
    for path in paths {
        let target = Target::new(path);
        let format = match &target {
            Target::Stdout => Format::Png,
            Target::Path(path) => Format::of_path(path)?,
        };
        if outputs.iter().any(|output| output.target == target) {
            return Err(Failure::usage(format!("-o {} is given twice", path.display())));
        }
        outputs.push(Output { target, format });
    }
    Ok(outputs)
}

/// `teapot` of `models/teapot.obj`; of `kitchen/scene.toml` and `kitchen/` it is `kitchen`.
fn scene_name(path: &Path) -> String {
    let name = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let generic = path.file_name().is_some_and(|name| name == "scene.toml");
    let absolute = || std::path::absolute(path).ok();
    let folder = || absolute().and_then(|path| path.parent().and_then(name));
    let own = || name(path).or_else(|| absolute().as_deref().and_then(name));
    (if generic { folder() } else { own() }).unwrap_or_else(|| "picture".to_owned())
}

/// The layers beside the beauty: what is asked for, and what a heat map needs.
fn aovs(names: &[String], heatmap: Option<low::Heatmap>) -> Result<Vec<Aov>> {
    let mut aovs = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        match name {
            "all" => aovs.extend(Aov::ALL),
            // Always there.
            "beauty" => {}
            name => aovs.push(aov(name)?),
        }
    }
    aovs.extend(heatmap.map(|heatmap| match heatmap {
        low::Heatmap::Steps => Aov::Steps,
        low::Heatmap::Tests => Aov::Tests,
        low::Heatmap::Cells => Aov::Cells,
    }));
    let mut unique = Vec::new();
    for aov in aovs {
        if !unique.contains(&aov) {
            unique.push(aov);
        }
    }
    Ok(unique)
}

fn aov(name: &str) -> Result<Aov> {
    name.parse().map_err(|_| {
        let names: Vec<&str> = ["beauty"].into_iter().chain(Aov::ALL.into_iter().flat_map(|aov| [aov.name(), aov.layer()])).collect();
        let hint = suggest::nearest(name, names).map_or("see --list-aovs".to_owned(), |name| format!("did you mean \"{name}\"?"));
        Failure::usage(format!("no layer is called \"{name}\"; {hint}"))
    })
}

fn tonemap(name: &str) -> Result<Tonemap> {
    Tonemap::from_name(&name.to_lowercase()).ok_or_else(|| {
        Failure::usage(format!("no tone map is called \"{name}\"; {}", suggest::hint(name, Tonemap::ALL.map(Tonemap::name))))
    })
}

fn overwrite(low: low::Overwrite) -> Overwrite {
    match low {
        low::Overwrite::Always => Overwrite::Replace,
        low::Overwrite::Never => Overwrite::Refuse,
    }
}

pub fn grid(low: &low::Grid) -> Grid {
    Grid { density: low.density, resolution: low.resolution, overlap: low.overlap }
}

fn device(low: low::Device) -> Device {
    // Every text selects by something; one that selects nothing is told by the renderer, with the devices there are.
    let Ok(selector) = low.device.parse();
    Device { selector, validate: low.validate }
}

fn reports(low: &low::Reports, quiet: bool) -> Reports {
    Reports { stats: low.stats, json: low.json, progress: !low.no_progress && !low.json && !quiet }
}

/// Permissions and limits of loading a scene.
pub fn load_options(low: &low::Limits) -> LoadOptions {
    let mut options = LoadOptions { allow_external_paths: low.allow_external_paths, ..LoadOptions::default() };
    if let Some(mib) = low.max_size {
        let bytes = mib << 20;
        options.max_mesh_bytes = bytes;
        options.max_material_bytes = options.max_material_bytes.min(bytes);
        options.max_description_bytes = options.max_description_bytes.min(bytes);
        options.max_texture_bytes = options.max_texture_bytes.min(bytes);
    }
    options
}

/// The camera of a picture of `size`: the one that is asked for, else the scene's, else one that shows everything.
pub fn camera(view: &low::View, scene: &Scene, size: [u32; 2]) -> Result<Camera> {
    let asked_for_frame = view.azimuth.is_some() || view.elevation.is_some() || view.zoom.is_some();
    let framing = Framing {
        azimuth: view.azimuth.unwrap_or(0.0),
        elevation: view.elevation.unwrap_or(0.0),
        zoom: view.zoom.unwrap_or(1.0),
        up: view.up.unwrap_or(scene.up),
        vertical_fov_degrees: view.fov.unwrap_or(Framing::default().vertical_fov_degrees),
        aspect: size[0] as f32 / size[1] as f32,
    };
    let mut camera = if let Some(name) = &view.camera {
        let mut camera = named(scene, name)?;
        camera.vertical_fov_degrees = view.fov.unwrap_or(camera.vertical_fov_degrees);
        camera.up = view.up.unwrap_or(camera.up);
        camera
    } else if let Some(eye) = view.eye {
        let framed = scene.frame(&framing);
        Camera {
            eye,
            target: view.target.unwrap_or(framed.target),
            up: framing.up,
            vertical_fov_degrees: framing.vertical_fov_degrees,
            orthographic_height: None,
        }
    } else if asked_for_frame || scene.cameras.is_empty() {
        scene.frame(&framing)
    } else {
        let mut camera = scene.camera(None).unwrap_or_else(|| scene.frame(&framing));
        camera.vertical_fov_degrees = view.fov.unwrap_or(camera.vertical_fov_degrees);
        camera.up = view.up.unwrap_or(camera.up);
        camera
    };
    let axis: [f64; 3] = std::array::from_fn(|i| f64::from(camera.target[i]) - f64::from(camera.eye[i]));
    let distance = axis.iter().map(|value| value * value).sum::<f64>().sqrt();
    if distance == 0.0 {
        return Err(Failure::usage("the camera stands on its target; set --eye and --target apart"));
    }
    let up = camera.up.map(f64::from);
    let across = [axis[1] * up[2] - axis[2] * up[1], axis[2] * up[0] - axis[0] * up[2], axis[0] * up[1] - axis[1] * up[0]];
    if across.iter().map(|value| value * value).sum::<f64>().sqrt() <= 1e-6 * distance * up.iter().map(|v| v * v).sum::<f64>().sqrt() {
        return Err(Failure::usage("the camera looks straight along its up direction; give another with --up"));
    }
    if view.ortho && camera.orthographic_height.is_none() {
        // What stands at the target keeps its size.
        let half = (f64::from(camera.vertical_fov_degrees).to_radians() / 2.0).tan() * distance;
        camera.orthographic_height = Some((2.0 * half) as f32);
    }
    Ok(camera)
}

fn named(scene: &Scene, name: &str) -> Result<Camera> {
    if let Some(camera) = scene.camera(Some(name)) {
        return Ok(camera);
    }
    if let Some(camera) = name.parse().ok().and_then(|index: usize| scene.cameras.get(index)) {
        return Ok(camera.camera);
    }
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    Err(Failure::usage(format!("the scene has no camera \"{name}\"; {}", suggest::hint(name, names))))
}

#[cfg(test)]
mod tests {
    use super::{Source, Target, aovs, outputs, scene_name};
    use gridwalk_render::Aov;
    use gridwalk_render::image::Format;
    use std::path::Path;

    #[test]
    fn pictures_are_called_after_the_scene() {
        assert_eq!(scene_name(Path::new("models/teapot.obj")), "teapot");
        assert_eq!(scene_name(Path::new("scenes/kitchen/scene.toml")), "kitchen");
        assert_eq!(scene_name(Path::new("scenes/kitchen/")), "kitchen");
    }

    #[test]
    fn every_output_has_a_format() {
        let source = Source::new(Path::new("a/b.obj"));
        let ok = |paths: &[&str]| outputs(&source, &paths.iter().map(Into::into).collect::<Vec<_>>(), false);
        assert_eq!(ok(&[]).map(|all| all[0].target.clone()).ok(), Some(Target::Path("b.png".into())));
        let formats = ok(&["-", "x.exr"]).map(|all| all.iter().map(|output| output.format).collect::<Vec<_>>());
        assert_eq!(formats.ok(), Some(vec![Format::Png, Format::Exr]));
        assert!(ok(&["x.jpg"]).is_err() && ok(&["x.png", "x.png"]).is_err());
    }

    #[test]
    fn layers_by_name_and_word() {
        let names = |names: &[&str]| aovs(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>(), None);
        assert_eq!(names(&[]).ok(), Some(vec![]));
        assert_eq!(names(&["depth", "beauty", "N", "normal"]).ok(), Some(vec![Aov::Depth, Aov::Normal]));
        assert_eq!(names(&["all"]).ok().map(|all| all.len()), Some(Aov::ALL.len()));
        let message = names(&["albdo"]).err().map(|failure| failure.error.to_string()).unwrap_or_default();
        assert!(message.contains("did you mean \"albedo\""), "{message}");
    }
}
