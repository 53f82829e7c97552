#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The closest hit of each ray among all triangles of a range, without a grid's cells: the oracle that the walk is compared with. The best
// hit of the ranges before lies in the walks; the last range writes the hits.

#include "shared/dispatch.glsl"
#include "shared/trace_types.glsl"
#include "shared/walk.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform BruteForce {
    GridwalkGrid grid;
    RaysIn rays;
    HitsOut hits;
    WalkStatesInOut walks;
    uint ray_count;
    uint first;
    uint end; // at most first + 32,768
    uint last; // 1: no range follows
};

void main() {
    uint index = invocation_index();
    if (index >= ray_count) {
        return;
    }
    Ray ray = rays.ray[index];
    GridHeader header = grid.header;
    MovedRay moved = move_ray(ray, header);
    Hit hit = Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    if (moved.valid) {
        Walk walk;
        walk.ray = moved;
        walk.best_s = moved.s_max;
        walk.best_u = 0.0;
        walk.best_v = 0.0;
        walk.best_triangle = GRIDWALK_MISS;
        if (first > 0u) {
            WalkState saved = walks.walk[index];
            walk_commit(walk, saved.best_s, saved.best_u, saved.best_v, saved.best_triangle);
        }
        for (uint triangle = first; triangle < end; ++triangle) {
            float s;
            float u;
            float v;
            if (walk_test(walk, header, 3u * triangle, s, u, v)) {
                walk_commit(walk, s, u, v, triangle);
            }
        }
        walks.walk[index] = WalkState(0u, 0u, 0u, 0.0, walk.best_s, walk.best_u, walk.best_v, walk.best_triangle);
        if (walk.best_triangle != GRIDWALK_MISS) {
            hit = Hit(hit_distance(moved, ray, walk.best_s), walk.best_u, walk.best_v, walk.best_triangle);
        }
    }
    if (last != 0u) {
        hits.hit[index] = hit;
    }
}
