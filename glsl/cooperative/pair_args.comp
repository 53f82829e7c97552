#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Scans the counts of pairs, and turns the number of all into the sizes of the steps that follow.

#include "shared/offsets.glsl"

layout(constant_id = 2) const uint MAP_SIZE = 64;
layout(constant_id = 3) const uint SORT_TILE = 8192;
layout(constant_id = 4) const uint PAIRS_EACH = 16;
layout(constant_id = 5) const uint SORT_TILES = 1; // tiles a workgroup of the sort
layout(constant_id = 6) const uint RANGE_PAIRS = 1; // pairs an invocation of cell_ranges
layout(constant_id = 7) const uint TABLE_ROWS = 1; // rows of the digit table a workgroup of table_scan

layout(push_constant, std430) uniform PairArgs {
    StateInOut state;
    UintsIn partials;
    UintsInOut offsets;
    ArgumentsOut arguments;
    ReportInOut report;
    uint pair_capacity;
    uint pass_capacity; // passes recorded; the cell capacity admits no more
};

void main() {
    uint total;
    if (!scan_tile(partials, offsets, state.state.offset_count, total) || gl_LocalInvocationID.x != 0u) {
        return;
    }
    uint count = min(total, pair_capacity);
    uint overflow = state.state.overflow | (total > pair_capacity ? OVERFLOW_PAIRS : 0u);
    uint tiles = (count + SORT_TILE - 1u) / SORT_TILE;
    state.state.pair_total = total;
    state.state.pair_count = count;
    state.state.kept_count = count; // until the first pass counts
    state.state.overflow = overflow;
    report.report.pair_total = total;
    report.report.overflow = overflow;

    uvec3 runs = split_workgroups((count + PAIRS_EACH - 1u) / PAIRS_EACH, MAP_SIZE);
    arguments.arguments.emit_large = state.state.has_large != 0u ? uvec4(runs, 0u) : uvec4(0u);
    arguments.arguments.cell_ranges = uvec4(split_workgroups((count + RANGE_PAIRS - 1u) / RANGE_PAIRS, MAP_SIZE), 0u);
    for (uint pass = 0u; pass < pass_capacity; ++pass) {
        bool used = pass < state.state.pass_count && count > 0u;
        arguments.arguments.sort[pass] = used ? uvec4(split_workgroups(tiles, SORT_TILES), 0u) : uvec4(0u);
        arguments.arguments.table_scan[pass] = used ? uvec4(split_workgroups(1u << state.state.digit_bits, TABLE_ROWS), 0u) : uvec4(0u);
    }
}
