#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The exclusive scan of each row of the digit table in place: how many keys with the digit the tiles before have; and the sum of each row. A row
// is an invocation's where a tile of the sort is, and otherwise a workgroup's.

#include "shared/scan.glsl"
#include "shared/sort_tile.glsl"

layout(push_constant, std430) uniform TableScan {
    StateIn state;
    UintsInOut table;
    UintsOut sums;
    uint pass;
};

// Of an invocation in a turn, one after another.
const uint ENTRIES_EACH = 8u;

// At most MOST_SORT_TILES turns.
void scan_alone(uint row, uint tile_count) {
    if (row >> state.state.digit_bits != 0u) {
        return;
    }
    uint sum = 0u;
    for (uint i = row * tile_count; i < (row + 1u) * tile_count; ++i) {
        uint count = table.word[i];
        table.word[i] = sum;
        sum += count;
    }
    sums.word[row] = sum;
}

void scan_together(uint row, uint tile_count) {
    bool used = row >> state.state.digit_bits == 0u;
    uint end = used ? tile_count : 0u;
    uint begin = row * tile_count;
    uint sum = 0u;
    for (uint turn = 0u; turn < end; turn += gl_WorkGroupSize.x * ENTRIES_EACH) {
        uint first = min(turn + gl_LocalInvocationID.x * ENTRIES_EACH, end);
        uint last = min(first + ENTRIES_EACH, end);
        uint mine = 0u;
        for (uint i = first; i < last; ++i) {
            mine += table.word[begin + i];
        }
        uint total;
        uint before = sum + workgroup_exclusive_scan(mine, total);
        for (uint i = first; i < last; ++i) {
            uint count = table.word[begin + i];
            table.word[begin + i] = before;
            before += count;
        }
        sum += total;
    }
    if (used && gl_LocalInvocationID.x == 0u) {
        sums.word[row] = sum;
    }
}

void main() {
    uint pair_count = pairs_of(state, pass);
    uint tile = sort_tile_of(pair_count);
    uint tile_count = (pair_count + tile - 1u) / tile;
    if (SORT_ALONE) {
        scan_alone(invocation_index(), tile_count);
    } else {
        scan_together(workgroup_index(), tile_count);
    }
}
