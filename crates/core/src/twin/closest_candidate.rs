//! Kernel `closest_candidate`: the closest hit of each ray through the public include, `shared/gridwalk.glsl`.

use crate::intersect::{Intersection, hit_distance, move_ray};
use crate::ray::{Hit, MISS, Ray, UNFINISHED};
use crate::walk::{Filter, GRIDWALK_TURNS, Grid, Walk, walk_accepts, walk_begin, walk_commit, walk_is_over, walk_step, walk_test};

/// Candidates of a ray: hits, each closer than what has been committed so far.
#[derive(Clone, Copy, Debug)]
pub struct GridwalkCandidates {
    /// The candidate, set by [`gridwalk_next`].
    pub hit: Hit,
    /// The ray.
    pub ray: Ray,
    walk: Option<Walk>,
    s: f32,
    turns: u32,
    searching: bool,
    unfinished: bool,
}

/// Begins a search.
pub fn gridwalk_candidates(grid: &Grid, ray: &Ray) -> GridwalkCandidates {
    let walk = move_ray(ray, grid.header).map(|moved| walk_begin(grid, moved));
    GridwalkCandidates { hit: Hit::MISS, ray: *ray, walk, s: 0.0, turns: 0, searching: walk.is_some(), unfinished: false }
}

/// Begins a search among what a filter lets through.
pub fn gridwalk_candidates_filtered(grid: &Grid, ray: &Ray, filter: Filter) -> GridwalkCandidates {
    let candidates = gridwalk_candidates(grid, ray);
    GridwalkCandidates { walk: candidates.walk.map(|walk| Walk { filter, ..walk }), ..candidates }
}

/// Finds the next candidate; false when there is none, and from then on.
pub fn gridwalk_next(grid: &Grid, candidates: &mut GridwalkCandidates) -> bool {
    let Some(walk) = &mut candidates.walk else { return false };
    while candidates.searching {
        if candidates.turns >= GRIDWALK_TURNS {
            candidates.unfinished = true;
            break;
        }
        candidates.turns += 1;
        if walk.reference < walk.list_end {
            let triangle = grid.references[walk.reference as usize] / 3;
            walk.reference += 1;
            if let Some(Intersection { s, u, v }) = walk_test(walk, grid, triangle).filter(|_| walk_accepts(walk, grid, triangle)) {
                candidates.s = s;
                candidates.hit = Hit { t: hit_distance(&walk.ray, &candidates.ray, s), u, v, triangle };
                return true;
            }
        } else if walk_is_over(walk) || !walk_step(walk, grid) {
            break;
        }
    }
    candidates.searching = false;
    false
}

/// Makes the candidate the closest hit.
pub fn gridwalk_commit(candidates: &mut GridwalkCandidates) {
    let Hit { u, v, triangle, .. } = candidates.hit;
    if let Some(walk) = &mut candidates.walk {
        walk_commit(walk, Intersection { s: candidates.s, u, v }, triangle);
    }
}

/// The closest hit that was committed.
pub fn gridwalk_committed(candidates: &GridwalkCandidates) -> Hit {
    match &candidates.walk {
        _ if candidates.unfinished => Hit { triangle: UNFINISHED, ..Hit::MISS },
        Some(walk) if walk.best_triangle != MISS => {
            let t = hit_distance(&walk.ray, &candidates.ray, walk.best_s);
            Hit { t, u: walk.best_u, v: walk.best_v, triangle: walk.best_triangle }
        }
        _ => Hit::MISS,
    }
}

/// One invocation.
pub fn gridwalk_closest_hit(grid: &Grid, ray: &Ray) -> Hit {
    let mut candidates = gridwalk_candidates(grid, ray);
    while gridwalk_next(grid, &mut candidates) {
        gridwalk_commit(&mut candidates);
    }
    gridwalk_committed(&candidates)
}

/// One launch.
pub fn closest_candidate(grid: &Grid, rays: &[Ray], hits: &mut [Hit]) {
    for (ray, hit) in rays.iter().zip(hits) {
        *hit = gridwalk_closest_hit(grid, ray);
    }
}
