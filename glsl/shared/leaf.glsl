// What counting and emission of the second level share: which leaf cells of a split cell a triangle of its list overlaps. An invocation takes
// one triangle, since that may be tested against all 32,768 leaf cells: half of lavapipe's budget of 65,535 turns.
#ifndef LEAF_GLSL
#define LEAF_GLSL

#include "shared/build.glsl"
#include "shared/overlap.glsl"
#include "shared/split.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;
layout(constant_id = 1) const bool EXACT = false;
layout(constant_id = 2) const uint OWNER_SHIFT = 5;

// The split cell that lists a reference, of those between the owners of its block's first reference and the next block's.
uint split_cell_of(SplitCellsIn cells, UintsIn owners, StateIn state, uint reference) {
    uint reference_count = state.state.offset_count - 1u;
    uint shift = owner_shift(OWNER_SHIFT, reference_count);
    uint block = reference >> shift;
    uint low = owners.word[block];
    uint high = state.state.split_cells;
    if ((block + 1u) << shift < reference_count) {
        high = owners.word[block + 1u] + 1u;
    }
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (cells.cell[middle].first_reference <= reference) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

struct LeafBox {
    CellBox cells; // of the refined grid
    uint count; // 0: the triangle is in the cell's list by rounding alone, or the cell is not split
    bool test; // whether a cell of the box may be one that the triangle misses
};

LeafBox leaf_box(GridHeader fine, SplitCell split, vec3 v0, vec3 v1, vec3 v2) {
    uvec3 low = uvec3(split.xy & 0xFFFFu, split.xy >> 16u, split.z) << split.level;
    uvec3 high = low + uvec3((1u << split.level) - 1u);
    LeafBox box;
    box.cells = triangle_cells(fine, v0, v1, v2);
    // Decided before the box is cut: the rest of a row is a row, but a row may be the rest of a box.
    box.test = EXACT && !is_row(box.cells);
    box.cells.low = max(box.cells.low, low);
    box.cells.high = min(box.cells.high, high);
    bool empty = any(greaterThan(box.cells.low, box.cells.high)) || split.level == 0u;
    box.count = empty ? 0u : cells_of(box.cells);
    return box;
}

// What the count keeps of a box for the emission.
uint leaf_box_word(LeafBox box, uint level) {
    uvec3 low = box.cells.low & ((1u << level) - 1u);
    uvec3 more = box.cells.high - box.cells.low;
    return box.count > SMALL_BOX ? LARGE_LEAF_BOX : (box.count == 0u ? 0u : small_leaf_box_word(low, more, level));
}

// Writes the leaf cells that the triangle of a large box overlaps from `pair` on: `with_values` its row beside each, in the same turn, of which
// there are no more to spare.
void emit_large(GridHeader header, Triangles triangles, SplitCell split, uint row, uint pair, UintsOut keys, UintsOut values, bool with_values) {
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
            if (with_values) {
                values.word[pair] = row;
            }
            pair += 1u;
        }
        cell = next_cell(box.cells, cell);
    }
}

#endif
