//! Uniform grids for ray tracing, as data and arithmetic: what the kernels compute, on the CPU and without Vulkan.
#![forbid(unsafe_code)]

pub mod kernel;
pub mod layout;
pub mod ray;

pub use layout::Report;
pub use ray::{Hit, MISS, Ray, UNFINISHED};
