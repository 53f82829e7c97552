// The grid as data. Everything from the header on lives in the grid's frame: (input coordinate - middle) * scale. The scale is a power of
// two chosen so that the largest |coordinate| lies in [1, 2): the product is exact, and no threshold below depends on the unit of the scene.
// The middle is zero but along axes on which the scene lies so far from the origin that the difference is exact (Sterbenz 1974): what
// counts for the padding is then the scene's size, not its place.
#ifndef GRID_GLSL
#define GRID_GLSL

#include "shared/types.glsl"

// [begin, end) in the references; {0, 0} for an empty cell, but nothing that counts where its brick is empty. A split cell has the index of
// its first leaf cell instead, and CELL_SPLIT with its level: 2^level leaf cells along each axis, x fastest. They lie behind the grid's
// cells, in the same words; {d, 0} for an empty one: all leaf cells of the same cell that are closer than d in the maximum norm are empty,
// and d = 0 says no more than d = 1.
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer Cells { uvec2 range[]; };
// A triangle is referred to by the index of its first row: three times its own.
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer References { uint row[]; };
// Three rows a triangle: the x of its vertices, their y, their z; all zero for a dropped triangle, which no ray hits. The fourth components are
// words: TRIANGLE_* bits with the triangle's number in its geometry, the geometry's id, and its mask.
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Triangles { vec4 row[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer TriangleWordsIn { uvec4 row[]; };

// The triangle of a first row: a third of it, by the inverse of 3 modulo 2^32, since 3 divides it.
uint triangle_of(uint row) { return row * 0xAAAAAAABu; }

const uint CELL_SPLIT = 1u << 31;
const uint CELL_LEVEL = 7u;

const uint TRIANGLE_DROPPED = 1u << 31;
const uint TRIANGLE_FLIPPED = 1u << 30; // its front is where its vertices go round clockwise
const uint TRIANGLE_TWO_SIDED = 1u << 29; // never culled
const uint TRIANGLE_NUMBER = (1u << 26) - 1u;

// A brick is a block of 4^3 cells. Bit x + 4 y + 16 z of the mask (low word first) is set for a cell that is not empty. All bricks closer
// than `distance`, in the maximum norm, are empty: 0 for a brick that is not.
struct Brick {
    uvec2 mask;
    uint distance;
    uint longest_list; // of its cells, before they were split
};
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Bricks { Brick brick[]; };

const uint BRICK_SIZE = 4u;

uvec3 brick_resolution(uvec3 resolution) { return (resolution + uvec3(BRICK_SIZE - 1u)) / BRICK_SIZE; }

// Host twin: gridwalk_core::layout::GridHeader.
struct GridHeader {
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

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer GridwalkGrid { GridHeader header; };

// To be called before any invocation has returned: a driver that runs on a CPU loads a word once for a subgroup only where it knows all of its
// invocations to be active, and elsewhere once for each. Kernels that many elements pass through load other words there too.
GridHeader load_header(GridwalkGrid grid) { return grid.header; }

vec3 to_frame(GridHeader grid, vec3 point) { return (point - grid.middle) * grid.scale; }

// Lower boundary of cell i, upper boundary of cell i - 1. The one function that both the build and the walk use: the walk is watertight
// only if they agree bit for bit.
vec3 boundary(vec3 box_min, vec3 cell_size, vec3 i) {
    vec3 offset = i * cell_size;
    return box_min + offset;
}

// Of whole numbers in [0, 2^23): added to 2^23 they are the mantissa. Drivers that run on a CPU convert floats to integers one invocation
// at a time.
uvec3 whole(vec3 x) { return floatBitsToUint(x + vec3(8388608.0)) & uvec3(0x7FFFFFu); }

// floor(x) for x in [0.5, 2^23 - 0.5], likewise: the nearest to x - 0.5. Of odd whole numbers the one below. For larger x a larger number.
ivec3 whole_below(vec3 x) { return floatBitsToInt(x + vec3(8388607.5)) - ivec3(0x4B000000); }

// Two products that do not wait for each other.
uint cell_id(uvec3 cell, uvec3 resolution) { return cell.x + resolution.x * cell.y + resolution.x * resolution.y * cell.z; }

#endif
