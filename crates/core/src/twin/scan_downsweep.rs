//! Twin of kernel `scan_downsweep`.

use super::scan_spine::exclusive_scan;
use crate::dispatch::workgroups;
use crate::shape::Shape;

/// Scans each tile in place, from the scanned sum of all tiles before it.
pub fn scan_downsweep(shape: &Shape, groups: [u32; 3], length: u32, partials: &[u32], values: &mut [u32]) {
    let tiles = values[..length as usize].chunks_mut(shape.scan_tile() as usize);
    for (tile, values) in workgroups(groups).zip(tiles) {
        exclusive_scan(values, partials[tile as usize]);
    }
}
