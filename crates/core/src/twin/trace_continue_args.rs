//! Kernel `trace_continue_args`: a trace goes on over all rays if a walk was given up, else over none.

use crate::dispatch::split_workgroups;
use crate::layout::TraceState;

/// One invocation.
pub fn trace_continue_args(state: &mut TraceState, map_size: u32) {
    let rays = if state.unfinished != 0 { state.ray_count } else { 0 };
    let [x, y, z] = split_workgroups(rays, map_size);
    state.arguments = [x, y, z, 0];
    state.unfinished = 0;
}
