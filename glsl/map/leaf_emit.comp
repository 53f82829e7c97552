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
    UintsIn owners;
    // Written behind what the first level has there, and offsets, masks and owners.
    UintsOut keys_a;
    UintsOut keys_b;
    UintsOut values_a;
    UintsOut values_b;
    CellsOut cells;
};

void main() {
    uint index = invocation_index();
    if (index + 1u >= state.state.offset_count) {
        return;
    }
    SplitCell split = split_cells.cell[owners.word[index]];
    if (split.level == 0u) {
        return;
    }
    uint place = index - split.first_reference;
    if (place == 0u) {
        cells.range[split.cell] = uvec2(state.state.first_cell + split.leaf_begin, CELL_SPLIT | split.level);
    }
    bool to_a = writes_a(state.state.pass_count, 0u);
    UintsOut keys = UintsOut(to_a ? uvec2(keys_a) : uvec2(keys_b));
    UintsOut values = UintsOut(to_a ? uvec2(values_a) : uvec2(values_b));
    uint vertex = references.vertex[split.list_begin + place];
    vec3 v0 = triangles.vertex[vertex].xyz;
    vec3 v1 = triangles.vertex[vertex + 1u].xyz;
    vec3 v2 = triangles.vertex[vertex + 2u].xyz;
    GridHeader fine = refined(grid.header, split.level);
    LeafBox box = leaf_box(fine, split, v0, v1, v2);
    uint mask = masks.word[index];
    bool small = box.count <= SMALL_BOX;
    SeparatingAxes axes;
    if (!small) {
        axes = separating_axes(fine, v0, v1, v2, box.cells.low);
    }
    uint pair = state.state.first_pair + offsets.word[index];
    uvec3 inside = uvec3((1u << split.level) - 1u);
    uvec3 cell = box.cells.low;
    for (uint n = 0u; n < box.count; ++n) {
        bool overlaps = small ? ((mask >> n) & 1u) != 0u : (!box.test || meets(axes, fine, cell - box.cells.low));
        if (overlaps) {
            uvec3 local = cell & inside;
            keys.word[pair] = split.leaf_begin + local.x + ((local.y + (local.z << split.level)) << split.level);
            values.word[pair] = vertex;
            pair += 1u;
        }
        cell = next_cell(box.cells, cell);
    }
}
