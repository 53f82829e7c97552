// Made by `cargo tool shaders` from glsl/shared/gridwalk.glsl and its includes: edit those.
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
#ifndef GRIDWALK_WALK_GLSL
#define GRIDWALK_WALK_GLSL

// A ray brought into the grid's frame, and the watertight ray-triangle test (Woop, Benthin and Wald 2013) there.
#ifndef GRIDWALK_INTERSECT_GLSL
#define GRIDWALK_INTERSECT_GLSL

// The grid as data. Everything from the header on lives in the grid's frame: (input coordinate - middle) * scale. The scale is a power of
// two chosen so that the largest |coordinate| lies in [1, 2): the product is exact, and no threshold below depends on the unit of the scene.
// The middle is zero but along axes on which the scene lies so far from the origin that the difference is exact (Sterbenz 1974): what
// counts for the padding is then the scene's size, not its place.
#ifndef GRIDWALK_GRID_GLSL
#define GRIDWALK_GRID_GLSL

// Rays and hits as they lie in device memory. Host twins: gridwalk_core::Ray and gridwalk_core::Hit.
#ifndef GRIDWALK_TYPES_GLSL
#define GRIDWALK_TYPES_GLSL

// Points origin + t * direction, t in [t_min, t_max]; any length of direction but zero.
struct Ray {
    vec3 origin;
    float t_min;
    vec3 direction;
    float t_max;
};

// The point (1 - u - v) a + u b + v c of a triangle, at distance t.
struct Hit {
    float t;
    float u;
    float v;
    uint triangle;
};

const uint GRIDWALK_MISS = 0xFFFFFFFFu;
const uint GRIDWALK_UNFINISHED = 0xFFFFFFFEu;
// No constant expression in GLSL, hence a macro.
#define GRIDWALK_INFINITY uintBitsToFloat(0x7F800000u)

#endif

// [begin, end) in the references; {0, 0} for an empty cell, but nothing that counts where its brick is empty. A split cell has the index of
// its first leaf cell instead, and CELL_SPLIT with its level: 2^level leaf cells along each axis, x fastest. They lie behind the grid's
// cells, in the same words; {d, 0} for an empty one: all leaf cells of the same cell that are closer than d in the maximum norm are empty,
// and d = 0 says no more than d = 1.
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer GridwalkCells { uvec2 range[]; };
// A triangle is referred to by the index of its first row: three times its own.
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer GridwalkReferences { uint row[]; };
// Three rows a triangle: the x of its vertices, their y, their z; all zero for a dropped triangle, which no ray hits. The fourth components are
// words: TRIANGLE_* bits with the triangle's number in its geometry, the geometry's id, and its mask.
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer GridwalkTriangles { vec4 row[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer GridwalkTriangleWordsIn { uvec4 row[]; };

// The triangle of a first row: a third of it, by the inverse of 3 modulo 2^32, since 3 divides it.
uint gridwalk_triangle_of(uint row) { return row * 0xAAAAAAABu; }

const uint GRIDWALK_CELL_SPLIT = 1u << 31;
const uint GRIDWALK_CELL_LEVEL = 7u;

const uint GRIDWALK_TRIANGLE_DROPPED = 1u << 31;
const uint GRIDWALK_TRIANGLE_FLIPPED = 1u << 30; // its front is where its vertices go round clockwise
const uint GRIDWALK_TRIANGLE_TWO_SIDED = 1u << 29; // never culled
const uint GRIDWALK_TRIANGLE_NUMBER = (1u << 26) - 1u;

// A brick is a block of 4^3 cells. Bit x + 4 y + 16 z of the mask (low word first) is set for a cell that is not empty. All bricks closer
// than `distance`, in the maximum norm, are empty: 0 for a brick that is not.
struct GridwalkBrick {
    uvec2 mask;
    uint distance;
    uint longest_list; // of its cells, before they were split
};
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer GridwalkBricks { GridwalkBrick brick[]; };

const uint GRIDWALK_BRICK_SIZE = 4u;

uvec3 gridwalk_brick_resolution(uvec3 resolution) { return (resolution + uvec3(GRIDWALK_BRICK_SIZE - 1u)) / GRIDWALK_BRICK_SIZE; }

// Host twin: gridwalk_core::layout::GridHeader.
struct GridwalkGridHeader {
    vec3 box_min; // padded
    float scale;
    vec3 box_max; // padded
    float pad;
    vec3 cell_size;
    float inverse_scale;
    vec3 inverse_cell_size;
    uint cell_count;
    uvec3 resolution;
    uint triangle_count;
    uvec2 cells;
    uvec2 references;
    uvec2 triangles;
    uvec2 bricks;
    vec3 middle; // in input coordinates
    uint fine_shift; // most levels of a split cell; 0: none is split
    // A walk counts in fine cells, of which each cell has 2^fine_shift along an axis.
    vec3 fine_cell_size;
    uint reserved0;
    vec3 inverse_fine_cell_size;
    uint reserved1;
};

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer GridwalkGrid { GridwalkGridHeader header; };

// To be called before any invocation has returned: a driver that runs on a CPU loads a word once for a subgroup only where it knows all of its
// invocations to be active, and elsewhere once for each. Kernels that many elements pass through load other words there too.
precise GridwalkGridHeader gridwalk_load_header(GridwalkGrid grid) { return grid.header; }

precise vec3 gridwalk_to_frame(GridwalkGridHeader grid, vec3 point) { return (point - grid.middle) * grid.scale; }

// Lower boundary of cell i, upper boundary of cell i - 1. The one function that both the build and the walk use: the walk is watertight
// only if they agree bit for bit.
precise vec3 gridwalk_boundary(vec3 box_min, vec3 cell_size, vec3 i) {
    precise vec3 offset = i * cell_size;
    return box_min + offset;
}

// Of whole numbers in [0, 2^23): added to 2^23 they are the mantissa. Drivers that run on a CPU convert floats to integers one invocation
// at a time.
uvec3 gridwalk_whole(vec3 x) { return floatBitsToUint(x + vec3(8388608.0)) & uvec3(0x7FFFFFu); }

// floor(x) for x in [0.5, 2^23 - 0.5], likewise: the nearest to x - 0.5. Of odd whole numbers the one below. For larger x a larger number.
ivec3 gridwalk_whole_below(vec3 x) { return floatBitsToInt(x + vec3(8388607.5)) - ivec3(0x4B000000); }

// Two products that do not wait for each other.
uint gridwalk_cell_id(uvec3 cell, uvec3 resolution) { return cell.x + resolution.x * cell.y + resolution.x * resolution.y * cell.z; }

#endif

// Points origin + s * direction. The direction is the ray's, times a power of two that brings its largest component into [1, 2); a
// component below 2^-40 of the largest is zero. The origin is where the ray enters the padded box, or a little before, or its own start.
struct GridwalkMovedRay {
    vec3 origin;
    vec3 direction;
    vec3 inverse; // of the direction; 0 where that is 0
    float s_min;
    float s_max;
    // t = (start + s) * t_of_s.x * t_of_s.y: two powers of two, each representable where their product may not be.
    float start;
    vec2 t_of_s;
    // The shear of the triangle test and the axis that it maps to z.
    vec3 shear;
    bool z_is_x;
    bool z_is_y;
    bool valid;
};

const float GRIDWALK_NEGLIGIBLE_COMPONENT = 9.094947017729282e-13; // 2^-40
const float GRIDWALK_SLAB_TOLERANCE = 9.5367431640625e-07; // 2^-20, above the rounding of a slab's distance by 2.5 ulp divisions
const float GRIDWALK_LEAST_NORMAL = 1.1754943508222875e-38; // 2^-126

// 2^e for -126 <= e <= 127.
precise float gridwalk_power_of_two(int e) { return uintBitsToFloat(uint(e + 127) << 23); }

// floor(log2(x)) for normal x > 0, clamped so that the power of two and its inverse are normal numbers.
int gridwalk_clamped_exponent(float x) { return clamp(int((floatBitsToUint(x) >> 23) & 255u) - 127, -126, 126); }

bool gridwalk_is_finite(vec3 v) { return all(lessThan(abs(v), vec3(GRIDWALK_INFINITY))); }

precise vec3 gridwalk_select(bvec3 which, vec3 yes, vec3 no) {
    return vec3(which.x ? yes.x : no.x, which.y ? yes.y : no.y, which.z ? yes.z : no.z);
}

precise vec3 gridwalk_permute(GridwalkMovedRay ray, vec3 v) { return ray.z_is_x ? v.yzx : (ray.z_is_y ? v.zxy : v); }

precise GridwalkMovedRay gridwalk_move_ray(Ray ray, GridwalkGridHeader grid) {
    precise GridwalkMovedRay moved;
    precise vec3 magnitude = abs(ray.direction);
    moved.z_is_x = magnitude.x >= magnitude.y && magnitude.x >= magnitude.z;
    moved.z_is_y = !moved.z_is_x && magnitude.y >= magnitude.z;
    precise float largest = gridwalk_permute(moved, magnitude).z;
    moved.valid = gridwalk_is_finite(ray.origin) && gridwalk_is_finite(ray.direction) && largest > 0.0 && !isnan(ray.t_min) && !isnan(ray.t_max);
    if (!moved.valid) {
        return moved;
    }
    int exponent = gridwalk_clamped_exponent(largest);
    precise float shrink = gridwalk_power_of_two(-exponent);
    precise float grow = gridwalk_power_of_two(exponent);
    precise vec3 direction = gridwalk_select(lessThan(magnitude, vec3(largest * GRIDWALK_NEGLIGIBLE_COMPONENT)), vec3(0.0), ray.direction * shrink);
    bvec3 still = equal(direction, vec3(0.0));
    precise vec3 inverse = gridwalk_select(still, vec3(0.0), 1.0 / direction);
    precise vec3 origin = gridwalk_to_frame(grid, ray.origin);
    moved.t_of_s = vec2(grid.inverse_scale, shrink);
    precise float first = ray.t_min * grow * grid.scale;
    precise float last = ray.t_max * grow * grid.scale;

    // The interval of the box, and the tests of the axes along which the ray does not move.
    bvec3 beside = bvec3(uvec3(lessThan(origin, grid.box_min)) | uvec3(greaterThan(origin, grid.box_max)));
    moved.valid = !any(bvec3(uvec3(still) & uvec3(beside)));
    bvec3 up = greaterThan(direction, vec3(0.0));
    precise vec3 to_low = (grid.box_min - origin) * inverse;
    precise vec3 to_high = (grid.box_max - origin) * inverse;
    precise vec3 near = gridwalk_select(still, vec3(-GRIDWALK_INFINITY), gridwalk_select(up, to_low, to_high));
    precise vec3 far = gridwalk_select(still, vec3(GRIDWALK_INFINITY), gridwalk_select(up, to_high, to_low));
    precise float entry = max(near.x, max(near.y, near.z));
    precise float leave = min(far.x, min(far.y, far.z));
    // From far away both are rounded by more than the padding; what lies behind the origin is never visited.
    entry -= abs(entry) * GRIDWALK_SLAB_TOLERANCE;
    leave += abs(leave) * GRIDWALK_SLAB_TOLERANCE;
    moved.start = max(entry, first);
    // No >, which a NaN would pass.
    moved.valid = moved.valid && moved.start <= leave && moved.start <= last;
    precise vec3 travelled = moved.start * direction;
    moved.origin = origin + travelled;
    // A ray that starts 2^127 of the grid's units away is lost.
    moved.valid = moved.valid && gridwalk_is_finite(moved.origin);
    moved.s_min = first - moved.start;
    moved.s_max = last - moved.start;

    moved.direction = direction;
    moved.inverse = inverse;
    precise vec3 permuted = gridwalk_permute(moved, direction);
    precise float inverse_z = gridwalk_permute(moved, inverse).z;
    moved.shear = vec3(permuted.x * inverse_z, permuted.y * inverse_z, inverse_z);
    return moved;
}

// t of a hit at s, inside of the ray's interval in spite of rounding.
precise float gridwalk_hit_distance(GridwalkMovedRay moved, Ray ray, float s) {
    precise float t = (moved.start + s) * moved.t_of_s.x * moved.t_of_s.y;
    return min(max(t, ray.t_min), ray.t_max);
}

// s of a t, as hit_distance has it.
precise float gridwalk_distance_to_s(GridwalkMovedRay moved, float t) {
    return t / moved.t_of_s.y / moved.t_of_s.x - moved.start;
}

// Vertices of a triangle relative to the ray's origin, their components in the order of the triangle test.
struct GridwalkCorners {
    vec3 a;
    vec3 b;
    vec3 c;
};

// What the triangle test of a ray has as x, y and z, as `permute` has it.
uvec3 gridwalk_axes_of(GridwalkMovedRay ray) { return ray.z_is_x ? uvec3(1u, 2u, 0u) : (ray.z_is_y ? uvec3(2u, 0u, 1u) : uvec3(0u, 1u, 2u)); }

// From the vertices' coordinates along those axes, and the ray's origin's.
precise GridwalkCorners gridwalk_corners_of(vec3 origin, vec3 x, vec3 y, vec3 z) {
    precise vec3 from_x = x - vec3(origin.x);
    precise vec3 from_y = y - vec3(origin.y);
    precise vec3 from_z = z - vec3(origin.z);
    return GridwalkCorners(vec3(from_x.x, from_y.x, from_z.x), vec3(from_x.y, from_y.y, from_z.y), vec3(from_x.z, from_y.z, from_z.z));
}

// Edge functions of a triangle as the ray sees it: of the edges that lie opposite of a, b and c. Those of a shared edge differ in sign alone,
// because each is a difference of two products and nothing is contracted.
precise vec3 gridwalk_edge_functions(GridwalkMovedRay ray, GridwalkCorners corners) {
    precise float ax = corners.a.x - ray.shear.x * corners.a.z;
    precise float ay = corners.a.y - ray.shear.y * corners.a.z;
    precise float bx = corners.b.x - ray.shear.x * corners.b.z;
    precise float by = corners.b.y - ray.shear.y * corners.b.z;
    precise float cx = corners.c.x - ray.shear.x * corners.c.z;
    precise float cy = corners.c.y - ray.shear.y * corners.c.z;
    return vec3(cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
}

// Whether the ray's line passes within the edges. Zero counts as inside, so no ray passes between two neighbours. Compared as integers,
// which costs drivers that run on a CPU a third of what minima and maxima of floats cost that may be no number: as unsigned ones only
// negative floats exceed that of -0, as signed ones only positive ones exceed 0.
bool gridwalk_is_inside(vec3 edges) {
    uvec3 bits = floatBitsToUint(edges);
    ivec3 signed_bits = floatBitsToInt(edges);
    bool negative = max(bits.x, max(bits.y, bits.z)) > 0x80000000u;
    bool positive = max(signed_bits.x, max(signed_bits.y, signed_bits.z)) > 0;
    return !(negative && positive);
}

// Where a ray that passes within a triangle's edges meets it; false, and no values, if it is seen exactly edge-on. Both windings are met.
bool gridwalk_meet_triangle(GridwalkMovedRay ray, GridwalkCorners corners, vec3 edges, precise out float s, precise out float u, precise out float v) {
    precise float determinant = edges.x + edges.y + edges.z;
    // The distance is the plane's, not the edge functions': theirs is lost to cancellation where the triangle is long and thin. It is exact
    // for planes along the axes, and never beyond the triangle's vertices.
    precise vec3 a = corners.a;
    precise vec3 e1 = corners.b - a;
    precise vec3 e2 = corners.c - a;
    precise vec3 normal = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
    precise float facing = normal.x * ray.shear.x + normal.y * ray.shear.y + normal.z;
    precise float along = (normal.x * a.x + normal.y * a.y + normal.z * a.z) / facing;
    s = min(max(along, min(a.z, min(corners.b.z, corners.c.z))), max(a.z, max(corners.b.z, corners.c.z))) * ray.shear.z;
    precise float inverse = 1.0 / determinant;
    u = edges.y * inverse;
    v = edges.z * inverse;
    // The inverse of a denormal may be infinite.
    return abs(determinant) >= GRIDWALK_LEAST_NORMAL && abs(facing) >= GRIDWALK_LEAST_NORMAL;
}

// Whether the ray's line meets the triangle; s, u and v are set if so.
bool gridwalk_intersect_triangle(GridwalkMovedRay ray, GridwalkCorners corners, precise out float s, precise out float u, precise out float v) {
    precise vec3 edges = gridwalk_edge_functions(ray, corners);
    return gridwalk_is_inside(edges) && gridwalk_meet_triangle(ray, corners, edges, s, u, v);
}

#endif

struct GridwalkWalk {
    GridwalkMovedRay ray;
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

const float GRIDWALK_BEYOND = 3.0e38;

ivec3 gridwalk_select(bvec3 which, ivec3 yes, ivec3 no) {
    return ivec3(which.x ? yes.x : no.x, which.y ? yes.y : no.y, which.z ? yes.z : no.z);
}

// s of the boundary of the block ahead along each axis.
precise vec3 gridwalk_walk_boundaries(GridwalkWalk walk, GridwalkGridHeader grid) {
    return gridwalk_boundary(grid.box_min, grid.fine_cell_size, vec3(walk.edge)) * walk.ray.inverse + walk.at_zero;
}

// Looks at the cell: its list, the block around it, and where the ray leaves that.
void gridwalk_walk_enter(precise inout GridwalkWalk walk, GridwalkGridHeader grid) {
    uvec3 bricks_along = gridwalk_brick_resolution(grid.resolution);
    int shift = int(grid.fine_shift);
    ivec3 cell = walk.cell >> shift;
    ivec3 at = cell >> 2;
    GridwalkBrick brick = GridwalkBricks(grid.bricks).brick[gridwalk_cell_id(uvec3(at), bricks_along)];
    ivec3 inner = cell & 3;
    uint bit = uint(inner.x | (inner.y << 2) | ((inner.z & 1) << 4));
    uint word = inner.z < 2 ? brick.mask.x : brick.mask.y;
    walk.reference = 0u;
    walk.list_end = 0u;
    // Or the last leaf cell, as the ray goes, of the empty ones around. What is written in a branch costs all walks a blend on a CPU driver.
    ivec3 ahead = walk.cell;
    if (((word >> bit) & 1u) != 0u) {
        uvec2 range = GridwalkCells(grid.cells).range[gridwalk_cell_id(uvec3(cell), grid.resolution)];
        if ((range.y & GRIDWALK_CELL_SPLIT) != 0u) {
            int level = int(range.y & GRIDWALK_CELL_LEVEL);
            shift -= level;
            int last = (1 << level) - 1;
            ivec3 leaf = (walk.cell >> shift) & last;
            range = GridwalkCells(grid.cells).range[range.x + uint(leaf.x + ((leaf.y + (leaf.z << level)) << level))];
            int empty = range.y == 0u ? max(int(range.x) - 1, 0) : 0;
            ahead += gridwalk_select(walk.up, min(ivec3(empty), ivec3(last) - leaf), -min(ivec3(empty), leaf)) << shift;
        }
        walk.reference = range.x;
        walk.list_end = range.y;
    }
    // An octant of the brick, of 2^3 cells, all of which are empty.
    shift += (word & (0x00330033u << (bit & 10u))) == 0u ? 1 : 0;
    ivec3 next = (ahead >> shift) + walk.one_up;
    int reach = int(brick.distance);
    // Beyond the grid's upper end nothing is, and the walk ends. Below its lower end there are no cells that the next could be clamped to.
    ivec3 beyond = max((at + gridwalk_select(walk.up, ivec3(reach), ivec3(1 - reach))) << 2, ivec3(0));
    ivec3 far = beyond << int(grid.fine_shift);
    ivec3 near = next << shift;
    walk.edge = reach != 0 ? far : near;
    // As integers: none is below 0 that the maximum does not take.
    ivec3 boundaries = floatBitsToInt(gridwalk_walk_boundaries(walk, grid));
    walk.exit = intBitsToFloat(max(floatBitsToInt(walk.exit), min(boundaries.x, min(boundaries.y, boundaries.z))));
}

// Where the ray's point lies, in fine cells.
precise vec3 gridwalk_walk_point(GridwalkWalk walk, GridwalkGridHeader grid, float s) {
    precise vec3 travelled = s * walk.ray.direction;
    return (walk.from_low + travelled) * grid.inverse_fine_cell_size;
}

// At the ray's first cell. Only for a valid ray and a grid of at least one cell.
precise GridwalkWalk gridwalk_walk_begin(GridwalkGridHeader grid, GridwalkMovedRay ray) {
    precise GridwalkWalk walk;
    walk.ray = ray;
    walk.up = greaterThan(ray.direction, vec3(0.0));
    walk.one_up = gridwalk_select(walk.up, ivec3(1), ivec3(0));
    walk.at_zero = gridwalk_select(equal(ray.direction, vec3(0.0)), vec3(GRIDWALK_BEYOND), -ray.origin * ray.inverse);
    walk.from_low = ray.origin - grid.box_min;
    precise vec3 at = min(max(gridwalk_walk_point(walk, grid, 0.0), vec3(0.5)), vec3(grid.resolution << grid.fine_shift) - vec3(0.5));
    walk.cell = gridwalk_whole_below(at);
    walk.exit = 0.0;
    walk.best_s = ray.s_max;
    walk.best_u = 0.0;
    walk.best_v = 0.0;
    walk.best_triangle = GRIDWALK_MISS;
    walk.mask = 0xFFFFFFFFu;
    walk.cull = 0u;
    gridwalk_walk_enter(walk, grid);
    return walk;
}

// Into the next block; false outside of the grid.
bool gridwalk_walk_step(precise inout GridwalkWalk walk, GridwalkGridHeader grid) {
    precise vec3 boundaries = gridwalk_walk_boundaries(walk, grid);
    bool x = boundaries.x <= boundaries.y && boundaries.x <= boundaries.z;
    bool y = !x && boundaries.y <= boundaries.z;
    ivec3 last = walk.edge - walk.one_up;
    // Clamped as floats below, since a ray from far away may be anywhere, and a conversion out of range may give anything; above, what is larger
    // stays larger.
    ivec3 inside = gridwalk_whole_below(max(gridwalk_walk_point(walk, grid, walk.exit), vec3(0.5)));
    inside = min(max(inside, min(walk.cell, last)), max(walk.cell, last));
    ivec3 beyond = last + 2 * walk.one_up - ivec3(1);
    walk.cell = gridwalk_select(bvec3(x, y, !x && !y), beyond, inside);
    if (any(greaterThanEqual(uvec3(walk.cell), grid.resolution << grid.fine_shift))) {
        return false;
    }
    gridwalk_walk_enter(walk, grid);
    return true;
}

// Whether no cell ahead can hold a hit that is closer than the best, or as close.
bool gridwalk_walk_is_over(GridwalkWalk walk) { return walk.best_s <= walk.exit; }

// Whether a hit is in the ray's interval and closer than the best; of equal ones the lower index wins.
bool gridwalk_walk_improves(GridwalkWalk walk, float s, uint triangle) {
    return s >= walk.ray.s_min && (s < walk.best_s || (s == walk.best_s && triangle < walk.best_triangle));
}

// The next of the cell's list, by its first row.
uint gridwalk_walk_take(precise inout GridwalkWalk walk, GridwalkGridHeader grid) {
    uint row = GridwalkReferences(grid.references).row[walk.reference];
    walk.reference += 1u;
    return row;
}

precise GridwalkCorners gridwalk_walk_corners(GridwalkWalk walk, GridwalkGridHeader grid, uint row) {
    GridwalkTriangles triangles = GridwalkTriangles(grid.triangles);
    uvec3 axes = gridwalk_axes_of(walk.ray);
    precise vec3 x = triangles.row[row + axes.x].xyz;
    precise vec3 y = triangles.row[row + axes.y].xyz;
    precise vec3 z = triangles.row[row + axes.z].xyz;
    return gridwalk_corners_of(gridwalk_permute(walk.ray, walk.ray.origin), x, y, z);
}

bool gridwalk_walk_test(GridwalkWalk walk, GridwalkGridHeader grid, uint row, precise out float s, precise out float u, precise out float v) {
    return gridwalk_intersect_triangle(walk.ray, gridwalk_walk_corners(walk, grid, row), s, u, v) && gridwalk_walk_improves(walk, s, gridwalk_triangle_of(row));
}

// The id of a triangle's geometry, and the triangle's number within it.
uvec2 gridwalk_geometry(GridwalkGrid grid, uint triangle) {
    GridwalkTriangleWordsIn words = GridwalkTriangleWordsIn(grid.header.triangles);
    return uvec2(words.row[3u * triangle + 1u].w, words.row[3u * triangle].w & GRIDWALK_TRIANGLE_NUMBER);
}

// Whether the ray sees the side of a triangle around which its vertices go counterclockwise. Only for one that the ray's line meets.
bool gridwalk_sees_front(GridwalkMovedRay ray, GridwalkCorners corners) {
    precise vec3 e1 = corners.b - corners.a;
    precise vec3 e2 = corners.c - corners.a;
    precise vec3 normal = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
    precise float facing = normal.x * ray.shear.x + normal.y * ray.shear.y + normal.z;
    return (facing < 0.0) == (ray.shear.z > 0.0);
}

// Whether a triangle that the ray's line meets is one that the ray is to hit: by masks and by culling.
bool gridwalk_walk_accepts(GridwalkWalk walk, GridwalkGridHeader grid, uint triangle) {
    GridwalkTriangleWordsIn words = GridwalkTriangleWordsIn(grid.triangles);
    if (walk.mask != 0xFFFFFFFFu && (words.row[3u * triangle + 2u].w & walk.mask) == 0u) {
        return false;
    }
    if (walk.cull == 0u) {
        return true;
    }
    uint flags = words.row[3u * triangle].w;
    bool front = gridwalk_sees_front(walk.ray, gridwalk_walk_corners(walk, grid, 3u * triangle));
    front = front != ((flags & GRIDWALK_TRIANGLE_FLIPPED) != 0u);
    bool culled = (walk.cull & (front ? GRIDWALK_CULL_FRONT : GRIDWALK_CULL_BACK)) != 0u;
    return !culled || (flags & GRIDWALK_TRIANGLE_TWO_SIDED) != 0u;
}

void gridwalk_walk_commit(precise inout GridwalkWalk walk, float s, float u, float v, uint triangle) {
    walk.best_s = s;
    walk.best_u = u;
    walk.best_v = v;
    walk.best_triangle = triangle;
}

#endif

// lavapipe ends every loop of an invocation, silently, after 65,535 turns in sum over the divergent invocations of its subgroup: a loop over
// gridwalk_next, whose invocations wait for each other at each candidate, may need fewer there where lists are that long.
#ifndef GRIDWALK_TURNS
#define GRIDWALK_TURNS 32768u
#endif

struct GridwalkCandidates {
    Hit hit; // the candidate: set by gridwalk_next
    Ray ray;
    GridwalkGridHeader grid;
    GridwalkWalk walk;
    float s; // of the candidate
    uint turns;
    bool searching;
    bool unfinished;
};

bool gridwalk_is_hit(Hit hit) { return hit.triangle < GRIDWALK_UNFINISHED; }

precise GridwalkCandidates gridwalk_candidates(GridwalkGrid grid, Ray ray) {
    precise GridwalkCandidates candidates;
    candidates.hit = Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    candidates.ray = ray;
    candidates.grid = grid.header;
    candidates.s = 0.0;
    candidates.turns = 0u;
    candidates.unfinished = false;
    precise GridwalkMovedRay moved = gridwalk_move_ray(ray, candidates.grid);
    candidates.searching = moved.valid;
    candidates.walk.best_triangle = GRIDWALK_MISS;
    if (moved.valid) {
        candidates.walk = gridwalk_walk_begin(candidates.grid, moved);
    }
    return candidates;
}

// Candidates of geometries that share a bit with the mask, without what is culled: GRIDWALK_CULL_BACK, GRIDWALK_CULL_FRONT, or 0. A front is
// the side around which a triangle's vertices go counterclockwise.
precise GridwalkCandidates gridwalk_candidates_filtered(GridwalkGrid grid, Ray ray, uint mask, uint cull) {
    precise GridwalkCandidates candidates = gridwalk_candidates(grid, ray);
    candidates.walk.mask = mask;
    candidates.walk.cull = cull;
    return candidates;
}

// One turn: a triangle is tested, or the walk steps. True if there is a candidate.
bool gridwalk_turn(precise inout GridwalkCandidates candidates) {
    candidates.unfinished = candidates.turns >= GRIDWALK_TURNS;
    candidates.turns += 1u;
    if (candidates.unfinished) {
        candidates.searching = false;
    } else if (candidates.walk.reference < candidates.walk.list_end) {
        uint row = gridwalk_walk_take(candidates.walk, candidates.grid);
        precise float u;
        precise float v;
        if (gridwalk_walk_test(candidates.walk, candidates.grid, row, candidates.s, u, v)
            && gridwalk_walk_accepts(candidates.walk, candidates.grid, gridwalk_triangle_of(row))) {
            candidates.hit = Hit(gridwalk_hit_distance(candidates.walk.ray, candidates.ray, candidates.s), u, v, gridwalk_triangle_of(row));
            return true;
        }
    } else if (gridwalk_walk_is_over(candidates.walk) || !gridwalk_walk_step(candidates.walk, candidates.grid)) {
        candidates.searching = false;
    }
    return false;
}

// Finds the next candidate; false when there is none, and from then on.
bool gridwalk_next(precise inout GridwalkCandidates candidates) {
    while (candidates.searching) {
        if (gridwalk_turn(candidates)) {
            return true;
        }
    }
    return false;
}

// Makes the candidate the closest hit: later ones are closer still.
void gridwalk_commit(precise inout GridwalkCandidates candidates) {
    gridwalk_walk_commit(candidates.walk, candidates.s, candidates.hit.u, candidates.hit.v, candidates.hit.triangle);
}

// Ends the search: gridwalk_next returns false.
void gridwalk_terminate(precise inout GridwalkCandidates candidates) { candidates.searching = false; }

precise Hit gridwalk_committed(GridwalkCandidates candidates) {
    if (candidates.unfinished) {
        return Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_UNFINISHED);
    }
    precise GridwalkWalk walk = candidates.walk;
    if (walk.best_triangle == GRIDWALK_MISS) {
        return Hit(GRIDWALK_INFINITY, 0.0, 0.0, GRIDWALK_MISS);
    }
    return Hit(gridwalk_hit_distance(walk.ray, candidates.ray, walk.best_s), walk.best_u, walk.best_v, walk.best_triangle);
}

precise Hit gridwalk_closest_of(GridwalkCandidates candidates) {
    // One loop, in which all invocations take their turns together: see GRIDWALK_TURNS.
    while (candidates.searching) {
        if (gridwalk_turn(candidates)) {
            gridwalk_commit(candidates);
        }
    }
    return gridwalk_committed(candidates);
}

precise Hit gridwalk_any_of(GridwalkCandidates candidates) {
    if (gridwalk_next(candidates)) {
        gridwalk_commit(candidates);
    }
    return gridwalk_committed(candidates);
}

precise Hit gridwalk_closest_hit(GridwalkGrid grid, Ray ray) { return gridwalk_closest_of(gridwalk_candidates(grid, ray)); }

precise Hit gridwalk_closest_hit_filtered(GridwalkGrid grid, Ray ray, uint mask, uint cull) {
    return gridwalk_closest_of(gridwalk_candidates_filtered(grid, ray, mask, cull));
}

// The first hit that is found: its triangle is GRIDWALK_MISS if there is none.
precise Hit gridwalk_any_hit(GridwalkGrid grid, Ray ray) { return gridwalk_any_of(gridwalk_candidates(grid, ray)); }

precise Hit gridwalk_any_hit_filtered(GridwalkGrid grid, Ray ray, uint mask, uint cull) {
    return gridwalk_any_of(gridwalk_candidates_filtered(grid, ray, mask, cull));
}

#endif
