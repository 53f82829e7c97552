#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Vertex colours between two key-frames, a word an invocation. At weight 0 they are the first's, bit for bit; a key-frame without colours
// is white.

#include "render/shared/motion.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform InterpolateColours {
    MotionWordsIn first_colours;
    MotionWordsIn second_colours;
    MotionWordsOut colours;
    uint word_count;
    float weight;
    uint has_colours;
    uint padding;
};

void main() {
    uint i = invocation_index();
    if (i >= word_count) {
        return;
    }
    if (has_colours == 0u) {
        colours.word[i] = floatBitsToUint(1.0);
        return;
    }
    colours.word[i] = weight == 0.0 ? first_colours.word[i] : between(first_colours.word[i], second_colours.word[i], weight);
}
