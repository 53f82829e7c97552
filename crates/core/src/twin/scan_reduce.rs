//! Twin of kernel `scan_reduce`.

use crate::dispatch::workgroups;
use crate::shape::Shape;

/// The saturating sum of each tile of counts.
pub fn scan_reduce(shape: &Shape, groups: [u32; 3], length: u32, values: &[u32], partials: &mut [u32]) {
    let tiles = values[..length as usize].chunks(shape.scan_tile() as usize);
    for (tile, values) in workgroups(groups).zip(tiles) {
        partials[tile as usize] = values.iter().fold(0, |sum: u32, value| sum.saturating_add(*value));
    }
}
