// Compaction in order: flags are summed by blocks (reduce), the sums of the blocks are scanned (spine), and each block is scanned from its
// sum on (downsweep). Reduce-then-scan needs no forward progress between workgroups.
#ifndef RENDER_FLAGS_GLSL
#define RENDER_FLAGS_GLSL

#include "render/shared/queue.glsl"

const uint FLAG_INVOCATIONS = 256u;
const uint FLAGS_EACH = 8u;
const uint FLAG_BLOCK = FLAG_INVOCATIONS * FLAGS_EACH;

shared uint sums_shared[FLAG_INVOCATIONS];

// Exclusive prefix over the workgroup of one value an invocation; `total` is the sum of all. In workgroup-uniform flow only.
uint workgroup_prefix(uint value, out uint total) {
    uint lane = gl_LocalInvocationID.x;
    sums_shared[lane] = value;
    barrier();
    for (uint step = 1u; step < FLAG_INVOCATIONS; step *= 2u) {
        uint earlier = lane >= step ? sums_shared[lane - step] : 0u;
        barrier();
        sums_shared[lane] += earlier;
        barrier();
    }
    total = sums_shared[FLAG_INVOCATIONS - 1u];
    uint inclusive = sums_shared[lane];
    barrier();
    return inclusive - value;
}

#endif
