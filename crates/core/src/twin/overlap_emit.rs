//! Twin of kernel `overlap_emit`.

use crate::grid::cell_id;
use crate::layout::GridHeader;
use crate::overlap::{triangle_cells, triangle_overlaps_cell};
use crate::shape::Shape;

/// Writes the pairs (cell id, triangle). The kernel hands an invocation a run of pairs and searches for its triangle; here each triangle
/// writes its own, which must come to the same.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn overlap_emit(
    shape: &Shape,
    groups: [u32; 3],
    exact: bool,
    grid: &GridHeader,
    pair_count: u32,
    offsets: &[u32],
    triangles: &[[f32; 4]],
    keys: &mut [u32],
    values: &mut [u32],
) {
    let covered = groups[0] * groups[1] * shape.map_size * shape.emit_pairs;
    let last = pair_count.min(covered);
    for (triangle, ends) in offsets.windows(2).enumerate().take_while(|(_, ends)| ends[0] < last) {
        if ends[0] == ends[1] {
            continue;
        }
        let v: [[f32; 3]; 3] = std::array::from_fn(|i| {
            let [x, y, z, _] = triangles[3 * triangle + i];
            [x, y, z]
        });
        let cells = triangle_cells(grid, v);
        // A box of one row of cells is met by its triangle in each of them.
        let test = exact && cells.size().iter().filter(|n| **n == 1).count() < 2;
        for pair in ends[0]..ends[1].min(last) {
            let cell = cells.cell(pair - ends[0]);
            let overlaps = !test || triangle_overlaps_cell(grid, v, cell);
            keys[pair as usize] = if overlaps { cell_id(cell, grid.resolution) } else { grid.cell_count };
            values[pair as usize] = triangle as u32;
        }
    }
}
