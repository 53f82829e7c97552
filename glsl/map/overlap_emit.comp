#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Writes the pairs (cell id, triangle) of a triangle with a small box.

#include "shared/build.glsl"
#include "shared/overlap.glsl"
#include "shared/ping_pong.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform OverlapEmit {
    GridwalkGrid grid;
    StateIn state;
    UintsIn offsets;
    UintsIn boxes; // of overlap_count
    UintsOut keys_a;
    UintsOut keys_b;
    UintsOut values_a;
    UintsOut values_b;
};

void main() {
    uvec3 resolution = load_header(grid).resolution;
    bool to_a = writes_a(state.state.pass_count, 0u);
    uint pair_count = state.state.pair_count;
    uint triangle = invocation_index();
    if (triangle >= state.state.triangle_count) {
        return;
    }
    uint mask = boxes.word[3u * triangle];
    if (mask == 0u) {
        return;
    }
    uint cell = boxes.word[3u * triangle + 1u];
    uint sizes = boxes.word[3u * triangle + 2u];
    uvec2 size = uvec2(sizes & 0xFFFFu, sizes >> 16u);
    uint to_row = resolution.x - size.x;
    uint to_slice = resolution.x * (resolution.y - size.y);
    UintsOut keys = UintsOut(to_a ? uvec2(keys_a) : uvec2(keys_b));
    UintsOut values = UintsOut(to_a ? uvec2(values_a) : uvec2(values_b));
    vec2 inverse = vec2(1.0) / vec2(size);
    uint pair = offsets.word[triangle];
    for (; mask != 0u && pair < pair_count; mask &= mask - 1u) {
        keys.word[pair] = cell + id_within(uint(findLSB(mask)), inverse, to_row, to_slice);
        values.word[pair] = 3u * triangle;
        pair += 1u;
    }
}
