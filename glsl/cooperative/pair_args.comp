#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Scans the counts of pairs, and turns the number of all into the sizes of the steps that follow.

#include "shared/offsets.glsl"
#include "shared/sort_arguments.glsl"

layout(constant_id = 7) const uint PAIRS_EACH = 16;

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
    state.state.pair_total = total;
    state.state.pair_count = count;
    state.state.kept_count = count; // until the first pass counts
    state.state.overflow = overflow;
    report.report.pair_total = total;
    report.report.overflow = overflow;

    uvec3 runs = deal_workgroups((count + PAIRS_EACH - 1u) / PAIRS_EACH, MAP_SIZE);
    arguments.arguments.emit_large = state.state.has_large != 0u ? uvec4(runs, 0u) : uvec4(0u);
    arguments.arguments.cell_ranges = range_groups(count);
    for (uint pass = 0u; pass < pass_capacity; ++pass) {
        uint sorted = pass < state.state.pass_count ? count : 0u;
        arguments.arguments.sort[pass] = sort_groups(sorted);
        arguments.arguments.table_scan[pass] = table_groups(sorted, state.state.digit_bits);
    }
}
