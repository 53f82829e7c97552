#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One invocation turns a number of rays, given or in a buffer, into what the kernels of the sort take from a build's state, and into the
// arguments of their dispatches, of which the first pass's are those of all.

#include "shared/build.glsl"
#include "shared/ray_key.glsl"
#include "shared/sort_tile.glsl"
#include "shared/trace_types.glsl"

layout(local_size_x = 1) in;
layout(constant_id = 1) const uint MAP_SIZE = 64;
layout(constant_id = 2) const uint SORT_BITS = 10;
layout(constant_id = 4) const uint TABLE_ROWS = 1; // rows of the digit table a workgroup of table_scan

layout(push_constant, std430) uniform RaySortArgs {
    StateOut state;
    ArgumentsOut arguments;
    RayCountIn count;
    uint max_rays;
    uint indirect; // 0: max_rays is the number itself
};

void main() {
    uint rays = traced_rays(count, max_rays, indirect);
    uint passes = (RAY_KEY_BITS + SORT_BITS - 1u) / SORT_BITS;
    uint digit_bits = (RAY_KEY_BITS + passes - 1u) / passes;
    state.state.pair_count = rays;
    state.state.kept_count = rays;
    state.state.key_bits = RAY_KEY_BITS;
    state.state.pass_count = passes;
    state.state.digit_bits = digit_bits;
    state.state.first_pair = 0u;
    state.state.sentinel = SATURATED; // no ray's key: none is left behind
    arguments.arguments.ray_keys = uvec4(split_workgroups(rays, MAP_SIZE), 0u);
    arguments.arguments.sort[0] = uvec4(sort_workgroups(rays), 0u);
    arguments.arguments.table_scan[0] = uvec4(split_workgroups(1u << digit_bits, TABLE_ROWS), 0u);
}
