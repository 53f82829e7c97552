// What is reduced over the cells of bricks: numbers of the report, and how much the second level has to do.
#ifndef OCCUPANCY_GLSL
#define OCCUPANCY_GLSL

#include "shared/brick.glsl"
#include "shared/scan.glsl"
#include "shared/split.glsl"

// Host twin: gridwalk_core::layout::TileOccupancy.
struct TileOccupancy {
    uint cells_in_use;
    uint longest_list;
    // Of the cells that are split if LEAST_SPLIT is the least list, and if LEAST_SPLIT_OF_LONG is: report_spine decides.
    uint split_cells[2];
    uint split_references[2]; // triangles in their lists
    uint leaf_cells[2];
    // Of all tiles before; written by report_spine.
    uint cells_before;
    uint references_before;
    uint leaves_before;
    uint reserved;
};

layout(buffer_reference, std430, buffer_reference_align = 16) buffer OccupancyInOut { TileOccupancy tile[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer OccupancyIn { TileOccupancy tile[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer OccupancyOut { TileOccupancy tile[]; };

shared TileOccupancy workgroup_partial[gl_WorkGroupSize.x];

const TileOccupancy NOTHING = TileOccupancy(0u, 0u, uint[2](0u, 0u), uint[2](0u, 0u), uint[2](0u, 0u), 0u, 0u, 0u, 0u);

TileOccupancy unite(TileOccupancy a, TileOccupancy b) {
    TileOccupancy sum = NOTHING;
    sum.cells_in_use = a.cells_in_use + b.cells_in_use;
    sum.longest_list = max(a.longest_list, b.longest_list);
    for (uint i = 0u; i < 2u; ++i) {
        sum.split_cells[i] = a.split_cells[i] + b.split_cells[i];
        sum.split_references[i] = a.split_references[i] + b.split_references[i];
        sum.leaf_cells[i] = saturating_add(a.leaf_cells[i], b.leaf_cells[i]);
    }
    return sum;
}

// Over the workgroup, in all invocations. The workgroup size is a power of two.
TileOccupancy workgroup_occupancy(TileOccupancy mine) {
    uint lane = gl_LocalInvocationID.x;
    workgroup_partial[lane] = mine;
    barrier();
    for (uint reach = gl_WorkGroupSize.x / 2u; reach > 0u; reach /= 2u) {
        if (lane < reach) {
            workgroup_partial[lane] = unite(workgroup_partial[lane], workgroup_partial[lane + reach]);
        }
        barrier();
    }
    return workgroup_partial[0];
}

#endif
