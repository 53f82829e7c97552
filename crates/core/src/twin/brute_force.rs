//! Kernel `brute_force`: the closest hit of a ray among a range of triangles, without the grid's cells.

use std::ops::Range;

use crate::intersect::{Intersection, hit_distance, move_ray};
use crate::layout::WalkState;
use crate::ray::{Hit, MISS, Ray};
use crate::walk::{Grid, walk_commit, walk_nowhere, walk_test};

/// One invocation: goes on from the best hit of the ranges before, unless it is the first, and gives the best so far.
pub fn brute_force_of(grid: &Grid, ray: &Ray, saved: &mut WalkState, triangles: Range<u32>) -> Hit {
    let Some(moved) = move_ray(ray, grid.header) else { return Hit::MISS };
    let mut walk = walk_nowhere(moved);
    if triangles.start > 0 {
        let best = Intersection { s: saved.best_s, u: saved.best_u, v: saved.best_v };
        walk_commit(&mut walk, best, saved.best_triangle);
    }
    for triangle in triangles {
        if let Some(hit) = walk_test(&walk, grid, triangle) {
            walk_commit(&mut walk, hit, triangle);
        }
    }
    *saved = WalkState {
        best_s: walk.best_s,
        best_u: walk.best_u,
        best_v: walk.best_v,
        best_triangle: walk.best_triangle,
        ..WalkState::default()
    };
    if walk.best_triangle == MISS {
        return Hit::MISS;
    }
    Hit { t: hit_distance(&moved, ray, walk.best_s), u: walk.best_u, v: walk.best_v, triangle: walk.best_triangle }
}

/// One launch; the hits are written if it is the last.
pub fn brute_force(grid: &Grid, rays: &[Ray], hits: &mut [Hit], walks: &mut [WalkState], triangles: Range<u32>, last: bool) {
    for ((ray, hit), walk) in rays.iter().zip(hits).zip(walks) {
        let found = brute_force_of(grid, ray, walk, triangles.clone());
        if last {
            *hit = found;
        }
    }
}
