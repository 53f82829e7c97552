// Numbers of the report that are reduced over all cells.
#ifndef OCCUPANCY_GLSL
#define OCCUPANCY_GLSL

#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 256) in;

// x: cells in use, y: length of the longest list.
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer OccupancyIn { uvec2 occupancy[]; };
layout(buffer_reference, std430, buffer_reference_align = 8) writeonly buffer OccupancyOut { uvec2 occupancy[]; };

shared uvec2 workgroup_partial[gl_WorkGroupSize.x];

uvec2 unite(uvec2 a, uvec2 b) { return uvec2(a.x + b.x, max(a.y, b.y)); }

// Over the workgroup, in all invocations. The workgroup size is a power of two.
uvec2 workgroup_occupancy(uvec2 mine) {
    uint lane = gl_LocalInvocationID.x;
    workgroup_partial[lane] = mine;
    barrier();
    for (uint reach = gl_WorkGroupSize.x / 2u; reach > 0u; reach /= 2u) {
        if (lane < reach) {
            workgroup_partial[lane] = unite(workgroup_partial[lane], workgroup_partial[lane + reach]);
        }
        barrier();
    }
    return workgroup_partial[0];
}

#endif
