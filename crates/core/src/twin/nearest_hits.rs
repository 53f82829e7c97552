//! Kernel `nearest_hits`: the nearest hits of each ray, in order of distance, then of triangle.

use crate::intersect::{Intersection, hit_distance, intersect_triangle, move_ray};
use crate::layout::{WALK_FINE, WalkState};
use crate::ray::{Hit, MISS, Ray, UNFINISHED};
use crate::twin::closest_hit::Launch;
use crate::walk::{
    Grid, STEPS_EACH_TURN, TESTS_EACH_TURN, TURNS, Walk, walk_accepts, walk_begin, walk_commit, walk_is_over, walk_restore, walk_save,
    walk_step, walk_test,
};

/// A search for several hits.
struct Search<'a> {
    ray: &'a Ray,
    hits: &'a mut [Hit],
    found: usize,
    /// s and triangle of the last hit: the next is beyond.
    floor: (f32, u32),
    /// Of the cell's list.
    list_begin: u32,
}

impl Search<'_> {
    /// Keeps the best hit, and begins again in the same cell. True if enough have been found.
    fn take(&mut self, walk: &mut Walk) -> bool {
        let t = hit_distance(&walk.ray, self.ray, walk.best_s);
        self.hits[self.found] = Hit { t, u: walk.best_u, v: walk.best_v, triangle: walk.best_triangle };
        self.found += 1;
        self.floor = (walk.best_s, walk.best_triangle);
        let nothing = Intersection { s: walk.ray.s_max, u: 0.0, v: 0.0 };
        walk_commit(walk, nothing, MISS);
        walk.reference = self.list_begin;
        self.found == self.hits.len()
    }

    /// Searches until the end or for [`TURNS`] turns; true at the end.
    fn run(&mut self, walk: &mut Walk, grid: &Grid) -> bool {
        for _ in 0..TURNS {
            let mut steps = 0;
            while walk.reference >= walk.list_end && steps < STEPS_EACH_TURN {
                steps += 1;
                let is_over = walk_is_over(walk);
                let has_hit = walk.best_triangle != MISS;
                if is_over && has_hit {
                    if self.take(walk) {
                        return true;
                    }
                    continue;
                }
                if is_over || !walk_step(walk, grid) {
                    if has_hit {
                        self.take(walk);
                    }
                    return true;
                }
                self.list_begin = walk.reference;
            }
            let stop = walk.list_end.min(walk.reference + TESTS_EACH_TURN);
            while walk.reference < stop {
                let triangle = grid.references[walk.reference as usize] / 3;
                walk.reference += 1;
                let (floor_s, floor_triangle) = self.floor;
                let beyond = |hit: &Intersection| hit.s > floor_s || (hit.s == floor_s && triangle > floor_triangle);
                let hit = walk_test(walk, grid, triangle).filter(|_| walk_accepts(walk, grid, triangle));
                if let Some(hit) = hit.filter(beyond) {
                    walk_commit(walk, hit, triangle);
                }
            }
        }
        false
    }
}

/// One invocation, which finds as many hits as there is room for; true if the walk was given up and is to be continued.
pub fn nearest_hits_of(grid: &Grid, ray: &Ray, hits: &mut [Hit], saved: &mut WalkState, launch: Launch) -> bool {
    if launch.continues && saved.given_up == 0 {
        return false;
    }
    let found = if launch.continues { (saved.given_up & ((1 << WALK_FINE) - 1)) as usize - 1 } else { 0 };
    let before = match (found, launch.resume) {
        (0, false) => None,
        (0, true) => hits.last().map(|hit| hit.triangle),
        _ => Some(hits[found - 1].triangle),
    };
    let mut search = Search { ray, hits, found, floor: (f32::NEG_INFINITY, 0), list_begin: 0 };
    let mut rest = if before == Some(UNFINISHED) { UNFINISHED } else { MISS };
    let mut given_up = false;
    if let Some(moved) = move_ray(ray, grid.header).filter(|_| before.is_none_or(|triangle| triangle < UNFINISHED)) {
        if let Some((triangle, hit)) = before.and_then(|triangle| Some((triangle, intersect_triangle(&moved, grid.triangle(triangle))?))) {
            search.floor = (hit.s, triangle);
        }
        let mut walk = Walk { filter: launch.filter, ..walk_begin(grid, moved) };
        if launch.continues {
            search.list_begin = walk_restore(&mut walk, grid, saved);
        } else {
            search.list_begin = walk.reference;
        }
        given_up = !search.run(&mut walk, grid);
        if given_up && launch.last {
            rest = UNFINISHED;
        } else if given_up {
            *saved = walk_save(&walk, grid);
            saved.given_up += search.found as u32;
        }
    }
    if !given_up || launch.last {
        let found = search.found;
        search.hits[found..].fill(Hit { triangle: rest, ..Hit::MISS });
        saved.given_up = 0;
    }
    given_up && !launch.last
}
