#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// One workgroup turns the sums of the blocks into their prefixes, and their total into the header of the next queue.

#include "render/shared/flags.glsl"

layout(local_size_x = 256) in;

const uint MAP_WORKGROUP = 64u;

layout(push_constant, std430) uniform FlagSpine {
    QueueIn queue;
    WordsInOut sums;
    QueueOut next;
};

void main() {
    uint blocks = (queue.header.count + FLAG_BLOCK - 1u) / FLAG_BLOCK;
    uint before = 0u;
    for (uint first = 0u; first < blocks; first += FLAG_INVOCATIONS) {
        uint i = first + gl_LocalInvocationID.x;
        uint total;
        uint prefix = workgroup_prefix(i < blocks ? sums.word[i] : 0u, total);
        if (i < blocks) {
            sums.word[i] = before + prefix;
        }
        before += total;
    }
    if (gl_LocalInvocationID.x == 0u) {
        uvec3 groups = deal_workgroups(before, MAP_WORKGROUP);
        next.header.count = before;
        next.header.groups_x = groups.x;
        next.header.groups_y = groups.y;
        next.header.groups_z = groups.z;
    }
}
