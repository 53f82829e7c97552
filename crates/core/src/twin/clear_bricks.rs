//! Twin of kernel `clear_bricks`.

use crate::grid::brick_resolution;
use crate::shape::Shape;

/// Takes each brick for one without a triangle.
pub fn clear_bricks(shape: &Shape, groups: [u32; 3], resolution: [u32; 3], used: &mut [u32]) {
    let count: u32 = brick_resolution(resolution).iter().product();
    used[..count.min(groups.iter().product::<u32>() * shape.map_size) as usize].fill(0);
}
