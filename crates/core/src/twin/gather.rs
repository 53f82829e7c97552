//! Twin of kernel `gather`.

use crate::dispatch::workgroups;
use crate::gather::{TriangleWords, gather_triangle, gathered_state, triangle_words};
use crate::layout::BuildState;
use crate::shape::Shape;

/// Writes the triangles of one mesh, and begins the build's state.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn gather(
    shape: &Shape,
    groups: [u32; 3],
    positions: &[f32],
    indices: &[u32],
    triangles: &mut [[f32; 4]],
    state: &mut BuildState,
    vertex_count: u32,
    triangle_count: u32,
) {
    *state = gathered_state(triangle_count, triangle_count);
    let invocations = workgroups(groups).flat_map(|group| group * shape.map_size..(group + 1) * shape.map_size);
    for triangle in invocations.filter(|triangle| *triangle < triangle_count) {
        let vertices = gather_triangle(positions, indices, vertex_count, triangle);
        let words = TriangleWords { flags: triangle, id: 0, mask: u32::MAX };
        triangles[3 * triangle as usize..][..3].copy_from_slice(&triangle_words(vertices, words));
    }
}
