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

    /// Cells along x and y, as the lower and the upper half of a word.
    pub fn sizes_word(&self) -> u32 {
        let [x, y, _] = self.size();
        x | y << 16
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

/// An axis at right angles to an edge of a triangle and to a box axis, in the plane of the two other box axes.
#[derive(Clone, Copy, Debug)]
struct EdgeAxis {
    plane: [usize; 2],
    edge: [f32; 2],
    middle: f32,
    reach: f32,
}

/// Axes that may part a triangle from a cell of its box, seen from the middle of a first cell; the box's own axes are left to
/// [`overlapped_box`].
#[derive(Clone, Copy, Debug)]
pub struct SeparatingAxes {
    first: [u32; 3],
    cell_size: Vec3,
    edges: [EdgeAxis; 9],
    normal: Vec3,
    middle: f32,
    reach: f32,
}

impl SeparatingAxes {
    /// Of a triangle with corners `v`.
    pub fn new(grid: &GridHeader, v: [Vec3; 3], first: [u32; 3]) -> SeparatingAxes {
        let half_cell = grid.cell_size.map(|size| size * 0.5);
        let centre = add(boundary(grid.box_min, grid.cell_size, first.map(|i| i as f32)), half_cell);
        let half_size = half_cell.map(|half| half + grid.pad * 4.0);
        let ends = v.map(|v| sub(v, centre));
        let edges: [Vec3; 3] = std::array::from_fn(|i| sub(v[(i + 1) % 3], v[i]));
        let axis = |n: usize| {
            let (i, plane) = (n % 3, [[1, 2], [2, 0], [0, 1]][n / 3]);
            let in_plane = |v: Vec3| plane.map(|axis: usize| v[axis]);
            let (edge, half_size) = (in_plane(edges[i]), in_plane(half_size));
            let [p, q] = [ends[i], ends[(i + 2) % 3]].map(in_plane).map(|v| edge[0] * v[1] - edge[1] * v[0]);
            let reach = edge[1].abs() * half_size[0] + edge[0].abs() * half_size[1] + (p - q).abs() * 0.5;
            EdgeAxis { plane, edge, middle: (p + q) * 0.5, reach }
        };
        let [e0, e1, _] = edges;
        let normal = [e0[1] * e1[2] - e0[2] * e1[1], e0[2] * e1[0] - e0[0] * e1[2], e0[0] * e1[1] - e0[1] * e1[0]];
        let [p0, p1, p2] = ends.map(|v| normal[0] * v[0] + normal[1] * v[1] + normal[2] * v[2]);
        let (low, high) = (min_f32(p0, min_f32(p1, p2)), max_f32(p0, max_f32(p1, p2)));
        let reach = normal[0].abs() * half_size[0] + normal[1].abs() * half_size[1] + normal[2].abs() * half_size[2];
        SeparatingAxes {
            first,
            cell_size: grid.cell_size,
            edges: std::array::from_fn(axis),
            normal,
            middle: (low + high) * 0.5,
            reach: reach + (high - low) * 0.5,
        }
    }

    /// Whether none of the axes parts the triangle from a padded cell, none of whose numbers is below the first cell's.
    pub fn meets(&self, cell: [u32; 3]) -> bool {
        let away: Vec3 = std::array::from_fn(|axis| (cell[axis] - self.first[axis]) as f32 * self.cell_size[axis]);
        let apart_along_edges = self.edges.iter().any(|axis| {
            let [x, y] = axis.plane.map(|i| away[i]);
            (axis.middle - (axis.edge[0] * y - axis.edge[1] * x)).abs() > axis.reach
        });
        let along = self.middle - (self.normal[0] * away[0] + self.normal[1] * away[1] + self.normal[2] * away[2]);
        !(apart_along_edges || along.abs() > self.reach)
    }
}

/// Whether a triangle meets one padded cell.
pub fn triangle_overlaps_cell(grid: &GridHeader, v: [Vec3; 3], cell: [u32; 3]) -> bool {
    SeparatingAxes::new(grid, v, cell).meets(cell)
}
