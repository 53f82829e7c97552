//! Twin of kernel `overlap_count`.

use crate::dispatch::workgroups;
use crate::gather::gather_triangle;
use crate::layout::GridHeader;
use crate::overlap::triangle_cells;
use crate::shape::Shape;

/// Brings triangles into the grid's frame and counts the cells that their boxes overlap; the entry after the last triangle is zero.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn overlap_count(
    shape: &Shape,
    groups: [u32; 3],
    grid: &GridHeader,
    positions: &[f32],
    indices: &[u32],
    triangles: &mut [[f32; 4]],
    counts: &mut [u32],
    vertex_count: u32,
    triangle_count: u32,
) {
    let invocations = workgroups(groups).flat_map(|group| group * shape.map_size..(group + 1) * shape.map_size);
    for triangle in invocations.filter(|triangle| *triangle <= triangle_count) {
        if triangle == triangle_count {
            counts[triangle as usize] = 0;
            continue;
        }
        let gathered = gather_triangle(positions, indices, vertex_count, triangle);
        let v = gathered.map_or([[0.0; 3]; 3], |v| v.map(|vertex| grid.to_frame(vertex)));
        counts[triangle as usize] = gathered.map_or(0, |_| {
            let [x, y, z] = triangle_cells(grid, v).size();
            x * y * z
        });
        for (i, [x, y, z]) in v.into_iter().enumerate() {
            let fourth = if i == 0 && gathered.is_none() { 1.0 } else { 0.0 };
            triangles[3 * triangle as usize + i] = [x, y, z, fourth];
        }
    }
}
