//! Twin of kernel `ray_sort_args`.

use super::pair_args::four;
use super::ray_keys::RAY_KEY_BITS;
use super::trace_args::traced_rays;
use crate::dispatch::split_workgroups;
use crate::layout::{BuildState, DispatchArguments};
use crate::shape::Shape;
use crate::sort::passes_of;

/// Turns a number of rays into what the kernels of the sort take from a build's state, and into the arguments of their dispatches, of
/// which the first pass's are those of all.
pub fn ray_sort_args(shape: &Shape, state: &mut BuildState, arguments: &mut DispatchArguments, count: Option<u32>, max_rays: u32) {
    let rays = traced_rays(count, max_rays);
    let (pass_count, digit_bits) = passes_of(RAY_KEY_BITS, shape.sort_bits);
    let (key_bits, sentinel) = (RAY_KEY_BITS, u32::MAX);
    *state = BuildState { pair_count: rays, kept_count: rays, key_bits, pass_count, digit_bits, first_pair: 0, sentinel, ..*state };
    arguments.ray_keys = four(split_workgroups(rays, shape.map_size));
    arguments.sort[0] = four(shape.sort_workgroups(rays));
    arguments.table_scan[0] = four(split_workgroups(1 << digit_bits, shape.table_rows()));
}
