// Triangles as a build first writes them: in input coordinates, by rows (see shared/grid.glsl).
#ifndef GATHER_GLSL
#define GATHER_GLSL

#include "shared/bounds_types.glsl"
#include "shared/build.glsl"
#include "shared/intersect.glsl"

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer TriangleWordsOut { uvec4 row[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer TriangleWordsInOut { uvec4 row[]; };

// What of a triangle is the same for all of its geometry.
struct TriangleWords {
    uint flags; // TRIANGLE_* bits, and the triangle's number in its geometry
    uint id; // of the geometry
    uint mask;
};

// A triangle with a vertex that is not finite is dropped: it stays in its place, all zero, and no cell lists it. Any other is in `bounds`.
void write_triangle(TriangleWordsOut triangles, uint triangle, vec3 v0, vec3 v1, vec3 v2, bool is_whole, TriangleWords words,
                    inout Bounds bounds) {
    bool dropped = !(is_whole && is_finite(v0) && is_finite(v1) && is_finite(v2));
    uint flags = words.flags | (dropped ? TRIANGLE_DROPPED : 0u);
    triangles.row[3u * triangle] = uvec4(dropped ? uvec3(0u) : floatBitsToUint(vec3(v0.x, v1.x, v2.x)), flags);
    triangles.row[3u * triangle + 1u] = uvec4(dropped ? uvec3(0u) : floatBitsToUint(vec3(v0.y, v1.y, v2.y)), words.id);
    triangles.row[3u * triangle + 2u] = uvec4(dropped ? uvec3(0u) : floatBitsToUint(vec3(v0.z, v1.z, v2.z)), words.mask);
    if (dropped) {
        bounds.dropped += 1u;
    } else {
        bounds.low = min(bounds.low, min(v0, min(v1, v2)));
        bounds.high = max(bounds.high, max(v0, max(v1, v2)));
    }
}

// The head of a build's state, from which all later steps take the number of triangles.
BuildState gathered_state(uint triangle_count, uint triangle_total) {
    uint overflow = triangle_total > triangle_count ? OVERFLOW_TRIANGLES : 0u;
    return BuildState(triangle_count, triangle_count + 1u, 0u, 0u, 0u, 0u, overflow, triangle_total, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
}

#endif
