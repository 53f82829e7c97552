//! Twin of kernel `overlap_count`.

use crate::dispatch::workgroups;
use crate::gather::is_dropped;
use crate::layout::GridHeader;
use crate::overlap::triangle_cells;
use crate::shape::Shape;
use crate::vector::Vec3;

/// Brings triangles into the grid's frame and counts the cells that their boxes overlap; the entry after the last triangle is zero.
pub fn overlap_count(
    shape: &Shape,
    groups: [u32; 3],
    grid: &GridHeader,
    triangle_count: u32,
    triangles: &mut [[f32; 4]],
    counts: &mut [u32],
) {
    let invocations = workgroups(groups).flat_map(|group| group * shape.map_size..(group + 1) * shape.map_size);
    for triangle in invocations.filter(|triangle| *triangle <= triangle_count) {
        counts[triangle as usize] = 0;
        let first = 3 * triangle as usize;
        if triangle == triangle_count || is_dropped(triangles[first]) {
            continue;
        }
        let v: [Vec3; 3] = std::array::from_fn(|corner| {
            let [x, y, z, word] = triangles[first + corner];
            let [x, y, z] = grid.to_frame([x, y, z]);
            triangles[first + corner] = [x, y, z, word];
            [x, y, z]
        });
        let [x, y, z] = triangle_cells(grid, v).size();
        counts[triangle as usize] = x * y * z;
    }
}
