// Input triangles, as the caller has them.
#ifndef GATHER_GLSL
#define GATHER_GLSL

#include "shared/build.glsl"
#include "shared/intersect.glsl"

struct Vertices {
    vec3 v0;
    vec3 v1;
    vec3 v2;
    bool dropped; // a vertex is not finite, or its index lies outside of the positions
};

vec3 position(FloatsIn positions, uint vertex) {
    return vec3(positions.word[3u * vertex], positions.word[3u * vertex + 1u], positions.word[3u * vertex + 2u]);
}

Vertices gather_triangle(FloatsIn positions, UintsIn indices, uint vertex_count, uint triangle) {
    uvec3 vertex = uvec3(indices.word[3u * triangle], indices.word[3u * triangle + 1u], indices.word[3u * triangle + 2u]);
    Vertices result = Vertices(vec3(0.0), vec3(0.0), vec3(0.0), true);
    result.dropped = any(greaterThanEqual(vertex, uvec3(vertex_count)));
    if (result.dropped) {
        return result;
    }
    result.v0 = position(positions, vertex.x);
    result.v1 = position(positions, vertex.y);
    result.v2 = position(positions, vertex.z);
    result.dropped = !(is_finite(result.v0) && is_finite(result.v1) && is_finite(result.v2));
    return result;
}

#endif
