//! Triangles as a build first writes them, as `shared/gather.glsl` has them.

use crate::layout::{Bounds, BuildState, OVERFLOW_TRIANGLES, TRIANGLE_DROPPED};
use crate::shape::Shape;
use crate::vector::{Vec3, is_finite, max, min};

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

/// A triangle as it lies in memory, by rows: x of its vertices, y, z, and a word in each fourth component. All coordinates are zero if it is
/// dropped.
pub fn triangle_rows(vertices: Option<[Vec3; 3]>, words: TriangleWords) -> [[f32; 4]; 3] {
    let whole = vertices.filter(|vertices| vertices.iter().all(|vertex| is_finite(*vertex)));
    let flags = words.flags | if whole.is_none() { TRIANGLE_DROPPED } else { 0 };
    rows_of(whole.unwrap_or([[0.0; 3]; 3]), [flags, words.id, words.mask])
}

/// The rows of a triangle with these words.
pub fn rows_of([a, b, c]: [Vec3; 3], words: [u32; 3]) -> [[f32; 4]; 3] {
    std::array::from_fn(|axis| [a[axis], b[axis], c[axis], f32::from_bits(words[axis])])
}

/// The vertices of a triangle that lies in memory.
pub fn vertices_of([x, y, z]: [[f32; 4]; 3]) -> [Vec3; 3] {
    std::array::from_fn(|corner| [x[corner], y[corner], z[corner]])
}

/// Whether a triangle in memory was dropped, by its first row.
pub fn is_dropped(first: [f32; 4]) -> bool {
    first[3].to_bits() & TRIANGLE_DROPPED != 0
}

/// The union of two boxes.
pub fn unite(a: Bounds, b: Bounds) -> Bounds {
    Bounds { low: min(a.low, b.low), dropped: a.dropped + b.dropped, high: max(a.high, b.high), reserved: 0 }
}

/// The box of a triangle in memory.
fn triangle_bounds(rows: &[[f32; 4]]) -> Bounds {
    if is_dropped(rows[0]) {
        return Bounds { dropped: 1, ..Bounds::EMPTY };
    }
    let [a, b, c] = vertices_of([rows[0], rows[1], rows[2]]);
    Bounds { low: min(a, min(b, c)), dropped: 0, high: max(a, max(b, c)), reserved: 0 }
}

/// The boxes of the tiles of triangles that lie in memory.
pub fn tile_bounds(shape: &Shape, triangles: &[[f32; 4]], partials: &mut [Bounds]) {
    let tile_size = 3 * shape.bounds_tile() as usize;
    // One tile even without a triangle.
    partials[0] = Bounds::EMPTY;
    for (partial, tile) in partials.iter_mut().zip(triangles.chunks(tile_size)) {
        *partial = tile.chunks(3).map(triangle_bounds).fold(Bounds::EMPTY, unite);
    }
}

/// The head of a build's state, from which all later steps take the number of triangles.
pub fn gathered_state(triangle_count: u32, triangle_total: u32) -> BuildState {
    let overflow = if triangle_total > triangle_count { OVERFLOW_TRIANGLES } else { 0 };
    BuildState { triangle_count, offset_count: triangle_count + 1, overflow, triangle_total, ..BuildState::default() }
}
