//! Kernel `count_hits`: how many triangles each ray hits.

use crate::intersect::{Intersection, move_ray};
use crate::layout::WalkState;
use crate::ray::{MISS, Ray, UNFINISHED};
use crate::twin::closest_hit::Launch;
use crate::walk::{
    Grid, STEPS_EACH_TURN, TESTS_EACH_TURN, TURNS, Walk, walk_accepts, walk_begin, walk_commit, walk_is_over, walk_restore, walk_save,
    walk_step, walk_test,
};

/// Counts until the end or for [`TURNS`] turns; true at the end. A triangle counts in the one block between whose entry and exit it is hit.
fn count_run(walk: &mut Walk, grid: &Grid, entry: &mut f32, count: &mut u32) -> bool {
    for _ in 0..TURNS {
        let mut steps = 0;
        while walk.reference >= walk.list_end && steps < STEPS_EACH_TURN {
            *entry = walk.exit;
            if walk_is_over(walk) || !walk_step(walk, grid) {
                return true;
            }
            steps += 1;
        }
        let stop = walk.list_end.min(walk.reference + TESTS_EACH_TURN);
        while walk.reference < stop {
            let triangle = grid.references[walk.reference as usize] / 3;
            walk.reference += 1;
            let hit = walk_test(walk, grid, triangle).filter(|hit| hit.s > *entry && hit.s <= walk.exit);
            *count += u32::from(hit.is_some() && walk_accepts(walk, grid, triangle));
        }
    }
    false
}

/// One invocation; true if the walk was given up and is to be continued.
pub fn count_hits_of(grid: &Grid, ray: &Ray, counted: &mut u32, saved: &mut WalkState, launch: Launch) -> bool {
    if launch.continues && saved.given_up == 0 {
        return false;
    }
    let mut count = 0;
    let mut given_up = false;
    if let Some(moved) = move_ray(ray, grid.header) {
        let nothing = Intersection { s: moved.s_max, u: 0.0, v: 0.0 };
        let mut walk = Walk { filter: launch.filter, ..walk_begin(grid, moved) };
        let mut entry = f32::NEG_INFINITY;
        if launch.continues {
            walk_restore(&mut walk, grid, saved);
            walk_commit(&mut walk, nothing, MISS);
            (entry, count) = (saved.best_u, saved.best_triangle);
        }
        given_up = !count_run(&mut walk, grid, &mut entry, &mut count);
        if given_up && launch.last {
            count = UNFINISHED;
        } else if given_up {
            walk_commit(&mut walk, Intersection { u: entry, ..nothing }, count);
            *saved = walk_save(&walk, grid);
        }
    }
    if !given_up || launch.last {
        *counted = count;
        saved.given_up = 0;
    }
    given_up && !launch.last
}
