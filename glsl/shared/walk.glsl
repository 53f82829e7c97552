// The walk of a ray along the cells of the grid by 3D-DDA (Amanatides and Woo 1987; thesis section 3.2), in the moved frame, with jumps
// across empty space: a step leaves a block of cells. Where a brick holds triangles that is one cell, or the cell's octant of the brick if that
// is empty, or of a split cell one leaf cell with all those around that are known to be empty if it is; elsewhere it is all bricks around that
// are known to be empty.
//
// Positions are counted in fine cells: the first level's cells are blocks of 2^fine_shift of them along each axis, the leaf cells of a split
// cell (Kalojanov, Billeter and Slusallek 2011) smaller blocks.
//
// The integer cell is the truth: distances to boundaries are computed from it and never accumulated. A step moves along one axis by the
// boundary, and along the others, inside of the block, to where the ray's point lies, never backwards. A block is entered where its
// predecessor was left, and exits never decrease, so for every s between a block's entry and its exit the point of the ray lies within
// pad / 2 of it: each hit with s <= exit has been found when the walk leaves a block.
#ifndef WALK_GLSL
#define WALK_GLSL

#include "shared/intersect.glsl"

struct Walk {
    MovedRay ray;
    vec3 from_low; // the ray's origin, seen from the grid's lower corner
    vec3 at_zero; // s where a coordinate is 0; beyond any where the direction is 0
    bvec3 up; // the direction is positive
    ivec3 one_up; // 1 where it is, else 0
    ivec3 cell; // fine
    ivec3 edge; // the boundary of the block ahead along each axis, by the fine cell above it
    float exit;
    uint reference; // next in the cell's list
    uint list_end;
    float best_s;
    float best_u;
    float best_v;
    uint best_triangle; // GRIDWALK_MISS: none so far
    uint mask; // of the ray
    uint cull; // GRIDWALK_CULL_* bits
};

const uint GRIDWALK_CULL_BACK = 1u;
const uint GRIDWALK_CULL_FRONT = 2u;

const float BEYOND = 3.0e38;

ivec3 select(bvec3 which, ivec3 yes, ivec3 no) {
    return ivec3(which.x ? yes.x : no.x, which.y ? yes.y : no.y, which.z ? yes.z : no.z);
}

// s of the boundary of the block ahead along each axis.
vec3 walk_boundaries(Walk walk, GridHeader grid) {
    return boundary(grid.box_min, grid.fine_cell_size, vec3(walk.edge)) * walk.ray.inverse + walk.at_zero;
}

// Looks at the cell: its list, the block around it, and where the ray leaves that.
void walk_enter(inout Walk walk, GridHeader grid) {
    uvec3 bricks_along = brick_resolution(grid.resolution);
    int shift = int(grid.fine_shift);
    ivec3 cell = walk.cell >> shift;
    ivec3 at = cell >> 2;
    Brick brick = Bricks(grid.bricks).brick[cell_id(uvec3(at), bricks_along)];
    ivec3 inner = cell & 3;
    uint bit = uint(inner.x | (inner.y << 2) | ((inner.z & 1) << 4));
    uint word = inner.z < 2 ? brick.mask.x : brick.mask.y;
    walk.reference = 0u;
    walk.list_end = 0u;
    // Or the last leaf cell, as the ray goes, of the empty ones around. What is written in a branch costs all walks a blend on a CPU driver.
    ivec3 ahead = walk.cell;
    if (((word >> bit) & 1u) != 0u) {
        uvec2 range = Cells(grid.cells).range[cell_id(uvec3(cell), grid.resolution)];
        if ((range.y & CELL_SPLIT) != 0u) {
            int level = int(range.y & CELL_LEVEL);
            shift -= level;
            int last = (1 << level) - 1;
            ivec3 leaf = (walk.cell >> shift) & last;
            range = Cells(grid.cells).range[range.x + uint(leaf.x + ((leaf.y + (leaf.z << level)) << level))];
            int empty = range.y == 0u ? max(int(range.x) - 1, 0) : 0;
            ahead += select(walk.up, min(ivec3(empty), ivec3(last) - leaf), -min(ivec3(empty), leaf)) << shift;
        }
        walk.reference = range.x;
        walk.list_end = range.y;
    }
    // An octant of the brick, of 2^3 cells, all of which are empty.
    shift += (word & (0x00330033u << (bit & 10u))) == 0u ? 1 : 0;
    ivec3 next = (ahead >> shift) + walk.one_up;
    int reach = int(brick.distance);
    // Beyond the grid's upper end nothing is, and the walk ends. Below its lower end there are no cells that the next could be clamped to.
    ivec3 beyond = max((at + select(walk.up, ivec3(reach), ivec3(1 - reach))) << 2, ivec3(0));
    ivec3 far = beyond << int(grid.fine_shift);
    ivec3 near = next << shift;
    walk.edge = reach != 0 ? far : near;
    // As integers: none is below 0 that the maximum does not take.
    ivec3 boundaries = floatBitsToInt(walk_boundaries(walk, grid));
    walk.exit = intBitsToFloat(max(floatBitsToInt(walk.exit), min(boundaries.x, min(boundaries.y, boundaries.z))));
}

// Where the ray's point lies, in fine cells.
vec3 walk_point(Walk walk, GridHeader grid, float s) {
    vec3 travelled = s * walk.ray.direction;
    return (walk.from_low + travelled) * grid.inverse_fine_cell_size;
}

// At the ray's first cell. Only for a valid ray and a grid of at least one cell.
Walk walk_begin(GridHeader grid, MovedRay ray) {
    Walk walk;
    walk.ray = ray;
    walk.up = greaterThan(ray.direction, vec3(0.0));
    walk.one_up = select(walk.up, ivec3(1), ivec3(0));
    walk.at_zero = select(equal(ray.direction, vec3(0.0)), vec3(BEYOND), -ray.origin * ray.inverse);
    walk.from_low = ray.origin - grid.box_min;
    vec3 at = min(max(walk_point(walk, grid, 0.0), vec3(0.5)), vec3(grid.resolution << grid.fine_shift) - vec3(0.5));
    walk.cell = whole_below(at);
    walk.exit = 0.0;
    walk.best_s = ray.s_max;
    walk.best_u = 0.0;
    walk.best_v = 0.0;
    walk.best_triangle = GRIDWALK_MISS;
    walk.mask = 0xFFFFFFFFu;
    walk.cull = 0u;
    walk_enter(walk, grid);
    return walk;
}

// Into the next block; false outside of the grid.
bool walk_step(inout Walk walk, GridHeader grid) {
    vec3 boundaries = walk_boundaries(walk, grid);
    bool x = boundaries.x <= boundaries.y && boundaries.x <= boundaries.z;
    bool y = !x && boundaries.y <= boundaries.z;
    ivec3 last = walk.edge - walk.one_up;
    // Clamped as floats below, since a ray from far away may be anywhere, and a conversion out of range may give anything; above, what is larger
    // stays larger.
    ivec3 inside = whole_below(max(walk_point(walk, grid, walk.exit), vec3(0.5)));
    inside = min(max(inside, min(walk.cell, last)), max(walk.cell, last));
    ivec3 beyond = last + 2 * walk.one_up - ivec3(1);
    walk.cell = select(bvec3(x, y, !x && !y), beyond, inside);
    if (any(greaterThanEqual(uvec3(walk.cell), grid.resolution << grid.fine_shift))) {
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

// The next of the cell's list, by its first row.
uint walk_take(inout Walk walk, GridHeader grid) {
    uint row = References(grid.references).row[walk.reference];
    walk.reference += 1u;
    return row;
}

Corners walk_corners(Walk walk, GridHeader grid, uint row) {
    Triangles triangles = Triangles(grid.triangles);
    uvec3 axes = axes_of(walk.ray);
    vec3 x = triangles.row[row + axes.x].xyz;
    vec3 y = triangles.row[row + axes.y].xyz;
    vec3 z = triangles.row[row + axes.z].xyz;
    return corners_of(permute(walk.ray, walk.ray.origin), x, y, z);
}

bool walk_test(Walk walk, GridHeader grid, uint row, out float s, out float u, out float v) {
    return intersect_triangle(walk.ray, walk_corners(walk, grid, row), s, u, v) && walk_improves(walk, s, triangle_of(row));
}

// The id of a triangle's geometry, and the triangle's number within it.
uvec2 gridwalk_geometry(GridwalkGrid grid, uint triangle) {
    TriangleWordsIn words = TriangleWordsIn(grid.header.triangles);
    return uvec2(words.row[3u * triangle + 1u].w, words.row[3u * triangle].w & TRIANGLE_NUMBER);
}

// Whether the ray sees the side of a triangle around which its vertices go counterclockwise. Only for one that the ray's line meets.
bool sees_front(MovedRay ray, Corners corners) {
    vec3 e1 = corners.b - corners.a;
    vec3 e2 = corners.c - corners.a;
    vec3 normal = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
    float facing = normal.x * ray.shear.x + normal.y * ray.shear.y + normal.z;
    return (facing < 0.0) == (ray.shear.z > 0.0);
}

// Whether a triangle that the ray's line meets is one that the ray is to hit: by masks and by culling.
bool walk_accepts(Walk walk, GridHeader grid, uint triangle) {
    TriangleWordsIn words = TriangleWordsIn(grid.triangles);
    if (walk.mask != 0xFFFFFFFFu && (words.row[3u * triangle + 2u].w & walk.mask) == 0u) {
        return false;
    }
    if (walk.cull == 0u) {
        return true;
    }
    uint flags = words.row[3u * triangle].w;
    bool front = sees_front(walk.ray, walk_corners(walk, grid, 3u * triangle));
    front = front != ((flags & TRIANGLE_FLIPPED) != 0u);
    bool culled = (walk.cull & (front ? GRIDWALK_CULL_FRONT : GRIDWALK_CULL_BACK)) != 0u;
    return !culled || (flags & TRIANGLE_TWO_SIDED) != 0u;
}

void walk_commit(inout Walk walk, float s, float u, float v, uint triangle) {
    walk.best_s = s;
    walk.best_u = u;
    walk.best_v = v;
    walk.best_triangle = triangle;
}

#endif
