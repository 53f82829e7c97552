#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Takes each brick for one without a triangle.

#include "shared/brick.glsl"
#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform ClearBricks {
    GridwalkGrid grid;
    UintsOut used;
};

void main() {
    uint index = invocation_index();
    if (index < brick_count_of(brick_resolution(grid.header.resolution))) {
        used.word[index] = 0u;
    }
}
