#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_ray_query : require

// Rays through an acceleration structure of the driver's own: one run of 64 of every so many in memory, answered side by side.

#include "shared/dispatch.glsl"
#include "shared/trace_types.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;
layout(constant_id = 1) const bool ANY = false; // the first hit ends the search, and is a hit at 0 of triangle 0

// Host twin: contender::RUN.
const uint RUN = 64u;

layout(push_constant, std430) uniform RayQuery {
    uvec2 structure;
    RaysIn rays;
    HitsOut hits;
    uint first; // answer
    uint count; // of answers
    uint stride; // of runs: the n-th run of answers is that of the run n * stride of rays
};

void main() {
    uint index = invocation_index();
    if (index >= count) {
        return;
    }
    index += first;
    Ray ray = rays.ray[index / RUN * RUN * stride + index % RUN];
    uint flags = ANY ? (gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT) : gl_RayFlagsOpaqueEXT;
    rayQueryEXT query;
    rayQueryInitializeEXT(query, accelerationStructureEXT(structure), flags, 0xFFu, ray.origin, ray.t_min, ray.direction, ray.t_max);
    while (rayQueryProceedEXT(query)) {
    }
    Hit hit = Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionTriangleEXT) {
        vec2 uv = rayQueryGetIntersectionBarycentricsEXT(query, true);
        float t = rayQueryGetIntersectionTEXT(query, true);
        hit = ANY ? Hit(0.0, 0.0, 0.0, 0u) : Hit(t, uv.x, uv.y, uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, true)));
    }
    hits.hit[index] = hit;
}
