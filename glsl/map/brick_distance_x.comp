#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Distances of bricks along x, of a run of bricks an invocation: those that are not empty, of the run and around, are bits of two words.

#include "shared/brick_distance.glsl"

// At most 16, so that the first word has all bricks up to the one whose distance is sought.
layout(constant_id = 1) const uint DISTANCE_RUN = 4;

layout(push_constant, std430) uniform BrickDistanceX {
    GridwalkGrid grid;
    Bricks bricks;
    DistancesOut distances;
};

void main() {
    uvec3 along = brick_resolution(grid.header.resolution);
    uint runs = (along.x + DISTANCE_RUN - 1u) / DISTANCE_RUN;
    uint index = invocation_index();
    if (index >= runs * along.y * along.z) {
        return;
    }
    uint row = index / runs;
    uint begin = (index - row * runs) * DISTANCE_RUN;
    uint end = min(begin + DISTANCE_RUN, along.x);
    uint first = row * along.x;
    // Bit 16 is the run's first brick.
    uint low = 0u;
    uint high = 0u;
    for (uint x = max(begin, MAX_DISTANCE) - MAX_DISTANCE; x < min(end + MAX_DISTANCE, along.x); ++x) {
        uvec2 mask = bricks.brick[first + x].mask;
        uint bit = x + 16u - begin;
        uint full = uint((mask.x | mask.y) != 0u) << (bit & 31u);
        low |= bit < 32u ? full : 0u;
        high |= bit < 32u ? 0u : full;
    }
    for (uint x = begin; x < end; ++x) {
        uint bit = x + 16u - begin;
        // Without a bit these are so far away that it counts for nothing.
        int before = int(bit) - findMSB(low & (0xFFFFFFFFu >> (31u - bit)));
        uint beyond = low >> bit;
        int after = beyond != 0u ? findLSB(beyond) : (high != 0u ? findLSB(high) + 32 - int(bit) : int(MAX_DISTANCE));
        distances.distance[first + x] = min(uint(min(before, after)), MAX_DISTANCE);
    }
}
