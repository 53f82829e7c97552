#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Triangles of one tightly packed mesh, one an invocation; the first invocation begins the build's state.

#include "shared/gather.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform Gather {
    FloatsIn positions;
    UintsIn indices;
    TriangleWordsOut triangles;
    StateOut state;
    uint vertex_count;
    uint triangle_count;
};

vec3 position(uint vertex) {
    return vec3(positions.word[3u * vertex], positions.word[3u * vertex + 1u], positions.word[3u * vertex + 2u]);
}

void main() {
    uint triangle = invocation_index();
    if (triangle == 0u) {
        state.state = gathered_state(triangle_count, triangle_count);
    }
    if (triangle >= triangle_count) {
        return;
    }
    uvec3 vertex = uvec3(indices.word[3u * triangle], indices.word[3u * triangle + 1u], indices.word[3u * triangle + 2u]);
    bool is_whole = all(lessThan(vertex, uvec3(vertex_count)));
    vec3 v0 = vec3(0.0);
    vec3 v1 = vec3(0.0);
    vec3 v2 = vec3(0.0);
    if (is_whole) {
        v0 = position(vertex.x);
        v1 = position(vertex.y);
        v2 = position(vertex.z);
    }
    write_triangle(triangles, triangle, v0, v1, v2, is_whole, TriangleWords(triangle, 0u, 0xFFFFFFFFu));
}
