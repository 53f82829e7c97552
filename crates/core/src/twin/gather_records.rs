//! Twin of kernel `gather_records`.

use crate::dispatch::workgroups;
use crate::gather::{TriangleWords, triangle_words};
use crate::geometry::{AddressedMemory, FLAG_FLIP_FACING, FLAG_TWO_SIDED, GeometryRecord, position_of, vertices_of};
use crate::layout::{TRIANGLE_FLIPPED, TRIANGLE_TWO_SIDED};
use crate::shape::Shape;

/// Writes the triangles of all geometries.
pub fn gather_records(
    shape: &Shape,
    groups: [u32; 3],
    memory: &AddressedMemory,
    records: &[GeometryRecord],
    firsts: &[u32],
    triangle_count: u32,
    triangles: &mut [[f32; 4]],
) {
    let invocations = workgroups(groups).flat_map(|group| group * shape.map_size..(group + 1) * shape.map_size);
    for triangle in invocations.filter(|triangle| *triangle < triangle_count) {
        let index = firsts[..records.len()].partition_point(|first| *first <= triangle) - 1;
        let record = &records[index];
        let local = triangle - firsts[index];
        let vertices = vertices_of(memory, record, local);
        let is_whole = vertices.iter().all(|vertex| *vertex < record.vertex_count);
        let found = is_whole.then(|| vertices.map(|vertex| position_of(memory, record, vertex)));
        let bit = |flag, bit| if record.flags & flag != 0 { bit } else { 0 };
        let flags = local | bit(FLAG_FLIP_FACING, TRIANGLE_FLIPPED) | bit(FLAG_TWO_SIDED, TRIANGLE_TWO_SIDED);
        let words = TriangleWords { flags, id: record.id, mask: record.mask };
        triangles[3 * triangle as usize..][..3].copy_from_slice(&triangle_words(found, words));
    }
}
