#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Distances of bricks along y.

#include "shared/brick_distance.glsl"

layout(push_constant, std430) uniform BrickDistanceY {
    GridwalkGrid grid;
    DistancesIn distances_x;
    DistancesOut distances;
};

uint before(uint index) { return distances_x.distance[index]; }

DEFINE_NEAREST(nearest, before)

void main() {
    uvec3 along = brick_resolution(grid.header.resolution);
    uint index = invocation_index();
    if (index >= along.x * along.y * along.z) {
        return;
    }
    distances.distance[index] = nearest(index, index / along.x % along.y, along.y, along.x);
}
