// The trace kernels: one walk a ray, given up after TURNS turns and continued by the next dispatch from where it stood.
//
// Before including, a kernel may define
//   TRACE_ANY                 the first accepted hit ends the walk
//   TRACE_ACCEPT(t, u, v)     whether a candidate on triangle t is a hit: an alpha test, say
#ifndef TRACE_GLSL
#define TRACE_GLSL

#include "shared/dispatch.glsl"
#include "shared/trace_types.glsl"
#include "shared/walk.glsl"

#ifndef TRACE_ACCEPT
#define TRACE_ACCEPT(triangle, u, v) true
#endif

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;
layout(constant_id = 1) const bool CONTINUE = false; // goes on with walks that were given up, and leaves the others alone
layout(constant_id = 2) const bool LAST = false; // a walk that is given up now is reported
layout(constant_id = 3) const bool RESUME = false; // existing hits are to be beaten
layout(constant_id = 4) const bool COUNT = false;
layout(constant_id = 5) const bool EXTRAS = false; // masks, culling, geometry ids: what is not asked for costs nothing
layout(constant_id = 6) const bool BY_TWO = false; // rows of triangles are loaded by two coordinates and one

// Bits of the push constant `launch`, where it stands for the first three.
const uint LAUNCH_CONTINUE = 1u;
const uint LAUNCH_LAST = 2u;
const uint LAUNCH_RESUME = 4u;

// Bits of the push constant `options`.
const uint OPTION_CULL = 3u; // GRIDWALK_CULL_* bits
const uint OPTION_MASKS = 4u; // each ray has a mask of its own
const uint OPTION_GEOMETRIES = 8u; // geometry and number within it are written
const uint OPTION_ORDER = 16u; // rays are traced in the order that is given

// A turn walks through empty cells to the next list, then tests triangles of it: so the invocations of a subgroup mostly do the same.
// lavapipe ends every loop of an invocation, silently, after 65,535 turns in sum over all of its loops and over the divergent paths of
// its subgroup: TURNS * (1 + STEPS_EACH_TURN + TESTS_EACH_TURN) = 32,750 stays below.
const uint TURNS = 1310u;
const uint STEPS_EACH_TURN = 4u;
const uint TESTS_EACH_TURN = 20u;

struct Counters {
    uint steps; // cells visited
    uint tests; // triangles tested
    uint cells; // cells visited that are not empty
};

WalkState walk_save(Walk walk, GridHeader grid) {
    uvec3 cell = uvec3(walk.cell) >> grid.fine_shift;
    uvec3 inside = uvec3(walk.cell) & ((1u << grid.fine_shift) - 1u);
    uint fine = inside.x | inside.y << 8u | inside.z << 16u;
    return WalkState(1u | fine << WALK_FINE, cell_id(cell, grid.resolution), walk.reference, walk.exit, walk.best_s, walk.best_u, walk.best_v, walk.best_triangle);
}

// Where the list of the walk's cell begins.
uint walk_restore(inout Walk walk, GridHeader grid, WalkState saved) {
    uint slice = grid.resolution.x * grid.resolution.y;
    uint in_slice = saved.cell % slice;
    uvec3 cell = uvec3(in_slice % grid.resolution.x, in_slice / grid.resolution.x, saved.cell / slice);
    uint fine = saved.given_up >> WALK_FINE;
    walk.cell = ivec3((cell << grid.fine_shift) + (uvec3(fine, fine >> 8u, fine >> 16u) & 255u));
    walk.exit = saved.exit;
    walk_enter(walk, grid);
    uint list_begin = walk.reference;
    walk.reference = saved.reference;
    walk_commit(walk, saved.best_s, saved.best_u, saved.best_v, saved.best_triangle);
    return list_begin;
}

// Gives the walk its ray's mask and what is culled.
#define TRACE_FILTER(walk, index) \
    walk.cull = options & OPTION_CULL; \
    walk.mask = (options & OPTION_MASKS) != 0u ? mask & masks.word[index] : mask;

// The index of the ray that is traced at a place; walks that are given up are kept by places, hits by indices.
#define TRACE_INDEX(index, place) \
    uint index = place; \
    if ((options & OPTION_ORDER) != 0u) { \
        index = order.word[place]; \
    }

// Eight bytes that are loaded at once: an address that is never followed, since that takes no 64-bit integers.
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer EightBytes { uvec2 word; };

// Rows of triangles as drivers that run on a CPU load them best: they take a word of one invocation after the other in any case, and of eight
// bytes at once as long as of four. The third coordinate is loaded alone.
struct TwoAndOne {
    EightBytes two;
    float one;
    uint word;
};
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer TwoAndOneRows { TwoAndOne row[]; };

vec3 load_row(uvec2 rows, uint row) {
    if (!BY_TWO) {
        return Triangles(rows).row[row].xyz;
    }
    TwoAndOneRows parts = TwoAndOneRows(rows);
    return vec3(uintBitsToFloat(uvec2(parts.row[row].two)), parts.row[row].one);
}

// Addresses of the first triangle's rows in the order of a ray's triangle test, and its origin likewise: so nothing that is loaded has to be
// permuted.
struct OrderedRows {
    uvec2 x;
    uvec2 y;
    uvec2 z;
    vec3 origin;
};

uvec2 address_plus(uvec2 address, uint bytes) {
    uint low = address.x + bytes;
    return uvec2(low, address.y + uint(low < bytes));
}

OrderedRows order_rows(MovedRay ray, GridHeader grid) {
    uvec3 offsets = 16u * axes_of(ray);
    uvec2 x = address_plus(grid.triangles, offsets.x);
    uvec2 y = address_plus(grid.triangles, offsets.y);
    uvec2 z = address_plus(grid.triangles, offsets.z);
    return OrderedRows(x, y, z, permute(ray, ray.origin));
}

Corners load_corners(OrderedRows rows, uint row) {
    return corners_of(rows.origin, load_row(rows.x, row), load_row(rows.y, row), load_row(rows.z, row));
}

// Walks until the end or for TURNS turns; true at the end.
bool walk_run(inout Walk walk, GridHeader grid, inout Counters counters) {
    OrderedRows rows = order_rows(walk.ray, grid);
    for (uint turn = 0u; turn < TURNS; ++turn) {
        uint steps = 0u;
        while (walk.reference >= walk.list_end && steps < STEPS_EACH_TURN) {
            if (walk_is_over(walk) || !walk_step(walk, grid)) {
                return true;
            }
            steps += 1u;
            if (COUNT) {
                counters.steps += 1u;
                counters.cells += uint(walk.reference < walk.list_end);
            }
        }
        uint stop = min(walk.list_end, walk.reference + TESTS_EACH_TURN);
        References references = References(grid.references);
        uint ahead = 0u;
        if (walk.reference < stop) {
            ahead = references.row[walk.reference];
        }
        while (walk.reference < stop) {
            if (COUNT) {
                counters.tests += 1u;
            }
            // What the next test begins with is on its way during this one.
            uint row = ahead;
            walk.reference += 1u;
            ahead = references.row[min(walk.reference, stop - 1u)];
            Corners corners = load_corners(rows, row);
            // As walk_test has it, but that all which a hit changes is in the branch that most tests do not take: drivers that run on a CPU pass
            // it by where no invocation of the subgroup takes it.
            vec3 edges = edge_functions(walk.ray, corners);
            if (is_inside(edges)) {
                float s;
                float u;
                float v;
                uint triangle = triangle_of(row);
                bool met = meet_triangle(walk.ray, corners, edges, s, u, v) && walk_improves(walk, s, triangle);
                if (met && (!EXTRAS || walk_accepts(walk, grid, triangle)) && TRACE_ACCEPT(triangle, u, v)) {
                    walk_commit(walk, s, u, v, triangle);
#ifdef TRACE_ANY
                    return true;
#endif
                }
            }
        }
    }
    return false;
}

#endif
