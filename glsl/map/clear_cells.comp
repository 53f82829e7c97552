#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Empties the cells in use: one invocation, eight of them.

#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer CellsOut { uvec4 pair[]; };

layout(push_constant, std430) uniform ClearCells {
    GridwalkGrid grid;
    CellsOut cells;
};

// configure counts on it; the cells' memory is rounded up to it.
const uint CELLS_EACH = 8u;

void main() {
    uint first = invocation_index() * CELLS_EACH;
    if (first >= grid.header.cell_count) {
        return;
    }
    for (uint i = 0u; i < CELLS_EACH / 2u; ++i) {
        cells.pair[first / 2u + i] = uvec4(0u);
    }
}
