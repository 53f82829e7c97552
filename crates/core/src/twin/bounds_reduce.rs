//! Twin of kernel `bounds_reduce`.

use crate::dispatch::workgroups;
use crate::gather::is_dropped;
use crate::layout::Bounds;
use crate::shape::Shape;
use crate::vector::{max, min};

/// The union of two boxes.
pub fn unite(a: Bounds, b: Bounds) -> Bounds {
    Bounds { low: min(a.low, b.low), dropped: a.dropped + b.dropped, high: max(a.high, b.high), reserved: 0 }
}

/// The box of each tile of triangles, and how many of them are dropped.
pub fn bounds_reduce(shape: &Shape, groups: [u32; 3], triangle_count: u32, triangles: &[[f32; 4]], partials: &mut [Bounds]) {
    let tile_size = shape.bounds_tile();
    for tile in workgroups(groups) {
        let first = tile * tile_size;
        if first >= triangle_count.max(1) {
            continue;
        }
        let boxes = (first..triangle_count.min(first + tile_size)).map(|triangle| {
            let vertices = &triangles[3 * triangle as usize..][..3];
            if is_dropped(vertices[0]) {
                return Bounds { dropped: 1, ..Bounds::EMPTY };
            }
            let [a, b, c] = [0, 1, 2].map(|corner| [vertices[corner][0], vertices[corner][1], vertices[corner][2]]);
            Bounds { low: min(a, min(b, c)), dropped: 0, high: max(a, max(b, c)), reserved: 0 }
        });
        partials[tile as usize] = boxes.fold(Bounds::EMPTY, unite);
    }
}
