#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Writes the pairs (cell id, triangle) of the triangles with large boxes: one invocation, a run of consecutive pairs, so the work is
// balanced whatever a triangle's size. Only if there are such triangles.

#include "shared/brick.glsl"
#include "shared/build.glsl"
#include "shared/overlap.glsl"
#include "shared/ping_pong.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;
layout(constant_id = 1) const uint PAIRS_EACH = 16;
layout(constant_id = 2) const bool EXACT = false;

layout(push_constant, std430) uniform OverlapEmitLarge {
    GridwalkGrid grid;
    StateIn state;
    UintsIn offsets;
    Triangles triangles;
    UintsOut keys_a;
    UintsOut keys_b;
    UintsOut values_a;
    UintsOut values_b;
    UintsOut used; // a word a brick: 1 if a triangle may lie in it
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
    GridHeader header = load_header(grid);
    uint triangle_count = state.state.triangle_count;
    bool to_a = writes_a(state.state.pass_count, 0u);
    uint first = invocation_index() * PAIRS_EACH;
    uint last = min(first + PAIRS_EACH, state.state.pair_count);
    if (first >= last) {
        return;
    }
    UintsOut keys = UintsOut(to_a ? uvec2(keys_a) : uvec2(keys_b));
    UintsOut values = UintsOut(to_a ? uvec2(values_a) : uvec2(values_b));

    uvec3 bricks_along = brick_resolution(header.resolution);
    uint triangle = owner(first, triangle_count);
    uint begin = offsets.word[triangle];
    uint end = offsets.word[triangle + 1u];
    // At most PAIRS_EACH turns: each triangle that is passed has a pair, and may cost a search. The inner loop takes as many in all, but lanes that
    // are in different turns of this one go through it one after another. Those of large boxes are told by their numbers of pairs.
    // The turns are counted since lavapipe of Mesa 22.3 was seen not to end the loop by its pairs alone, though none was left, on a processor
    // with AVX-512.
    for (uint pair = first, turns = 0u; pair < last && turns < PAIRS_EACH; ++turns) {
        if (end - begin > SMALL_BOX) {
            vec3 v0;
            vec3 v1;
            vec3 v2;
            load_vertices(triangles, 3u * triangle, v0, v1, v2);
            CellBox box = triangle_cells(header, v0, v1, v2);
            uvec3 size = box.high - box.low + uvec3(1u);
            uint local = pair - begin;
            uint row = local / size.x;
            uvec3 cell = box.low + uvec3(local - row * size.x, row % size.y, row / size.y);
            bool test = EXACT && !is_row(box);
            SeparatingAxes axes = separating_axes(header, v0, v1, v2, box.low);
            for (uint i = pair; i < min(end, last); ++i) {
                bool overlaps = !test || meets(axes, header, cell - box.low);
                keys.word[i] = overlaps ? cell_id(cell, header.resolution) : header.cell_count;
                values.word[i] = 3u * triangle;
                used.word[brick_id(cell / BRICK_SIZE, bricks_along)] = 1u;
                cell = next_cell(box, cell);
            }
        }
        pair = end;
        if (pair < last) {
            triangle += 1u;
            end = offsets.word[triangle + 1u];
            // Across triangles without a cell; a search again if there are many.
            if (end == pair) {
                triangle = owner(pair, triangle_count);
                end = offsets.word[triangle + 1u];
            }
            begin = pair;
        }
    }
}
