#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The distance of each empty leaf cell to the nearest that is not empty, in the maximum norm, among those of the same split cell: into the
// first word of its range, where it is more than one. A workgroup takes SPLIT_CELLS_EACH split cells, one after another, of which few have so many
// leaf cells that this is worth it. A row of leaf cells along x is a word of bits, which spread by one cell along each axis in a turn.

#include "shared/build.glsl"
#include "shared/split.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 1) const uint SPLIT_CELLS_EACH = 1;

layout(push_constant, std430) uniform LeafDistance {
    StateIn state; // of the second level
    SplitCellsIn split_cells;
    UintsInOut cells;
};

const uint ROWS = 1u << (2u * MAX_LEVEL);

// Bits of the leaf cells that are closer to one that is not empty than the turn's distance.
shared uint near[ROWS];
// The same, spread along x and y.
shared uint spread[ROWS];

void write_distances(uint first, uint bits, uint reached) {
    for (uint rest = bits; rest != 0u; rest &= rest - 1u) {
        cells.word[2u * (first + uint(findLSB(rest)))] = reached;
    }
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    for (uint i = 0u; i < SPLIT_CELLS_EACH; ++i) {
        uint record = workgroup_index() * SPLIT_CELLS_EACH + i;
        uint level = record < state.state.split_cells ? split_cells.cell[record].level : 0u;
        if (level < LEAST_MEASURED) {
            continue;
        }
        uint first = state.state.first_cell + split_cells.cell[record].leaf_begin;
        uint along = 1u << level;
        uint rows = along << level;
        uint most = max_leaf_distance(level);
        uint all = 0xFFFFFFFFu >> (32u - along);
        for (uint row = lane; row < rows; row += gl_WorkGroupSize.x) {
            uint bits = 0u;
            for (uint x = 0u; x < along; ++x) {
                bits |= uint(cells.word[2u * (first + (row << level) + x) + 1u] != 0u) << x;
            }
            near[row] = bits;
        }
        barrier();
        for (uint reach = 1u; reach < most; ++reach) {
            for (uint row = lane; row < rows; row += gl_WorkGroupSize.x) {
                uint y = row & (along - 1u);
                uint bits = near[row] | (y > 0u ? near[row - 1u] : 0u) | (y + 1u < along ? near[row + 1u] : 0u);
                spread[row] = (bits | bits << 1u | bits >> 1u) & all;
            }
            barrier();
            for (uint row = lane; row < rows; row += gl_WorkGroupSize.x) {
                uint z = row >> level;
                uint bits = spread[row] | (z > 0u ? spread[row - along] : 0u) | (z + 1u < along ? spread[row + along] : 0u);
                // A distance of one is what an empty leaf cell has anyway.
                write_distances(first + (row << level), reach > 1u ? bits & ~near[row] : 0u, reach);
                near[row] = bits;
            }
            barrier();
        }
        for (uint row = lane; row < rows; row += gl_WorkGroupSize.x) {
            write_distances(first + (row << level), all & ~near[row], most);
        }
    }
}
