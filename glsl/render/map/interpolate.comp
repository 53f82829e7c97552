#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Vertices between two key-frames, on the straight line from one to the other. At weight 0 they are the first's, bit for bit.

#include "render/shared/motion.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform Interpolate {
    MotionWordsIn first_positions;
    MotionWordsIn first_normals;
    MotionWordsIn first_uvs;
    MotionWordsIn second_positions;
    MotionWordsIn second_normals;
    MotionWordsIn second_uvs;
    MotionWordsOut positions;
    MotionWordsOut normals;
    MotionWordsOut uvs;
    uint vertex_count;
    float weight;
};

void main() {
    uint vertex = invocation_index();
    if (vertex >= vertex_count) {
        return;
    }
    if (weight == 0.0) {
        for (uint i = 3u * vertex; i < 3u * vertex + 3u; ++i) {
            positions.word[i] = first_positions.word[i];
            normals.word[i] = first_normals.word[i];
        }
        for (uint i = 2u * vertex; i < 2u * vertex + 2u; ++i) {
            uvs.word[i] = first_uvs.word[i];
        }
        return;
    }
    for (uint i = 3u * vertex; i < 3u * vertex + 3u; ++i) {
        positions.word[i] = between(first_positions.word[i], second_positions.word[i], weight);
    }
    for (uint i = 2u * vertex; i < 2u * vertex + 2u; ++i) {
        uvs.word[i] = between(first_uvs.word[i], second_uvs.word[i], weight);
    }
    uint x = 3u * vertex;
    vec3 normal = renormalised(vec3(
        uintBitsToFloat(between(first_normals.word[x], second_normals.word[x], weight)),
        uintBitsToFloat(between(first_normals.word[x + 1u], second_normals.word[x + 1u], weight)),
        uintBitsToFloat(between(first_normals.word[x + 2u], second_normals.word[x + 2u], weight))
    ));
    normals.word[x] = floatBitsToUint(normal.x);
    normals.word[x + 1u] = floatBitsToUint(normal.y);
    normals.word[x + 2u] = floatBitsToUint(normal.z);
}
