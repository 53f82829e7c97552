// What the kernels of the rebuild share: the state that replaces numbers read back by the host.
#ifndef BUILD_GLSL
#define BUILD_GLSL

#include "shared/dispatch.glsl"
#include "shared/grid.glsl"

const uint MAX_PASSES = 8u;
const uint SATURATED = 0xFFFFFFFFu;

// Host twin: gridwalk_core::layout::BuildState. A later kernel's number of elements is always taken from here.
struct BuildState {
    uint triangle_count;
    uint offset_count; // triangle_count + 1
    uint pair_total; // cells of all triangles, saturating
    uint pair_count; // at most the capacity
    uint key_bits;
    uint pass_count; // digits in use
    uint overflow; // OVERFLOW_* bits
    uint triangle_total; // of all geometries, saturating; triangle_count is at most the capacity
    uint digit_bits; // of each pass
    uint has_large; // 1: some triangle's box holds more cells than a mask has bits
    uint kept_count; // pairs with a cell: the first pass of the sort leaves the others behind
    uint sentinel; // key of a pair without a cell
    // The second level has a state of its own, with what follows and those of the sort.
    uint first_pair; // of its pairs, behind those of the first level
    uint first_cell; // of its cells, likewise
    uint split_cells; // cells with a record
    uint least_split; // triangles of the shortest list whose cell is split
};

const uint OVERFLOW_PAIRS = 1u;
const uint OVERFLOW_CELLS = 2u;
const uint OVERFLOW_TRIANGLES = 4u;
const uint OVERFLOW_LEAVES = 8u;

// Host twin: gridwalk_core::layout::DispatchArguments; each is a VkDispatchIndirectCommand and a word of padding. A pass that is not in
// use has zero groups.
struct DispatchArguments {
    uvec4 emit_large;
    uvec4 sort[MAX_PASSES];
    uvec4 table_scan[MAX_PASSES];
    uvec4 cell_ranges;
    uvec4 brick_reduce;
    uvec4 bricks; // one invocation each; brick_distance_x uses the first of them
    uvec4 clear_cells;
    // Written only where geometries are counted on the device.
    uvec4 gather;
    uvec4 overlap_count;
    uvec4 offsets_scan;
    // Written only where rays are sorted; then only this and the first passes' of the sort are.
    uvec4 ray_keys;
};

// Likewise of the second level. Host twin: gridwalk_core::layout::LeafArguments.
struct LeafArguments {
    uvec4 split_cells;
    uvec4 count;
    uvec4 offsets_scan;
    uvec4 args; // of leaf_args
    uvec4 emit_large;
    uvec4 leaf_sort;
    uvec4 emit;
    uvec4 sort[MAX_PASSES];
    uvec4 table_scan[MAX_PASSES];
    uvec4 cell_ranges;
    uvec4 distance;
};

layout(buffer_reference, std430, buffer_reference_align = 16) buffer LeafArgumentsInOut { LeafArguments arguments; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer LeafArgumentsOut { LeafArguments arguments; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer StateIn { BuildState state; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer StateOut { BuildState state; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer StateInOut { BuildState state; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer UintsIn { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer UintsOut { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) buffer UintsInOut { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer FloatsIn { float word[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer HeaderOut { GridHeader header; };

// Host twin: gridwalk_core::layout::Report.
struct Report {
    uint triangles;
    uint dropped;
    uint cells;
    uint cells_in_use;
    uvec3 resolution;
    uint longest_list;
    uint pairs;
    uint pair_total;
    uint overflow;
    uint key_bits;
    vec3 box_min;
    float density;
    vec3 box_max;
    uint triangle_total;
    uint split_cells;
    uint leaf_cells;
    uint leaf_pairs;
    uint reserved;
};

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer ArgumentsOut { DispatchArguments arguments; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer ReportOut { Report report; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer ReportInOut { Report report; };

// Pairs that a pass of the sort reads. The first leaves those without a cell behind.
uint pairs_of(StateIn state, uint pass) { return pass == 0u ? state.state.pair_count : state.state.kept_count; }

uint saturating_add(uint a, uint b) {
    uint sum = a + b;
    return sum < a ? SATURATED : sum;
}

#endif
