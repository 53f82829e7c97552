//! Digits, numbers and buffers of the radix sort, as `shared/sort.glsl` and `shared/ping_pong.glsl` have them.

use crate::dispatch::workgroups;
use crate::layout::BuildState;
use crate::shape::Shape;

/// The digit of a key in a pass of `bits` a digit.
pub const fn digit_of(key: u32, pass: u32, bits: u32) -> u32 {
    (key >> (pass * bits)) & ((1 << bits) - 1)
}

/// Passes for keys of so many bits in digits of at most `sort_bits`, and the bits of each digit: no more than that many passes need.
pub const fn passes_of(key_bits: u32, sort_bits: u32) -> (u32, u32) {
    let passes = key_bits.div_ceil(sort_bits);
    (passes, if passes == 0 { 0 } else { key_bits.div_ceil(passes) })
}

/// Pairs that a pass reads. The first leaves those without a cell behind.
pub const fn pairs_of(state: &BuildState, pass: u32) -> u32 {
    if pass == 0 { state.pair_count } else { state.kept_count }
}

/// Whether pair buffer a, not b, is written when `written` passes have been: 0 for the emission, pass + 1 for a pass. The last pass in use
/// writes b.
pub const fn writes_a(pass_count: u32, written: u32) -> bool {
    (pass_count.wrapping_sub(written)) & 1 == 1
}

/// Tiles of pairs that the workgroups of a dispatch sort, in order.
pub fn sort_tiles(shape: &Shape, groups: [u32; 3]) -> impl Iterator<Item = u32> {
    let each = shape.sort_tiles();
    workgroups(groups).flat_map(move |group| group * each..(group + 1) * each)
}
