//! What is to be rendered, and what came out.

use crate::{BuildStats, Error, Layers, Result, StepTime};
use std::{fmt, str::FromStr};

/// A layer of a picture other than its beauty: what the ray through the middle of each pixel met, whatever the number of samples. A surface
/// that is seen through counts as met where there is anything of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Aov {
    /// Distance along the ray, infinite on the background.
    Depth,
    /// Shading normal, on the viewer's side.
    Normal,
    /// The triangle's own normal, on the viewer's side.
    GeometricNormal,
    /// World position.
    Position,
    /// Diffuse colour, textured, linear.
    Albedo,
    /// Texture coordinates.
    Uv,
    /// Triangle within its mesh, mesh, and material, as integers; 4294967295 on the background. A material that only a later key-frame has is
    /// told by the number of the scene's own of that name, or else by 2147483648 or more, made of the name: the same in every frame.
    Id,
    /// Cells that the walk visited.
    Steps,
    /// Triangles that it tested.
    Tests,
    /// Cells that it visited and that were not empty.
    Cells,
}

impl Aov {
    /// All of them.
    pub const ALL: [Aov; 10] =
        [Aov::Depth, Aov::Normal, Aov::GeometricNormal, Aov::Position, Aov::Albedo, Aov::Uv, Aov::Id, Aov::Steps, Aov::Tests, Aov::Cells];

    /// The name in options.
    pub const fn name(self) -> &'static str {
        match self {
            Aov::Depth => "depth",
            Aov::Normal => "normal",
            Aov::GeometricNormal => "geometric-normal",
            Aov::Position => "position",
            Aov::Albedo => "albedo",
            Aov::Uv => "uv",
            Aov::Id => "id",
            Aov::Steps => "steps",
            Aov::Tests => "tests",
            Aov::Cells => "cells",
        }
    }

    /// The name of its layer, as EXR files have it.
    pub const fn layer(self) -> &'static str {
        match self {
            Aov::Depth => "Z",
            Aov::Normal => "N",
            Aov::GeometricNormal => "Ng",
            Aov::Position => "P",
            Aov::Albedo => "albedo",
            Aov::Uv => "uv",
            Aov::Id => "id",
            Aov::Steps => "debug.steps",
            Aov::Tests => "debug.tests",
            Aov::Cells => "debug.cells",
        }
    }

    /// Prefix and names of its channels.
    pub(crate) const fn channels(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Aov::Depth => ("", &["Z"]),
            Aov::Normal => ("N", &["X", "Y", "Z"]),
            Aov::GeometricNormal => ("Ng", &["X", "Y", "Z"]),
            Aov::Position => ("P", &["X", "Y", "Z"]),
            Aov::Albedo => ("albedo", &["R", "G", "B"]),
            Aov::Uv => ("uv", &["U", "V"]),
            Aov::Id => ("id", &["prim", "mesh", "material"]),
            Aov::Steps => ("debug", &["steps"]),
            Aov::Tests => ("debug", &["tests"]),
            Aov::Cells => ("debug", &["cells"]),
        }
    }

    /// Whether it needs the counting walk.
    pub const fn is_count(self) -> bool {
        matches!(self, Aov::Steps | Aov::Tests | Aov::Cells)
    }
}

impl fmt::Display for Aov {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Aov {
    type Err = Error;

    /// The name in options or that of the layer, whatever the case.
    fn from_str(text: &str) -> Result<Aov> {
        // `N` and `normal` and `n` are one; `Ng` is another.
        let found = Aov::ALL.into_iter().find(|aov| {
            aov.name().eq_ignore_ascii_case(text)
                || aov.layer().eq_ignore_ascii_case(text)
                || (*aov == Aov::Id && ["prim_id", "mesh_id", "material_id", "ids"].contains(&text))
        });
        found.ok_or_else(|| Error::Setting {
            setting: "aov",
            value: text.to_owned(),
            expected: "depth, normal, geometric-normal, position, albedo, uv, id, steps, tests or cells",
        })
    }
}

/// A part of a picture, in pixels from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// How a picture is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Columns of the whole picture.
    pub width: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// Renders a part alone; the layers have its size.
    pub crop: Option<Crop>,
    /// Samples a pixel, in a fixed stratified pattern; a single one goes through the middle.
    pub spp: u32,
    /// Reflections that are followed; none of a share below 1/4096.
    pub depth: u32,
    /// Layers beside the beauty.
    pub aovs: Vec<Aov>,
    /// Leaves the background out of the picture, and the share of a pixel that it fills out of its alpha.
    pub transparent: bool,
    /// Pixels that are rendered at once, at most 262,144; on a CPU no more than [`crate::Context::rays_per_submission`] are.
    pub batch: u32,
}

impl Default for RenderSettings {
    fn default() -> Self {
        RenderSettings {
            width: 1024,
            height: 768,
            crop: None,
            spp: 1,
            depth: 4,
            aovs: Vec::new(),
            transparent: false,
            batch: crate::RAYS_PER_SUBMISSION,
        }
    }
}

/// Greatest width or height of a picture.
pub const MAX_SIZE: u32 = 65_536;

impl RenderSettings {
    pub(crate) fn check(&self) -> Result<Crop> {
        let range = |setting, value: u32, low: u32, high: u32, expected| {
            if (low..=high).contains(&value) { Ok(()) } else { Err(Error::Setting { setting, value: value.to_string(), expected }) }
        };
        range("width", self.width, 1, MAX_SIZE, "1 to 65,536 pixels")?;
        range("height", self.height, 1, MAX_SIZE, "1 to 65,536 pixels")?;
        range("spp", self.spp, 1, 1 << 20, "1 to 1,048,576 samples a pixel")?;
        range("depth", self.depth, 0, 1024, "0 to 1,024 reflections")?;
        range("batch", self.batch, 1, crate::RAYS_PER_SUBMISSION, "1 to 262,144 pixels")?;
        let crop = self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height });
        let inside = |first: u32, count: u32, size: u32| count > 0 && first.checked_add(count).is_some_and(|end| end <= size);
        if !inside(crop.x, crop.width, self.width) || !inside(crop.y, crop.height, self.height) {
            return Err(Error::Setting {
                setting: "crop",
                value: format!("{} x {} at {}, {}", crop.width, crop.height, crop.x, crop.y),
                expected: "a part of the picture of at least one pixel",
            });
        }
        if u64::from(crop.width) * u64::from(crop.height) > 1 << 30 {
            return Err(Error::Setting {
                setting: "size",
                value: format!("{} x {}", crop.width, crop.height),
                expected: "at most 1,073,741,824 pixels",
            });
        }
        Ok(crop)
    }
}

/// How many rays of each kind were traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Mirrored.
    pub reflection: u64,
    /// Straight on, behind surfaces that are seen through.
    pub passed: u64,
    /// Given up because their walk was too long. They count as seeing nothing, or as shadow.
    pub unfinished: u64,
}

impl RayCounts {
    /// All kinds.
    pub const fn total(&self) -> u64 {
        self.camera + self.shadow + self.reflection + self.passed
    }
}

/// What a picture took.
#[derive(Clone, Debug, Default)]
pub struct FrameStats {
    /// Rays by kind.
    pub rays: RayCounts,
    /// Device milliseconds of the traces; 0 without timestamps.
    pub trace_ms: f64,
    /// Milliseconds of reading the pixels back and putting the picture together.
    pub readback_ms: f64,
    /// Milliseconds from the first submission to the last byte read back.
    pub frame_ms: f64,
    /// Device milliseconds by step, in the order of a frame.
    pub steps: Vec<StepTime>,
    /// Submissions.
    pub submissions: u32,
    /// Bytes of device memory of the queues and the film.
    pub queue_bytes: u64,
}

/// A picture with what it took.
#[derive(Clone, Debug)]
pub struct Frame {
    /// `beauty` (R, G, B, A; linear) and the layers that were asked for.
    pub layers: Layers,
    /// Counts and times.
    pub stats: FrameStats,
    /// The build of the grid that it was rendered through.
    pub build: BuildStats,
}

/// How far a picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Share that is done, 0 to 1.
    pub done: f64,
    /// Rays from the camera so far.
    pub camera_rays: u64,
}
