#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The box of a tile of triangles, and how many of them are dropped: first half of the scene box (thesis section 3.1).

#include "shared/bounds.glsl"
#include "shared/gather.glsl"

layout(constant_id = 1) const uint TRIANGLES_EACH = 8;

layout(push_constant, std430) uniform BoundsReduce {
    FloatsIn positions;
    UintsIn indices;
    BoundsOut partials;
    uint vertex_count;
    uint triangle_count;
};

void main() {
    uint tile = workgroup_index();
    uint tile_size = gl_WorkGroupSize.x * TRIANGLES_EACH;
    Bounds bounds = empty_bounds();
    for (uint i = 0u; i < TRIANGLES_EACH; ++i) {
        uint triangle = tile * tile_size + i * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (triangle < triangle_count) {
            Vertices vertices = gather_triangle(positions, indices, vertex_count, triangle);
            if (vertices.dropped) {
                bounds.dropped += 1u;
            } else {
                bounds.low = min(bounds.low, min(vertices.v0, min(vertices.v1, vertices.v2)));
                bounds.high = max(bounds.high, max(vertices.v0, max(vertices.v1, vertices.v2)));
            }
        }
    }
    bounds = workgroup_bounds(bounds);
    // The last row of workgroups may hold tiles beyond the last triangle.
    if (gl_LocalInvocationID.x == 0u && tile * tile_size < max(triangle_count, 1u)) {
        partials.bounds[tile] = bounds;
    }
}
