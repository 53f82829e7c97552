//! Twin of kernel `geometry_scan`.

use super::pair_args::four;
use crate::dispatch::split_workgroups;
use crate::gather::gathered_state;
use crate::geometry::{AddressedMemory, GeometryRecord, count_of};
use crate::layout::{BuildState, DispatchArguments};
use crate::shape::Shape;

/// Finds the first triangle of each geometry, and from the number of all triangles the sizes of the steps that follow.
pub fn geometry_scan(
    shape: &Shape,
    memory: &AddressedMemory,
    records: &[GeometryRecord],
    firsts: &mut [u32],
    state: &mut BuildState,
    arguments: &mut DispatchArguments,
    triangle_capacity: u32,
) {
    let total = records.iter().zip(firsts).fold(0, |total: u32, (record, first)| {
        *first = total;
        total.saturating_add(count_of(memory, record))
    });
    let count = total.min(triangle_capacity);
    *state = gathered_state(count, total);
    arguments.gather = four(split_workgroups(count.max(1), shape.bounds_tile()));
    arguments.overlap_count = four(split_workgroups(count + 1, shape.map_size));
    arguments.offsets_scan = four(split_workgroups(count + 1, shape.scan_tile()));
}
