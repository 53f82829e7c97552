#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One invocation turns a number of rays, given or in a buffer, into the arguments of the first trace.

#include "shared/trace_types.glsl"

layout(local_size_x = 1) in;
layout(constant_id = 1) const uint MAP_SIZE = 64;

layout(push_constant, std430) uniform TraceArgs {
    TraceStateOut state;
    RayCountIn count;
    uint max_rays;
    uint indirect; // 0: max_rays is the number itself
};

void main() {
    uint rays = traced_rays(count, max_rays, indirect);
    state.state.arguments = uvec4(deal_workgroups(rays, MAP_SIZE), 0u);
    state.state.ray_count = rays;
    state.state.unfinished = 0u;
}
