//! Twin of kernel `table_scan`.

use super::pair_args::exclusive_scan;
use crate::dispatch::workgroups;
use crate::layout::BuildState;
use crate::shape::Shape;
use crate::sort::pairs_of;

/// Scans each row of the digit table in place; `sums` are those of the rows.
pub fn table_scan(shape: &Shape, groups: [u32; 3], state: &BuildState, table: &mut [u32], sums: &mut [u32], pass: u32) {
    let pair_count = pairs_of(state, pass);
    let tile_count = pair_count.div_ceil(shape.sort_tile_of(pair_count));
    let each = shape.table_rows();
    for row in workgroups(groups).flat_map(|group| group * each..(group + 1) * each).take(1 << state.digit_bits) {
        sums[row as usize] = exclusive_scan(&mut table[(row * tile_count) as usize..][..tile_count as usize], 0);
    }
}
