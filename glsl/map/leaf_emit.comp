#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Writes the pairs (leaf cell, triangle) of the second level, and makes each split cell lead to its leaf cells.

#include "shared/leaf.glsl"
#include "shared/ping_pong.glsl"

layout(buffer_reference, std430, buffer_reference_align = 8) writeonly buffer CellsOut { uvec2 range[]; };

layout(push_constant, std430) uniform LeafEmit {
    GridwalkGrid grid;
    StateIn state; // of the second level
    SplitCellsIn split_cells;
    References references;
    Triangles triangles;
    UintsIn offsets;
    UintsIn masks;
    UintsIn boxes;
    UintsIn owners;
    // Written behind what the first level has there, and offsets, masks and boxes.
    UintsOut keys_a;
    UintsOut keys_b;
    UintsOut values_a;
    UintsOut values_b;
    CellsOut cells;
};

void main() {
    GridHeader header = load_header(grid);
    uint first_cell = state.state.first_cell;
    uint first_pair = state.state.first_pair;
    bool to_a = writes_a(state.state.pass_count, 0u);
    uint index = invocation_index();
    if (index + 1u >= state.state.offset_count) {
        return;
    }
    uint owner = split_cell_of(split_cells, owners, state, index);
    uint place = index - split_cells.cell[owner].first_reference;
    uint box_word = boxes.word[index];
    uint mask = masks.word[index];
    if (place == 0u) {
        SplitCell split = split_cells.cell[owner];
        if (split.level != 0u) {
            cells.range[split.cell] = uvec2(first_cell + split.leaf_begin, CELL_SPLIT | split.level);
        }
    }
    if (mask == 0u && box_word != LARGE_LEAF_BOX) {
        return;
    }
    UintsOut keys = UintsOut(to_a ? uvec2(keys_a) : uvec2(keys_b));
    UintsOut values = UintsOut(to_a ? uvec2(values_a) : uvec2(values_b));
    uint row = references.row[split_cells.cell[owner].list_begin + place];
    uint pair = first_pair + offsets.word[index];
    uint leaf_begin = split_cells.cell[owner].leaf_begin;
    if (box_word == LARGE_LEAF_BOX) {
        SplitCell split = split_cells.cell[owner];
        vec3 v0;
        vec3 v1;
        vec3 v2;
        load_vertices(triangles, row, v0, v1, v2);
        GridHeader fine = refined(header, split.level);
        LeafBox box = leaf_box(fine, split, v0, v1, v2);
        SeparatingAxes axes = separating_axes(fine, v0, v1, v2, box.cells.low);
        uvec3 inside = uvec3((1u << split.level) - 1u);
        uvec3 cell = box.cells.low;
        for (uint n = 0u; n < box.count; ++n) {
            if (!box.test || meets(axes, fine, cell - box.cells.low)) {
                uvec3 local = cell & inside;
                keys.word[pair] = leaf_begin + local.x + ((local.y + (local.z << split.level)) << split.level);
                values.word[pair] = row;
                pair += 1u;
            }
            cell = next_cell(box.cells, cell);
        }
        return;
    }
    uint along = 1u << (box_word >> 25u);
    uvec2 size = (uvec2(box_word >> 15u, box_word >> 20u) & 31u) + uvec2(1u);
    uint key = leaf_begin + (box_word & 0x7FFFu);
    vec2 inverse = vec2(1.0) / vec2(size);
    for (; mask != 0u; mask &= mask - 1u) {
        keys.word[pair] = key + id_within(uint(findLSB(mask)), inverse, along - size.x, along * (along - size.y));
        values.word[pair] = row;
        pair += 1u;
    }
}
