// The second level (Kalojanov, Billeter and Slusallek 2011): a cell with many triangles is split into 2^level leaf cells along each axis,
// which have lists of their own. Boundaries of leaf cells are those of a grid that is finer by a power of two: where they coincide with
// boundaries of cells they are the same bits.
#ifndef SPLIT_GLSL
#define SPLIT_GLSL

#include "shared/grid.glsl"

const uint MAX_LEVEL = 5u;

// Least level whose empty leaf cells know how far the nearest is that is not.
const uint LEAST_MEASURED = 4u;

// The longest such distance: a quarter of the split cell, so that a jump covers at most half of it.
uint max_leaf_distance(uint level) { return 1u << (level - 2u); }

// Triangles of a list from which on its cell is split: more where lists are long all over, since it is those far longer than the others
// that rays wait for.
const uint LEAST_SPLIT = 24u;
const uint LEAST_SPLIT_OF_LONG = 64u;
// Mean length of a grid's lists from which on they are long.
const uint LONG_LISTS = 6u;

// The level of a cell that is split, by the length of its list: a surface that crosses it meets about 2 x 4^level of its leaf cells.
uint leaf_level(uint count, uint least, uint most) {
    uint level = uint(count >= 24u) + uint(count >= 48u) + uint(count >= 128u) + uint(count >= 256u) + uint(count >= 1024u);
    return count >= least ? min(most, level) : 0u;
}

uint leaf_count_of(uint level) { return 1u << (3u * level); }

// A cell that is to be split. Host twin: gridwalk_core::layout::SplitCell.
struct SplitCell {
    uint first_reference; // of all references of split cells
    uint list_begin;
    uint list_length;
    uint leaf_begin; // of all leaf cells
    uint cell;
    uint level; // 0: its leaf cells did not fit, so it stays whole
    uint xy; // of the cell: x in the low half
    uint z;
};

// What the count of the second level keeps of a triangle's box of leaf cells where that is a large one.
const uint LARGE_LEAF_BOX = 1u << 31;

// And where it is a small one: its first leaf cell within the split cell, its sizes less one along x and y, and the level.
uint small_leaf_box_word(uvec3 low, uvec3 more, uint level) {
    return (low.x + ((low.y + (low.z << level)) << level)) | more.x << 15u | more.y << 20u | level << 25u;
}

// A small box, as overlap.glsl's id_within takes it.
struct SmallLeafBox {
    uint low;
    vec2 inverse;
    uint to_row;
    uint to_slice;
};

// Of the word of a large box nothing that counts: its level is masked, since more bits than a word has are no shift.
SmallLeafBox small_leaf_box(uint word) {
    uint along = 1u << ((word >> 25u) & 7u);
    uvec2 size = (uvec2(word >> 15u, word >> 20u) & 31u) + uvec2(1u);
    return SmallLeafBox(word & 0x7FFFu, vec2(1.0) / vec2(size), along - size.x, along * (along - size.y));
}

// The split cell that lists the first reference of each block of 2^shift is kept, so that the one of any reference is found among few. There
// are at most 2^14 blocks, of at least 2^least references.
uint owner_shift(uint least, uint reference_count) { return max(least, uint(max(findMSB(reference_count), 13) - 13)); }

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer SplitCellsIn { SplitCell cell[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer SplitCellsOut { SplitCell cell[]; };

// The whole grid with 2^level cells for each along each axis.
GridHeader refined(GridHeader grid, uint level) {
    grid.cell_size *= uintBitsToFloat((127u - level) << 23);
    grid.inverse_cell_size *= uintBitsToFloat((127u + level) << 23);
    grid.resolution <<= level;
    return grid;
}

#endif
