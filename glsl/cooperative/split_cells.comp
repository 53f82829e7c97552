#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Writes a record of each cell that is to be split: where its references and its leaf cells begin among those of all split cells; and
// which record holds the first reference of each block.

#include "shared/occupancy.glsl"

layout(constant_id = 1) const uint BRICKS_EACH = 4;
layout(constant_id = 2) const uint OWNER_SHIFT = 5;

layout(push_constant, std430) uniform SplitCells {
    GridwalkGrid grid;
    StateIn state; // of the second level
    Cells cells;
    Bricks bricks;
    OccupancyIn partials;
    SplitCellsOut split_cells;
    UintsOut owners; // of the first reference of each block
    uint leaf_capacity;
};

void main() {
    uvec3 resolution = grid.header.resolution;
    uvec3 bricks_along = brick_resolution(resolution);
    uint brick_count = bricks_along.x * bricks_along.y * bricks_along.z;
    uint most = grid.header.fine_shift;
    uint least = state.state.least_split;
    uint which = least == LEAST_SPLIT ? 0u : 1u;
    uint tile = workgroup_index();
    uint first = (tile * gl_WorkGroupSize.x + gl_LocalInvocationID.x) * BRICKS_EACH;
    TileOccupancy occupancy = NOTHING;
    if (tile * gl_WorkGroupSize.x * BRICKS_EACH < brick_count) {
        occupancy = partials.tile[tile];
    }
    uint last = occupancy.split_cells[which] > 0u ? min(first + BRICKS_EACH, brick_count) : first;
    uint records = 0u;
    uint references = 0u;
    uint leaves = 0u;
    for (uint index = first; index < last; ++index) {
        if (bricks.brick[index].longest_list < least) {
            continue;
        }
        BrickCells brick = brick_cells(index, resolution);
        for (uint z = 0u; z < brick.size.z; ++z) {
            for (uint y = 0u; y < brick.size.y; ++y) {
                uint row = cell_id(brick.low + uvec3(0u, y, z), resolution);
                for (uint x = 0u; x < brick.size.x; ++x) {
                    uvec2 range = cells.range[row + x];
                    uint level = leaf_level(range.y - range.x, least, most);
                    records += uint(level != 0u);
                    references += level != 0u ? range.y - range.x : 0u;
                    leaves += level != 0u ? leaf_count_of(level) : 0u;
                }
            }
        }
    }
    uint shift = owner_shift(OWNER_SHIFT, state.state.offset_count - 1u);
    uint total;
    uint record = occupancy.cells_before + workgroup_exclusive_scan(records, total);
    uint reference = occupancy.references_before + workgroup_exclusive_scan(references, total);
    uint leaf = saturating_add(occupancy.leaves_before, workgroup_exclusive_scan(leaves, total));
    for (uint index = first; index < last && records > 0u; ++index) {
        if (bricks.brick[index].longest_list < least) {
            continue;
        }
        BrickCells brick = brick_cells(index, resolution);
        for (uint z = 0u; z < brick.size.z; ++z) {
            for (uint y = 0u; y < brick.size.y; ++y) {
                uvec3 cell = brick.low + uvec3(0u, y, z);
                uint row = cell_id(cell, resolution);
                for (uint x = 0u; x < brick.size.x; ++x) {
                    uvec2 range = cells.range[row + x];
                    uint length = range.y - range.x;
                    uint level = leaf_level(length, least, most);
                    if (level != 0u) {
                        uint end = saturating_add(leaf, leaf_count_of(level));
                        uint fitting = end <= leaf_capacity ? level : 0u;
                        uint xy = (cell.x + x) | cell.y << 16u;
                        split_cells.cell[record] = SplitCell(reference, range.x, length, leaf, row + x, fitting, xy, cell.z);
                        // At most 2^14 turns for all.
                        for (uint block = (reference + (1u << shift) - 1u) >> shift; block << shift < reference + length; ++block) {
                            owners.word[block] = record;
                        }
                        record += 1u;
                        reference += length;
                        leaf = end;
                    }
                }
            }
        }
    }
}
