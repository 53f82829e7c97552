//! Kernel `any_hit`: whether each ray hits anything.

use crate::intersect::move_ray;
use crate::layout::{TraceState, WalkState};
use crate::ray::{MISS, Ray, UNFINISHED};
use crate::twin::closest_hit::Launch;
use crate::walk::{Counters, Grid, Observer, Walk, walk_begin, walk_restore, walk_run, walk_save};

/// One invocation; true if the walk was given up and is to be continued.
pub fn any_hit_of(grid: &Grid, ray: &Ray, occluded: &mut u32, saved: &mut WalkState, launch: Launch, observer: &mut impl Observer) -> bool {
    if launch.continues && saved.given_up == 0 {
        return false;
    }
    let mut result = 0;
    let mut given_up = false;
    if let Some(moved) = move_ray(ray, grid.header) {
        let mut walk = Walk { filter: launch.filter, ..walk_begin(grid, moved) };
        if launch.continues {
            walk_restore(&mut walk, grid, saved);
        } else {
            observer.cell(&walk, grid, 0.0);
        }
        given_up = !walk_run(&mut walk, grid, true, &mut Counters::default(), observer);
        result = u32::from(walk.best_triangle != MISS);
        if given_up && launch.last {
            result = UNFINISHED;
        } else if given_up {
            *saved = walk_save(&walk, grid);
        }
    }
    if !given_up || launch.last {
        *occluded = result;
        saved.given_up = 0;
    }
    given_up && !launch.last
}

/// One launch.
pub fn any_hit(
    grid: &Grid,
    rays: &[Ray],
    occluded: &mut [u32],
    walks: &mut [WalkState],
    state: &mut TraceState,
    launch: Launch,
    observer: &mut impl Observer,
) {
    for ((ray, occluded), walk) in rays.iter().zip(occluded).zip(walks).take(state.ray_count as usize) {
        if any_hit_of(grid, ray, occluded, walk, launch, observer) {
            state.unfinished = 1;
        }
    }
}
