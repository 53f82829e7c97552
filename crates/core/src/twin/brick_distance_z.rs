//! Twin of kernel `brick_distance_z`.

use super::brick_distance_x::{covered, nearest};
use crate::layout::Brick;
use crate::shape::Shape;

/// Distances of bricks along z and the axes before.
pub fn brick_distance_z(shape: &Shape, groups: [u32; 3], resolution: [u32; 3], distances_y: &[u32], bricks: &mut [Brick]) {
    for index in covered(shape, groups, resolution) {
        bricks[index as usize].distance = nearest(resolution, index, 2, |index| distances_y[index as usize]);
    }
}
