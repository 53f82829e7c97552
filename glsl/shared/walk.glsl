// The walk of a ray along the cells of the grid by 3D-DDA (Amanatides and Woo 1987; thesis section 3.2), in the moved frame.
//
// The integer cell is the truth: distances to boundaries are computed from it and never accumulated. A step moves along one axis. A cell
// is entered where its predecessor was left, and exits never decrease, so for every s between a cell's entry and its exit the point of
// the ray lies within pad / 2 of the cell: each hit with s <= exit has been found when the walk leaves a cell.
#ifndef WALK_GLSL
#define WALK_GLSL

#include "shared/intersect.glsl"

struct Walk {
    MovedRay ray;
    vec3 inverse; // of the direction; 0 where that is 0
    vec3 never; // added to the distances: beyond any where the direction is 0
    vec3 ahead; // 1 where the boundary ahead is the cell's upper one
    ivec3 stride; // cell ids along each axis, with the sign of the direction
    ivec3 cell;
    int id;
    vec3 boundaries; // s of the boundary ahead along each axis
    float exit;
    uint reference; // next in the cell's list
    uint list_end;
    float best_s;
    float best_u;
    float best_v;
    uint best_triangle; // GRIDWALK_MISS: none so far
};

const float BEYOND = 3.0e38;

void walk_measure(inout Walk walk, GridHeader grid) {
    vec3 edges = boundary(grid.box_min, grid.cell_size, vec3(walk.cell) + walk.ahead);
    walk.boundaries = (edges - walk.ray.origin) * walk.inverse + walk.never;
    walk.exit = max(walk.exit, min(walk.boundaries.x, min(walk.boundaries.y, walk.boundaries.z)));
}

void walk_enter(inout Walk walk, GridHeader grid) {
    walk_measure(walk, grid);
    uvec2 range = Cells(grid.cells).range[walk.id];
    walk.reference = range.x;
    walk.list_end = range.y;
}

// At the ray's first cell. Only for a valid ray and a grid of at least one cell.
Walk walk_begin(GridHeader grid, MovedRay ray) {
    Walk walk;
    walk.ray = ray;
    bvec3 still = equal(ray.direction, vec3(0.0));
    bvec3 up = greaterThan(ray.direction, vec3(0.0));
    walk.inverse = vec3(still.x ? 0.0 : 1.0 / ray.direction.x, still.y ? 0.0 : 1.0 / ray.direction.y, still.z ? 0.0 : 1.0 / ray.direction.z);
    walk.never = vec3(still.x ? BEYOND : 0.0, still.y ? BEYOND : 0.0, still.z ? BEYOND : 0.0);
    walk.ahead = vec3(up);
    ivec3 extent = ivec3(grid.resolution);
    ivec3 strides = ivec3(1, extent.x, extent.x * extent.y);
    walk.stride = ivec3(up.x ? strides.x : -strides.x, up.y ? strides.y : -strides.y, up.z ? strides.z : -strides.z);
    vec3 last = vec3(grid.resolution) - vec3(1.0);
    vec3 first = min(max(floor((ray.origin - grid.box_min) * grid.inverse_cell_size), vec3(0.0)), last);
    walk.cell = ivec3(first);
    walk.id = walk.cell.x + walk.cell.y * strides.y + walk.cell.z * strides.z;
    walk.exit = 0.0;
    walk.best_s = ray.s_max;
    walk.best_u = 0.0;
    walk.best_v = 0.0;
    walk.best_triangle = GRIDWALK_MISS;
    walk_enter(walk, grid);
    return walk;
}

// Into the next cell; false outside of the grid.
bool walk_step(inout Walk walk, GridHeader grid) {
    bool x = walk.boundaries.x <= walk.boundaries.y && walk.boundaries.x <= walk.boundaries.z;
    bool y = !x && walk.boundaries.y <= walk.boundaries.z;
    bool z = !x && !y;
    int towards = (x ? walk.stride.x : (y ? walk.stride.y : walk.stride.z)) > 0 ? 1 : -1;
    walk.cell += ivec3(x ? towards : 0, y ? towards : 0, z ? towards : 0);
    walk.id += x ? walk.stride.x : (y ? walk.stride.y : walk.stride.z);
    int coordinate = x ? walk.cell.x : (y ? walk.cell.y : walk.cell.z);
    uint count = x ? grid.resolution.x : (y ? grid.resolution.y : grid.resolution.z);
    if (uint(coordinate) >= count) {
        return false;
    }
    walk_enter(walk, grid);
    return true;
}

// Whether no cell ahead can hold a hit that is closer than the best, or as close.
bool walk_is_over(Walk walk) { return walk.best_s <= walk.exit; }

// Whether a hit is in the ray's interval and closer than the best; of equal ones the lower index wins.
bool walk_improves(Walk walk, float s, uint triangle) {
    return s >= walk.ray.s_min && (s < walk.best_s || (s == walk.best_s && triangle < walk.best_triangle));
}

bool walk_test(Walk walk, GridHeader grid, uint triangle, out float s, out float u, out float v) {
    Triangles triangles = Triangles(grid.triangles);
    vec3 v0 = triangles.vertex[3u * triangle].xyz;
    vec3 v1 = triangles.vertex[3u * triangle + 1u].xyz;
    vec3 v2 = triangles.vertex[3u * triangle + 2u].xyz;
    return intersect_triangle(walk.ray, v0, v1, v2, s, u, v) && walk_improves(walk, s, triangle);
}

void walk_commit(inout Walk walk, float s, float u, float v, uint triangle) {
    walk.best_s = s;
    walk.best_u = u;
    walk.best_v = v;
    walk.best_triangle = triangle;
}

#endif
