#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The closest hit of each ray through the public include: proves that gridwalk.glsl and the kernels agree.

#include "shared/dispatch.glsl"
#include "shared/gridwalk.glsl"
#include "shared/trace_types.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform ClosestCandidate {
    GridwalkGrid grid;
    RaysIn rays;
    HitsOut hits;
    uint ray_count;
    uint mask;
    uint cull;
};

void main() {
    uint index = invocation_index();
    if (index < ray_count) {
        hits.hit[index] = gridwalk_closest_hit_filtered(grid, rays.ray[index], mask, cull);
    }
}
