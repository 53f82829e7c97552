//! Twin of kernel `sort_scatter`.

use super::pair_args::exclusive_scan;
use crate::layout::BuildState;
use crate::shape::Shape;
use crate::sort::{digit_of, pairs_of, sort_tiles};

/// Pairs as two arrays.
pub struct Pairs<'a, T: ?Sized> {
    /// Cell ids.
    pub keys: &'a T,
    /// Triangles.
    pub values: &'a T,
}

/// Moves the pairs of each tile to where their digit puts them; `table` says how many keys of a digit the tiles
/// before have, `sums` how many all have; those without a cell go nowhere. The first pass counts the others.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn sort_scatter(
    shape: &Shape,
    groups: [u32; 3],
    state: &mut BuildState,
    pairs: &Pairs<'_, [u32]>,
    keys_out: &mut [u32],
    values_out: &mut [u32],
    table: &[u32],
    sums: &[u32],
    pass: u32,
) {
    let (pair_count, bits) = (pairs_of(state, pass), state.digit_bits);
    let tile_size = shape.sort_tile_of(pair_count);
    let tile_count = pair_count.div_ceil(tile_size);
    let first = state.first_pair as usize;
    let tiles = pairs.keys[first..][..pair_count as usize].chunks(tile_size as usize).zip(pairs.values[first..].chunks(tile_size as usize));
    for (tile, (keys, values)) in sort_tiles(shape, groups).zip(tiles) {
        let mut rows = sums[..1 << bits].to_vec();
        let end = exclusive_scan(&mut rows, state.first_pair);
        if pass == 0 && tile == 0 {
            state.kept_count = end - state.first_pair;
        }
        let mut next: Vec<u32> =
            (0..).zip(rows).map(|(digit, row): (u32, u32)| row + table[(digit * tile_count + tile) as usize]).collect();
        for (key, value) in keys.iter().zip(values).filter(|(key, _)| **key != state.sentinel) {
            let destination = &mut next[digit_of(*key, pass, bits) as usize];
            keys_out[*destination as usize] = *key;
            values_out[*destination as usize] = *value;
            *destination += 1;
        }
    }
}
