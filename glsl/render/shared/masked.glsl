// The walk of the trace kernels, for scenes with masks: a candidate is a hit where its mask is solid.
// To be included after the push constants `grid`, `scene`, `queue`, `rays` and `walks` are declared.
#ifndef RENDER_MASKED_GLSL
#define RENDER_MASKED_GLSL

#define TRACE_ACCEPT(triangle, u, v) is_solid(scene, triangle, u, v)
#include "shared/trace.glsl"

// Walks a ray of the queue; the header is by load_header. False when there is nothing to be written, because an earlier dispatch has finished
// the walk or a later one will go on with it.
bool masked_walk(GridHeader header, uint index, Ray ray, out Hit hit) {
    hit = Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    if (index >= queue.header.count || (CONTINUE && walks.walk[index].given_up == 0u)) {
        return false;
    }
    MovedRay moved = move_ray(ray, header);
    Counters seen = Counters(0u, 0u, 0u);
    if (moved.valid) {
        Walk walk = walk_begin(header, moved);
        if (CONTINUE) {
            walk_restore(walk, header, walks.walk[index]);
        }
        bool given_up = !walk_run(walk, header, seen);
        if (given_up && !LAST) {
            walks.walk[index] = walk_save(walk, header);
            return false;
        }
        if (given_up) {
            hit.triangle = GRIDWALK_UNFINISHED;
        } else if (walk.best_triangle != GRIDWALK_MISS) {
            hit = Hit(hit_distance(moved, ray, walk.best_s), walk.best_u, walk.best_v, walk.best_triangle);
        }
    }
    walks.walk[index].given_up = 0u;
    return true;
}

#endif
