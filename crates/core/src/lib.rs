//! Uniform grids for ray tracing, as data and arithmetic: what the kernels compute, on the CPU and without Vulkan.
#![forbid(unsafe_code)]

pub mod dispatch;
pub mod gather;
pub mod geometry;
pub mod grid;
pub mod intersect;
pub mod kernel;
pub mod layout;
pub mod overlap;
pub mod ray;
pub mod shape;
pub mod sort;
pub mod split;
pub mod twin;
pub mod vector;
pub mod walk;

pub use geometry::GeometryRecord;
pub use layout::Report;
pub use ray::{Hit, MISS, Ray, UNFINISHED};
