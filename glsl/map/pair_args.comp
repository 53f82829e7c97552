#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One invocation turns the number of pairs into the sizes of the steps that follow.

#include "shared/build.glsl"

layout(local_size_x = 1) in;

layout(constant_id = 1) const uint MAP_SIZE = 64;
layout(constant_id = 2) const uint SORT_TILE = 8192;
layout(constant_id = 3) const uint SCAN_TILE = 4096;
layout(constant_id = 4) const uint PAIRS_EACH = 16;
layout(constant_id = 5) const uint SORT_TILES = 1; // tiles a workgroup of the sort
layout(constant_id = 6) const uint RANGE_PAIRS = 1; // pairs an invocation of cell_ranges

layout(push_constant, std430) uniform PairArgs {
    StateInOut state;
    UintsIn offsets;
    ArgumentsOut arguments;
    ReportInOut report;
    uint pair_capacity;
    uint pass_capacity; // passes recorded; the cell capacity admits no more
};

void main() {
    uint total = offsets.word[state.state.triangle_count];
    uint count = min(total, pair_capacity);
    uint overflow = state.state.overflow | (total > pair_capacity ? OVERFLOW_PAIRS : 0u);
    uint tiles = (count + SORT_TILE - 1u) / SORT_TILE;
    uint table_count = tiles << state.state.digit_bits;
    state.state.pair_total = total;
    state.state.pair_count = count;
    state.state.kept_count = count; // until the first pass counts
    state.state.table_count = table_count;
    state.state.overflow = overflow;
    report.report.pair_total = total;
    report.report.overflow = overflow;

    uvec3 runs = split_workgroups((count + PAIRS_EACH - 1u) / PAIRS_EACH, MAP_SIZE);
    arguments.arguments.emit_large = state.state.has_large != 0u ? uvec4(runs, 0u) : uvec4(0u);
    arguments.arguments.cell_ranges = uvec4(split_workgroups((count + RANGE_PAIRS - 1u) / RANGE_PAIRS, MAP_SIZE), 0u);
    for (uint pass = 0u; pass < pass_capacity; ++pass) {
        bool used = pass < state.state.pass_count && count > 0u;
        arguments.arguments.sort[pass] = used ? uvec4(split_workgroups(tiles, SORT_TILES), 0u) : uvec4(0u);
        arguments.arguments.table_scan[pass] = used ? uvec4(split_workgroups(table_count, SCAN_TILE), 0u) : uvec4(0u);
        arguments.arguments.table_spine[pass] = used ? uvec4(1u, 1u, 1u, 0u) : uvec4(0u);
    }
}
