//! Twin of kernel `ray_keys`, and the key itself, as `shared/ray_key.glsl` has it.

use crate::intersect::{MovedRay, move_ray};
use crate::layout::GridHeader;
use crate::ray::Ray;
use crate::vector::{Vec3, largest, sub};

/// Cells along the longest side of the box; along the shortest they are at most half as many.
const KEY_CELLS: f32 = 32.0;
const KEY_DIRECTION_BITS: u32 = 6;

/// Bits of a ray's key.
pub const RAY_KEY_BITS: u32 = 14 + KEY_DIRECTION_BITS;

/// The largest key: of a ray that is not valid, or does not meet the grid's box. No direction is short along all axes.
pub const RAY_KEY_WITHOUT_WALK: u32 = (1 << RAY_KEY_BITS) - 1;

/// Bits 0, 3, 6, 9, 12 of the five bits of a number.
const fn every_third_bit(x: u32) -> u32 {
    let x = (x | (x << 8)) & 0x100F;
    let x = (x | (x << 4)) & 0x10C3;
    (x | (x << 2)) & 0x1249
}

/// Of the point where a ray enters the box, or of its start inside of it, the Morton code of its cell in the cube of the box's longest side,
/// where cells are twice as long along the shortest side if that has more than 2^4. Then which of 56 kinds of directions it has: three
/// signs, and the components that are less than half of its length.
pub fn ray_key(ray: Option<&MovedRay>, grid: &GridHeader) -> u32 {
    let Some(ray) = ray else { return RAY_KEY_WITHOUT_WALK };
    let extent = sub(grid.box_max, grid.box_min);
    let longest = largest(extent);
    let scale = KEY_CELLS / longest;
    let place: Vec3 = sub(ray.origin, grid.box_min).map(|along| (along * scale).floor().clamp(0.0, KEY_CELLS - 1.0));
    let [x, y, z] = place.map(|cell| cell as u32);
    let z_is_shortest = extent[2] <= extent[0] && extent[2] <= extent[1];
    let y_is_shortest = !z_is_shortest && extent[1] <= extent[0];
    let (cell, shortest) = match (z_is_shortest, y_is_shortest) {
        (true, _) => ([x, y, z], extent[2]),
        (_, true) => ([z, x, y], extent[1]),
        _ => ([y, z, x], extent[0]),
    };
    let last = if shortest + shortest > longest { cell[2] >> 1 } else { cell[2].min(15) };
    let [a, b, c] = [cell[0], cell[1], last].map(every_third_bit);
    let square = ray.direction.map(|along| along * along);
    let quarter = 0.25 * (square[0] + square[1] + square[2]);
    let three = |bits: [bool; 3]| u32::from(bits[0]) | u32::from(bits[1]) << 1 | u32::from(bits[2]) << 2;
    let (signs, little) = (three(ray.direction.map(|along| along > 0.0)), three(square.map(|square| square < quarter)));
    (a | b << 1 | c << 2) << KEY_DIRECTION_BITS | signs << 3 | little
}

/// Writes the key of each ray, and its index.
pub fn ray_keys(grid: &GridHeader, rays: &[Ray], keys: &mut [u32], values: &mut [u32]) {
    for (index, ((ray, key), value)) in (0..).zip(rays.iter().zip(keys).zip(values)) {
        *key = ray_key(move_ray(ray, grid).as_ref(), grid);
        *value = index;
    }
}
