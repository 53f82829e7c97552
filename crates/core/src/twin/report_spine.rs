//! Twin of kernel `report_spine`.

use super::brick_reduce::unite;
use super::pair_args::four;
use crate::dispatch::split_workgroups;
use crate::grid::brick_resolution;
use crate::layout::{BuildState, GridHeader, LeafArguments, OVERFLOW_LEAVES, Report, TileOccupancy};
use crate::shape::Shape;
use crate::sort::passes_of;
use crate::split::{LEAST_SPLIT, LEAST_SPLIT_OF_LONG, LONG_LISTS};

/// Completes the report of the first level, scans what its tiles give the second to do, and begins the state of that.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn report_spine(
    shape: &Shape,
    grid: &GridHeader,
    state: &BuildState,
    partials: &mut [TileOccupancy],
    leaf_state: &mut BuildState,
    arguments: &mut LeafArguments,
    report: &mut Report,
    leaf_capacity: u32,
) {
    let bricks: u32 = brick_resolution(grid.resolution).iter().product();
    let count = bricks.div_ceil(shape.brick_tile());
    let partials = &mut partials[..count as usize];
    let sum = partials.iter().copied().fold(TileOccupancy::default(), unite);
    let long_lists = state.kept_count / LONG_LISTS >= sum.cells_in_use;
    let which = usize::from(long_lists);
    let mut before = TileOccupancy::default();
    for tile in partials {
        tile.cells_before = before.split_cells[which];
        tile.references_before = before.split_references[which];
        tile.leaves_before = before.leaf_cells[which];
        before = unite(before, *tile);
    }
    let [split_cells, split_references, leaf_cells] = [sum.split_cells, sum.split_references, sum.leaf_cells].map(|both| both[which]);
    report.cells_in_use = sum.cells_in_use;
    report.longest_list = sum.longest_list;
    report.split_cells = split_cells;
    report.leaf_cells = leaf_cells;
    report.leaf_pairs = 0;
    report.overflow = state.overflow | if leaf_cells > leaf_capacity { OVERFLOW_LEAVES } else { 0 };
    let key_bits = 32 - leaf_cells.min(leaf_capacity).saturating_sub(1).leading_zeros();
    let (pass_count, digit_bits) = passes_of(key_bits, shape.sort_bits);
    let counts = split_references + 1;
    *leaf_state = BuildState {
        offset_count: counts,
        key_bits,
        pass_count,
        digit_bits,
        sentinel: u32::MAX,
        first_pair: state.kept_count,
        first_cell: grid.cell_count,
        split_cells,
        least_split: if long_lists { LEAST_SPLIT_OF_LONG } else { LEAST_SPLIT },
        ..BuildState::default()
    };
    let groups = |groups| if split_cells > 0 { four(groups) } else { [0; 4] };
    arguments.split_cells = groups(split_workgroups(count, 1));
    arguments.count = groups(split_workgroups(counts, shape.map_size));
    arguments.offsets_scan = groups(split_workgroups(counts, shape.scan_tile()));
    arguments.args = if split_cells > 0 { arguments.offsets_scan } else { four([1, 1, 1]) };
}
