#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// How many triangles each ray hits, or GRIDWALK_UNFINISHED. Every cell that a triangle overlaps lists it; it counts in the one block of cells
// between whose entry and exit it is hit: these intervals follow each other without a gap, and the walk finds every hit there.

#include "shared/trace.glsl"

layout(push_constant, std430) uniform CountHits {
    GridwalkGrid grid;
    RaysIn rays;
    HitCountsOut counts;
    TraceStateInOut state;
    WalkStatesInOut walks;
    MasksIn masks;
    OrderIn order; // if one is given
    uint mask;
    uint options;
    uint launch; // LAUNCH_* bits
};

// Counts until the end or for TURNS turns; true at the end.
bool count_run(inout Walk walk, GridHeader header, inout float entry, inout uint count) {
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
            uint row = walk_take(walk, header);
            float s;
            float u;
            float v;
            bool met = walk_test(walk, header, row, s, u, v) && walk_accepts(walk, header, triangle_of(row));
            count += uint(met && s > entry && s <= walk.exit);
        }
    }
    return false;
}

void main() {
    GridHeader header = load_header(grid);
    uint place = invocation_index();
    if (place >= state.state.ray_count) {
        return;
    }
    bool continues = (launch & LAUNCH_CONTINUE) != 0u;
    bool last = (launch & LAUNCH_LAST) != 0u;
    if (continues && walks.walk[place].given_up == 0u) {
        return;
    }
    TRACE_INDEX(index, place)
    MovedRay moved = move_ray(rays.ray[index], header);
    uint count = 0u;
    bool given_up = false;
    if (moved.valid) {
        Walk walk = walk_begin(header, moved);
        float entry = -GRIDWALK_INFINITY;
        if (continues) {
            WalkState saved = walks.walk[place];
            walk_restore(walk, header, saved);
            walk_commit(walk, moved.s_max, 0.0, 0.0, GRIDWALK_MISS);
            entry = saved.best_u;
            count = saved.best_triangle;
        }
        TRACE_FILTER(walk, index)
        given_up = !count_run(walk, header, entry, count);
        if (given_up && last) {
            count = GRIDWALK_UNFINISHED;
        } else if (given_up) {
            walk_commit(walk, moved.s_max, entry, 0.0, count);
            walks.walk[place] = walk_save(walk, header);
            state.state.unfinished = 1u;
        }
    }
    if (!given_up || last) {
        counts.count[index] = count;
        walks.walk[place].given_up = 0u;
    }
}
