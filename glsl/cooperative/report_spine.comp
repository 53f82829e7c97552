#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One workgroup completes the report.

#include "shared/occupancy.glsl"

layout(constant_id = 1) const uint BRICK_TILE = 1024;

layout(push_constant, std430) uniform ReportSpine {
    GridwalkGrid grid;
    OccupancyIn partials;
    ReportOut report;
};

void main() {
    uvec3 bricks_along = brick_resolution(grid.header.resolution);
    uint count = (bricks_along.x * bricks_along.y * bricks_along.z + BRICK_TILE - 1u) / BRICK_TILE;
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
