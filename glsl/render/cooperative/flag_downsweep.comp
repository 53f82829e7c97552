#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Every flag's place among the set ones before it.

#include "render/shared/flags.glsl"

layout(local_size_x = 256) in;

layout(push_constant, std430) uniform FlagDownsweep {
    QueueIn queue;
    WordsIn flags;
    WordsIn sums;
    WordsOut offsets;
};

void main() {
    uint block = workgroup_index();
    uint count = queue.header.count;
    if (block * FLAG_BLOCK >= count) {
        return;
    }
    uint first = block * FLAG_BLOCK + gl_LocalInvocationID.x * FLAGS_EACH;
    uint value[FLAGS_EACH];
    uint sum = 0u;
    for (uint k = 0u; k < FLAGS_EACH; ++k) {
        value[k] = first + k < count ? flags.word[first + k] : 0u;
        sum += value[k];
    }
    uint total;
    uint place = sums.word[block] + workgroup_prefix(sum, total);
    for (uint k = 0u; k < FLAGS_EACH; ++k) {
        if (first + k < count) {
            offsets.word[first + k] = place;
        }
        place += value[k];
    }
}
