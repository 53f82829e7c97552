#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The box of a tile of triangles, and how many of them are dropped: first half of the scene box (thesis section 3.1).

#include "shared/bounds.glsl"
#include "shared/gather.glsl"

layout(constant_id = 1) const uint TRIANGLES_EACH = 8;

layout(push_constant, std430) uniform BoundsReduce {
    StateIn state;
    TriangleWordsIn triangles;
    BoundsOut partials;
};

void main() {
    uint triangle_count = state.state.triangle_count;
    uint tile = workgroup_index();
    uint tile_size = gl_WorkGroupSize.x * TRIANGLES_EACH;
    Bounds bounds = empty_bounds();
    for (uint i = 0u; i < TRIANGLES_EACH; ++i) {
        uint triangle = tile * tile_size + i * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (triangle < triangle_count) {
            uvec4 first = triangles.vertex[3u * triangle];
            if ((first.w & TRIANGLE_DROPPED) != 0u) {
                bounds.dropped += 1u;
            } else {
                vec3 v0 = uintBitsToFloat(first.xyz);
                vec3 v1 = uintBitsToFloat(triangles.vertex[3u * triangle + 1u].xyz);
                vec3 v2 = uintBitsToFloat(triangles.vertex[3u * triangle + 2u].xyz);
                bounds.low = min(bounds.low, min(v0, min(v1, v2)));
                bounds.high = max(bounds.high, max(v0, max(v1, v2)));
            }
        }
    }
    bounds = workgroup_bounds(bounds);
    // The last row of workgroups may hold tiles beyond the last triangle.
    if (gl_LocalInvocationID.x == 0u && tile * tile_size < max(triangle_count, 1u)) {
        partials.bounds[tile] = bounds;
    }
}
