// Traces from a shader of the user's own, through the include as it is published, where no two neighbours do the same: some leave at once,
// the others make one to five rounds, each of another kind of query, and each ray goes on beyond the last hit.
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require

#include "gridwalk.glsl"

layout(local_size_x = 64) in;

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Rays { Ray of[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer Words { uvec4 of[]; };

layout(push_constant, std430) uniform Divergent {
    uvec2 grid;
    Rays rays;
    Words hits; // five a ray
    uint count;
};

// An alpha test: which triangles this ray passes through.
bool is_opaque(uint index, uint triangle) { return ((index + triangle) & 3u) != 0u; }

Hit closest_opaque(uint index, Ray ray) {
    GridwalkCandidates candidates = gridwalk_candidates(GridwalkGrid(grid), ray);
    while (gridwalk_next(candidates)) {
        if (is_opaque(index, candidates.hit.triangle)) {
            gridwalk_commit(candidates);
        }
    }
    return gridwalk_committed(candidates);
}

// Ends at the third candidate, opaque or not: what has been committed until then.
Hit of_three(uint index, Ray ray) {
    GridwalkCandidates candidates = gridwalk_candidates_filtered(GridwalkGrid(grid), ray, 11u, GRIDWALK_CULL_BACK);
    uint seen = 0u;
    while (gridwalk_next(candidates)) {
        seen += 1u;
        if (is_opaque(index, candidates.hit.triangle)) {
            gridwalk_commit(candidates);
        }
        if (seen == 3u) {
            gridwalk_terminate(candidates);
        }
    }
    return gridwalk_committed(candidates);
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= count || index % 7u == 6u) {
        return;
    }
    Ray ray = rays.of[index];
    for (uint turn = 0u; turn <= index % 5u; ++turn) {
        Hit hit;
        switch ((index + turn) & 3u) {
            case 0u:
                hit = gridwalk_closest_hit(GridwalkGrid(grid), ray);
                break;
            case 1u:
                hit = gridwalk_any_hit(GridwalkGrid(grid), ray);
                break;
            case 2u:
                hit = closest_opaque(index, ray);
                break;
            default:
                hit = of_three(index, ray);
        }
        uvec2 beside = uvec2(floatBitsToUint(hit.u), floatBitsToUint(hit.v));
        // The id and the number of the hit's geometry take the place of its weights in every other round.
        if (gridwalk_is_hit(hit) && (turn & 1u) == 1u) {
            beside = gridwalk_geometry(GridwalkGrid(grid), hit.triangle);
        }
        hits.of[5u * index + turn] = uvec4(floatBitsToUint(hit.t), beside, hit.triangle);
        if (!gridwalk_is_hit(hit)) {
            break;
        }
        ray.t_min = hit.t + 0.0009765625;
    }
}
