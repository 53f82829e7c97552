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
        emit_large(header, triangles, split_cells.cell[owner], row, pair, keys, values, true);
        return;
    }
    SmallLeafBox box = small_leaf_box(box_word);
    for (; mask != 0u; mask &= mask - 1u) {
        keys.word[pair] = leaf_begin + box.low + id_within(uint(findLSB(mask)), box.inverse, box.to_row, box.to_slice);
        values.word[pair] = row;
        pair += 1u;
    }
}
