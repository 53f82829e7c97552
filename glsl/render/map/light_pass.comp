#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// How much of the light comes through all that lies on each shadow ray: the bits of a float from 0 to 1, or GRIDWALK_UNFINISHED. Each blended
// surface counts once: in the one block of cells between whose entry and exit it is met.

#include "render/shared/queue.glsl"
#include "render/shared/sample.glsl"
#include "shared/trace.glsl"

layout(push_constant, std430) uniform LightPass {
    GridwalkGrid grid;
    SceneIn scene;
    QueueIn queue;
    RaysIn rays;
    WordsOut passed;
    WalkStatesInOut walks;
};

// Whether an edge, seen along the ray with its triangle to its left, belongs to that triangle rather than to its neighbour.
bool owns_edge(float along_x, float along_y) { return along_y > 0.0 || (along_y == 0.0 && along_x > 0.0); }

// A ray through an edge meets both of its triangles, which together are one surface. Only for a triangle that the ray's line meets.
bool owns_hit(MovedRay ray, Corners corners) {
    vec3 a = corners.a;
    vec3 b = corners.b;
    vec3 c = corners.c;
    vec3 edges = edge_functions(ray, corners);
    float side = edges.x + edges.y + edges.z < 0.0 ? -1.0 : 1.0;
    vec2 to_b = (b.xy - ray.shear.xy * b.z) - (a.xy - ray.shear.xy * a.z);
    vec2 to_c = (c.xy - ray.shear.xy * c.z) - (b.xy - ray.shear.xy * b.z);
    vec2 to_a = (a.xy - ray.shear.xy * a.z) - (c.xy - ray.shear.xy * c.z);
    return (edges.x != 0.0 || owns_edge(to_c.x * side, to_c.y * side)) && (edges.y != 0.0 || owns_edge(to_a.x * side, to_a.y * side))
        && (edges.z != 0.0 || owns_edge(to_b.x * side, to_b.y * side));
}

// The share of the light that a candidate lets through.
float candidate_share(Walk walk, GridHeader header, uint triangle, float u, float v) {
    Material material = Materials(scene.table.materials).material[Surrounds(scene.table.surrounds).triangle[triangle].material];
    if ((material.flags & MATERIAL_BLEND) == 0u) {
        return is_solid(scene, triangle, u, v) ? 0.0 : 1.0;
    }
    bool owned = owns_hit(walk.ray, walk_corners(walk, header, 3u * triangle));
    return owned ? 1.0 - blended_opacity(scene, material, triangle, u, v) : 1.0;
}

// Walks until the end, until all light is gone, or for TURNS turns; false then.
bool pass_run(inout Walk walk, GridHeader header, inout float entry, inout float share) {
    for (uint turn = 0u; turn < TURNS; ++turn) {
        uint steps = 0u;
        while (walk.reference >= walk.list_end && steps < STEPS_EACH_TURN) {
            entry = walk.exit;
            if (walk_is_over(walk) || !walk_step(walk, header)) {
                return true;
            }
            steps += 1u;
        }
        uint stop = min(walk.list_end, walk.reference + TESTS_EACH_TURN);
        while (walk.reference < stop) {
            uint vertex = walk_take(walk, header);
            float s;
            float u;
            float v;
            if (walk_test(walk, header, vertex, s, u, v) && s > entry && s <= walk.exit) {
                share *= candidate_share(walk, header, triangle_of(vertex), u, v);
                if (share == 0.0) {
                    return true;
                }
            }
        }
    }
    return false;
}

void main() {
    GridHeader header = load_header(grid);
    uint index = invocation_index();
    if (index >= queue.header.count || (CONTINUE && walks.walk[index].given_up == 0u)) {
        return;
    }
    MovedRay moved = move_ray(rays.ray[index], header);
    float share = 1.0;
    bool given_up = false;
    if (moved.valid) {
        Walk walk = walk_begin(header, moved);
        float entry = -GRIDWALK_INFINITY;
        if (CONTINUE) {
            WalkState saved = walks.walk[index];
            walk_restore(walk, header, saved);
            walk_commit(walk, moved.s_max, 0.0, 0.0, GRIDWALK_MISS);
            entry = saved.best_u;
            share = saved.best_v;
        }
        given_up = !pass_run(walk, header, entry, share);
        if (given_up && !LAST) {
            walk_commit(walk, moved.s_max, entry, share, GRIDWALK_MISS);
            walks.walk[index] = walk_save(walk, header);
            return;
        }
    }
    passed.word[index] = given_up ? GRIDWALK_UNFINISHED : floatBitsToUint(share);
    walks.walk[index].given_up = 0u;
}
