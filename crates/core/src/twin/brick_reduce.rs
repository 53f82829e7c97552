//! Twin of kernel `brick_reduce`.

use crate::dispatch::workgroups;
use crate::grid::{BRICK_SIZE, brick_resolution, cell_id, cell_of};
use crate::layout::{Brick, GridHeader, TileOccupancy};
use crate::shape::Shape;
use crate::split::{LEAST_SPLIT, LEAST_SPLIT_OF_LONG, leaf_count_of, leaf_level};

/// What two sets of cells come to together.
pub(super) fn unite(a: TileOccupancy, b: TileOccupancy) -> TileOccupancy {
    TileOccupancy {
        cells_in_use: a.cells_in_use + b.cells_in_use,
        longest_list: a.longest_list.max(b.longest_list),
        split_cells: std::array::from_fn(|i| a.split_cells[i] + b.split_cells[i]),
        split_references: std::array::from_fn(|i| a.split_references[i] + b.split_references[i]),
        leaf_cells: std::array::from_fn(|i| a.leaf_cells[i].saturating_add(b.leaf_cells[i])),
        ..TileOccupancy::default()
    }
}

/// The cells of a brick that are in the grid, in the order of its bits; and their bits.
pub(super) fn cells_of_brick(resolution: [u32; 3], index: u32) -> impl Iterator<Item = (u32, [u32; 3])> {
    let low = cell_of(index, brick_resolution(resolution)).map(|n| n * BRICK_SIZE);
    let cell = move |bit: u32| std::array::from_fn(|axis| low[axis] + (bit >> (2 * axis)) % BRICK_SIZE);
    let inside = move |cell: &[u32; 3]| cell.iter().zip(&resolution).all(|(cell, count)| cell < count);
    (0..64).map(move |bit| (bit, cell(bit))).filter(move |(_, cell)| inside(cell))
}

fn brick(grid: &GridHeader, index: u32, used: bool, cells: &[[u32; 2]]) -> (Brick, TileOccupancy) {
    let mut mask = 0u64;
    let mut occupancy = TileOccupancy::default();
    for (bit, cell) in cells_of_brick(grid.resolution, index).filter(|_| used) {
        let [begin, end] = cells[cell_id(cell, grid.resolution) as usize];
        let length = end - begin;
        mask |= u64::from(end != 0) << bit;
        let levels = [LEAST_SPLIT, LEAST_SPLIT_OF_LONG].map(|least| leaf_level(length, least, grid.fine_shift));
        let split_cells = levels.map(|level| u32::from(level > 0));
        let split_references = levels.map(|level| if level > 0 { length } else { 0 });
        let leaf_cells = levels.map(|level| if level > 0 { leaf_count_of(level) } else { 0 });
        let cells_in_use = u32::from(end != 0);
        let one = TileOccupancy { cells_in_use, longest_list: length, split_cells, split_references, leaf_cells, ..occupancy };
        occupancy = unite(occupancy, one);
    }
    let longest_list = occupancy.longest_list;
    (Brick { mask: [mask as u32, (mask >> 32) as u32], longest_list, ..Brick::default() }, occupancy)
}

/// Which cells of each brick are in use, of those bricks that triangles may lie in; what each tile of bricks adds to the report and gives the
/// second level to do.
pub fn brick_reduce(
    shape: &Shape,
    groups: [u32; 3],
    grid: &GridHeader,
    used: &[u32],
    cells: &[[u32; 2]],
    bricks: &mut [Brick],
    partials: &mut [TileOccupancy],
) {
    let count: u32 = brick_resolution(grid.resolution).iter().product();
    for tile in workgroups(groups) {
        let first = tile * shape.brick_tile();
        if first >= count {
            continue;
        }
        partials[tile as usize] = (first..count.min(first + shape.brick_tile())).fold(TileOccupancy::default(), |sum, index| {
            let occupancy;
            (bricks[index as usize], occupancy) = brick(grid, index, used[index as usize] != 0, cells);
            unite(sum, occupancy)
        });
    }
}
