#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The key of each ray, and the ray's index: the pairs that the sort turns into the order of the rays.

#include "shared/build.glsl"
#include "shared/ray_key.glsl"
#include "shared/trace_types.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform RayKeys {
    GridwalkGrid grid;
    RaysIn rays;
    StateIn state;
    UintsOut keys;
    UintsOut values;
};

void main() {
    uint index = invocation_index();
    if (index < state.state.pair_count) {
        GridHeader header = grid.header;
        keys.word[index] = ray_key(move_ray(rays.ray[index], header), header);
        values.word[index] = index;
    }
}
