//! Twin of kernel `cell_ranges`.

use crate::dispatch::workgroups;
use crate::layout::Report;
use crate::shape::Shape;

/// Where each cell's list begins and ends in the sorted pairs (thesis Figure 3.3).
pub fn cell_ranges(
    shape: &Shape,
    groups: [u32; 3],
    cell_count: u32,
    pair_count: u32,
    keys: &[u32],
    cells: &mut [[u32; 2]],
    report: &mut Report,
) {
    let covered = workgroups(groups).end * shape.map_size;
    for pair in 0..pair_count.min(covered) {
        let key = keys[pair as usize];
        let before = pair.checked_sub(1).map(|before| keys[before as usize]);
        if before != Some(key) {
            cells[key as usize][0] = pair;
        }
        let next = if pair + 1 < pair_count { keys[pair as usize + 1] } else { cell_count };
        if next != key {
            cells[key as usize][1] = pair + 1;
        }
        if next == cell_count {
            report.pairs = pair + 1;
        }
    }
}
