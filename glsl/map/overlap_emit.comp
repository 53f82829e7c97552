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
    UintsIn masks;
    Triangles triangles;
    UintsOut keys_a;
    UintsOut keys_b;
    UintsOut values_a;
    UintsOut values_b;
};

void main() {
    uint triangle = invocation_index();
    if (triangle >= state.state.triangle_count) {
        return;
    }
    uint mask = masks.word[triangle];
    if (mask == 0u) {
        return;
    }
    GridHeader header = grid.header;
    bool to_a = writes_a(state.state.pass_count, 0u);
    UintsOut keys = UintsOut(to_a ? uvec2(keys_a) : uvec2(keys_b));
    UintsOut values = UintsOut(to_a ? uvec2(values_a) : uvec2(values_b));
    CellBox box = triangle_cells(header, triangles.vertex[3u * triangle].xyz, triangles.vertex[3u * triangle + 1u].xyz,
                                 triangles.vertex[3u * triangle + 2u].xyz);
    uvec3 cell = box.low;
    uint pair = offsets.word[triangle];
    uint pair_count = state.state.pair_count;
    for (; mask != 0u && pair < pair_count; mask >>= 1u) {
        if ((mask & 1u) != 0u) {
            keys.word[pair] = cell_id(cell, header.resolution);
            values.word[pair] = 3u * triangle;
            pair += 1u;
        }
        cell = next_cell(box, cell);
    }
}
