// Boxes united over a workgroup.
#ifndef BOUNDS_GLSL
#define BOUNDS_GLSL

#include "shared/bounds_types.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 256) in;

shared Bounds workgroup_partial[gl_WorkGroupSize.x];

Bounds unite(Bounds a, Bounds b) {
    return Bounds(min(a.low, b.low), a.dropped + b.dropped, max(a.high, b.high), 0u);
}

// The union over the workgroup, in its first invocation. The workgroup size is a power of two.
Bounds workgroup_bounds(Bounds mine) {
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
