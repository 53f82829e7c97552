//! Twin of kernel `pair_args`.

use crate::dispatch::{split_workgroups, workgroups};
use crate::layout::{BuildState, DispatchArguments, OVERFLOW_PAIRS, Report};
use crate::shape::Shape;

pub(super) fn four([x, y, z]: [u32; 3]) -> [u32; 4] {
    [x, y, z, 0]
}

/// The exclusive scan of some numbers in place, by saturating addition, from `before` on; returns the sum of all.
pub fn exclusive_scan(values: &mut [u32], before: u32) -> u32 {
    values.iter_mut().fold(before, |sum, value| {
        let next = sum.saturating_add(*value);
        *value = sum;
        next
    })
}

/// Scans each tile of `length` numbers in place, from the sum of all tiles before it; returns the sum of all.
pub fn scan_tiles(shape: &Shape, groups: [u32; 3], length: u32, partials: &[u32], values: &mut [u32]) -> u32 {
    let tiles = values[..length as usize].chunks_mut(shape.scan_tile() as usize);
    workgroups(groups).zip(tiles).fold(0, |_, (tile, values)| {
        let before = partials[..tile as usize].iter().fold(0, |sum: u32, partial| sum.saturating_add(*partial));
        exclusive_scan(values, before)
    })
}

/// Workgroups of a pass of the sort of a state's pairs: of its histogram and scatter, and of its table's scan.
pub(super) fn pass_groups(shape: &Shape, state: &BuildState, pass: u32) -> [[u32; 4]; 2] {
    if pass >= state.pass_count || state.pair_count == 0 {
        return [[0; 4]; 2];
    }
    [shape.sort_workgroups(state.pair_count), split_workgroups(1 << state.digit_bits, shape.table_rows())].map(four)
}

/// Scans the counts of pairs, and turns the number of all into the sizes of the steps that follow.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn pair_args(
    shape: &Shape,
    groups: [u32; 3],
    state: &mut BuildState,
    partials: &[u32],
    offsets: &mut [u32],
    arguments: &mut DispatchArguments,
    report: &mut Report,
    pair_capacity: u32,
    pass_capacity: u32,
) {
    let total = scan_tiles(shape, groups, state.offset_count, partials, offsets);
    let count = total.min(pair_capacity);
    state.pair_total = total;
    state.pair_count = count;
    state.kept_count = count;
    state.overflow |= if total > pair_capacity { OVERFLOW_PAIRS } else { 0 };
    report.pair_total = total;
    report.overflow = state.overflow;
    let runs = four(shape.deal_workgroups(count.div_ceil(shape.emit_pairs), shape.map_size));
    arguments.emit_large = if state.has_large != 0 { runs } else { [0; 4] };
    arguments.cell_ranges = four(shape.deal_workgroups(count.div_ceil(shape.range_pairs), shape.map_size));
    for pass in 0..pass_capacity {
        let at = pass as usize;
        [arguments.sort[at], arguments.table_scan[at]] = pass_groups(shape, state, pass);
    }
}
