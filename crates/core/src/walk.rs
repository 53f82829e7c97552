//! The walk of a ray along the cells of the grid by 3D-DDA (Amanatides and Woo 1987; thesis section 3.2), as `shared/walk.glsl` and
//! `shared/trace.glsl` have it: with jumps across bricks that are known to be empty.

use crate::gather::vertices_of;
use crate::grid::{boundary, brick_resolution, cell_id, cell_of, whole_below};
use crate::intersect::{Intersection, MovedRay, intersect_triangle};
use crate::layout::{Brick, CELL_LEVEL, CELL_SPLIT, GridHeader, TRIANGLE_FLIPPED, TRIANGLE_TWO_SIDED, WALK_FINE, WalkState};
use crate::ray::MISS;
use crate::vector::{Vec3, add, max, max_f32, min, min_f32, mul, sub};

/// Turns of a walk in one dispatch, after which it is given up.
pub const TURNS: u32 = 1310;
/// Cells visited in a turn.
pub const STEPS_EACH_TURN: u32 = 4;
/// Triangles tested in a turn.
pub const TESTS_EACH_TURN: u32 = 20;
/// Turns of a walk through the public include.
pub const GRIDWALK_TURNS: u32 = 32_768;
/// Of a walk's `cull`: triangles are not hit of which the ray sees the back.
pub const CULL_BACK: u32 = 1;
/// Of a walk's `cull`: triangles are not hit of which the ray sees the front.
pub const CULL_FRONT: u32 = 2;
/// Distance of a boundary that the ray does not move towards.
pub const BEYOND: f32 = 3.0e38;

/// A grid's memory, as a kernel reaches it through the addresses in the header.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// Head of the grid.
    pub header: &'a GridHeader,
    /// Bricks of 4^3 cells.
    pub bricks: &'a [Brick],
    /// Begin and end of each cell's list; of cells of empty bricks nothing that counts.
    pub cells: &'a [[u32; 2]],
    /// The lists of all cells: the index of each triangle's first row.
    pub references: &'a [u32],
    /// By rows, in the grid's frame.
    pub triangles: &'a [[[f32; 4]; 3]],
}

impl Grid<'_> {
    /// The vertices of a triangle, in the grid's frame.
    pub fn triangle(&self, index: u32) -> [Vec3; 3] {
        vertices_of(self.triangles[index as usize])
    }
}

/// Sees each step of a walk. Its default does nothing.
pub trait Observer {
    /// The walk is in a block of cells, having entered it at `entry`; it leaves at `walk.exit`.
    fn cell(&mut self, _walk: &Walk, _grid: &Grid, _entry: f32) {}

    /// A triangle of the cell's list is tested.
    fn test(&mut self, _walk: &Walk, _grid: &Grid, _triangle: u32) {}

    /// A hit was accepted as the best so far.
    fn hit(&mut self, _walk: &Walk, _grid: &Grid, _triangle: u32, _hit: Intersection) {}
}

impl Observer for () {}

/// Numbers of a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Blocks visited.
    pub steps: u32,
    /// Triangles tested.
    pub tests: u32,
    /// Blocks visited that are cells with triangles.
    pub cells: u32,
}

/// A ray on its way through a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// The ray in the grid's frame.
    pub ray: MovedRay,
    /// The ray's origin, seen from the grid's lower corner.
    pub from_low: Vec3,
    /// s where a coordinate is 0; beyond any where the direction is 0.
    pub at_zero: Vec3,
    /// Whether the direction is positive.
    pub up: [bool; 3],
    /// Where the walk is, in fine cells.
    pub cell: [i32; 3],
    /// First cell of the block around it. The kernels keep of the block what lies ahead: see [`Walk::edge`].
    pub low: [i32; 3],
    /// End of the block, exclusive.
    pub high: [i32; 3],
    /// s at which the block is left.
    pub exit: f32,
    /// Next in the cell's list.
    pub reference: u32,
    /// End of the cell's list.
    pub list_end: u32,
    /// s of the best hit, or of the end of the ray's interval.
    pub best_s: f32,
    /// Of the best hit.
    pub best_u: f32,
    /// Of the best hit.
    pub best_v: f32,
    /// Of the best hit; [`MISS`]: none so far.
    pub best_triangle: u32,
    /// What the ray may hit.
    pub filter: Filter,
}

/// What a ray may hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filter {
    /// Mask of the ray: with all bits it hits every geometry.
    pub mask: u32,
    /// [`CULL_BACK`], [`CULL_FRONT`].
    pub cull: u32,
}

impl Default for Filter {
    /// Everything.
    fn default() -> Filter {
        Filter { mask: u32::MAX, cull: 0 }
    }
}

impl Walk {
    /// The boundary of the block ahead along each axis, by the fine cell above it.
    pub fn edge(&self) -> [i32; 3] {
        std::array::from_fn(|axis| if self.up[axis] { self.high[axis] } else { self.low[axis] })
    }

    /// s of these boundaries.
    fn boundaries(&self, header: &GridHeader) -> Vec3 {
        let edges = boundary(header.box_min, header.fine_cell_size, self.edge().map(|i| i as f32));
        add(mul(edges, self.ray.inverse), self.at_zero)
    }
}

/// Looks at the cell: its list, the block around it, and where the ray leaves that.
fn walk_enter(walk: &mut Walk, grid: &Grid) {
    let header = grid.header;
    let bricks_along = brick_resolution(header.resolution);
    let mut shift = header.fine_shift;
    let cell = walk.cell.map(|i| i >> shift);
    let at = cell.map(|i| i >> 2);
    let brick = grid.bricks[cell_id(at.map(|i| i as u32), bricks_along) as usize];
    let inner = cell.map(|i| i & 3);
    let bit = inner[0] | (inner[1] << 2) | ((inner[2] & 1) << 4);
    let word = brick.mask[usize::from(inner[2] >= 2)];
    [walk.reference, walk.list_end] = [0, 0];
    // Leaf cells of the split cell that lie below and above, within an empty one's distance.
    let mut around = [[0; 3]; 2];
    if (word >> bit) & 1 != 0 {
        let mut range = grid.cells[cell_id(cell.map(|i| i as u32), header.resolution) as usize];
        if range[1] & CELL_SPLIT != 0 {
            let level = range[1] & CELL_LEVEL;
            shift -= level;
            let last = (1 << level) - 1;
            let leaf = walk.cell.map(|i| (i >> shift) as u32 & last);
            range = grid.cells[(range[0] + cell_id(leaf, [1 << level; 3])) as usize];
            let empty = if range[1] == 0 { range[0].saturating_sub(1) } else { 0 };
            around = [leaf, leaf.map(|i| last - i)].map(|room| room.map(|room| room.min(empty) as i32));
        }
        [walk.reference, walk.list_end] = range;
    }
    if word & (0x0033_0033 << (bit & 10)) == 0 {
        shift += 1;
    }
    let reach = brick.distance as i32;
    (walk.low, walk.high) = if reach == 0 {
        let block = walk.cell.map(|i| i >> shift);
        let (low, high): ([i32; 3], [i32; 3]) =
            (std::array::from_fn(|axis| block[axis] - around[0][axis]), std::array::from_fn(|axis| block[axis] + 1 + around[1][axis]));
        (low.map(|i| i << shift), high.map(|i| i << shift))
    } else {
        let shift = header.fine_shift;
        (at.map(|i| ((i - (reach - 1)) << 2).max(0) << shift), at.map(|i| (i + reach) << 2 << shift))
    };
    let [x, y, z] = walk.boundaries(header);
    walk.exit = max_f32(walk.exit, min_f32(x, min_f32(y, z)));
}

/// Where the ray's point lies, in fine cells.
fn walk_point(walk: &Walk, header: &GridHeader, s: f32) -> Vec3 {
    let travelled = walk.ray.direction.map(|x| s * x);
    mul(add(walk.from_low, travelled), header.inverse_fine_cell_size)
}

/// A walk that has no cell: for tests of triangles alone.
pub fn walk_nowhere(ray: MovedRay) -> Walk {
    Walk {
        ray,
        from_low: [0.0; 3],
        at_zero: [0.0; 3],
        up: [false; 3],
        cell: [0; 3],
        low: [0; 3],
        high: [0; 3],
        exit: 0.0,
        reference: 0,
        list_end: 0,
        best_s: ray.s_max,
        best_u: 0.0,
        best_v: 0.0,
        best_triangle: MISS,
        filter: Filter::default(),
    }
}

/// At the ray's first cell. Only for a grid of at least one cell.
pub fn walk_begin(grid: &Grid, ray: MovedRay) -> Walk {
    let mut walk = Walk {
        from_low: sub(ray.origin, grid.header.box_min),
        at_zero: std::array::from_fn(|axis| if ray.direction[axis] == 0.0 { BEYOND } else { -ray.origin[axis] * ray.inverse[axis] }),
        up: ray.direction.map(|x| x > 0.0),
        ..walk_nowhere(ray)
    };
    let last = sub(grid.header.resolution.map(|n| (n << grid.header.fine_shift) as f32), [0.5; 3]);
    walk.cell = min(max(walk_point(&walk, grid.header, 0.0), [0.5; 3]), last).map(whole_below);
    walk_enter(&mut walk, grid);
    walk
}

/// Into the next block; false outside of the grid.
pub fn walk_step(walk: &mut Walk, grid: &Grid) -> bool {
    let [x, y, z] = walk.boundaries(grid.header);
    let along = if x <= y && x <= z {
        0
    } else if y <= z {
        1
    } else {
        2
    };
    let inside = max(walk_point(walk, grid.header, walk.exit), [0.5; 3]).map(whole_below);
    walk.cell = std::array::from_fn(|axis| {
        let (cell, low, high) = (walk.cell[axis], walk.low[axis], walk.high[axis]);
        match (axis == along, walk.up[axis]) {
            (true, true) => high,
            (true, false) => low - 1,
            (false, true) => inside[axis].max(cell).min(high - 1),
            (false, false) => inside[axis].max(low).min(cell),
        }
    });
    if (0..3).any(|axis| walk.cell[axis] as u32 >= grid.header.resolution[axis] << grid.header.fine_shift) {
        return false;
    }
    walk_enter(walk, grid);
    true
}

/// Whether no cell ahead can hold a hit that is closer than the best, or as close.
pub fn walk_is_over(walk: &Walk) -> bool {
    walk.best_s <= walk.exit
}

/// Whether a hit is in the ray's interval and closer than the best; of equal ones the lower index wins.
pub fn walk_improves(walk: &Walk, s: f32, triangle: u32) -> bool {
    s >= walk.ray.s_min && (s < walk.best_s || (s == walk.best_s && triangle < walk.best_triangle))
}

/// The hit of a triangle, if it improves on the best.
pub fn walk_test(walk: &Walk, grid: &Grid, triangle: u32) -> Option<Intersection> {
    let hit = intersect_triangle(&walk.ray, grid.triangle(triangle))?;
    walk_improves(walk, hit.s, triangle).then_some(hit)
}

/// Whether the ray sees the side of a triangle around which its vertices go counterclockwise. Only for one that the ray's line meets.
pub fn sees_front(ray: &MovedRay, vertices: [Vec3; 3]) -> bool {
    let [a, b, c] = vertices.map(|vertex| ray.permute(sub(vertex, ray.origin)));
    let (e1, e2) = (sub(b, a), sub(c, a));
    let normal = [e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]];
    let facing = normal[0] * ray.shear[0] + normal[1] * ray.shear[1] + normal[2];
    (facing < 0.0) == (ray.shear[2] > 0.0)
}

/// Whether a triangle that the ray's line meets is one that the ray is to hit: by masks and by culling.
pub fn walk_accepts(walk: &Walk, grid: &Grid, triangle: u32) -> bool {
    let Filter { mask, cull } = walk.filter;
    let [flags, _, of_geometry] = grid.triangles[triangle as usize].map(|row| row[3].to_bits());
    if mask != u32::MAX && of_geometry & mask == 0 {
        return false;
    }
    if cull == 0 {
        return true;
    }
    let front = sees_front(&walk.ray, grid.triangle(triangle)) != (flags & TRIANGLE_FLIPPED != 0);
    let culled = cull & if front { CULL_FRONT } else { CULL_BACK } != 0;
    !culled || flags & TRIANGLE_TWO_SIDED != 0
}

/// Makes a hit the best.
pub fn walk_commit(walk: &mut Walk, hit: Intersection, triangle: u32) {
    walk.best_s = hit.s;
    walk.best_u = hit.u;
    walk.best_v = hit.v;
    walk.best_triangle = triangle;
}

/// What the next dispatch needs to go on.
pub fn walk_save(walk: &Walk, grid: &Grid) -> WalkState {
    let shift = grid.header.fine_shift;
    let [x, y, z] = walk.cell.map(|i| i as u32 & ((1 << shift) - 1));
    WalkState {
        given_up: 1 | (x | y << 8 | z << 16) << WALK_FINE,
        cell: cell_id(walk.cell.map(|i| i as u32 >> shift), grid.header.resolution),
        reference: walk.reference,
        exit: walk.exit,
        best_s: walk.best_s,
        best_u: walk.best_u,
        best_v: walk.best_v,
        best_triangle: walk.best_triangle,
    }
}

/// Goes on where a walk was given up. Where the list of its cell begins.
pub fn walk_restore(walk: &mut Walk, grid: &Grid, saved: &WalkState) -> u32 {
    let cell = cell_of(saved.cell, grid.header.resolution);
    let fine = saved.given_up >> WALK_FINE;
    walk.cell = std::array::from_fn(|axis| (cell[axis] << grid.header.fine_shift | fine >> (8 * axis) & 255) as i32);
    walk.exit = saved.exit;
    walk_enter(walk, grid);
    let list_begin = walk.reference;
    walk.reference = saved.reference;
    walk_commit(walk, Intersection { s: saved.best_s, u: saved.best_u, v: saved.best_v }, saved.best_triangle);
    list_begin
}

/// Walks until the end or for [`TURNS`] turns; true at the end. With `any`, the first hit is the end.
pub fn walk_run(walk: &mut Walk, grid: &Grid, any: bool, counters: &mut Counters, observer: &mut impl Observer) -> bool {
    for _ in 0..TURNS {
        let mut steps = 0;
        while walk.reference >= walk.list_end && steps < STEPS_EACH_TURN {
            let entry = walk.exit;
            if walk_is_over(walk) || !walk_step(walk, grid) {
                return true;
            }
            steps += 1;
            counters.steps += 1;
            counters.cells += u32::from(walk.reference < walk.list_end);
            observer.cell(walk, grid, entry);
        }
        let stop = walk.list_end.min(walk.reference + TESTS_EACH_TURN);
        while walk.reference < stop {
            let triangle = grid.references[walk.reference as usize] / 3;
            counters.tests += 1;
            walk.reference += 1;
            observer.test(walk, grid, triangle);
            if let Some(hit) = walk_test(walk, grid, triangle).filter(|_| walk_accepts(walk, grid, triangle)) {
                observer.hit(walk, grid, triangle, hit);
                walk_commit(walk, hit, triangle);
                if any {
                    return true;
                }
            }
        }
    }
    false
}
