#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Writes which leaf cells the triangles with large boxes overlap, for leaf_sort.

#include "shared/leaf.glsl"

layout(push_constant, std430) uniform LeafEmitLarge {
    GridwalkGrid grid;
    StateIn state; // of the second level
    SplitCellsIn split_cells;
    References references;
    Triangles triangles;
    UintsIn offsets;
    UintsIn boxes;
    UintsIn owners;
    UintsOut keys; // behind what the first level has there
};

void main() {
    GridHeader header = load_header(grid);
    uint first_pair = state.state.first_pair;
    uint index = invocation_index();
    if (index + 1u >= state.state.offset_count || boxes.word[index] != LARGE_LEAF_BOX) {
        return;
    }
    uint pair = first_pair + offsets.word[index];
    SplitCell split = split_cells.cell[split_cell_of(split_cells, owners, state, index)];
    uint row = references.row[split.list_begin + index - split.first_reference];
    emit_large(header, triangles, split, row, pair, keys, keys, false);
}
