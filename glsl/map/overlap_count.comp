#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Brings a triangle into the grid's frame and counts the cells that its box overlaps. The entry after the last triangle is zero, so that
// the scan leaves the total there.

#include "shared/gather.glsl"
#include "shared/overlap.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform OverlapCount {
    GridwalkGrid grid;
    StateIn state;
    TriangleWordsInOut triangles;
    UintsOut counts;
};

void main() {
    uint triangle = invocation_index();
    uint triangle_count = state.state.triangle_count;
    if (triangle > triangle_count) {
        return;
    }
    if (triangle == triangle_count) {
        counts.word[triangle] = 0u;
        return;
    }
    uvec4 first = triangles.vertex[3u * triangle];
    uint count = 0u;
    if ((first.w & TRIANGLE_DROPPED) == 0u) {
        GridHeader header = grid.header;
        uvec4 second = triangles.vertex[3u * triangle + 1u];
        uvec4 third = triangles.vertex[3u * triangle + 2u];
        vec3 v0 = to_frame(header, uintBitsToFloat(first.xyz));
        vec3 v1 = to_frame(header, uintBitsToFloat(second.xyz));
        vec3 v2 = to_frame(header, uintBitsToFloat(third.xyz));
        CellBox box = triangle_cells(header, v0, v1, v2);
        uvec3 size = box.high - box.low + uvec3(1u);
        count = size.x * size.y * size.z;
        triangles.vertex[3u * triangle] = uvec4(floatBitsToUint(v0), first.w);
        triangles.vertex[3u * triangle + 1u] = uvec4(floatBitsToUint(v1), second.w);
        triangles.vertex[3u * triangle + 2u] = uvec4(floatBitsToUint(v2), third.w);
    }
    counts.word[triangle] = count;
}
