#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Scans the counts of the second level's pairs, and turns the number of all into the sizes of the steps that follow. If they do not fit, no
// cell is split.

#include "shared/offsets.glsl"
#include "shared/split.glsl"

layout(constant_id = 2) const uint MAP_SIZE = 64;
layout(constant_id = 3) const uint SORT_TILE = 8192;
layout(constant_id = 4) const uint SORT_TILES = 1; // tiles a workgroup of the sort
layout(constant_id = 5) const uint SPLIT_CELLS_EACH = 1; // split cells a workgroup of leaf_distance
layout(constant_id = 6) const uint RANGE_PAIRS = 1; // pairs an invocation of cell_ranges
layout(constant_id = 7) const uint TABLE_ROWS = 1; // rows of the digit table a workgroup of table_scan

layout(push_constant, std430) uniform LeafArgs {
    StateInOut state; // of the second level
    UintsIn partials;
    UintsInOut offsets;
    LeafArgumentsInOut arguments;
    ReportInOut report;
    uint pair_capacity;
    uint pass_capacity; // passes recorded; the capacity of leaf cells admits no more
};

void main() {
    uint total;
    if (!scan_tile(partials, offsets, state.state.offset_count, total) || gl_LocalInvocationID.x != 0u) {
        return;
    }
    if (state.state.split_cells == 0u) {
        total = 0u; // nothing was counted
    }
    bool fits = total <= pair_capacity - state.state.first_pair;
    uint count = fits ? total : 0u;
    uint tiles = (count + SORT_TILE - 1u) / SORT_TILE;
    state.state.pair_total = total;
    state.state.pair_count = count;
    state.state.kept_count = count;
    if (!fits) {
        // Where pairs of the first level are missing, those are what room is needed for first.
        if ((report.report.overflow & OVERFLOW_PAIRS) == 0u) {
            report.report.pair_total = max(report.report.pair_total, saturating_add(state.state.first_pair, total));
        }
        report.report.overflow |= OVERFLOW_LEAVES;
    }
    report.report.leaf_pairs = count;

    arguments.arguments.emit = count > 0u ? arguments.arguments.count : uvec4(0u);
    arguments.arguments.cell_ranges = uvec4(split_workgroups((count + RANGE_PAIRS - 1u) / RANGE_PAIRS, MAP_SIZE), 0u);
    // Only where some cell is split that far.
    bool measured = leaf_level(report.report.longest_list, state.state.least_split, MAX_LEVEL) >= LEAST_MEASURED;
    arguments.arguments.distance = count > 0u && measured ? uvec4(split_workgroups(state.state.split_cells, SPLIT_CELLS_EACH), 0u) : uvec4(0u);
    for (uint pass = 0u; pass < pass_capacity; ++pass) {
        bool used = pass < state.state.pass_count && count > 0u;
        arguments.arguments.sort[pass] = used ? uvec4(split_workgroups(tiles, SORT_TILES), 0u) : uvec4(0u);
        arguments.arguments.table_scan[pass] = used ? uvec4(split_workgroups(1u << state.state.digit_bits, TABLE_ROWS), 0u) : uvec4(0u);
    }
}
