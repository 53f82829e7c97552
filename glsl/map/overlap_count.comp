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

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer TrianglesOut { vec4 vertex[]; };

layout(push_constant, std430) uniform OverlapCount {
    GridwalkGrid grid;
    FloatsIn positions;
    UintsIn indices;
    TrianglesOut triangles;
    UintsOut counts;
    uint vertex_count;
    uint triangle_count;
};

void main() {
    uint triangle = invocation_index();
    if (triangle > triangle_count) {
        return;
    }
    if (triangle == triangle_count) {
        counts.word[triangle] = 0u;
        return;
    }
    Vertices vertices = gather_triangle(positions, indices, vertex_count, triangle);
    GridHeader header = grid.header;
    uint count = 0u;
    vec3 v0 = vec3(0.0);
    vec3 v1 = vec3(0.0);
    vec3 v2 = vec3(0.0);
    if (!vertices.dropped) {
        v0 = to_frame(header, vertices.v0);
        v1 = to_frame(header, vertices.v1);
        v2 = to_frame(header, vertices.v2);
        CellBox box = triangle_cells(header, v0, v1, v2);
        uvec3 size = box.high - box.low + uvec3(1u);
        count = size.x * size.y * size.z;
    }
    // A dropped triangle counts no cell: its first vertex's fourth component tells it from one that shrank to the origin.
    triangles.vertex[3u * triangle] = vec4(v0, vertices.dropped ? 1.0 : 0.0);
    triangles.vertex[3u * triangle + 1u] = vec4(v1, 0.0);
    triangles.vertex[3u * triangle + 2u] = vec4(v2, 0.0);
    counts.word[triangle] = count;
}
