//! Twin of kernel `scan_spine`.

use crate::shape::Shape;

/// The exclusive scan of some numbers in place, by saturating addition, from `before` on; returns the sum of all.
pub fn exclusive_scan(values: &mut [u32], before: u32) -> u32 {
    values.iter_mut().fold(before, |sum, value| {
        let next = sum.saturating_add(*value);
        *value = sum;
        next
    })
}

/// Scans the sums of the tiles of `length` numbers in place; returns the sum of all.
pub fn scan_spine(shape: &Shape, length: u32, partials: &mut [u32]) -> u32 {
    exclusive_scan(&mut partials[..length.div_ceil(shape.scan_tile()) as usize], 0)
}
