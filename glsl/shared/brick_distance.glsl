// The distance of each brick to the nearest that is not empty, in the maximum norm, an axis a kernel: the least of max(steps, distance so
// far) over the bricks along the axis.
#ifndef BRICK_DISTANCE_GLSL
#define BRICK_DISTANCE_GLSL

#include "shared/dispatch.glsl"
#include "shared/grid.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer DistancesIn { uint distance[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer DistancesOut { uint distance[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer BricksInOut { Brick brick[]; };

// Longer distances are not told apart: a jump then covers 4 * (2 * 15 - 1) cells.
const uint MAX_DISTANCE = 15u;

// Defines uint name(uint index, uint along, uint count, uint stride): the distance at `index`, which is `along` of `count` bricks on the
// axis, whose ids differ by `stride`. `before(id)` is the distance so far.
#define DEFINE_NEAREST(name, before) \
    uint name(uint index, uint along, uint count, uint stride) { \
        uint best = min(before(index), MAX_DISTANCE); \
        for (uint steps = 1u; steps < best; ++steps) { \
            if (along >= steps) { \
                best = min(best, max(steps, before(index - steps * stride))); \
            } \
            if (along + steps < count) { \
                best = min(best, max(steps, before(index + steps * stride))); \
            } \
        } \
        return best; \
    }

#endif
