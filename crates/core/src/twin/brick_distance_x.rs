//! Twin of kernel `brick_distance_x`.

use crate::dispatch::workgroups;
use crate::grid::{brick_resolution, cell_of};
use crate::layout::Brick;
use crate::shape::Shape;

/// Longer distances are not told apart.
pub const MAX_DISTANCE: u32 = 15;

/// Bricks of a dispatch's invocations.
pub(super) fn covered(shape: &Shape, groups: [u32; 3], resolution: [u32; 3]) -> std::ops::Range<u32> {
    let count: u32 = brick_resolution(resolution).iter().product();
    0..count.min(workgroups(groups).end * shape.map_size)
}

/// The least of max(steps, distance so far) over the bricks along an axis. The kernel ends its search early; this looks at all.
pub(super) fn nearest(resolution: [u32; 3], index: u32, axis: usize, before: impl Fn(u32) -> u32) -> u32 {
    let along = brick_resolution(resolution);
    let stride: u32 = along[..axis].iter().product();
    let here = cell_of(index, along)[axis];
    let line = (0..along[axis]).filter(|there| there.abs_diff(here) < MAX_DISTANCE);
    let distances = line.map(|there| there.abs_diff(here).max(before(index - here * stride + there * stride)));
    distances.min().unwrap_or(MAX_DISTANCE).min(MAX_DISTANCE)
}

/// Distances of bricks along x.
pub fn brick_distance_x(shape: &Shape, groups: [u32; 3], resolution: [u32; 3], bricks: &[Brick], distances: &mut [u32]) {
    let before = |index: u32| if bricks[index as usize].mask == [0, 0] { MAX_DISTANCE } else { 0 };
    for index in covered(shape, groups, resolution) {
        distances[index as usize] = nearest(resolution, index, 0, before);
    }
}
