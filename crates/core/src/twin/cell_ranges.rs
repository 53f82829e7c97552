//! Twin of kernel `cell_ranges`.

use crate::dispatch::workgroups;
use crate::layout::{BuildState, Report};
use crate::shape::Shape;

/// Where each cell's list begins and ends in the sorted pairs (thesis Figure 3.3); of the second level, by its state, each leaf cell's.
pub fn cell_ranges(shape: &Shape, groups: [u32; 3], state: &BuildState, keys: &[u32], cells: &mut [[u32; 2]], report: &mut Report) {
    let covered = workgroups(groups).end * shape.map_size * shape.range_pairs;
    let (first, count) = (state.first_pair, state.kept_count);
    let key = |pair: u32| keys[(first + pair) as usize];
    for pair in 0..count.min(covered) {
        let cell = |key: u32| (state.first_cell + key) as usize;
        if pair == 0 {
            cells[cell(key(pair))][0] = first;
        }
        let next = (pair + 1 < count).then(|| key(pair + 1));
        if next != Some(key(pair)) {
            cells[cell(key(pair))][1] = first + pair + 1;
        }
        if let Some(next) = next.filter(|next| *next != key(pair)) {
            cells[cell(next)][0] = first + pair + 1;
        }
        if next.is_none() && state.first_cell == 0 {
            report.pairs = pair + 1;
        }
    }
}
