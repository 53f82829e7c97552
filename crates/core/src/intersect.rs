//! A ray brought into the grid's frame, and the watertight ray-triangle test (Woop, Benthin and Wald 2013) there, as
//! `shared/intersect.glsl` has them.

use crate::layout::GridHeader;
use crate::ray::Ray;
use crate::vector::{Vec3, add, clamped_exponent, is_finite, largest, max_f32, min_f32, power_of_two, sub};

/// Components of a direction below this part of the largest count as zero: 2^-40.
pub const NEGLIGIBLE_COMPONENT: f32 = 9.094_947e-13;
/// 2^-20, above the rounding of a slab's distance by divisions of 2.5 ulp.
pub const SLAB_TOLERANCE: f32 = 9.536_743e-7;

/// A ray in the grid's frame: the points `origin + s * direction`.
///
/// The direction is the ray's, times a power of two that brings its largest component into [1, 2). The origin is where the ray enters the
/// padded box, or a little before, or its own start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedRay {
    /// Where s is 0.
    pub origin: Vec3,
    /// Scaled; negligible components are zero.
    pub direction: Vec3,
    /// Of the direction; 0 where that is 0.
    pub inverse: Vec3,
    /// Least s of a hit.
    pub s_min: f32,
    /// Greatest s of a hit.
    pub s_max: f32,
    /// Distance from the ray's own origin to `origin`.
    pub start: f32,
    /// t = (start + s) * t_of_s\[0\] * t_of_s\[1\]: two powers of two, each representable where their product may not be.
    pub t_of_s: [f32; 2],
    /// Shear of the triangle test.
    pub shear: Vec3,
    /// Whether the test maps x to z.
    pub z_is_x: bool,
    /// Whether the test maps y to z.
    pub z_is_y: bool,
}

impl MovedRay {
    /// Components in the order of the triangle test: the axis along which the ray moves most is the last.
    pub fn permute(&self, v: Vec3) -> Vec3 {
        if self.z_is_x {
            [v[1], v[2], v[0]]
        } else if self.z_is_y {
            [v[2], v[0], v[1]]
        } else {
            v
        }
    }
}

/// Brings a ray into the frame of a grid; `None` if it is no valid ray, or does not meet the box within its interval.
pub fn move_ray(ray: &Ray, grid: &GridHeader) -> Option<MovedRay> {
    let magnitude = ray.direction.map(f32::abs);
    let longest = largest(magnitude);
    let valid = is_finite(ray.origin) && is_finite(ray.direction) && longest > 0.0 && !ray.t_min.is_nan() && !ray.t_max.is_nan();
    if !valid {
        return None;
    }
    let exponent = clamped_exponent(longest);
    let shrink = power_of_two(-exponent);
    let grow = power_of_two(exponent);
    let direction: Vec3 = std::array::from_fn(|axis| {
        let zero = magnitude[axis] < longest * NEGLIGIBLE_COMPONENT;
        if zero { 0.0 } else { ray.direction[axis] * shrink }
    });
    let still = direction.map(|x| x == 0.0);
    let inverse: Vec3 = std::array::from_fn(|axis| if still[axis] { 0.0 } else { 1.0 / direction[axis] });
    let origin = grid.to_frame(ray.origin);
    let first = ray.t_min * grow * grid.scale;
    let last = ray.t_max * grow * grid.scale;

    let mut entry = f32::NEG_INFINITY;
    let mut leave = f32::INFINITY;
    let mut valid = true;
    for axis in 0..3 {
        if still[axis] {
            valid = valid && origin[axis] >= grid.box_min[axis] && origin[axis] <= grid.box_max[axis];
        } else {
            let up = direction[axis] > 0.0;
            let near = ((if up { grid.box_min[axis] } else { grid.box_max[axis] }) - origin[axis]) * inverse[axis];
            let far = ((if up { grid.box_max[axis] } else { grid.box_min[axis] }) - origin[axis]) * inverse[axis];
            entry = max_f32(entry, near);
            leave = min_f32(leave, far);
        }
    }
    entry -= entry.abs() * SLAB_TOLERANCE;
    leave += leave.abs() * SLAB_TOLERANCE;
    let start = max_f32(entry, first);
    // No >, which a NaN would pass.
    if !(valid && start <= leave && start <= last) {
        return None;
    }
    let travelled = direction.map(|x| start * x);
    let origin = add(origin, travelled);
    if !is_finite(origin) {
        return None;
    }

    let magnitude = direction.map(f32::abs);
    let z_is_x = magnitude[0] >= magnitude[1] && magnitude[0] >= magnitude[2];
    let z_is_y = !z_is_x && magnitude[1] >= magnitude[2];
    let mut moved = MovedRay {
        origin,
        direction,
        inverse,
        s_min: first - start,
        s_max: last - start,
        start,
        t_of_s: [grid.inverse_scale, shrink],
        shear: [0.0; 3],
        z_is_x,
        z_is_y,
    };
    let permuted = moved.permute(direction);
    let inverse_z = moved.permute(inverse)[2];
    moved.shear = [permuted[0] * inverse_z, permuted[1] * inverse_z, inverse_z];
    Some(moved)
}

/// t of a hit at s, inside of the ray's interval in spite of rounding.
pub fn hit_distance(moved: &MovedRay, ray: &Ray, s: f32) -> f32 {
    let t = (moved.start + s) * moved.t_of_s[0] * moved.t_of_s[1];
    min_f32(max_f32(t, ray.t_min), ray.t_max)
}

/// s of a t, as [`hit_distance`] has it.
pub fn distance_to_s(moved: &MovedRay, t: f32) -> f32 {
    t / moved.t_of_s[1] / moved.t_of_s[0] - moved.start
}

/// The point of a triangle that a ray's line meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Distance in the grid's frame.
    pub s: f32,
    /// Weight of the second vertex.
    pub u: f32,
    /// Weight of the third vertex.
    pub v: f32,
}

/// Where the ray's line meets the triangle; not at all if it is seen exactly edge-on. Both windings are met, and zero counts as inside.
pub fn intersect_triangle(ray: &MovedRay, vertices: [Vec3; 3]) -> Option<Intersection> {
    let [a, b, c] = vertices.map(|vertex| ray.permute(sub(vertex, ray.origin)));
    let ax = a[0] - ray.shear[0] * a[2];
    let ay = a[1] - ray.shear[1] * a[2];
    let bx = b[0] - ray.shear[0] * b[2];
    let by = b[1] - ray.shear[1] * b[2];
    let cx = c[0] - ray.shear[0] * c[2];
    let cy = c[1] - ray.shear[1] * c[2];
    let edge_u = cx * by - cy * bx;
    let edge_v = ax * cy - ay * cx;
    let edge_w = bx * ay - by * ax;
    let bits = [edge_u, edge_v, edge_w].map(f32::to_bits);
    let negative = bits.iter().any(|bits| *bits > 0x8000_0000);
    let positive = bits.iter().any(|bits| *bits as i32 > 0);
    let determinant = edge_u + edge_v + edge_w;
    if (negative && positive) || determinant.is_nan() || determinant.abs() < f32::MIN_POSITIVE {
        return None;
    }
    // The distance is the plane's, not the edge functions': theirs is lost to cancellation where the triangle is long and thin. It is exact
    // for planes along the axes, and never beyond the triangle's vertices.
    let e1 = sub(b, a);
    let e2 = sub(c, a);
    let normal = [e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]];
    let facing = normal[0] * ray.shear[0] + normal[1] * ray.shear[1] + normal[2];
    if facing.is_nan() || facing.abs() < f32::MIN_POSITIVE {
        return None;
    }
    let along = (normal[0] * a[0] + normal[1] * a[1] + normal[2] * a[2]) / facing;
    let least = min_f32(a[2], min_f32(b[2], c[2]));
    let greatest = max_f32(a[2], max_f32(b[2], c[2]));
    let inverse = 1.0 / determinant;
    Some(Intersection { s: min_f32(max_f32(along, least), greatest) * ray.shear[2], u: edge_v * inverse, v: edge_w * inverse })
}
