#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Where each cell's list begins and ends in the sorted pairs (thesis Figure 3.3); of the second level, by its state, each leaf cell's.

#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform CellRanges {
    StateIn state;
    UintsIn keys;
    UintsOut cells;
    ReportOut report;
};

void main() {
    uint pair = invocation_index();
    uint pair_count = state.state.kept_count;
    if (pair >= pair_count) {
        return;
    }
    uint first = state.state.first_pair;
    uint first_cell = state.state.first_cell;
    uint key = keys.word[first + pair];
    if (pair == 0u || keys.word[first + pair - 1u] != key) {
        cells.word[2u * (first_cell + key)] = first + pair;
    }
    // No key is that large.
    uint next = pair + 1u < pair_count ? keys.word[first + pair + 1u] : SATURATED;
    if (next != key) {
        cells.word[2u * (first_cell + key) + 1u] = first + pair + 1u;
    }
    if (next == SATURATED && first_cell == 0u) {
        report.report.pairs = pair + 1u;
    }
}
