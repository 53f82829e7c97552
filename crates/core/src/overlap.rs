//! Which cells a triangle overlaps, as `shared/overlap.glsl` has it (thesis section 3.1, Figure 3.2).

use crate::grid::boundary;
use crate::layout::GridHeader;
use crate::vector::{Vec3, add, max, max_f32, min, min_f32, mul, sub};

/// Cells from `low` to `high`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellBox {
    /// First cell along each axis.
    pub low: [u32; 3],
    /// Last cell along each axis.
    pub high: [u32; 3],
}

impl CellBox {
    /// Cells along each axis.
    pub fn size(&self) -> [u32; 3] {
        std::array::from_fn(|axis| self.high[axis] - self.low[axis] + 1)
    }

    /// How many cells.
    pub fn count(&self) -> u32 {
        self.size().iter().product()
    }

    /// Whether the cells are in one row: then a triangle with this box meets all of them.
    pub fn is_row(&self) -> bool {
        self.size().iter().filter(|n| **n == 1).count() >= 2
    }

    /// The n-th cell, x fastest.
    pub fn cell(&self, n: u32) -> [u32; 3] {
        let size = self.size();
        let row = n / size[0];
        [self.low[0] + n % size[0], self.low[1] + row % size[1], self.low[2] + row / size[1]]
    }
}

/// Cells whose boundaries enclose [`low`, `high`].
pub fn overlapped_box(grid: &GridHeader, low: Vec3, high: Vec3) -> CellBox {
    let last = grid.resolution.map(|n| n as f32 - 1.0);
    let locate = |point| min(max(mul(sub(point, grid.box_min), grid.inverse_cell_size).map(f32::floor), [0.0; 3]), last);
    let (first, end) = (locate(low), locate(high));
    let lower = boundary(grid.box_min, grid.cell_size, first);
    let upper = boundary(grid.box_min, grid.cell_size, add(end, [1.0; 3]));
    CellBox {
        low: std::array::from_fn(|axis| max_f32(first[axis] - f32::from(lower[axis] > low[axis]), 0.0) as u32),
        high: std::array::from_fn(|axis| min_f32(end[axis] + f32::from(upper[axis] <= high[axis]), last[axis]) as u32),
    }
}

/// Cells that the box of a triangle, padded twice, overlaps.
pub fn triangle_cells(grid: &GridHeader, v: [Vec3; 3]) -> CellBox {
    let low = sub(min(v[0], min(v[1], v[2])), [grid.pad * 2.0; 3]);
    let high = add(max(v[0], max(v[1], v[2])), [grid.pad * 2.0; 3]);
    overlapped_box(grid, low, high)
}

/// Cells of a box whose overlap is told by one word. A box of more cells is a large one.
pub const SMALL_BOX: u32 = 32;

/// Whether the axis at right angles to an edge of a triangle and to a box axis parts the triangle from a box of the given half size around
/// the origin, in the plane of the two other box axes; `a` is an end of the edge, `c` the corner across.
pub fn separates(edge: [f32; 2], half_size: [f32; 2], a: [f32; 2], c: [f32; 2]) -> bool {
    let [p, q] = [a, c].map(|v| edge[0] * v[1] - edge[1] * v[0]);
    let reach = edge[1].abs() * half_size[0] + edge[0].abs() * half_size[1];
    min_f32(p, q) > reach || max_f32(p, q) < -reach
}

/// Whether a triangle meets a padded cell, by separating axes; the box's axes are left to [`overlapped_box`].
pub fn triangle_overlaps_cell(grid: &GridHeader, v: [Vec3; 3], cell: [u32; 3]) -> bool {
    let low = boundary(grid.box_min, grid.cell_size, cell.map(|i| i as f32));
    let half_cell = grid.cell_size.map(|size| size * 0.5);
    let centre = add(low, half_cell);
    let half_size = half_cell.map(|half| half + grid.pad * 3.0);
    let v = v.map(|v| sub(v, centre));
    let edges: [Vec3; 3] = std::array::from_fn(|i| sub(v[(i + 1) % 3], v[i]));
    let apart_along_edges = [[1, 2], [2, 0], [0, 1]].into_iter().any(|plane| {
        let in_plane = |v: Vec3| plane.map(|axis: usize| v[axis]);
        (0..3).any(|i| separates(in_plane(edges[i]), in_plane(half_size), in_plane(v[i]), in_plane(v[(i + 2) % 3])))
    });
    let [e0, e1, _] = edges;
    let normal = [e0[1] * e1[2] - e0[2] * e1[1], e0[2] * e1[0] - e0[0] * e1[2], e0[0] * e1[1] - e0[1] * e1[0]];
    let [p0, p1, p2] = v.map(|v| normal[0] * v[0] + normal[1] * v[1] + normal[2] * v[2]);
    let reach = normal[0].abs() * half_size[0] + normal[1].abs() * half_size[1] + normal[2].abs() * half_size[2];
    !(apart_along_edges || min_f32(p0, min_f32(p1, p2)) > reach || max_f32(p0, max_f32(p1, p2)) < -reach)
}
