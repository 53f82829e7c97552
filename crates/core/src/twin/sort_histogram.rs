//! Twin of kernel `sort_histogram`.

use crate::dispatch::workgroups;
use crate::shape::Shape;
use crate::sort::digit_of;

/// How often each digit occurs in each tile of keys: a row a digit, a column a tile.
pub fn sort_histogram(shape: &Shape, groups: [u32; 3], pair_count: u32, keys: &[u32], table: &mut [u32], pass: u32) {
    let tile_count = pair_count.div_ceil(shape.sort_tile());
    let tiles = keys[..pair_count as usize].chunks(shape.sort_tile() as usize);
    for (tile, keys) in workgroups(groups).zip(tiles) {
        for digit in 0..1u32 << shape.sort_bits {
            table[(digit * tile_count + tile) as usize] = 0;
        }
        for key in keys {
            table[(digit_of(*key, pass, shape.sort_bits) * tile_count + tile) as usize] += 1;
        }
    }
}
