//! Pictures by gridwalk: device, frame loop, shading and image files.

mod camera;
mod cast;
mod compact;
mod context;
mod device;
mod error;
mod estimate;
mod grid;
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
