#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Copies memory, 16 bytes an invocation: what a kernel can move.

#include "shared/dispatch.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer From { uvec4 word[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer To { uvec4 word[]; };

layout(push_constant, std430) uniform Copy {
    From from;
    To to;
    uint count;
};

void main() {
    uint index = invocation_index();
    if (index < count) {
        to.word[index] = from.word[index];
    }
}
