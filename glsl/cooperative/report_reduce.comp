#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Cells in use and longest list of a tile of cells.

#include "shared/occupancy.glsl"

layout(constant_id = 1) const uint CELLS_EACH = 16;

layout(push_constant, std430) uniform ReportReduce {
    GridwalkGrid grid;
    Cells cells;
    OccupancyOut partials;
};

void main() {
    uint tile = workgroup_index();
    uint cell_count = grid.header.cell_count;
    uint first = tile * gl_WorkGroupSize.x * CELLS_EACH;
    uvec2 occupancy = uvec2(0u);
    for (uint i = 0u; i < CELLS_EACH; ++i) {
        uint cell = first + i * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (cell < cell_count) {
            uvec2 range = cells.range[cell];
            occupancy = unite(occupancy, uvec2(uint(range.x != range.y), range.y - range.x));
        }
    }
    occupancy = workgroup_occupancy(occupancy);
    if (gl_LocalInvocationID.x == 0u && first < cell_count) {
        partials.occupancy[tile] = occupancy;
    }
}
