//! Twin of kernel `pair_args`.

use crate::dispatch::split_workgroups;
use crate::layout::{BuildState, DispatchArguments, OVERFLOW_PAIRS, Report};
use crate::shape::Shape;

pub(super) fn four([x, y, z]: [u32; 3]) -> [u32; 4] {
    [x, y, z, 0]
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
    arguments.cell_ranges = four(split_workgroups(count, shape.map_size));
    for pass in 0..pass_capacity as usize {
        let used = (pass as u32) < state.pass_count && count > 0;
        let groups = |groups| if used { four(groups) } else { [0; 4] };
        arguments.sort[pass] = groups(split_workgroups(tiles, shape.sort_tiles()));
        arguments.table_scan[pass] = groups(split_workgroups(state.table_count, shape.scan_tile()));
        arguments.table_spine[pass] = groups([1, 1, 1]);
    }
}
