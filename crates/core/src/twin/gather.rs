//! Twin of kernel `gather`.

use crate::dispatch::workgroups;
use crate::gather::{TriangleWords, gather_triangle, gathered_state, tile_bounds, triangle_rows};
use crate::layout::{Bounds, BuildState};
use crate::shape::Shape;

/// Writes the triangles of one mesh and the box of each tile of them, and begins the build's state.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn gather(
    shape: &Shape,
    groups: [u32; 3],
    positions: &[f32],
    indices: &[u32],
    triangles: &mut [[f32; 4]],
    state: &mut BuildState,
    partials: &mut [Bounds],
    vertex_count: u32,
    triangle_count: u32,
) {
    *state = gathered_state(triangle_count, triangle_count);
    let tiles = workgroups(groups).flat_map(|tile| tile * shape.bounds_tile()..(tile + 1) * shape.bounds_tile());
    for triangle in tiles.filter(|triangle| *triangle < triangle_count) {
        let vertices = gather_triangle(positions, indices, vertex_count, triangle);
        let words = TriangleWords { flags: triangle, id: 0, mask: u32::MAX };
        triangles[3 * triangle as usize..][..3].copy_from_slice(&triangle_rows(vertices, words));
    }
    tile_bounds(shape, &triangles[..3 * triangle_count as usize], partials);
}
