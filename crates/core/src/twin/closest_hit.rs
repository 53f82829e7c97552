//! Kernel `closest_hit`: the closest hit of each ray.

use crate::intersect::{Intersection, distance_to_s, hit_distance, move_ray};
use crate::layout::{TraceState, WalkState};
use crate::ray::{Hit, Ray, UNFINISHED};
use crate::walk::{Counters, Filter, Grid, Observer, Walk, walk_begin, walk_restore, walk_run, walk_save};

/// Constants that the launches of a trace kernel differ in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Launch {
    /// Goes on with walks that were given up, and leaves the others alone.
    pub continues: bool,
    /// A walk that is given up now is reported.
    pub last: bool,
    /// Existing hits are to be beaten.
    pub resume: bool,
    /// What the rays may hit.
    pub filter: Filter,
}

/// What the kernel has for each ray beside the ray itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// The hit: read if the launch resumes.
    pub hit: Hit,
    /// The walk, if it was given up.
    pub walk: WalkState,
    /// Numbers of the walk, all launches together.
    pub counters: Counters,
}

impl Slot {
    /// Before the first launch.
    pub const NEW: Slot = Slot {
        hit: Hit::MISS,
        walk: WalkState { given_up: 0, cell: 0, reference: 0, exit: 0.0, best_s: 0.0, best_u: 0.0, best_v: 0.0, best_triangle: 0 },
        counters: Counters { steps: 0, tests: 0, cells: 0 },
    };
}

/// One invocation; true if the walk was given up and is to be continued.
pub fn closest_hit_of(grid: &Grid, ray: &Ray, slot: &mut Slot, launch: Launch, observer: &mut impl Observer) -> bool {
    if launch.continues && slot.walk.given_up == 0 {
        return false;
    }
    let mut hit = if launch.resume { slot.hit } else { Hit::MISS };
    if !launch.continues {
        slot.counters = Counters::default();
    }
    let mut given_up = false;
    // What was not found in an earlier grid may be closer than all that is found in this one.
    let was_given_up = launch.resume && hit.triangle == UNFINISHED;
    if let Some(mut moved) = move_ray(ray, grid.header).filter(|_| !was_given_up) {
        if launch.resume && hit.is_hit() {
            moved.s_max = distance_to_s(&moved, hit.t);
        }
        let mut walk = Walk { filter: launch.filter, ..walk_begin(grid, moved) };
        if launch.continues {
            walk_restore(&mut walk, grid, &slot.walk);
        } else {
            slot.counters.steps = 1;
            slot.counters.cells = u32::from(walk.reference < walk.list_end);
            observer.cell(&walk, grid, 0.0);
        }
        given_up = !walk_run(&mut walk, grid, false, &mut slot.counters, observer);
        if given_up && launch.last {
            hit = Hit { triangle: UNFINISHED, ..Hit::MISS };
        } else if given_up {
            slot.walk = walk_save(&walk, grid);
        } else if walk.best_triangle != Hit::MISS.triangle {
            let best = Intersection { s: walk.best_s, u: walk.best_u, v: walk.best_v };
            hit = Hit { t: hit_distance(&moved, ray, best.s), u: best.u, v: best.v, triangle: walk.best_triangle };
        }
    }
    if !given_up || launch.last {
        slot.hit = hit;
        slot.walk.given_up = 0;
    }
    given_up && !launch.last
}

/// One launch.
pub fn closest_hit(grid: &Grid, rays: &[Ray], slots: &mut [Slot], state: &mut TraceState, launch: Launch, observer: &mut impl Observer) {
    for (ray, slot) in rays.iter().zip(slots).take(state.ray_count as usize) {
        if closest_hit_of(grid, ray, slot, launch, observer) {
            state.unfinished = 1;
        }
    }
}
