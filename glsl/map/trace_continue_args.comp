#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One invocation: if a walk was given up, the trace goes on over all rays, else over none.

#include "shared/trace_types.glsl"

layout(local_size_x = 1) in;
layout(constant_id = 1) const uint MAP_SIZE = 64;

layout(push_constant, std430) uniform TraceContinueArgs { TraceStateInOut state; };

void main() {
    uint rays = state.state.unfinished != 0u ? state.state.ray_count : 0u;
    state.state.arguments = uvec4(deal_workgroups(rays, MAP_SIZE), 0u);
    state.state.unfinished = 0u;
}
