#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Triangles of one tightly packed mesh, and the box of each tile of them, with how many are dropped: first half of the scene box (thesis
// section 3.1). The first invocation begins the build's state.

#include "shared/bounds.glsl"
#include "shared/gather.glsl"

layout(constant_id = 1) const uint TRIANGLES_EACH = 8;

layout(push_constant, std430) uniform Gather {
    FloatsIn positions;
    UintsIn indices;
    TriangleWordsOut triangles;
    StateOut state;
    BoundsOut partials;
    uint vertex_count;
    uint triangle_count;
};

vec3 position(uint vertex) {
    return vec3(positions.word[3u * vertex], positions.word[3u * vertex + 1u], positions.word[3u * vertex + 2u]);
}

void gather(uint triangle, inout Bounds bounds) {
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
    write_triangle(triangles, triangle, v0, v1, v2, is_whole, TriangleWords(triangle, 0u, 0xFFFFFFFFu), bounds);
}

void main() {
    uint tile = workgroup_index();
    uint first = tile * gl_WorkGroupSize.x * TRIANGLES_EACH;
    if (tile == 0u && gl_LocalInvocationID.x == 0u) {
        state.state = gathered_state(triangle_count, triangle_count);
    }
    Bounds bounds = empty_bounds();
    for (uint i = 0u; i < TRIANGLES_EACH; ++i) {
        uint triangle = first + i * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (triangle < triangle_count) {
            gather(triangle, bounds);
        }
    }
    bounds = workgroup_bounds(bounds);
    // The last row of workgroups may hold tiles beyond the last triangle.
    if (gl_LocalInvocationID.x == 0u && first < max(triangle_count, 1u)) {
        partials.bounds[tile] = bounds;
    }
}
