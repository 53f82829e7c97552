#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Sums the flags of each block.

#include "render/shared/flags.glsl"

layout(local_size_x = 256) in;

layout(push_constant, std430) uniform FlagReduce {
    QueueIn queue;
    WordsIn flags;
    WordsOut sums;
};

void main() {
    uint block = workgroup_index();
    uint count = queue.header.count;
    if (block * FLAG_BLOCK >= count) {
        return;
    }
    uint value = 0u;
    for (uint k = 0u; k < FLAGS_EACH; ++k) {
        uint i = block * FLAG_BLOCK + k * FLAG_INVOCATIONS + gl_LocalInvocationID.x;
        value += i < count ? flags.word[i] : 0u;
    }
    uint total;
    workgroup_prefix(value, total);
    if (gl_LocalInvocationID.x == 0u) {
        sums.word[block] = total;
    }
}
