// gridwalk in your own shader: include this file, pass the address of a built grid (as a uvec2, or as a GridwalkGrid in push constants or
// a buffer), and trace. It declares no binding, uses no shared memory, no barrier and no subgroup operation, and may be called in
// divergent code.
//
//   #extension GL_EXT_buffer_reference : require
//   #extension GL_EXT_buffer_reference_uvec2 : require
//   #include "gridwalk.glsl"
//   Hit hit = gridwalk_closest_hit(GridwalkGrid(grid_address), Ray(origin, t_min, direction, t_max));
//   if (gridwalk_is_hit(hit)) { ... }
//
// Candidates, for an alpha test or the like: each is closer than what has been committed so far.
//
//   GridwalkCandidates candidates = gridwalk_candidates(grid, ray);
//   while (gridwalk_next(candidates)) {
//       if (opaque(candidates.hit)) { gridwalk_commit(candidates); }
//   }
//   Hit hit = gridwalk_committed(candidates);
//
// gridwalk_geometry(grid, hit.triangle) gives the id of a hit's geometry and the triangle's number within it. The functions _filtered take
// a mask and what is to be culled beside.
//
// A walk that needs more than GRIDWALK_TURNS turns (cells and triangles) ends as GRIDWALK_UNFINISHED. Public are the types Ray and Hit,
// GridwalkGrid as an opaque address, the constants GRIDWALK_* and the functions gridwalk_*; everything else may change.
#ifndef GRIDWALK_GLSL
#define GRIDWALK_GLSL

#include "shared/walk.glsl"

// lavapipe ends every loop of an invocation, silently, after 65,535 turns in sum over the divergent invocations of its subgroup: a loop over
// gridwalk_next, whose invocations wait for each other at each candidate, may need fewer there where lists are that long.
#ifndef GRIDWALK_TURNS
#define GRIDWALK_TURNS 32768u
#endif

struct GridwalkCandidates {
    Hit hit; // the candidate: set by gridwalk_next
    Ray ray;
    GridHeader grid;
    Walk walk;
    float s; // of the candidate
    uint turns;
    bool searching;
    bool unfinished;
};

bool gridwalk_is_hit(Hit hit) { return hit.triangle < GRIDWALK_UNFINISHED; }

GridwalkCandidates gridwalk_candidates(GridwalkGrid grid, Ray ray) {
    GridwalkCandidates candidates;
    candidates.hit = Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    candidates.ray = ray;
    candidates.grid = grid.header;
    candidates.s = 0.0;
    candidates.turns = 0u;
    candidates.unfinished = false;
    MovedRay moved = move_ray(ray, candidates.grid);
    candidates.searching = moved.valid;
    candidates.walk.best_triangle = GRIDWALK_MISS;
    if (moved.valid) {
        candidates.walk = walk_begin(candidates.grid, moved);
    }
    return candidates;
}

// Candidates of geometries that share a bit with the mask, without what is culled: GRIDWALK_CULL_BACK, GRIDWALK_CULL_FRONT, or 0. A front is
// the side around which a triangle's vertices go counterclockwise.
GridwalkCandidates gridwalk_candidates_filtered(GridwalkGrid grid, Ray ray, uint mask, uint cull) {
    GridwalkCandidates candidates = gridwalk_candidates(grid, ray);
    candidates.walk.mask = mask;
    candidates.walk.cull = cull;
    return candidates;
}

// One turn: a triangle is tested, or the walk steps. True if there is a candidate.
bool gridwalk_turn(inout GridwalkCandidates candidates) {
    candidates.unfinished = candidates.turns >= GRIDWALK_TURNS;
    candidates.turns += 1u;
    if (candidates.unfinished) {
        candidates.searching = false;
    } else if (candidates.walk.reference < candidates.walk.list_end) {
        uint row = walk_take(candidates.walk, candidates.grid);
        float u;
        float v;
        if (walk_test(candidates.walk, candidates.grid, row, candidates.s, u, v)
            && walk_accepts(candidates.walk, candidates.grid, triangle_of(row))) {
            candidates.hit = Hit(hit_distance(candidates.walk.ray, candidates.ray, candidates.s), u, v, triangle_of(row));
            return true;
        }
    } else if (walk_is_over(candidates.walk) || !walk_step(candidates.walk, candidates.grid)) {
        candidates.searching = false;
    }
    return false;
}

// Finds the next candidate; false when there is none, and from then on.
bool gridwalk_next(inout GridwalkCandidates candidates) {
    while (candidates.searching) {
        if (gridwalk_turn(candidates)) {
            return true;
        }
    }
    return false;
}

// Makes the candidate the closest hit: later ones are closer still.
void gridwalk_commit(inout GridwalkCandidates candidates) {
    walk_commit(candidates.walk, candidates.s, candidates.hit.u, candidates.hit.v, candidates.hit.triangle);
}

// Ends the search: gridwalk_next returns false.
void gridwalk_terminate(inout GridwalkCandidates candidates) { candidates.searching = false; }

Hit gridwalk_committed(GridwalkCandidates candidates) {
    if (candidates.unfinished) {
        return Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_UNFINISHED);
    }
    Walk walk = candidates.walk;
    if (walk.best_triangle == GRIDWALK_MISS) {
        return Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    }
    return Hit(hit_distance(walk.ray, candidates.ray, walk.best_s), walk.best_u, walk.best_v, walk.best_triangle);
}

Hit gridwalk_closest_of(GridwalkCandidates candidates) {
    // One loop, in which all invocations take their turns together: see GRIDWALK_TURNS.
    while (candidates.searching) {
        if (gridwalk_turn(candidates)) {
            gridwalk_commit(candidates);
        }
    }
    return gridwalk_committed(candidates);
}

Hit gridwalk_any_of(GridwalkCandidates candidates) {
    if (gridwalk_next(candidates)) {
        gridwalk_commit(candidates);
    }
    return gridwalk_committed(candidates);
}

Hit gridwalk_closest_hit(GridwalkGrid grid, Ray ray) { return gridwalk_closest_of(gridwalk_candidates(grid, ray)); }

Hit gridwalk_closest_hit_filtered(GridwalkGrid grid, Ray ray, uint mask, uint cull) {
    return gridwalk_closest_of(gridwalk_candidates_filtered(grid, ray, mask, cull));
}

// The first hit that is found: its triangle is GRIDWALK_MISS if there is none.
Hit gridwalk_any_hit(GridwalkGrid grid, Ray ray) { return gridwalk_any_of(gridwalk_candidates(grid, ray)); }

Hit gridwalk_any_hit_filtered(GridwalkGrid grid, Ray ray, uint mask, uint cull) {
    return gridwalk_any_of(gridwalk_candidates_filtered(grid, ray, mask, cull));
}

#endif
