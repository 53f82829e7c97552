//! Rays and hits as they lie in device memory.

use bytemuck::{Pod, Zeroable};

/// [`Hit::triangle`] of a ray that hits nothing.
pub const MISS: u32 = 0xFFFF_FFFF;

/// [`Hit::triangle`] of a ray whose walk was given up after the recorded continuations: neither a hit nor a miss.
pub const UNFINISHED: u32 = 0xFFFF_FFFE;

/// A ray: the points `origin + t * direction` for `t` in the closed interval [`t_min`, `t_max`].
///
/// The direction has any length but zero, and `t` counts in its units. A ray with a NaN anywhere, or with an infinite origin or
/// direction, misses; `t_max` may be infinite. A device may take a direction for zero whose components are all denormal.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where `t` is 0.
    pub origin: [f32; 3],
    /// Least `t` of a hit.
    pub t_min: f32,
    /// Direction, of any length but zero.
    pub direction: [f32; 3],
    /// Greatest `t` of a hit.
    pub t_max: f32,
}

/// Where a ray hit: the point is `(1 - u - v) a + u b + v c` of the triangle's vertices.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Hit {
    /// Distance in units of the ray's direction; infinite on a miss.
    pub t: f32,
    /// Barycentric weight of the second vertex; 0 on a miss.
    pub u: f32,
    /// Barycentric weight of the third vertex; 0 on a miss.
    pub v: f32,
    /// Index of the triangle, counted over all geometries of the grid; [`MISS`] or [`UNFINISHED`] otherwise.
    pub triangle: u32,
}

impl Hit {
    /// The hit of a ray that hits nothing.
    pub const MISS: Hit = Hit { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: MISS };

    /// Whether a triangle was hit.
    pub const fn is_hit(&self) -> bool {
        self.triangle < UNFINISHED
    }
}
