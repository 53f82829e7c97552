//! Twin of kernel `split_cells`.

use super::brick_reduce::cells_of_brick;
use crate::dispatch::workgroups;
use crate::grid::{brick_resolution, cell_id};
use crate::layout::{Brick, BuildState, GridHeader, SplitCell, TileOccupancy};
use crate::shape::Shape;
use crate::split::{LEAST_SPLIT, leaf_count_of, leaf_level, owner_shift};

/// Writes a record of each cell that is to be split, one with at least the state's `least_split` triangles; and which record holds the first
/// reference of each block.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn split_cells(
    shape: &Shape,
    groups: [u32; 3],
    grid: &GridHeader,
    state: &BuildState,
    cells: &[[u32; 2]],
    bricks: &[Brick],
    partials: &[TileOccupancy],
    records: &mut [SplitCell],
    owners: &mut [u32],
    leaf_capacity: u32,
) {
    let least = state.least_split;
    let shift = owner_shift(shape.owner_shift(), state.offset_count - 1);
    let count: u32 = brick_resolution(grid.resolution).iter().product();
    for tile in workgroups(groups) {
        let first = tile * shape.brick_tile();
        if first >= count || partials[tile as usize].split_cells[usize::from(least != LEAST_SPLIT)] == 0 {
            continue;
        }
        let TileOccupancy { cells_before: mut record, references_before: mut first_reference, leaves_before: mut leaf_begin, .. } =
            partials[tile as usize];
        let tile = first..count.min(first + shape.brick_tile());
        let long_bricks = tile.filter(|index| bricks[*index as usize].longest_list >= least);
        for (_, cell) in long_bricks.flat_map(|index| cells_of_brick(grid.resolution, index)) {
            let id = cell_id(cell, grid.resolution);
            let [list_begin, end] = cells[id as usize];
            let list_length = end - list_begin;
            let level = leaf_level(list_length, least, grid.fine_shift);
            if level == 0 {
                continue;
            }
            let leaf_end = leaf_begin.saturating_add(leaf_count_of(level));
            let level = if leaf_end <= leaf_capacity { level } else { 0 };
            let [x, y, z] = cell;
            records[record as usize] =
                SplitCell { first_reference, list_begin, list_length, leaf_begin, cell: id, level, xy: x | y << 16, z };
            let blocks = first_reference.div_ceil(1 << shift)..(first_reference + list_length).div_ceil(1 << shift);
            owners[blocks.start as usize..blocks.end as usize].fill(record);
            record += 1;
            first_reference += list_length;
            leaf_begin = leaf_end;
        }
    }
}
