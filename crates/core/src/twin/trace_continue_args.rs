//! Kernel `trace_continue_args`: a trace goes on over all rays if a walk was given up, else over none.

use crate::layout::TraceState;
use crate::shape::Shape;

/// One invocation.
pub fn trace_continue_args(state: &mut TraceState, shape: &Shape) {
    let rays = if state.unfinished != 0 { state.ray_count } else { 0 };
    let [x, y, z] = shape.deal_workgroups(rays, shape.map_size);
    state.arguments = [x, y, z, 0];
    state.unfinished = 0;
}
