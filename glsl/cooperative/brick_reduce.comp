#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Which cells of each brick are in use, for the walk; and what a tile of bricks adds to the report and gives the second level to do.

#include "shared/occupancy.glsl"

layout(constant_id = 1) const uint BRICKS_EACH = 4;

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer BricksOut { Brick brick[]; };

layout(push_constant, std430) uniform BrickReduce {
    GridwalkGrid grid;
    UintsIn used;
    Cells cells;
    BricksOut bricks;
    OccupancyOut partials;
};

void main() {
    uvec3 resolution = grid.header.resolution;
    uvec3 bricks_along = brick_resolution(resolution);
    uint brick_count = bricks_along.x * bricks_along.y * bricks_along.z;
    uint most = grid.header.fine_shift;
    uint tile = workgroup_index();
    uint first = tile * gl_WorkGroupSize.x * BRICKS_EACH;
    TileOccupancy occupancy = NOTHING;
    for (uint i = 0u; i < BRICKS_EACH; ++i) {
        uint index = first + i * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (index < brick_count) {
            BrickCells brick = brick_cells(index, resolution);
            uvec2 mask = uvec2(0u);
            uint longest = 0u;
            uint row_bits = (1u << brick.size.x) - 1u;
            uint depth = used.word[index] != 0u ? brick.size.z : 0u;
            for (uint z = 0u; z < depth; ++z) {
                for (uint y = 0u; y < brick.size.y; ++y) {
                    uint row = cell_id(brick.low + uvec3(0u, y, z), resolution);
                    uint bits = 0u;
                    for (uint x = 0u; x < BRICK_SIZE; ++x) {
                        uvec2 range = cells.range[row + min(x, brick.size.x - 1u)];
                        bits |= uint(range.y != 0u) << x;
                        longest = max(longest, range.y - range.x);
                    }
                    uint shift = BRICK_SIZE * y + 16u * (z & 1u);
                    bits = (bits & row_bits) << shift;
                    mask.x |= z < 2u ? bits : 0u;
                    mask.y |= z < 2u ? 0u : bits;
                }
            }
            // Few bricks have such a cell.
            bool splits = most != 0u && longest >= LEAST_SPLIT;
            for (uint cell = 0u; cell < BRICK_SIZE * BRICK_SIZE * BRICK_SIZE && splits; ++cell) {
                uvec3 local = uvec3(cell, cell >> 2u, cell >> 4u) & (BRICK_SIZE - 1u);
                if (all(lessThan(local, brick.size))) {
                    uvec2 range = cells.range[cell_id(brick.low + local, resolution)];
                    uint length = range.y - range.x;
                    uint level = leaf_level(length, LEAST_SPLIT, most);
                    for (uint i = 0u; i < (level == 0u ? 0u : length >= LEAST_SPLIT_OF_LONG ? 2u : 1u); ++i) {
                        occupancy.split_cells[i] += 1u;
                        occupancy.split_references[i] += length;
                        occupancy.leaf_cells[i] = saturating_add(occupancy.leaf_cells[i], leaf_count_of(level));
                    }
                }
            }
            occupancy.cells_in_use += uint(bitCount(mask.x) + bitCount(mask.y));
            occupancy.longest_list = max(occupancy.longest_list, longest);
            // The distance is measured by the next steps.
            bricks.brick[index] = Brick(mask, 0u, longest);
        }
    }
    occupancy = workgroup_occupancy(occupancy);
    if (gl_LocalInvocationID.x == 0u && first < brick_count) {
        partials.tile[tile] = occupancy;
    }
}
