//! Twin of kernel `gather_records`.

use crate::dispatch::workgroups;
use crate::gather::{TriangleWords, tile_bounds, triangle_rows};
use crate::geometry::{AddressedMemory, FLAG_FLIP_FACING, FLAG_TWO_SIDED, GeometryRecord, position_of, vertices_of};
use crate::layout::{Bounds, TRIANGLE_FLIPPED, TRIANGLE_TWO_SIDED};
use crate::shape::Shape;

/// Writes the triangles of all geometries, and the box of each tile of them.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn gather_records(
    shape: &Shape,
    groups: [u32; 3],
    memory: &AddressedMemory,
    records: &[GeometryRecord],
    firsts: &[u32],
    triangle_count: u32,
    triangles: &mut [[f32; 4]],
    partials: &mut [Bounds],
) {
    let tiles = workgroups(groups).flat_map(|tile| tile * shape.bounds_tile()..(tile + 1) * shape.bounds_tile());
    for triangle in tiles.filter(|triangle| *triangle < triangle_count) {
        let index = firsts[..records.len()].partition_point(|first| *first <= triangle) - 1;
        let record = &records[index];
        let local = triangle - firsts[index];
        let vertices = vertices_of(memory, record, local);
        let is_whole = vertices.iter().all(|vertex| *vertex < record.vertex_count);
        let found = is_whole.then(|| vertices.map(|vertex| position_of(memory, record, vertex)));
        let bit = |flag, bit| if record.flags & flag != 0 { bit } else { 0 };
        let flags = local | bit(FLAG_FLIP_FACING, TRIANGLE_FLIPPED) | bit(FLAG_TWO_SIDED, TRIANGLE_TWO_SIDED);
        let words = TriangleWords { flags, id: record.id, mask: record.mask };
        triangles[3 * triangle as usize..][..3].copy_from_slice(&triangle_rows(found, words));
    }
    tile_bounds(shape, &triangles[..3 * triangle_count as usize], partials);
}
