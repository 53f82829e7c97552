//! Twin of kernel `sort_histogram`.

use crate::layout::BuildState;
use crate::shape::Shape;
use crate::sort::{digit_of, pairs_of, sort_tiles};

/// How often each digit occurs in each tile of keys that have a cell: a row a digit, a column a tile.
pub fn sort_histogram(shape: &Shape, groups: [u32; 3], state: &BuildState, keys: &[u32], table: &mut [u32], pass: u32) {
    let (pair_count, bits) = (pairs_of(state, pass), state.digit_bits);
    let tile_size = shape.sort_tile_of(pair_count);
    let tile_count = pair_count.div_ceil(tile_size);
    let tiles = keys[state.first_pair as usize..][..pair_count as usize].chunks(tile_size as usize);
    for (tile, keys) in sort_tiles(shape, groups).zip(tiles) {
        for digit in 0..1u32 << bits {
            table[(digit * tile_count + tile) as usize] = 0;
        }
        for key in keys.iter().filter(|key| **key != state.sentinel) {
            table[(digit_of(*key, pass, bits) * tile_count + tile) as usize] += 1;
        }
    }
}
