#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Counts the leaf cells that each triangle of a split cell's list overlaps, with a bit of its mask each where they lie in a small box, and
// empties the leaf cells. The count after the last is zero, so that the scan leaves the total there.

#include "shared/leaf.glsl"

layout(buffer_reference, std430, buffer_reference_align = 8) writeonly buffer CellsOut { uvec2 range[]; };

layout(push_constant, std430) uniform LeafCount {
    GridwalkGrid grid;
    StateIn state; // of the second level
    SplitCellsIn split_cells;
    References references;
    Triangles triangles;
    UintsOut counts;
    UintsOut masks;
    UintsOut boxes;
    UintsIn owners;
    CellsOut cells;
};

void main() {
    GridHeader header = load_header(grid);
    uint first_cell = state.state.first_cell;
    uint index = invocation_index();
    uint total = state.state.offset_count - 1u;
    if (index > total) {
        return;
    }
    if (index == total) {
        counts.word[index] = 0u;
        return;
    }
    SplitCell split = split_cells.cell[split_cell_of(split_cells, owners, state, index)];
    uint place = index - split.first_reference;
    // Few turns: there are at most 32 leaf cells for each triangle of a list.
    uint leaves = split.level == 0u ? 0u : leaf_count_of(split.level);
    for (uint leaf = place; leaf < leaves; leaf += split.list_length) {
        cells.range[first_cell + split.leaf_begin + leaf] = uvec2(0u);
    }
    uint row = references.row[split.list_begin + place];
    vec3 v0;
    vec3 v1;
    vec3 v2;
    load_vertices(triangles, row, v0, v1, v2);
    GridHeader fine = refined(header, split.level);
    LeafBox box = leaf_box(fine, split, v0, v1, v2);
    uint count = box.count;
    uint mask = 0u;
    if (box.test && count > 0u) {
        SeparatingAxes axes = separating_axes(fine, v0, v1, v2, box.cells.low);
        uvec3 cell = box.cells.low;
        count = 0u;
        for (uint n = 0u; n < box.count; ++n) {
            bool overlaps = meets(axes, fine, cell - box.cells.low);
            count += uint(overlaps);
            mask |= overlaps ? 1u << (n & 31u) : 0u;
            cell = next_cell(box.cells, cell);
        }
    } else if (count > 0u) {
        mask = 0xFFFFFFFFu >> (SMALL_BOX - min(count, SMALL_BOX));
    }
    counts.word[index] = count;
    masks.word[index] = box.count > SMALL_BOX ? 0u : mask;
    boxes.word[index] = leaf_box_word(box, split.level);
}
