//! Triangles as a build first writes them, as `shared/gather.glsl` has them.

use crate::layout::{BuildState, OVERFLOW_TRIANGLES, TRIANGLE_DROPPED};
use crate::vector::{Vec3, is_finite};

/// The vertices of a triangle; `None` if one is not finite or its index lies outside of the positions: the triangle is dropped.
pub fn gather_triangle(positions: &[f32], indices: &[u32], vertex_count: u32, triangle: u32) -> Option<[Vec3; 3]> {
    let first = 3 * triangle as usize;
    let vertices = [indices[first], indices[first + 1], indices[first + 2]];
    if vertices.iter().any(|vertex| *vertex >= vertex_count) {
        return None;
    }
    let found = vertices.map(|vertex| {
        let first = 3 * vertex as usize;
        [positions[first], positions[first + 1], positions[first + 2]]
    });
    found.iter().all(|vertex| is_finite(*vertex)).then_some(found)
}

/// What of a triangle is the same for all of its geometry, but for its number there.
#[derive(Clone, Copy, Debug)]
pub struct TriangleWords {
    /// `TRIANGLE_*` bits, and the triangle's number in its geometry.
    pub flags: u32,
    /// Of the geometry.
    pub id: u32,
    /// Of the geometry.
    pub mask: u32,
}

/// A triangle as it lies in memory; all zero if it is dropped.
pub fn triangle_words(vertices: Option<[Vec3; 3]>, words: TriangleWords) -> [[f32; 4]; 3] {
    let whole = vertices.filter(|vertices| vertices.iter().all(|vertex| is_finite(*vertex)));
    let flags = words.flags | if whole.is_none() { TRIANGLE_DROPPED } else { 0 };
    let [a, b, c] = whole.unwrap_or([[0.0; 3]; 3]);
    let with = |[x, y, z]: Vec3, word: u32| [x, y, z, f32::from_bits(word)];
    [with(a, flags), with(b, words.id), with(c, words.mask)]
}

/// Whether a triangle in memory was dropped, by its first vertex.
pub fn is_dropped(first: [f32; 4]) -> bool {
    first[3].to_bits() & TRIANGLE_DROPPED != 0
}

/// The head of a build's state, from which all later steps take the number of triangles.
pub fn gathered_state(triangle_count: u32, triangle_total: u32) -> BuildState {
    let overflow = if triangle_total > triangle_count { OVERFLOW_TRIANGLES } else { 0 };
    BuildState { triangle_count, offset_count: triangle_count + 1, overflow, triangle_total, ..BuildState::default() }
}
