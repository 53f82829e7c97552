// The exclusive scan of one number an invocation over a workgroup, by saturating addition (which is associative).
#ifndef SCAN_GLSL
#define SCAN_GLSL

#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 256) in;

shared uint workgroup_sum[gl_WorkGroupSize.x];

// Hillis and Steele 1986. `total` is the same in all invocations. Call in uniform flow; a second call needs no barrier in between.
uint workgroup_exclusive_scan(uint mine, out uint total) {
    uint lane = gl_LocalInvocationID.x;
    workgroup_sum[lane] = mine;
    barrier();
    for (uint reach = 1u; reach < gl_WorkGroupSize.x; reach *= 2u) {
        uint before = lane >= reach ? workgroup_sum[lane - reach] : 0u;
        barrier();
        workgroup_sum[lane] = saturating_add(workgroup_sum[lane], before);
        barrier();
    }
    total = workgroup_sum[gl_WorkGroupSize.x - 1u];
    uint result = lane > 0u ? workgroup_sum[lane - 1u] : 0u;
    barrier();
    return result;
}

#endif
