#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One workgroup completes the report of the first level, scans what its tiles give the second to do, and begins the state of that.

#include "shared/occupancy.glsl"

layout(constant_id = 1) const uint BRICK_TILE = 1024;
layout(constant_id = 2) const uint MAP_SIZE = 64;
layout(constant_id = 3) const uint SCAN_TILE = 4096;
layout(constant_id = 4) const uint SORT_BITS = 10;

layout(push_constant, std430) uniform ReportSpine {
    GridwalkGrid grid;
    StateIn state;
    OccupancyInOut partials;
    StateOut leaf_state;
    LeafArgumentsOut arguments;
    ReportOut report;
    uint leaf_capacity;
};

void main() {
    uvec3 bricks_along = brick_resolution(grid.header.resolution);
    uint count = (bricks_along.x * bricks_along.y * bricks_along.z + BRICK_TILE - 1u) / BRICK_TILE;
    // A run of tiles an invocation.
    uint run = (count + gl_WorkGroupSize.x - 1u) / gl_WorkGroupSize.x;
    uint first = min(gl_LocalInvocationID.x * run, count);
    uint last = min(first + run, count);
    TileOccupancy mine = NOTHING;
    for (uint tile = first; tile < last; ++tile) {
        mine = unite(mine, partials.tile[tile]);
    }
    TileOccupancy sum = workgroup_occupancy(mine);
    bool long_lists = state.state.kept_count / LONG_LISTS >= sum.cells_in_use;
    uint which = uint(long_lists);
    uint split_cells;
    uint split_references;
    uint leaf_total;
    uint cells_before = workgroup_exclusive_scan(mine.split_cells[which], split_cells);
    uint references_before = workgroup_exclusive_scan(mine.split_references[which], split_references);
    uint leaves_before = workgroup_exclusive_scan(mine.leaf_cells[which], leaf_total);
    for (uint tile = first; tile < last; ++tile) {
        partials.tile[tile].cells_before = cells_before;
        partials.tile[tile].references_before = references_before;
        partials.tile[tile].leaves_before = leaves_before;
        cells_before += partials.tile[tile].split_cells[which];
        references_before += partials.tile[tile].split_references[which];
        leaves_before = saturating_add(leaves_before, partials.tile[tile].leaf_cells[which]);
    }
    if (gl_LocalInvocationID.x == 0u) {
        report.report.cells_in_use = sum.cells_in_use;
        report.report.longest_list = sum.longest_list;
        report.report.split_cells = split_cells;
        report.report.leaf_cells = leaf_total;
        report.report.leaf_pairs = 0u;
        report.report.overflow = state.state.overflow | (leaf_total > leaf_capacity ? OVERFLOW_LEAVES : 0u);

        uint leaf_cells = min(leaf_total, leaf_capacity);
        uint key_bits = leaf_cells <= 1u ? 0u : uint(findMSB(leaf_cells - 1u)) + 1u;
        uint pass_count = (key_bits + SORT_BITS - 1u) / SORT_BITS;
        uint digit_bits = pass_count == 0u ? 0u : (key_bits + pass_count - 1u) / pass_count;
        leaf_state.state = BuildState(0u, split_references + 1u, 0u, 0u, key_bits, pass_count, 0u, 0u, digit_bits, 0u, 0u, SATURATED,
                                      state.state.kept_count, grid.header.cell_count, split_cells,
                                      long_lists ? LEAST_SPLIT_OF_LONG : LEAST_SPLIT);
        bool any_split = split_cells != 0u;
        uint counts = split_references + 1u;
        arguments.arguments.split_cells = any_split ? uvec4(split_workgroups(count, 1u), 0u) : uvec4(0u);
        arguments.arguments.count = any_split ? uvec4(split_workgroups(counts, MAP_SIZE), 0u) : uvec4(0u);
        arguments.arguments.offsets_scan = any_split ? uvec4(split_workgroups(counts, SCAN_TILE), 0u) : uvec4(0u);
        // Without a split cell once, to leave out the steps that follow.
        arguments.arguments.args = any_split ? uvec4(split_workgroups(counts, SCAN_TILE), 0u) : uvec4(1u, 1u, 1u, 0u);
    }
}
