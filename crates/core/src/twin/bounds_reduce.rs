//! Twin of kernel `bounds_reduce`.

use crate::dispatch::workgroups;
use crate::gather::gather_triangle;
use crate::layout::Bounds;
use crate::shape::Shape;
use crate::vector::{max, min};

/// The union of two boxes.
pub fn unite(a: Bounds, b: Bounds) -> Bounds {
    Bounds { low: min(a.low, b.low), dropped: a.dropped + b.dropped, high: max(a.high, b.high), reserved: 0 }
}

/// The box of each tile of triangles, and how many of them are dropped.
pub fn bounds_reduce(
    shape: &Shape,
    groups: [u32; 3],
    positions: &[f32],
    indices: &[u32],
    partials: &mut [Bounds],
    vertex_count: u32,
    triangle_count: u32,
) {
    let tile_size = shape.bounds_tile();
    for tile in workgroups(groups) {
        let first = tile * tile_size;
        if first >= triangle_count.max(1) {
            continue;
        }
        let triangles = first..triangle_count.min(first + tile_size);
        let boxes = triangles.map(|triangle| match gather_triangle(positions, indices, vertex_count, triangle) {
            Some([a, b, c]) => Bounds { low: min(a, min(b, c)), dropped: 0, high: max(a, max(b, c)), reserved: 0 },
            None => Bounds { dropped: 1, ..Bounds::EMPTY },
        });
        partials[tile as usize] = boxes.fold(Bounds::EMPTY, unite);
    }
}
