//! Builds uniform grids over triangles on a Vulkan device that it is given, and traces rays through them.
//!
//! The crate records commands into the caller's command buffers, on the caller's device, in the caller's memory. It never allocates device
//! memory, submits or waits.

mod error;
pub mod hazard;
pub mod kernels;
pub mod plan;
mod push;
pub mod requirements;
mod shape;
mod sizes;
mod sync;
mod tracer;

pub use ash;
pub use error::{Error, Result};
pub use gridwalk_core;
pub use gridwalk_core::{Hit, MISS, Ray, Report, UNFINISHED, kernel};
pub use shape::{Shape, split_workgroups};
pub use sizes::{BuildSizes, Capacity, MAX_CELLS, MAX_PAIRS, MAX_RAYS, MAX_TRIANGLES, REGION_ALIGNMENT, RegionSize, region_bytes};
pub use sync::{Access, cmd_barrier};
pub use tracer::{BuildInfo, BuildOptions, DeviceDesc, Geometry, Overlap, RayCount, Region, Timestamps, TraceInfo, Tracer};

/// The public GLSL include in one piece: trace from your own shader.
pub const GRIDWALK_GLSL: &str = include_str!("../glsl/gridwalk.glsl");
