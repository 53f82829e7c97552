//! Twin of kernel `clear_cells`.

use super::brick_reduce::cells_of_brick;
use crate::grid::{BRICK_SIZE, brick_resolution, cell_id};
use crate::shape::Shape;

/// Empties the cells of the bricks that triangles may lie in.
pub fn clear_cells(shape: &Shape, groups: [u32; 3], resolution: [u32; 3], used: &[u32], cells: &mut [[u32; 2]]) {
    let slices = (groups.iter().product::<u32>() * shape.map_size).min(BRICK_SIZE * brick_resolution(resolution).iter().product::<u32>());
    for index in (0..slices / BRICK_SIZE).filter(|index| used[*index as usize] != 0) {
        for (_, cell) in cells_of_brick(resolution, index) {
            cells[cell_id(cell, resolution) as usize] = [0, 0];
        }
    }
}
