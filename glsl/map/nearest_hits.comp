#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The nearest hits of each ray, in order of distance, then of triangle: a search for the closest hit again and again, each beyond the last.
// The next begins where the last has ended, in the cell that held its hit: cells before hold none that lies beyond.

#include "shared/trace.glsl"

layout(push_constant, std430) uniform NearestHits {
    GridwalkGrid grid;
    RaysIn rays;
    HitsInOut hits; // `nearest` a ray
    TraceStateInOut state;
    WalkStatesInOut walks;
    MasksIn masks;
    GeometriesOut geometries; // as many as hits
    OrderIn order; // if one is given
    uint mask;
    uint options;
    uint launch; // LAUNCH_* bits
    uint nearest;
};

// A search for several hits.
struct Search {
    uint index; // of the ray
    uint found;
    // The last hit: the next is beyond.
    float floor_s;
    uint floor_triangle;
    uint list_begin; // of the cell's list
};

void write_hit(uint at, Hit hit) {
    hits.hit[at] = hit;
    if ((options & OPTION_GEOMETRIES) != 0u) {
        bool is_hit = hit.triangle < GRIDWALK_UNFINISHED;
        geometries.geometry[at] = is_hit ? gridwalk_geometry(grid, hit.triangle) : uvec2(GRIDWALK_MISS);
    }
}

// Writes the best hit, and begins again in the same cell. True if enough have been found.
bool take(inout Search search, inout Walk walk, Ray ray) {
    Hit hit = Hit(hit_distance(walk.ray, ray, walk.best_s), walk.best_u, walk.best_v, walk.best_triangle);
    write_hit(search.index * nearest + search.found, hit);
    search.found += 1u;
    search.floor_s = walk.best_s;
    search.floor_triangle = walk.best_triangle;
    walk_commit(walk, walk.ray.s_max, 0.0, 0.0, GRIDWALK_MISS);
    walk.reference = search.list_begin;
    return search.found == nearest;
}

// Searches until the end or for TURNS turns; true at the end.
bool nearest_run(inout Search search, inout Walk walk, GridHeader header, Ray ray) {
    for (uint turn = 0u; turn < TURNS; ++turn) {
        uint steps = 0u;
        while (walk.reference >= walk.list_end && steps < STEPS_EACH_TURN) {
            steps += 1u;
            bool is_over = walk_is_over(walk);
            bool has_hit = walk.best_triangle != GRIDWALK_MISS;
            if (is_over && has_hit) {
                if (take(search, walk, ray)) {
                    return true;
                }
                continue;
            }
            if (is_over || !walk_step(walk, header)) {
                if (has_hit) {
                    take(search, walk, ray);
                }
                return true;
            }
            search.list_begin = walk.reference;
        }
        uint stop = min(walk.list_end, walk.reference + TESTS_EACH_TURN);
        while (walk.reference < stop) {
            uint row = walk_take(walk, header);
            uint triangle = triangle_of(row);
            float s;
            float u;
            float v;
            bool met = walk_test(walk, header, row, s, u, v) && walk_accepts(walk, header, triangle);
            if (met && (s > search.floor_s || (s == search.floor_s && triangle > search.floor_triangle))) {
                walk_commit(walk, s, u, v, triangle);
            }
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
    bool resume = (launch & LAUNCH_RESUME) != 0u;
    if (continues && walks.walk[place].given_up == 0u) {
        return;
    }
    TRACE_INDEX(index, place)
    Ray ray = rays.ray[index];
    MovedRay moved = move_ray(ray, header);
    Search search = Search(index, continues ? (walks.walk[place].given_up & ((1u << WALK_FINE) - 1u)) - 1u : 0u, -GRIDWALK_INFINITY, 0u, 0u);
    uint rest = GRIDWALK_MISS;
    bool given_up = false;
    bool has_floor = search.found > 0u || resume;
    uint before = GRIDWALK_MISS;
    if (has_floor) {
        before = hits.hit[index * nearest + (search.found > 0u ? search.found : nearest) - 1u].triangle;
    }
    // Beyond the last hit of all there is none; beyond one that is unknown nothing is known.
    bool searches = moved.valid && (!has_floor || before < GRIDWALK_UNFINISHED);
    if (before == GRIDWALK_UNFINISHED) {
        rest = GRIDWALK_UNFINISHED;
    }
    if (searches) {
        Walk walk = walk_begin(header, moved);
        if (has_floor) {
            // The same arithmetic on the same triangle gives the same distance.
            float u;
            float v;
            intersect_triangle(moved, walk_corners(walk, header, 3u * before), search.floor_s, u, v);
            search.floor_triangle = before;
        }
        if (continues) {
            search.list_begin = walk_restore(walk, header, walks.walk[place]);
        } else {
            search.list_begin = walk.reference;
        }
        TRACE_FILTER(walk, index)
        given_up = !nearest_run(search, walk, header, ray);
        if (given_up && last) {
            rest = GRIDWALK_UNFINISHED;
        } else if (given_up) {
            WalkState saved = walk_save(walk, header);
            saved.given_up += search.found;
            walks.walk[place] = saved;
            state.state.unfinished = 1u;
        }
    }
    if (!given_up || last) {
        for (uint i = search.found; i < nearest; ++i) {
            write_hit(index * nearest + i, Hit(GRIDWALK_INFINITY, 0.0, 0.0, rest));
        }
        walks.walk[place].given_up = 0u;
    }
}
