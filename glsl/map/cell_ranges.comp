#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Where each cell's list begins and ends in the sorted pairs (thesis Figure 3.3).

#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform CellRanges {
    GridwalkGrid grid;
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
    uint none = grid.header.cell_count;
    uint key = keys.word[pair];
    if (pair == 0u || keys.word[pair - 1u] != key) {
        cells.word[2u * key] = pair;
    }
    uint next = pair + 1u < pair_count ? keys.word[pair + 1u] : none;
    if (next != key) {
        cells.word[2u * key + 1u] = pair + 1u;
    }
    if (next == none) {
        report.report.pairs = pair + 1u;
    }
}
