//! Twin of kernel `pair_args`.

use crate::dispatch::split_workgroups;
use crate::layout::{BuildState, DispatchArguments, OVERFLOW_PAIRS, Report};
use crate::shape::Shape;

pub(super) fn four([x, y, z]: [u32; 3]) -> [u32; 4] {
    [x, y, z, 0]
}

/// Workgroups of a pass of the sort of a state's pairs: of its histogram and scatter, of the reduce and the downsweep of its table's scan, and
/// of that scan's spine.
pub(super) fn pass_groups(shape: &Shape, state: &BuildState, pass: u32) -> [[u32; 4]; 3] {
    if pass >= state.pass_count || state.pair_count == 0 {
        return [[0; 4]; 3];
    }
    let tiles = state.pair_count.div_ceil(shape.sort_tile());
    [split_workgroups(tiles, shape.sort_tiles()), split_workgroups(state.table_count, shape.scan_tile()), [1, 1, 1]].map(four)
}

/// Turns the number of pairs into the sizes of the steps that follow.
pub fn pair_args(
    shape: &Shape,
    state: &mut BuildState,
    offsets: &[u32],
    arguments: &mut DispatchArguments,
    report: &mut Report,
    pair_capacity: u32,
    pass_capacity: u32,
) {
    let total = offsets[state.triangle_count as usize];
    let count = total.min(pair_capacity);
    let tiles = count.div_ceil(shape.sort_tile());
    state.pair_total = total;
    state.pair_count = count;
    state.kept_count = count;
    state.table_count = tiles << state.digit_bits;
    state.overflow |= if total > pair_capacity { OVERFLOW_PAIRS } else { 0 };
    report.pair_total = total;
    report.overflow = state.overflow;
    let runs = four(split_workgroups(count.div_ceil(shape.emit_pairs), shape.map_size));
    arguments.emit_large = if state.has_large != 0 { runs } else { [0; 4] };
    arguments.cell_ranges = four(split_workgroups(count.div_ceil(shape.range_pairs), shape.map_size));
    for pass in 0..pass_capacity {
        let at = pass as usize;
        [arguments.sort[at], arguments.table_scan[at], arguments.table_spine[at]] = pass_groups(shape, state, pass);
    }
}
