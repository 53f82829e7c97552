#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Distances of bricks along x.

#include "shared/brick_distance.glsl"

layout(push_constant, std430) uniform BrickDistanceX {
    GridwalkGrid grid;
    Bricks bricks;
    DistancesOut distances;
};

uint before(uint index) {
    uvec2 mask = bricks.brick[index].mask;
    return (mask.x | mask.y) != 0u ? 0u : MAX_DISTANCE;
}

DEFINE_NEAREST(nearest, before)

void main() {
    uvec3 along = brick_resolution(grid.header.resolution);
    uint index = invocation_index();
    if (index >= along.x * along.y * along.z) {
        return;
    }
    distances.distance[index] = nearest(index, index % along.x, along.x, 1u);
}
