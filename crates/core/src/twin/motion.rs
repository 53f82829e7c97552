//! What the twins of the kernels that move vertices have in common.

use bytemuck::{Pod, Zeroable};

use crate::vector::{Vec3, largest};

/// A joint's part in a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Influence {
    /// Number of a matrix.
    pub joint: u32,
    /// The joint's share.
    pub weight: f32,
}

/// [`ActiveTarget::positions`] and [`ActiveTarget::normals`] of a target without them.
pub const NO_DELTAS: u32 = u32::MAX;

/// A morph target that counts now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ActiveTarget {
    /// Where in the deltas those of its positions begin, or [`NO_DELTAS`].
    pub positions: u32,
    /// Where in the deltas those of its normals begin, or [`NO_DELTAS`].
    pub normals: u32,
    /// Its share.
    pub weight: f32,
    /// Zero.
    pub reserved: u32,
}

/// The bits of a number on the way from one to another: exactly the first's where the two are equal.
pub fn between(first: u32, second: u32, weight: f32) -> u32 {
    let (a, b) = (f32::from_bits(first), f32::from_bits(second));
    (a + (b - a) * weight).to_bits()
}

/// At length one; what has no direction stays as it is.
pub fn renormalised(v: Vec3) -> Vec3 {
    let size = largest(v.map(f32::abs));
    if size.is_nan() || size <= 0.0 || size.is_infinite() {
        return v;
    }
    let [x, y, z] = v.map(|component| component / size);
    let size = (x * x + y * y + z * z).sqrt();
    [x / size, y / size, z / size]
}

/// Vector `i` of an array of components.
pub(super) fn vec3(values: &[f32], i: u32) -> Vec3 {
    std::array::from_fn(|axis| values[3 * i as usize + axis])
}

/// Puts vector `i` into an array of components.
pub(super) fn put_vec3(values: &mut [f32], i: u32, v: Vec3) {
    values[3 * i as usize..3 * i as usize + 3].copy_from_slice(&v);
}
