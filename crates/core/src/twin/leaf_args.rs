//! Twin of kernel `leaf_args`.

use super::pair_args::{four, pass_groups, scan_tiles};
use crate::dispatch::split_workgroups;
use crate::layout::{BuildState, LeafArguments, OVERFLOW_LEAVES, OVERFLOW_PAIRS, Report};
use crate::shape::Shape;
use crate::split::{LEAST_MEASURED, MAX_LEVEL, leaf_level};

/// Scans the counts of the second level's pairs, and turns the number of all into the sizes of the steps that follow. If they do not fit, no
/// cell is split.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn leaf_args(
    shape: &Shape,
    groups: [u32; 3],
    state: &mut BuildState,
    partials: &[u32],
    offsets: &mut [u32],
    arguments: &mut LeafArguments,
    report: &mut Report,
    pair_capacity: u32,
    pass_capacity: u32,
) {
    let sum = scan_tiles(shape, groups, state.offset_count, partials, offsets);
    let total = if state.split_cells > 0 { sum } else { 0 };
    let fits = total <= pair_capacity - state.first_pair;
    let count = if fits { total } else { 0 };
    state.pair_total = total;
    state.pair_count = count;
    state.kept_count = count;
    if !fits {
        if report.overflow & OVERFLOW_PAIRS == 0 {
            report.pair_total = report.pair_total.max(state.first_pair.saturating_add(total));
        }
        report.overflow |= OVERFLOW_LEAVES;
    }
    report.leaf_pairs = count;
    write_sort(shape, &BuildState { pair_count: if shape.leaf_run == 0 { count } else { 0 }, ..*state }, arguments, pass_capacity);
    let alone = shape.leaf_run > 0 && count > 0;
    arguments.emit_large = if alone { arguments.count } else { [0; 4] };
    let work = count + 2 * (state.offset_count - 1) + report.leaf_cells / 8;
    arguments.leaf_sort = if alone { four(split_workgroups(work / shape.leaf_run + 1, shape.sort_size)) } else { [0; 4] };
    let measured = leaf_level(report.longest_list, state.least_split, MAX_LEVEL) >= LEAST_MEASURED;
    arguments.distance = if count > 0 && measured { four(split_workgroups(state.split_cells, shape.measured_cells())) } else { [0; 4] };
}

/// The sizes of the steps that sort the second level's pairs all together.
pub(super) fn write_sort(shape: &Shape, state: &BuildState, arguments: &mut LeafArguments, pass_capacity: u32) {
    let count = state.pair_count;
    arguments.emit = if count > 0 { arguments.count } else { [0; 4] };
    arguments.cell_ranges = four(shape.deal_workgroups(count.div_ceil(shape.range_pairs), shape.map_size));
    for pass in 0..pass_capacity {
        let at = pass as usize;
        [arguments.sort[at], arguments.table_scan[at]] = pass_groups(shape, state, pass);
    }
}
