#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Whether each ray hits anything: 1, 0, or GRIDWALK_UNFINISHED.

#define TRACE_ANY
#include "shared/trace.glsl"

layout(push_constant, std430) uniform AnyHit {
    GridwalkGrid grid;
    RaysIn rays;
    OccludedOut occluded;
    TraceStateInOut state;
    WalkStatesInOut walks;
    // Of the variant with extras, but for the order.
    MasksIn masks;
    GeometriesOut geometries; // of the hit that ended the search
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
    Counters seen = Counters(0u, 0u, 0u);
    uint result = 0u;
    uint triangle = GRIDWALK_MISS;
    bool given_up = false;
    if (moved.valid) {
        Walk walk = walk_begin(header, moved);
        if (CONTINUE) {
            walk_restore(walk, header, walks.walk[place]);
        }
        if (EXTRAS) {
            TRACE_FILTER(walk, index)
        }
        given_up = !walk_run(walk, header, seen);
        triangle = walk.best_triangle;
        result = triangle != GRIDWALK_MISS ? 1u : 0u;
        if (given_up) {
            if (LAST) {
                result = GRIDWALK_UNFINISHED;
            } else {
                walks.walk[place] = walk_save(walk, header);
                state.state.unfinished = 1u;
            }
        }
    }
    if (!given_up || LAST) {
        occluded.occluded[index] = result;
        if (EXTRAS && (options & OPTION_GEOMETRIES) != 0u) {
            geometries.geometry[index] = result == 1u ? gridwalk_geometry(grid, triangle) : uvec2(GRIDWALK_MISS);
        }
        walks.walk[place].given_up = 0u;
    }
}
