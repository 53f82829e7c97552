//! Pictures and ray queries by gridwalk, on a device of its own: device, frame loop, shading and image files.
//!
//! # Rays without an engine
//!
//! [`Context`] opens a device, [`GpuScene`] is a scene in its memory, [`Grid`] the grid over it. [`cast`] and [`occluded`] take rays and give
//! answers as slices of the host, any number of them. [`RayBatch`] keeps rays on the device where many queries follow one another, and
//! [`Renderer`] makes pictures.
//!
//! ```
//! use gridwalk_render::gridwalk::{Hit, Ray};
//! use gridwalk_render::gridwalk_scene::{Material, Scene, generate};
//! use gridwalk_render::{BuildSettings, Context, ContextDesc, GpuScene, GridBuilder, cast, occluded};
//!
//! # fn main() -> gridwalk_render::Result<()> {
//! let ball = generate::sphere([0.0, 0.0, 0.0], 1.0, 64);
//! let scene = Scene { meshes: vec![ball], materials: vec![Material::default()], ..Scene::default() };
//!
//! let context = Context::new(&ContextDesc::default())?; // the best device that there is, a CPU driver if there is no other
//! let on_device = GpuScene::upload(&context, &scene)?;
//! let grid = GridBuilder::new(&context)?.build(&on_device, &BuildSettings::default())?;
//!
//! let towards = |x| Ray { origin: [x, 0.1, 5.0], t_min: 0.0, direction: [0.0, 0.0, -1.0], t_max: f32::INFINITY };
//! let hits = cast(&grid, &[towards(0.2), towards(2.0)])?;
//! assert!(hits[0].is_hit() && (hits[0].t - 4.0).abs() < 0.05);
//! assert_eq!(hits[1], Hit::MISS);
//! assert_eq!(occluded(&grid, &[towards(0.2), towards(2.0)])?, [1, 0]);
//! # Ok(())
//! # }
//! ```

mod camera;
mod cast;
mod compact;
mod context;
mod device;
mod error;
mod estimate;
mod grid;
mod host_memory;
pub mod image;
pub mod kernels;
mod layers;
mod layout;
mod picture;
mod pipeline;
mod player;
mod push;
mod queries;
mod queues;
mod scene;
mod settings;
mod wavefront;

pub use cast::{RAYS_PER_SUBMISSION, RayBatch, cast, occluded};
pub use context::{Buffer, BufferDesc, BufferKind, Context, ContextDesc};
pub use device::{DeviceInfo, DeviceKind, DeviceLimits, DeviceSelector, list_devices};
pub use error::{Error, Result};
pub use estimate::{GridEstimate, estimate_grid};
pub use grid::{BuildSettings, BuildStats, Grid, GridBuilder};
pub use layers::{Layer, LayerData, Layers};
pub use pipeline::StepTime;
pub use player::{Player, PlayerOptions, SeekStats};
pub use scene::GpuScene;
pub use settings::{Aov, Crop, Frame, FrameStats, MAX_SIZE, Progress, RayCounts, RenderSettings};
pub use wavefront::Renderer;

pub use gridwalk;
pub use gridwalk_scene;
