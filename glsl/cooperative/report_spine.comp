#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One workgroup completes the report.

#include "shared/occupancy.glsl"

layout(constant_id = 1) const uint REPORT_TILE = 4096;

layout(push_constant, std430) uniform ReportSpine {
    GridwalkGrid grid;
    OccupancyIn partials;
    ReportOut report;
};

void main() {
    uint count = (grid.header.cell_count + REPORT_TILE - 1u) / REPORT_TILE;
    uvec2 occupancy = uvec2(0u);
    for (uint i = gl_LocalInvocationID.x; i < count; i += gl_WorkGroupSize.x) {
        occupancy = unite(occupancy, partials.occupancy[i]);
    }
    occupancy = workgroup_occupancy(occupancy);
    if (gl_LocalInvocationID.x == 0u) {
        report.report.cells_in_use = occupancy.x;
        report.report.longest_list = occupancy.y;
    }
}
