//! Twin of kernel `ray_keys`, and the key itself, as `shared/ray_key.glsl` has it.

use crate::intersect::{MovedRay, move_ray};
use crate::layout::GridHeader;
use crate::ray::Ray;
use crate::vector::{Vec3, largest, sub};

const KEY_BITS_AN_AXIS: u32 = 5;
const KEY_DIRECTION_BITS: u32 = 5;

/// Bits of a ray's key.
pub const RAY_KEY_BITS: u32 = 3 * KEY_BITS_AN_AXIS + KEY_DIRECTION_BITS;

/// The largest key: of a ray that is not valid, or does not meet the grid's box.
pub const RAY_KEY_WITHOUT_WALK: u32 = (1 << RAY_KEY_BITS) - 1;

/// Bits 0, 3, 6, 9, 12 of the five bits of a number.
const fn every_third_bit(x: u32) -> u32 {
    let x = (x | (x << 8)) & 0x100F;
    let x = (x | (x << 4)) & 0x10C3;
    (x | (x << 2)) & 0x1249
}

/// Of the point where a ray enters the box, or of its start inside of it, the Morton code in the cube of the box's longest side; then which
/// of 24 kinds of directions it has: its longest component, and three signs.
pub fn ray_key(ray: Option<&MovedRay>, grid: &GridHeader) -> u32 {
    let Some(ray) = ray else { return RAY_KEY_WITHOUT_WALK };
    let count = (1 << KEY_BITS_AN_AXIS) as f32;
    let scale = count / largest(sub(grid.box_max, grid.box_min));
    let place: Vec3 = sub(ray.origin, grid.box_min).map(|along| (along * scale).floor().clamp(0.0, count - 1.0));
    let [x, y, z] = place.map(|cell| every_third_bit(cell as u32));
    let [right, up, back] = ray.direction.map(|along| u32::from(along > 0.0));
    let along = if ray.z_is_x { 0 } else { 2 - u32::from(ray.z_is_y) };
    (x | y << 1 | z << 2) << KEY_DIRECTION_BITS | along << 3 | right | up << 1 | back << 2
}

/// Writes the key of each ray, and its index.
pub fn ray_keys(grid: &GridHeader, rays: &[Ray], keys: &mut [u32], values: &mut [u32]) {
    for (index, ((ray, key), value)) in (0..).zip(rays.iter().zip(keys).zip(values)) {
        *key = ray_key(move_ray(ray, grid).as_ref(), grid);
        *value = index;
    }
}
