//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Measures rebuilds and rays of gridwalk, and of its rivals on the same triangles and rays: Embree where it is installed.
///
/// Our times are device times, those of rivals on the host are wall times; all are medians over the runs, taken in turns after a warm-up. Ratios
/// above 1 mean faster than the rival; on a CPU driver there is a ratio of processor times too, which other work on the machine disturbs least.
/// On lavapipe all use the same number of threads. Standard output carries the table, or JSON with `--json -`.
#[derive(Clone, Debug, Parser)]
#[command(name = "gridwalk-bench", bin_name = "cargo tool bench", version, args_conflicts_with_subcommands = true)]
pub struct Arguments {
    /// What else can be measured
    #[command(subcommand)]
    pub mode: Option<Mode>,

    /// Scenes: files (.obj, .toml), names (bunny, elephant, dragon, sponza, stadium, or `five` for all of these; forest, army, soup, or `all`)
    /// looked up in the folders of GRIDWALK_SCENES and in the cache of `cargo tool scenes`, or made ones by number of triangles (sphere:N,
    /// bumpy:N, terrain:N, soup:N, stadium:N) [default: bumpy:70000]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,

    /// Also tell what changed since the run whose figures this file holds, and whether the noise explains it
    #[arg(long, value_name = "OLD.json")]
    pub compare: Option<PathBuf>,

    /// Also draw the ratios as bars, into an SVG file
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,

    /// What every measurement needs
    #[command(flatten)]
    pub common: Common,

    /// Runs after the warm-up
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: u32,

    /// Measure these alone: camera, reflection (of the camera rays' hits) and diffuse are closest hits, shadow (from the camera rays' hits
    /// to the first light) and any (the diffuse rays once more) are any hits; frame is a rebuild with camera and shadow rays through what it
    /// made; object, in the stadium, is the camera rays that look at what stands in its middle [default: all]
    #[arg(long, value_delimiter = ',', value_name = "WHAT")]
    pub only: Vec<Part>,

    /// Quality of the tree that Embree's rays are traced through
    #[arg(long, default_value = "medium")]
    pub embree_quality: Quality,

    /// Of the rebuild's steps, show only those whose name holds this (all are measured)
    #[arg(long, value_name = "TEXT")]
    pub filter_steps: Option<String>,
}

/// Other measurements.
#[derive(Clone, Debug, Subcommand)]
pub enum Mode {
    /// Plays animations, everything rebuilt each frame, with Embree doing the same on the same triangles and rays
    ///
    /// A frame has camera rays, shadow rays from what they hit to the first light, a reflection ray from each hit, and shadow rays from
    /// what these hit. Our times are device times, Embree's wall times, of its fastest rebuild and of single rays through the tree that it
    /// makes; medians over the runs of a frame, taken in turns. Making the rays costs neither of them anything.
    Dynamic(Dynamic),
    /// Measures one shape at growing numbers of triangles, and how times and memory grow with them
    Growth(Growth),
}

/// Arguments of `dynamic`.
#[derive(Clone, Debug, Args)]
pub struct Dynamic {
    /// Scenes: files, key-frame patterns, or names looked up in the folders of GRIDWALK_SCENES and in the cache of `cargo tool scenes`:
    /// gallop (24 key-frames of an elephant), herd (twelve of them, out of step), forest, fox, man, morph, engine; or made ones that sway
    /// (sphere:N, bumpy:N, terrain:N, soup:N, stadium:N) [default: bumpy:70000]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,

    /// Frames of each scene, evenly over its duration [default: all at its own rate, at most 24]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub frames: Option<u32>,

    /// Runs of each frame
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: u32,

    /// What every measurement needs
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of `growth`.
#[derive(Clone, Debug, Args)]
pub struct Growth {
    /// Which shape: sphere, bumpy, terrain, soup, stadium
    #[arg(default_value = "bumpy")]
    pub shape: String,

    /// Triangles to begin with
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(100..))]
    pub least: u32,

    /// Triangles to end with
    #[arg(long, default_value_t = 10_000_000, value_parser = clap::value_parser!(u32).range(100..=50_000_000))]
    pub most: u32,

    /// Also draw how each figure grows, on logarithmic scales, into an SVG file
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,

    /// Measure these alone [default: rebuild, camera, diffuse]
    #[arg(long, value_delimiter = ',', value_name = "WHAT")]
    pub only: Vec<Part>,

    /// Runs of each size after the warm-up
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: u32,

    /// What every measurement needs
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of all measurements.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Also look for scenes by name in this folder
    #[arg(long, value_name = "DIR")]
    pub folder: Vec<PathBuf>,

    /// Density k: cells a triangle [default: the library's]
    #[arg(long)]
    pub density: Option<f32>,

    /// Which cells list a triangle [default: the library's]
    #[arg(long)]
    pub overlap: Option<Overlap>,

    /// Levels of the grid: 1 is the flat grid [default: the library's]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=2))]
    pub levels: Option<u32>,

    /// Width and height of the camera's picture, a multiple of 8; as many other rays
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(8..=8192))]
    pub size: u32,

    /// Seed of the diffuse rays and of the scenes that are made
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// Order in which we trace rays; sorting is part of the time, and rivals get the rays as they are given: as given; sorted by the library;
    /// or sorted where the rays are in no order of their own: diffuse, any
    #[arg(long, default_value = "auto", value_name = "ORDER")]
    pub ray_order: RayOrder,

    /// Threads of Embree, and of lavapipe by LP_NUM_THREADS [default: LP_NUM_THREADS, or the machine's]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// Measure these alone besides: Embree, crate obvhs, the driver's own acceleration structures and ray queries; `none` is none [default: all
    /// that are there]
    #[arg(long, value_delimiter = ',', value_name = "WHO")]
    pub rivals: Vec<Who>,

    /// Embree's library, instead of the usual names
    #[arg(long, value_name = "FILE")]
    pub embree: Option<PathBuf>,

    /// Device: cpu, best, an index, a UUID or a part of the name
    #[arg(long, default_value = "best", env = "GRIDWALK_DEVICE")]
    pub device: String,

    /// Write all figures as JSON; `-` is standard output, and the table then goes to standard error
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// Rebuilds.
    Rebuild,
    /// Rebuilds with camera and shadow rays.
    Frame,
    /// Closest hits of camera rays.
    Camera,
    /// Any hits of shadow rays.
    Shadow,
    /// Closest hits of mirrored rays.
    Reflection,
    /// Closest hits of diffuse rays.
    Diffuse,
    /// Any hits of diffuse rays.
    Any,
    /// Closest hits of camera rays that look at the object that a scene is about.
    Object,
}

/// Who is measured besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Who {
    /// Embree, where it is installed.
    Embree,
    /// The crate, on the host.
    Obvhs,
    /// Of the same device, where it has them.
    Driver,
    /// Nobody.
    None,
}

/// The overlap test of the build.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Overlap {
    /// By bounding box.
    Box,
    /// By the triangle itself.
    Exact,
}

/// The order in which we trace rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RayOrder {
    /// As they are given.
    Given,
    /// Sorted by the library, which is part of the time.
    Sorted,
    /// Sorted where they are in no order of their own.
    Auto,
}

impl RayOrder {
    /// Whether rays of a kind are sorted.
    pub fn sorts(self, kind: &str) -> bool {
        match self {
            RayOrder::Given => false,
            RayOrder::Sorted => true,
            RayOrder::Auto => matches!(kind, "diffuse" | "any"),
        }
    }
}

/// `RTCBuildQuality` of a tree to trace through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// Surface area heuristic.
    Medium,
    /// With spatial splits.
    High,
}

impl Common {
    /// Whether a rival is to be measured, and whether it was asked for by name.
    pub fn wants(&self, who: Who) -> (bool, bool) {
        let is_named = self.rivals.contains(&who);
        (is_named || self.rivals.is_empty(), is_named)
    }
}

impl Arguments {
    /// Whether a part is to be measured.
    pub fn measures(&self, part: Part) -> bool {
        self.only.is_empty() || self.only.contains(&part)
    }
}
