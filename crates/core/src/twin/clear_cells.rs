//! Twin of kernel `clear_cells`.

use crate::dispatch::workgroups;
use crate::shape::Shape;

/// Cells that an invocation clears.
pub const CELLS_EACH: u32 = 8;

/// Empties the cells in use, and those up to the next multiple of eight.
pub fn clear_cells(shape: &Shape, groups: [u32; 3], cell_count: u32, cells: &mut [[u32; 2]]) {
    let invocations = workgroups(groups).flat_map(|group| group * shape.map_size..(group + 1) * shape.map_size);
    for first in invocations.map(|invocation| invocation * CELLS_EACH).filter(|first| *first < cell_count) {
        cells[first as usize..(first + CELLS_EACH) as usize].fill([0, 0]);
    }
}
