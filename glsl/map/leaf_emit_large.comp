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
            keys.word[pair] = split.leaf_begin + local.x + ((local.y + (local.z << split.level)) << split.level);
            pair += 1u;
        }
        cell = next_cell(box.cells, cell);
    }
}
