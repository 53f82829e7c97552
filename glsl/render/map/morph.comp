#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Adds the weighted deltas of morph targets to a mesh. Normals are brought to length one by `skin`, which comes after.

#include "render/shared/motion.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform Morph {
    MotionFloatsIn base_positions;
    MotionFloatsIn base_normals;
    MotionFloatsIn deltas;
    ActiveTargetsIn targets;
    MotionFloatsOut positions;
    MotionFloatsOut normals;
    uint vertex_count;
    uint target_count; // below 32,768
};

// Word `i` of a vertex' deltas, weighted and added.
float moved(float base, uint deltas_begin, uint i, float weight) {
    return deltas_begin == NO_DELTAS ? base : base + deltas.word[deltas_begin + i] * weight;
}

void main() {
    uint vertex = invocation_index();
    if (vertex >= vertex_count) {
        return;
    }
    vec3 position = motion_vec3(base_positions, vertex);
    vec3 normal = motion_vec3(base_normals, vertex);
    uint x = 3u * vertex;
    for (uint i = 0u; i < target_count; ++i) {
        ActiveTarget target = targets.target[i];
        position.x = moved(position.x, target.positions, x, target.weight);
        position.y = moved(position.y, target.positions, x + 1u, target.weight);
        position.z = moved(position.z, target.positions, x + 2u, target.weight);
        normal.x = moved(normal.x, target.normals, x, target.weight);
        normal.y = moved(normal.y, target.normals, x + 1u, target.weight);
        normal.z = moved(normal.z, target.normals, x + 2u, target.weight);
    }
    positions.word[x] = position.x;
    positions.word[x + 1u] = position.y;
    positions.word[x + 2u] = position.z;
    normals.word[x] = normal.x;
    normals.word[x + 1u] = normal.y;
    normals.word[x + 2u] = normal.z;
}
