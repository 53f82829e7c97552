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

// The split cell that lists a reference.
uint split_cell_of(SplitCellsIn cells, uint cell_count, uint reference) {
    uint low = 0u;
    uint high = cell_count;
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

#endif
