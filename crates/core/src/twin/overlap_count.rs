//! Twin of kernel `overlap_count`.

use crate::dispatch::workgroups;
use crate::gather::{is_dropped, rows_of, vertices_of};
use crate::grid::{BRICK_SIZE, brick_resolution, cell_id};
use crate::layout::{BuildState, GridHeader};
use crate::overlap::{CellBox, SMALL_BOX, SeparatingAxes, triangle_cells};
use crate::shape::Shape;

/// Marks the bricks of a box: a triangle may lie in them.
pub fn mark_bricks(grid: &GridHeader, cells: &CellBox, used: &mut [u32]) {
    let [low, high] = [cells.low, cells.high].map(|cell| cell.map(|n| n / BRICK_SIZE));
    for z in low[2]..=high[2] {
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                used[cell_id([x, y, z], brick_resolution(grid.resolution)) as usize] = 1;
            }
        }
    }
}

/// Brings triangles into the grid's frame and counts their cells: of a small box those that it overlaps, a bit of its mask each, of a large
/// one all; that has no bit. Of a triangle's three words the mask is the first; of a small box its first cell and
/// [`crate::overlap::CellBox::sizes_word`] are the others, and its bricks are marked as used. The count after the last triangle is zero.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn overlap_count(
    shape: &Shape,
    groups: [u32; 3],
    exact: bool,
    grid: &GridHeader,
    state: &mut BuildState,
    triangles: &mut [[f32; 4]],
    counts: &mut [u32],
    boxes: &mut [[u32; 3]],
    used: &mut [u32],
) {
    let triangle_count = state.triangle_count;
    let invocations = workgroups(groups).flat_map(|group| group * shape.map_size..(group + 1) * shape.map_size);
    for triangle in invocations.filter(|triangle| *triangle <= triangle_count) {
        counts[triangle as usize] = 0;
        if triangle == triangle_count {
            continue;
        }
        boxes[triangle as usize] = [0; 3];
        let first = 3 * triangle as usize;
        if is_dropped(triangles[first]) {
            continue;
        }
        let rows: [[f32; 4]; 3] = std::array::from_fn(|axis| triangles[first + axis]);
        let v = vertices_of(rows).map(|vertex| grid.to_frame(vertex));
        triangles[first..first + 3].copy_from_slice(&rows_of(v, rows.map(|row| row[3].to_bits())));
        let cells = triangle_cells(grid, v);
        let all = cells.count();
        boxes[triangle as usize] = [0, cell_id(cells.low, grid.resolution), cells.sizes_word()];
        if all > SMALL_BOX {
            state.has_large = 1;
            counts[triangle as usize] = all;
            continue;
        }
        mark_bricks(grid, &cells, used);
        let axes = SeparatingAxes::new(grid, v, cells.low);
        let meets = |n: &u32| !exact || cells.is_row() || axes.meets(cells.cell(*n));
        let mask = (0..all).filter(meets).fold(0u32, |mask, n| mask | 1 << n);
        counts[triangle as usize] = mask.count_ones();
        boxes[triangle as usize][0] = mask;
    }
}
