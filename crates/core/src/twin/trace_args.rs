//! Kernel `trace_args`: a number of rays as arguments of the first trace.

use crate::layout::TraceState;
use crate::shape::Shape;

/// The number of rays: `max_rays` itself, or at most that if it lies in memory.
pub(super) fn traced_rays(count: Option<u32>, max_rays: u32) -> u32 {
    count.map_or(max_rays, |count| max_rays.min(count))
}

/// `count` is the number in memory of an indirect trace; without it `max_rays` is the number itself.
pub fn trace_args(state: &mut TraceState, count: Option<u32>, max_rays: u32, shape: &Shape) {
    let rays = traced_rays(count, max_rays);
    let [x, y, z] = shape.deal_workgroups(rays, shape.map_size);
    state.arguments = [x, y, z, 0];
    state.ray_count = rays;
    state.unfinished = 0;
}
