//! The command line as it is meant: every default filled in, every name resolved, every contradiction found, before any work begins.

use std::path::{Path, PathBuf};

use gridwalk_render::gridwalk_scene::{Animation, Camera, DEFAULT_FPS, Framing, LoadOptions, Scene};
use gridwalk_render::image::{Chroma, Format, MovieFormat, Overwrite, Rate, Tonemap};
use gridwalk_render::{Aov, Crop, DeviceSelector};

use super::low;
use super::pattern::{FrameRange, Pattern};
use crate::exit::{Failure, Result};
use crate::suggest;

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A mesh on standard input.
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

    /// What results are called after it.
    fn stem(&self) -> String {
        match self {
            Source::Stdin => "stdin".to_owned(),
            Source::Path(path) => scene_name(path),
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
    pub levels: Option<u32>,
}

/// Which device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    pub selector: DeviceSelector,
    pub validate: bool,
}

/// How a picture looks, and where from.
#[derive(Clone, Debug)]
pub struct Picture {
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
}

/// A point in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// Seconds.
    Time(f64),
    /// The number of a frame, at a rate or at the scene's own.
    Frame(u64, Option<Rate>),
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
    pub picture: Picture,
    pub clip: Option<String>,
    pub moment: Moment,
    pub grid: Grid,
    pub device: Device,
    pub reports: Reports,
    pub repeat: Option<u32>,
}

/// Where the frames of an animation go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AnimationOutput {
    /// Each into a file of its own.
    Sequence { pattern: Pattern, format: Format },
    /// All into one.
    Movie { target: Target, format: MovieFormat },
}

/// `gridwalk animate`.
#[derive(Clone, Debug)]
pub struct Animate {
    pub source: Source,
    pub load: LoadOptions,
    pub clip: Option<String>,
    pub outputs: Vec<AnimationOutput>,
    /// The user named the outputs.
    pub named: bool,
    pub overwrite: Overwrite,
    pub skip_existing: bool,
    pub chroma: Chroma,
    pub picture: Picture,
    pub range: Option<FrameRange>,
    pub fps: Option<Rate>,
    /// Seconds.
    pub duration: Option<f64>,
    /// Seconds of a whole turn.
    pub turntable: Option<f64>,
    pub grid: Grid,
    pub device: Device,
    pub reports: Reports,
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

impl Picture {
    /// Works out what is meant. `png` and `exr` tell what it is written as: something of eight bits, something with layers.
    fn new(low: low::Picture, view: low::View, png: bool, exr: bool) -> Result<Picture> {
        if !low.aov.is_empty() && !exr {
            return Err(Failure::usage("--aov needs an EXR to go into: add -o NAME.exr"));
        }
        if low.heatmap.is_some() && !png {
            return Err(Failure::usage("--heatmap is written as PNG: add -o NAME.png"));
        }
        Ok(Picture {
            size: low.size,
            aovs: aovs(&low.aov, low.heatmap)?,
            transparent: low.transparent,
            crop: low.crop.map(|[x, y, width, height]| Crop { x, y, width, height }),
            heatmap: low.heatmap,
            exposure: low.exposure,
            tonemap: low.tonemap.as_deref().map(tonemap).transpose()?,
            spp: low.spp,
            depth: low.depth,
            view,
        })
    }
}

impl Moment {
    fn new(low: &low::Moment) -> Moment {
        match (low.time, low.frame) {
            (Some(time), _) => Moment::Time(time),
            (None, frame) => Moment::Frame(frame.unwrap_or(0), low.clock.fps),
        }
    }

    /// Seconds from the beginning of an animation.
    pub fn time(self, animation: &Animation) -> f64 {
        match self {
            Moment::Time(time) => time,
            Moment::Frame(frame, fps) => rate(fps, animation).time(frame),
        }
    }
}

/// Frames a second: what is asked for, else what the scene was made for.
pub fn rate(asked: Option<Rate>, animation: &Animation) -> Rate {
    let scene = || Rate::from_number(animation.fps).or_else(|| Rate::from_number(DEFAULT_FPS));
    // The default of all is a whole number.
    asked.or_else(scene).unwrap_or(Rate::ONE)
}

impl Render {
    /// Works out what is meant. `quiet` is that of the whole program.
    pub fn new(low: low::Render, quiet: bool) -> Result<Render> {
        let scene = low.scene.ok_or_else(|| Failure::usage("which scene? gridwalk render SCENE"))?;
        let source = Source::new(&scene);
        let outputs = outputs(&source, &low.output, low.picture.heatmap.is_some())?;
        let has_exr = outputs.iter().any(|output| output.format == Format::Exr);
        let has_png = outputs.iter().any(|output| output.format == Format::Png);
        let to_stdout = outputs.iter().any(|output| output.target == Target::Stdout);
        if to_stdout && low.reports.json {
            return Err(Failure::usage("-o - and --json both want standard output; write the picture to a file"));
        }
        Ok(Render {
            load: load_options(&low.limits),
            source,
            outputs,
            named: !low.output.is_empty(),
            overwrite: overwrite(low.overwrite),
            picture: Picture::new(low.picture, low.view, has_png, has_exr)?,
            moment: Moment::new(&low.moment),
            clip: low.moment.clock.clip,
            grid: grid(&low.grid),
            device: device(low.device),
            reports: reports(&low.reports, quiet),
            repeat: low.repeat,
        })
    }
}

impl Animate {
    /// Works out what is meant. `quiet` is that of the whole program.
    pub fn new(low: low::Animate, quiet: bool) -> Result<Animate> {
        let source = Source::new(&low.scene);
        let outputs = animation_outputs(&source, &low.output, low.format)?;
        let has_exr = outputs.iter().any(|output| matches!(output, AnimationOutput::Sequence { format: Format::Exr, .. }));
        let has_png = outputs.iter().any(|output| !matches!(output, AnimationOutput::Sequence { format: Format::Exr, .. }));
        let to_stdout = outputs.iter().any(|output| matches!(output, AnimationOutput::Movie { target: Target::Stdout, .. }));
        if to_stdout && low.reports.json {
            return Err(Failure::usage("-o - and --json both want standard output; write the movie to a file"));
        }
        if let (Some(FrameRange { last: Some(last), .. }), Some(_)) = (low.frames, low.duration) {
            let hint = "say where the frames end in one way: leave --duration out";
            return Err(Failure::usage(format!(
                "--duration and --frames ..{last} both say where the animation ends; {hint}, or write --frames A.."
            )));
        }
        Ok(Animate {
            load: load_options(&low.limits),
            source,
            clip: low.clock.clip,
            outputs,
            named: !low.output.is_empty(),
            overwrite: overwrite(low.overwrite),
            skip_existing: low.skip_existing,
            chroma: match low.chroma {
                low::Chroma::C420 => Chroma::C420,
                low::Chroma::C444 => Chroma::C444,
            },
            picture: Picture::new(low.picture, low.view, has_png, has_exr)?,
            range: low.frames,
            fps: low.clock.fps,
            duration: low.duration,
            turntable: low.turntable,
            grid: grid(&low.grid),
            device: device(low.device),
            reports: reports(&low.reports, quiet),
        })
    }

    /// The numbers of the frames to render, and their rate.
    pub fn frames(&self, animation: &Animation) -> Result<(Vec<u64>, Rate)> {
        let rate = rate(self.fps, animation);
        let of_seconds = |seconds: f64| ((seconds * rate.per_second()).round() as u64).max(1);
        let own = (animation.duration > 0.0).then(|| animation.frame_count(rate.per_second()));
        let count = self.duration.or(self.turntable).map(of_seconds).or(own);
        let range = self.range.unwrap_or(FrameRange { first: 0, last: None, step: 1 });
        let last = match (range.last, count) {
            (Some(last), _) => last,
            (None, Some(count)) => count - 1,
            (None, None) => {
                return Err(Failure::usage(format!(
                    "{} does not move: turn the camera around it with --turntable 6, or tell how many frames there are with --frames or --duration",
                    self.source.name()
                )));
            }
        };
        if last < range.first {
            return Err(Failure::usage(format!("the last frame is {last}; --frames begins with {}", range.first)));
        }
        if (last - range.first) / u64::from(range.step) >= MAX_FRAMES {
            return Err(Failure::usage(format!("more than {MAX_FRAMES} frames; take a part of them with --frames")));
        }
        Ok(((range.first..=last).step_by(range.step as usize).collect(), rate))
    }

    /// Frames from one that is rendered to the next.
    pub fn step(&self) -> u32 {
        self.range.map_or(1, |range| range.step)
    }

    /// How far the camera has turned at a time; `None` where it does not.
    pub fn turn(&self, time: f64) -> Option<f64> {
        self.turntable.map(|seconds| time / seconds)
    }
}

/// Half a year of film.
const MAX_FRAMES: u64 = 500_000_000;

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
        let stem = source.stem();
        let name = if heatmap { format!("{stem}-heatmap.png") } else { format!("{stem}.png") };
        return Ok(vec![Output { target: Target::Path(name.into()), format: Format::Png }]);
    }
    let mut outputs: Vec<Output> = Vec::new();
    for path in paths {
        let target = Target::new(path);
        let format = match &target {
            Target::Stdout => Format::Png,
            Target::Path(path) if MovieFormat::of_path(path).is_some() => {
                return Err(Failure::usage(format!("{0} is an animation: gridwalk animate SCENE -o {0}", path.display())));
            }
            Target::Path(path) => Format::of_path(path)?,
        };
        if outputs.iter().any(|output| output.target == target) {
            return Err(Failure::usage(format!("-o {} is given twice", path.display())));
        }
        outputs.push(Output { target, format });
    }
    Ok(outputs)
}

/// The files of an animation: by default an animated PNG with the scene's name in the current folder.
fn animation_outputs(source: &Source, paths: &[PathBuf], format: Option<low::AnimationFormat>) -> Result<Vec<AnimationOutput>> {
    let unnamed = || vec![PathBuf::from(format!("{}.{}", source.stem(), format.map_or("apng", low::AnimationFormat::extension)))];
    let paths = if paths.is_empty() { unnamed() } else { paths.to_vec() };
    let mut outputs: Vec<AnimationOutput> = Vec::new();
    for path in &paths {
        let output = animation_output(path, format)?;
        if outputs.contains(&output) {
            return Err(Failure::usage(format!("-o {} is given twice", path.display())));
        }
        outputs.push(output);
    }
    Ok(outputs)
}

fn animation_output(path: &Path, format: Option<low::AnimationFormat>) -> Result<AnimationOutput> {
    let refuse = |reason: &str| Err(Failure::usage(format!("-o {}: {reason}", path.display())));
    let target = Target::new(path);
    let kind = match (format, &target) {
        (Some(format), _) => format.kind(),
        (None, Target::Stdout) => Kind::Movie(MovieFormat::Y4m),
        (None, Target::Path(path)) => match (MovieFormat::of_path(path), Format::of_path(path)) {
            (Some(format), _) => Kind::Movie(format),
            (None, Ok(format)) => Kind::Picture(format),
            (None, Err(_)) => {
                return refuse(
                    "the ending names no format; use .apng, .gif, .y4m, .mp4, .mkv, .webm, a sequence .%04d.png or .%04d.exr, or --format",
                );
            }
        },
    };
    match (kind, target) {
        (Kind::Picture(_), Target::Stdout) => refuse("standard output takes a movie; use --format y4m"),
        (Kind::Movie(format), Target::Stdout) if format.is_by_ffmpeg() => {
            refuse("ffmpeg writes into files alone; give a name, or use --format y4m")
        }
        (Kind::Movie(format), target) => {
            if Pattern::new(path).is_ok_and(|pattern| pattern.has_number()) {
                return refuse("a movie is one file; leave the place for the number of the frame out");
            }
            Ok(AnimationOutput::Movie { target, format })
        }
        (Kind::Picture(format), Target::Path(path)) => match Pattern::new(&path) {
            Ok(pattern) => Ok(AnimationOutput::Sequence { pattern, format }),
            Err(reason) => refuse(&reason),
        },
    }
}

enum Kind {
    Picture(Format),
    Movie(MovieFormat),
}

impl low::AnimationFormat {
    const fn kind(self) -> Kind {
        match self {
            low::AnimationFormat::Png => Kind::Picture(Format::Png),
            low::AnimationFormat::Exr => Kind::Picture(Format::Exr),
            low::AnimationFormat::Apng => Kind::Movie(MovieFormat::Apng),
            low::AnimationFormat::Gif => Kind::Movie(MovieFormat::Gif),
            low::AnimationFormat::Y4m => Kind::Movie(MovieFormat::Y4m),
            low::AnimationFormat::Mp4 => Kind::Movie(MovieFormat::Mp4),
            low::AnimationFormat::Mkv => Kind::Movie(MovieFormat::Mkv),
            low::AnimationFormat::Webm => Kind::Movie(MovieFormat::Webm),
        }
    }

    /// The ending of the default name.
    const fn extension(self) -> &'static str {
        match self {
            low::AnimationFormat::Png => "%04d.png",
            low::AnimationFormat::Exr => "%04d.exr",
            _ => match self.kind() {
                Kind::Movie(format) => format.extension(),
                Kind::Picture(format) => format.extension(),
            },
        }
    }
}

/// `teapot` of `models/teapot.obj`; of `kitchen/scene.toml` and `kitchen/` it is `kitchen`.
fn scene_name(path: &Path) -> String {
    let name = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    // `elephant` of `elephant.%04d.obj`.
    let name = |path: &Path| name(path).map(|stem| Pattern::new(Path::new(&stem)).map_or(stem, |pattern| pattern.stem()));
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
    Grid { density: low.density, resolution: low.resolution, overlap: low.overlap, levels: low.levels }
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

/// The camera of a picture of `size` at a time: the one that is asked for, else the scene's, else one that shows everything. `turn` is how
/// far it has turned about its target, of a turntable; one without a target turns about the middle of all.
pub fn camera(view: &low::View, animation: &Animation, time: f64, size: [u32; 2], turn: Option<f64>) -> Result<Camera> {
    let scene = &animation.scene;
    let asked_for_frame = view.azimuth.is_some() || view.elevation.is_some() || view.zoom.is_some();
    let framing = Framing {
        azimuth: view.azimuth.unwrap_or(0.0),
        elevation: view.elevation.unwrap_or(0.0),
        zoom: view.zoom.unwrap_or(1.0),
        up: view.up.unwrap_or(scene.up),
        vertical_fov_degrees: view.fov.unwrap_or(Framing::default().vertical_fov_degrees),
        aspect: size[0] as f32 / size[1] as f32,
    };
    let framed = || if turn.is_some() { framed_all_round(animation, &framing) } else { animation.frame(&framing) };
    let own = |name| {
        let mut camera = animation.camera(name, time).unwrap_or_else(framed);
        camera.vertical_fov_degrees = view.fov.unwrap_or(camera.vertical_fov_degrees);
        camera.up = view.up.unwrap_or(camera.up);
        camera
    };
    let own_name = view.camera.as_deref().map(|name| camera_name(scene, name)).transpose()?;
    let automatic = asked_for_frame || scene.cameras.is_empty();
    let has_target = own_name.is_none() && (view.eye.is_some() || automatic) || animation.has_target(own_name);
    let mut camera = if own_name.is_some() {
        own(own_name)
    } else if let Some(eye) = view.eye {
        Camera {
            eye,
            target: view.target.unwrap_or(framed().target),
            up: framing.up,
            vertical_fov_degrees: framing.vertical_fov_degrees,
            orthographic_height: None,
        }
    } else if automatic {
        framed()
    } else {
        own(None)
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
    let centre = || if has_target { camera.target } else { animation.frame(&framing).target };
    let pivot = turn.map(|turn| (turn, centre()));
    if view.ortho && camera.orthographic_height.is_none() {
        // What stands at the centre keeps its size.
        let centre = centre();
        let ahead = (0..3).map(|i| (f64::from(centre[i]) - f64::from(camera.eye[i])) * axis[i] / distance).sum::<f64>();
        let half = (f64::from(camera.vertical_fov_degrees).to_radians() / 2.0).tan() * if ahead > 0.0 { ahead } else { distance };
        camera.orthographic_height = Some((2.0 * half) as f32);
    }
    Ok(pivot.map_or(camera, |(turn, pivot)| turned(&camera, pivot, framing.up, turn)))
}

/// The automatic view from as far away as shows everything from every side.
fn framed_all_round(animation: &Animation, framing: &Framing) -> Camera {
    const SIDES: u16 = 48;
    let mut camera = animation.frame(framing);
    let offset = |camera: &Camera| -> [f64; 3] { std::array::from_fn(|i| f64::from(camera.eye[i]) - f64::from(camera.target[i])) };
    let distance = |camera: &Camera| offset(camera).iter().map(|value| value * value).sum::<f64>().sqrt();
    let sides = (0..SIDES).map(|side| framing.azimuth + f32::from(side) * 360.0 / f32::from(SIDES));
    let farthest = sides.map(|azimuth| distance(&animation.frame(&Framing { azimuth, ..*framing }))).fold(0.0, f64::max);
    let (offset, factor) = (offset(&camera), farthest / distance(&camera));
    if factor > 1.0 && factor.is_finite() {
        camera.eye = std::array::from_fn(|i| (f64::from(camera.target[i]) + offset[i] * factor) as f32);
    }
    camera
}

/// A camera after so many turns about the axis `up` through a point, to the right (Rodrigues' formula).
fn turned(camera: &Camera, pivot: [f32; 3], up: [f32; 3], turns: f64) -> Camera {
    let length = up.iter().map(|value| f64::from(*value).powi(2)).sum::<f64>().sqrt();
    let axis = up.map(|value| f64::from(value) / length);
    let turns = turns.rem_euclid(1.0);
    // A whole turn ends exactly where it began.
    if turns == 0.0 {
        return *camera;
    }
    let (sin, cos) = (turns * std::f64::consts::TAU).sin_cos();
    let rotate = |v: [f64; 3]| -> [f64; 3] {
        let along: f64 = (0..3).map(|i| axis[i] * v[i]).sum();
        let cross = [axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2], axis[0] * v[1] - axis[1] * v[0]];
        std::array::from_fn(|i| v[i] * cos + cross[i] * sin + axis[i] * along * (1.0 - cos))
    };
    let moved = |point: [f32; 3]| -> [f32; 3] {
        let offset = rotate(std::array::from_fn(|i| f64::from(point[i]) - f64::from(pivot[i])));
        std::array::from_fn(|i| (f64::from(pivot[i]) + offset[i]) as f32)
    };
    Camera {
        eye: moved(camera.eye),
        target: moved(camera.target),
        up: rotate(camera.up.map(f64::from)).map(|value| value as f32),
        ..*camera
    }
}

/// The name of a camera that is asked for by name or number.
fn camera_name<'a>(scene: &'a Scene, name: &'a str) -> Result<&'a str> {
    if scene.camera(Some(name)).is_some() {
        return Ok(name);
    }
    if let Some(camera) = name.parse().ok().and_then(|index: usize| scene.cameras.get(index)) {
        return Ok(&camera.name);
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
