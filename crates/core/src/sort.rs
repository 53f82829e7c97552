//! Digits and buffers of the radix sort, as `shared/sort.glsl` and `shared/ping_pong.glsl` have them.

/// The digit of a key in a pass.
pub const fn digit_of(key: u32, pass: u32, sort_bits: u32) -> u32 {
    (key >> (pass * sort_bits)) & ((1 << sort_bits) - 1)
}

/// Whether pair buffer a, not b, is written when `written` passes have been: 0 for the emission, pass + 1 for a pass. The last pass in use
/// writes b.
pub const fn writes_a(pass_count: u32, written: u32) -> bool {
    (pass_count.wrapping_sub(written)) & 1 == 1
}
