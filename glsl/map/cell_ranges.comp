#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Where each cell's list begins and ends in the sorted pairs (thesis Figure 3.3); of the second level, by its state, each leaf cell's.
// An invocation takes a run of pairs, and writes the boundaries behind each of them: a key is loaded once, and once more for the run before.

#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;
layout(constant_id = 1) const uint RANGE_PAIRS = 1;

layout(push_constant, std430) uniform CellRanges {
    StateIn state;
    UintsIn keys;
    UintsOut cells;
    ReportOut report;
};

void main() {
    uint begin = invocation_index() * RANGE_PAIRS;
    uint pair_count = state.state.kept_count;
    uint first = state.state.first_pair;
    uint first_cell = state.state.first_cell;
    if (begin >= pair_count) {
        return;
    }
    uint end = min(begin + RANGE_PAIRS, pair_count);
    uint key = keys.word[first + begin];
    if (begin == 0u) {
        cells.word[2u * (first_cell + key)] = first;
    }
    for (uint pair = begin + 1u; pair <= end; ++pair) {
        // No key is that large.
        uint next = pair < pair_count ? keys.word[first + pair] : SATURATED;
        if (next != key) {
            cells.word[2u * (first_cell + key) + 1u] = first + pair;
            if (next != SATURATED) {
                cells.word[2u * (first_cell + next)] = first + pair;
            }
        }
        key = next;
    }
    if (key == SATURATED && first_cell == 0u) {
        report.report.pairs = pair_count;
    }
}
