// Where an invocation stands in a dispatch of more than 65,535 workgroups: the host and the argument kernels split a number of
// workgroups into x <= 65,535 and y, so the last row may hold workgroups beyond the last element.
#ifndef DISPATCH_GLSL
#define DISPATCH_GLSL

const uint MAX_GROUPS_X = 65535u;

uint workgroup_index() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

// A macro, since gl_WorkGroupSize is 1 to a function that stands before the declaration of the size.
#define invocation_index() (workgroup_index() * gl_WorkGroupSize.x + gl_LocalInvocationID.x)

// Workgroups for `count` elements, `size` a workgroup, as arguments of an indirect dispatch.
uvec3 split_workgroups(uint count, uint size) {
    uint groups = count / size + uint(count % size != 0u);
    uint rows = groups / MAX_GROUPS_X + uint(groups % MAX_GROUPS_X != 0u);
    return groups <= MAX_GROUPS_X ? uvec3(groups, 1u, 1u) : uvec3(MAX_GROUPS_X, rows, 1u);
}

#endif
