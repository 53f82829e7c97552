//! Twin of kernel `brick_distance_y`.

use super::brick_distance_x::{covered, nearest};
use crate::shape::Shape;

/// Distances of bricks along y and the axes before.
pub fn brick_distance_y(shape: &Shape, groups: [u32; 3], resolution: [u32; 3], distances_x: &[u32], distances: &mut [u32]) {
    for index in covered(shape, groups, resolution) {
        distances[index as usize] = nearest(resolution, index, 1, |index| distances_x[index as usize]);
    }
}
