#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Distances of bricks along z.

#include "shared/brick_distance.glsl"

layout(push_constant, std430) uniform BrickDistanceZ {
    GridwalkGrid grid;
    DistancesIn distances_y;
    BricksInOut bricks;
};

uint before(uint index) { return distances_y.distance[index]; }

DEFINE_NEAREST(nearest, before)

void main() {
    uvec3 along = brick_resolution(grid.header.resolution);
    uint index = invocation_index();
    if (index >= along.x * along.y * along.z) {
        return;
    }
    bricks.brick[index].distance = nearest(index, index / (along.x * along.y), along.z, along.x * along.y);
}
