//! The command line as it is typed: names, spellings, help texts. What it means is worked out in [`super::high`].

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};

use gridwalk_render::image::Rate;

use super::pattern::FrameRange;
use super::values::{Extent, Resolution, Vector, finite, positive, size, up, vector};
use crate::exit;

/// Renders scenes and casts rays through a uniform grid that is built, every time, on any Vulkan device.
#[derive(Debug, Parser)]
#[command(name = "gridwalk", version, after_help = exit::HELP, max_term_width = 110, disable_help_subcommand = true, args_override_self = true, propagate_version = true)]
pub struct Cli {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

/// Options of every command.
#[derive(Args, Clone, Debug)]
pub struct Global {
    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "Messages")]
    pub quiet: bool,
    /// Say more; twice: what is done; three times: everything
    #[arg(short, long, global = true, action = clap::ArgAction::Count, help_heading = "Messages")]
    pub verbose: u8,
    /// Also write messages, with times, to this file
    #[arg(long, global = true, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Messages")]
    pub log_file: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a picture of a scene
    #[command(after_help = RENDER_EXAMPLES)]
    Render(Box<Render>),
    /// Render the frames of a scene that moves, or of a turn around one that does not
    #[command(after_help = ANIMATE_EXAMPLES)]
    Animate(Box<Animate>),
    /// Tell what a scene holds, and the grid it would get
    Info(Box<Info>),
    /// List all Vulkan devices, and why one cannot serve
    Devices(Devices),
    /// Cast rays from a NumPy file and write what they hit
    #[command(after_help = CAST_EXAMPLES)]
    Cast(Box<Cast>),
    /// Compare two pictures
    #[command(after_help = DIFF_EXAMPLES)]
    Diff(Diff),
    /// List what options can be set to
    List(List),
    /// Print the completions of a shell
    Completions(Completions),
    /// Print the manual page, or write one for each command into a folder
    Man(Man),
}

const RENDER_EXAMPLES: &str = "\
Examples:
  gridwalk render teapot.obj
  gridwalk render teapot.obj -o - | feh -
  gridwalk render scene.toml --camera inside --spp 16 --tonemap agx -o a.png -o a.exr --aov N,Z,id
  gridwalk render bunny.obj --azimuth 90 --zoom 2 --heatmap steps --stats";

const ANIMATE_EXAMPLES: &str = "\
Ctrl-C ends after the frame at hand; movies are finished with the frames so
far. A second one ends at once.

Examples:
  gridwalk animate scene.toml
  gridwalk animate elephant.%04d.obj --fps 25 -o elephant.mp4
  gridwalk animate fox.glb --clip Run --size 640x480 -o run.gif -o run.%04d.png
  gridwalk animate teapot.obj --turntable 6 -o teapot.apng
  gridwalk animate scene.toml --frames 100..199 --skip-existing -o f.####.exr
  gridwalk animate scene.toml -o - | mpv -";

const CAST_EXAMPLES: &str = "\
RAYS.npy holds float32 of shape (N, 6): origin x y z, direction x y z; or
(N, 8): and then t_min, t_max.
HITS.npz holds t_hit float32 (inf on a miss), primitive_ids and geometry_ids
uint32 (4294967295 on a miss; primitives count in file order within their
geometry), primitive_uvs float32 (N, 2), primitive_normals float32 (N, 3);
with --occlusion it holds occluded alone. Materials do not matter: a triangle
with holes in its texture is hit all over.

Examples:
  gridwalk cast scene.obj --rays rays.npy -o hits.npz
  gridwalk cast scene.obj --rays rays.npy --occlusion -o occluded.npz --repeat 10 --stats";

const DIFF_EXAMPLES: &str = "\
PNGs are compared in the values they store, over 255; EXRs in linear light,
layer by layer. The status is 1 when the metric is beyond the threshold in
some layer, or a layer is in one picture only.

Examples:
  gridwalk diff a.png b.png
  gridwalk diff a.exr b.exr --layer Z --metric max --threshold 1e-5";

/// Which device, and whether to watch it.
#[derive(Args, Clone, Debug)]
pub struct Device {
    /// The device: its number or UUID of `gridwalk devices`, a part of its name, or `cpu`
    #[arg(long, value_name = "DEVICE", env = "GRIDWALK_DEVICE", default_value = "best", help_heading = "Device")]
    pub device: String,
    /// Turn the Khronos validation layers on, and end with status 1 on any message
    #[arg(long, help_heading = "Device")]
    pub validate: bool,
}

/// How the grid is built.
#[derive(Args, Clone, Debug)]
pub struct Grid {
    /// Cells a triangle that the grid aims at [default: the scene's, or 7]
    #[arg(long, value_name = "K", value_parser = positive, conflicts_with = "resolution", help_heading = "Grid")]
    pub density: Option<f32>,
    /// Cells along each axis, instead of by density
    #[arg(long, value_name = "XxYxZ", value_parser = super::values::resolution, help_heading = "Grid")]
    pub resolution: Option<Resolution>,
    /// List a triangle in the cells that its box touches, or that it touches itself
    #[arg(long, value_name = "TEST", help_heading = "Grid")]
    pub overlap: Option<Overlap>,
    /// Levels of the grid: 1 is the flat grid of the thesis, with 2 cells of many triangles are split [default: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2), help_heading = "Grid")]
    pub levels: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Overlap {
    /// By the triangle's box: a little cheaper to build
    Box,
    /// By the triangle itself: shorter lists (the default)
    Exact,
}

/// What may be read.
#[derive(Args, Clone, Debug)]
pub struct Limits {
    /// Also read files outside the scene's folder that the scene names
    #[arg(long, help_heading = "Limits")]
    pub allow_external_paths: bool,
    /// Refuse files above this size
    #[arg(long, value_name = "MiB", value_parser = clap::value_parser!(u64).range(1..=16_777_216), help_heading = "Limits")]
    pub max_size: Option<u64>,
}

/// What is told about the run.
#[derive(Args, Clone, Debug)]
pub struct Reports {
    /// Print a table of times and sizes on standard error
    #[arg(long, help_heading = "Reports")]
    pub stats: bool,
    /// Print one JSON object on standard output; of `animate`, one a frame and one in the end (docs/json.md)
    #[arg(long, help_heading = "Reports")]
    pub json: bool,
    /// Show no progress bar
    #[arg(long, help_heading = "Reports")]
    pub no_progress: bool,
}

/// How a picture looks, wherever it is taken from.
#[derive(Args, Clone, Debug)]
pub struct Picture {
    /// Pixels [default: the scene's, or 1024x768]
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = "Output")]
    pub size: Option<Extent>,
    /// Render a part alone, from its upper left corner
    #[arg(long, value_name = "X,Y,W,H", value_parser = super::values::crop, help_heading = "Output")]
    pub crop: Option<[u32; 4]>,
    /// Leave the background out: the picture gets an alpha channel
    #[arg(long, help_heading = "Output")]
    pub transparent: bool,
    /// Layers for the EXR, comma-separated: see --list-aovs; `all` for every one
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', help_heading = "Output")]
    pub aov: Vec<String>,
    /// Write the cost of each pixel's camera ray as colours, with a legend, instead of the picture
    #[arg(long, value_name = "COUNT", help_heading = "Output")]
    pub heatmap: Option<Heatmap>,
    /// Stops by which the PNG is brightened [default: the scene's, or 0]
    #[arg(long, value_name = "EV", value_parser = finite, allow_hyphen_values = true, help_heading = "Output")]
    pub exposure: Option<f32>,
    /// How the PNG brings bright light into its range: see --list-tonemaps [default: the scene's, or none]
    #[arg(long, value_name = "NAME", help_heading = "Output")]
    pub tonemap: Option<String>,

    /// Samples a pixel [default: the scene's, or 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536), help_heading = "Quality")]
    pub spp: Option<u32>,
    /// Reflections that are followed [default: the scene's, or 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=64), help_heading = "Quality")]
    pub depth: Option<u32>,
}

/// The course of time.
#[derive(Args, Clone, Debug)]
pub struct Clock {
    /// The clip to play, of a file that has several: see `list clips` [default: the first]
    #[arg(long, value_name = "NAME", help_heading = "Time")]
    pub clip: Option<String>,
    /// Frames a second: 25, 23.976 or 24000/1001 [default: the scene's, or 24]
    #[arg(long, value_name = "RATE", help_heading = "Time")]
    pub fps: Option<Rate>,
}

/// A point in time.
#[derive(Args, Clone, Debug)]
pub struct Moment {
    /// The moment, of a scene that moves, in seconds [default: 0]
    #[arg(long, value_name = "SECONDS", value_parser = super::values::seconds, conflicts_with = "frame", help_heading = "Time")]
    pub time: Option<f64>,
    /// The moment as the number of a frame: the picture that `animate` gives for it
    #[arg(long, value_name = "N", help_heading = "Time")]
    pub frame: Option<u64>,
    #[command(flatten)]
    pub clock: Clock,
}

#[derive(Args, Debug)]
pub struct Render {
    /// An .obj, .ply, .gltf or .glb file, a scene.toml, a folder that holds one, or - for OBJ, PLY or GLB from standard input
    #[arg(value_hint = ValueHint::AnyPath, required_unless_present_any = ["list_aovs", "list_tonemaps", "list_formats"])]
    pub scene: Option<PathBuf>,

    /// Where to: .png or .exr, several times if wanted; - is PNG on standard output [default: the scene's name, .png]
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Output")]
    pub output: Vec<PathBuf>,
    /// Whether a file that exists is replaced
    #[arg(long, value_name = "WHEN", default_value = "always", help_heading = "Output")]
    pub overwrite: Overwrite,
    #[command(flatten)]
    pub picture: Picture,
    #[command(flatten)]
    pub moment: Moment,
    #[command(flatten)]
    pub view: View,
    #[command(flatten)]
    pub grid: Grid,
    #[command(flatten)]
    pub device: Device,
    #[command(flatten)]
    pub reports: Reports,
    #[command(flatten)]
    pub limits: Limits,

    /// Render N times after one time that does not count, and report medians
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000), help_heading = "Reports")]
    pub repeat: Option<u32>,

    /// List the scene's cameras, and end
    #[arg(long, help_heading = "Lists")]
    pub list_cameras: bool,
    /// List the layers, and end
    #[arg(long, help_heading = "Lists")]
    pub list_aovs: bool,
    /// List the tone maps, and end
    #[arg(long, help_heading = "Lists")]
    pub list_tonemaps: bool,
    /// List the file formats, and end
    #[arg(long, help_heading = "Lists")]
    pub list_formats: bool,
}

#[derive(Args, Debug)]
pub struct Animate {
    /// As for `render`, or a sequence of files: mesh.%04d.obj, mesh.####.obj
    #[arg(value_hint = ValueHint::AnyPath)]
    pub scene: PathBuf,

    /// Where to: a sequence (frame.%04d.png, frame.####.exr, {frame:04}.png) or a movie (.apng, .gif, .y4m; .mp4, .mkv, .webm by
    /// ffmpeg), several times if wanted; - is Y4M on standard output [default: the scene's name, .apng]
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Output")]
    pub output: Vec<PathBuf>,
    /// The format of all outputs, instead of what the endings say
    #[arg(long, value_name = "FORMAT", help_heading = "Output")]
    pub format: Option<AnimationFormat>,
    /// Whether a file that exists is replaced
    #[arg(long, value_name = "WHEN", default_value = "always", help_heading = "Output")]
    pub overwrite: Overwrite,
    /// Leave files that exist, and render only the frames that are missing; any file of a frame's name counts as done, whatever is in it
    #[arg(long, help_heading = "Output")]
    pub skip_existing: bool,
    /// Colour samples of Y4M and video
    #[arg(long, value_name = "SAMPLES", default_value = "420", help_heading = "Output")]
    pub chroma: Chroma,
    #[command(flatten)]
    pub picture: Picture,

    /// The frames, both ends included: 0..99, 10.., 0..99:2, 7; a movie of every second frame keeps its speed [default: all]
    #[arg(long, value_name = "A..B[:STEP]", help_heading = "Time")]
    pub frames: Option<FrameRange>,
    /// How long the animation is, whatever the scene says
    #[arg(long, value_name = "SECONDS", value_parser = super::values::duration, help_heading = "Time")]
    pub duration: Option<f64>,
    #[command(flatten)]
    pub clock: Clock,

    #[command(flatten)]
    pub view: View,
    /// Turn the camera once about its target (the scene's middle for a camera of glTF, which has none), in so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = super::values::duration, help_heading = "Camera")]
    pub turntable: Option<f64>,
    #[command(flatten)]
    pub grid: Grid,
    #[command(flatten)]
    pub device: Device,
    #[command(flatten)]
    pub reports: Reports,
    #[command(flatten)]
    pub limits: Limits,

    /// List the scene's clips, and end
    #[arg(long, help_heading = "Lists")]
    pub list_clips: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AnimationFormat {
    /// A sequence of PNG
    Png,
    /// A sequence of EXR
    Exr,
    /// Animated PNG
    Apng,
    /// Animated GIF
    Gif,
    /// Uncompressed video
    Y4m,
    /// H.264, by ffmpeg
    Mp4,
    /// H.264 in Matroska, by ffmpeg
    Mkv,
    /// VP9, by ffmpeg
    Webm,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Chroma {
    /// One for four pixels: every player shows it
    #[value(name = "420")]
    C420,
    /// One a pixel
    #[value(name = "444")]
    C444,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Overwrite {
    /// Replace it
    Always,
    /// Leave it and end with status 7
    Never,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Heatmap {
    /// Cells that the ray passed
    Steps,
    /// Triangles that it was tested against
    Tests,
    /// Cells that it passed and that were not empty
    Cells,
}

impl Heatmap {
    /// The name of the channel.
    pub const fn name(self) -> &'static str {
        match self {
            Heatmap::Steps => "steps",
            Heatmap::Tests => "tests",
            Heatmap::Cells => "cells",
        }
    }
}

/// Where the picture is taken from. Without any of these the scene's own first camera is used, or one that shows everything.
#[derive(Args, Clone, Debug)]
pub struct View {
    /// A camera of the scene, by name or number [default: the one that the scene prefers, or one that shows everything at all times, but key-frames as at time 0]
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "azimuth", "elevation", "zoom"], help_heading = "Camera")]
    pub camera: Option<String>,
    /// Position
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, conflicts_with_all = ["azimuth", "elevation", "zoom"], help_heading = "Camera")]
    pub eye: Option<Vector>,
    /// The point in the middle of the picture [default: the scene's middle]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, requires = "eye", help_heading = "Camera")]
    pub target: Option<Vector>,
    /// Up: an axis such as +Z, or a vector
    #[arg(long, value_name = "AXIS", value_parser = up, allow_hyphen_values = true, help_heading = "Camera")]
    pub up: Option<Vector>,
    /// Vertical angle of view in degrees
    #[arg(long, value_name = "DEGREES", value_parser = super::values::angle, help_heading = "Camera")]
    pub fov: Option<f32>,
    /// Degrees to the right around the automatic view
    #[arg(long, value_name = "DEGREES", value_parser = finite, allow_hyphen_values = true, help_heading = "Camera")]
    pub azimuth: Option<f32>,
    /// Degrees upwards from the automatic view
    #[arg(long, value_name = "DEGREES", value_parser = finite, allow_hyphen_values = true, help_heading = "Camera")]
    pub elevation: Option<f32>,
    /// How much larger than the automatic view
    #[arg(long, value_name = "FACTOR", value_parser = positive, help_heading = "Camera")]
    pub zoom: Option<f32>,
    /// Parallel projection
    #[arg(long, help_heading = "Camera")]
    pub ortho: bool,
}

#[derive(Args, Debug)]
pub struct Info {
    /// An .obj, .ply, .gltf or .glb file, a scene.toml, a folder that holds one, or - for OBJ, PLY or GLB from standard input
    #[arg(value_hint = ValueHint::AnyPath)]
    pub scene: PathBuf,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub grid: Grid,
    #[command(flatten)]
    pub limits: Limits,
}

#[derive(Args, Debug)]
pub struct Devices {
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Debug)]
pub struct Cast {
    /// An .obj, .ply, .gltf or .glb file, a scene.toml, a folder that holds one, or - for OBJ, PLY or GLB from standard input
    #[arg(value_hint = ValueHint::AnyPath)]
    pub scene: PathBuf,
    /// The rays, as NumPy writes them; - is standard input
    #[arg(long, value_name = "RAYS.npy", value_hint = ValueHint::FilePath)]
    pub rays: PathBuf,
    /// Where to write what was hit; - is standard output
    #[arg(short, long, value_name = "HITS.npz", value_hint = ValueHint::FilePath, help_heading = "Output")]
    pub output: PathBuf,
    /// Whether a file that exists is replaced
    #[arg(long, value_name = "WHEN", default_value = "always", help_heading = "Output")]
    pub overwrite: Overwrite,
    /// Only find out whether each ray hits anything
    #[arg(long, help_heading = "Output")]
    pub occlusion: bool,
    /// Build and cast N times after one time that does not count, and report medians
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000), help_heading = "Reports")]
    pub repeat: Option<u32>,
    #[command(flatten)]
    pub grid: Grid,
    #[command(flatten)]
    pub device: Device,
    #[command(flatten)]
    pub reports: Reports,
    #[command(flatten)]
    pub limits: Limits,
}

#[derive(Args, Debug)]
pub struct Diff {
    /// A PNG or EXR
    #[arg(value_hint = ValueHint::FilePath)]
    pub a: PathBuf,
    /// Another of the same size
    #[arg(value_hint = ValueHint::FilePath)]
    pub b: PathBuf,
    /// What the threshold is for
    #[arg(long, value_name = "NAME", default_value = "mse")]
    pub metric: Metric,
    /// The largest value that counts as equal
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = super::values::threshold)]
    pub threshold: f64,
    /// Compare only these layers, comma-separated
    #[arg(long, value_name = "LAYERS", value_delimiter = ',')]
    pub layer: Vec<String>,
    /// Print one JSON object (docs/json.md)
    #[arg(long)]
    pub json: bool,
    /// Refuse pictures that take more memory than this
    #[arg(long, value_name = "MiB", default_value_t = 2048, value_parser = clap::value_parser!(u64).range(1..=16_777_216))]
    pub max_size: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Metric {
    /// Mean of the squared differences
    Mse,
    /// Largest difference
    Max,
    /// One minus the structural similarity
    Ssim,
}

#[derive(Args, Debug)]
pub struct List {
    /// What to list
    pub what: Listed,
    /// The scene whose cameras or clips to list
    #[arg(value_hint = ValueHint::AnyPath, required_if_eq_any([("what", "cameras"), ("what", "clips")]))]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub limits: Limits,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Listed {
    /// Cameras of a scene
    Cameras,
    /// Clips of a scene that moves
    Clips,
    /// Layers of a picture
    Aovs,
    /// Tone maps
    Tonemaps,
    /// File formats
    Formats,
    /// Vulkan devices
    Devices,
}

#[derive(Args, Debug)]
pub struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
}

#[derive(Args, Debug)]
pub struct Man {
    /// Write gridwalk.1, gridwalk-render.1 and so on into this folder, instead of the first to standard output
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
}
