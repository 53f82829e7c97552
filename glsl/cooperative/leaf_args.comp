#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Scans the counts of the second level's pairs, and turns the number of all into the sizes of the steps that follow. If they do not fit, no
// cell is split.

#include "shared/leaf_arguments.glsl"
#include "shared/offsets.glsl"
#include "shared/split.glsl"

layout(constant_id = 7) const uint SPLIT_CELLS_EACH = 1; // split cells a workgroup of leaf_distance
layout(constant_id = 8) const uint SORT_SIZE = 8; // invocations a workgroup of leaf_sort
layout(constant_id = 9) const uint LEAF_RUN = 0; // work of an invocation of leaf_sort; 0: all pairs are sorted together

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

    write_sort(arguments, LEAF_RUN == 0u ? count : 0u, state.state.pass_count, state.state.digit_bits, pass_capacity);
    arguments.arguments.emit_large = uvec4(0u);
    arguments.arguments.leaf_sort = uvec4(0u);
    if (LEAF_RUN != 0u && count > 0u) {
        arguments.arguments.emit_large = arguments.arguments.count;
        // No more than the whole of the work, as leaf_sort reckons it.
        uint work = count + 2u * (state.state.offset_count - 1u) + report.report.leaf_cells / 8u;
        arguments.arguments.leaf_sort = uvec4(split_workgroups(work / LEAF_RUN + 1u, SORT_SIZE), 0u);
    }
    // Only where some cell is split that far.
    bool measured = leaf_level(report.report.longest_list, state.state.least_split, MAX_LEVEL) >= LEAST_MEASURED;
    arguments.arguments.distance = count > 0u && measured ? uvec4(split_workgroups(state.state.split_cells, SPLIT_CELLS_EACH), 0u) : uvec4(0u);
}
