#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Writes the pairs (cell id, triangle): one invocation, a run of consecutive pairs, so the work is balanced whatever a triangle's size.

#include "shared/build.glsl"
#include "shared/overlap.glsl"
#include "shared/ping_pong.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;
layout(constant_id = 1) const uint PAIRS_EACH = 16;
layout(constant_id = 2) const bool EXACT = false;

layout(push_constant, std430) uniform OverlapEmit {
    GridwalkGrid grid;
    StateIn state;
    UintsIn offsets;
    Triangles triangles;
    UintsOut keys_a;
    UintsOut keys_b;
    UintsOut values_a;
    UintsOut values_b;
};

// The last triangle whose first pair is not after `pair`: the one that owns it. At most 27 turns.
uint owner(uint pair, uint triangle_count) {
    uint low = 0u;
    uint high = triangle_count;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (offsets.word[middle] <= pair) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

void main() {
    uint first = invocation_index() * PAIRS_EACH;
    uint last = min(first + PAIRS_EACH, state.state.pair_count);
    if (first >= last) {
        return;
    }
    GridHeader header = grid.header;
    uint triangle_count = state.state.triangle_count;
    bool to_a = writes_a(state.state.pass_count, 0u);
    UintsOut keys = UintsOut(to_a ? uvec2(keys_a) : uvec2(keys_b));
    UintsOut values = UintsOut(to_a ? uvec2(values_a) : uvec2(values_b));

    uint triangle = owner(first, triangle_count);
    uint end = first; // of the triangle's pairs; set below, as the first turn finds it reached
    vec3 v0;
    vec3 v1;
    vec3 v2;
    CellBox box;
    uvec3 size;
    uvec3 cell;
    bool test = false;
    for (uint pair = first; pair < last; ++pair) {
        if (pair == end) {
            if (pair != first) {
                triangle += 1u;
                // Across triangles without a cell; a search again if there are many.
                if (offsets.word[triangle + 1u] == pair) {
                    triangle = owner(pair, triangle_count);
                }
            }
            v0 = triangles.vertex[3u * triangle].xyz;
            v1 = triangles.vertex[3u * triangle + 1u].xyz;
            v2 = triangles.vertex[3u * triangle + 2u].xyz;
            box = triangle_cells(header, v0, v1, v2);
            size = box.high - box.low + uvec3(1u);
            end = offsets.word[triangle + 1u];
            uint local = pair - offsets.word[triangle];
            uint row = local / size.x;
            cell = box.low + uvec3(local - row * size.x, row % size.y, row / size.y);
            // A box of one row of cells is met by its triangle in each of them.
            uint rows = uint(size.x == 1u) + uint(size.y == 1u) + uint(size.z == 1u);
            test = EXACT && rows < 2u;
        }
        bool overlaps = !test || triangle_overlaps_cell(header, v0, v1, v2, cell);
        keys.word[pair] = overlaps ? cell_id(cell, header.resolution) : header.cell_count;
        values.word[pair] = triangle;
        cell.x += 1u;
        if (cell.x > box.high.x) {
            cell.x = box.low.x;
            cell.y += 1u;
            if (cell.y > box.high.y) {
                cell.y = box.low.y;
                cell.z += 1u;
            }
        }
    }
}
