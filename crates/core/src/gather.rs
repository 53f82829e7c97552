//! Input triangles, as `shared/gather.glsl` reads them.

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
