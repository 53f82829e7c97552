#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The closest hit of each ray.

#include "shared/trace.glsl"

layout(push_constant, std430) uniform ClosestHit {
    GridwalkGrid grid;
    RaysIn rays;
    HitsInOut hits;
    TraceStateInOut state;
    WalkStatesInOut walks;
    CountersInOut counters; // read and written only by the counting variant
    // Of the variant with extras, but for the order.
    MasksIn masks;
    GeometriesOut geometries;
    OrderIn order; // if one is given
    uint mask;
    uint options;
};

void main() {
    GridHeader header = load_header(grid);
    uint place = invocation_index();
    if (place >= state.state.ray_count) {
        return;
    }
    if (CONTINUE && walks.walk[place].given_up == 0u) {
        return;
    }
    TRACE_INDEX(index, place)
    Ray ray = rays.ray[index];
    MovedRay moved = move_ray(ray, header);
    Hit hit = Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    if (RESUME) {
        hit = hits.hit[index];
        moved.s_max = hit.triangle < GRIDWALK_UNFINISHED ? distance_to_s(moved, hit.t) : moved.s_max;
        // What was not found there may be closer than all that is found here.
        moved.valid = moved.valid && hit.triangle != GRIDWALK_UNFINISHED;
    }
    Counters seen = Counters(0u, 0u, 0u);
    bool given_up = false;
    bool found = false;
    if (moved.valid) {
        Walk walk = walk_begin(header, moved);
        if (CONTINUE) {
            walk_restore(walk, header, walks.walk[place]);
        } else {
            seen = Counters(1u, 0u, uint(walk.reference < walk.list_end));
        }
        if (EXTRAS) {
            TRACE_FILTER(walk, index)
        }
        given_up = !walk_run(walk, header, seen);
        if (given_up) {
            if (LAST) {
                hit = Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_UNFINISHED);
            } else {
                walks.walk[place] = walk_save(walk, header);
                state.state.unfinished = 1u;
            }
        } else if (walk.best_triangle != GRIDWALK_MISS) {
            hit = Hit(hit_distance(moved, ray, walk.best_s), walk.best_u, walk.best_v, walk.best_triangle);
            found = true;
        }
    }
    if (!given_up || LAST) {
        hits.hit[index] = hit;
        // A hit that stays has its geometry already.
        bool changed = !RESUME || found || hit.triangle == GRIDWALK_UNFINISHED;
        if (EXTRAS && changed && (options & OPTION_GEOMETRIES) != 0u) {
            geometries.geometry[index] = found ? gridwalk_geometry(grid, hit.triangle) : uvec2(GRIDWALK_MISS);
        }
        walks.walk[place].given_up = 0u;
    }
    if (COUNT) {
        uvec4 before = CONTINUE ? counters.counters[index] : uvec4(0u);
        counters.counters[index] = before + uvec4(seen.steps, seen.tests, seen.cells, 0u);
    }
}
