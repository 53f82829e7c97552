// Where an invocation stands in a dispatch: along x, then y, then z, unless elements are dealt.
#ifndef DISPATCH_GLSL
#define DISPATCH_GLSL

const uint MAX_GROUPS_X = 65535u;

uint workgroup_index() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.z + gl_WorkGroupID.z) * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

// A macro, since gl_WorkGroupSize is 1 to a function that stands before the declaration of the size.
#define invocation_index() (workgroup_index() * gl_WorkGroupSize.x + gl_LocalInvocationID.x)

// Workgroups for `count` elements, `size` a workgroup, as arguments of an indirect dispatch: at most 65,535 along x, the rest along y. The last
// row may hold workgroups beyond the last element.
uvec3 split_workgroups(uint count, uint size) {
    uint groups = count / size + uint(count % size != 0u);
    uint rows = groups / MAX_GROUPS_X + uint(groups % MAX_GROUPS_X != 0u);
    return groups <= MAX_GROUPS_X ? uvec3(groups, 1u, 1u) : uvec3(MAX_GROUPS_X, rows, 1u);
}

layout(constant_id = 20) const uint STRANDS = 1;
// Blocks that a strand is dealt, at most where workgroups along x admit it; and workgroups of a block, at least where there are as many.
const uint ROUNDS = 64u;
const uint BLOCK = 4u;

// The same for elements that cost unlike: rays into the sky, rays into leaves. Drivers that run on a CPU give each of their threads one run of
// consecutive workgroups, and wait for the last. So each z is a thread's there, to which blocks of workgroups, x long, are dealt in y rounds.
// With a single strand it is as above.
uvec3 deal_workgroups(uint count, uint size) {
    if (STRANDS == 1u) {
        return split_workgroups(count, size);
    }
    uint groups = count / size + uint(count % size != 0u);
    uint each = groups / STRANDS + uint(groups % STRANDS != 0u);
    uint rounds = max(min((each + BLOCK - 1u) / BLOCK, ROUNDS), (each + MAX_GROUPS_X - 1u) / MAX_GROUPS_X);
    return uvec3(each == 0u ? 0u : (each + rounds - 1u) / rounds, max(rounds, 1u), STRANDS);
}

#endif
