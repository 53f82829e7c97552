#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Empties the cells of the bricks that triangles may lie in: an invocation, a slice of a brick. What the others hold is never looked at.

#include "shared/brick.glsl"
#include "shared/build.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(buffer_reference, std430, buffer_reference_align = 8) writeonly buffer CellsOut { uvec2 range[]; };

layout(push_constant, std430) uniform ClearCells {
    GridwalkGrid grid;
    UintsIn used;
    CellsOut cells;
};

void main() {
    uvec3 resolution = grid.header.resolution;
    uint slice = invocation_index();
    uint index = slice / BRICK_SIZE;
    if (index >= brick_count_of(brick_resolution(resolution)) || used.word[index] == 0u) {
        return;
    }
    BrickCells brick = brick_cells(index, resolution);
    uint z = slice % BRICK_SIZE;
    if (z >= brick.size.z) {
        return;
    }
    for (uint y = 0u; y < brick.size.y; ++y) {
        uint row = cell_id(brick.low + uvec3(0u, y, z), resolution);
        for (uint x = 0u; x < BRICK_SIZE; ++x) {
            // The last again where the grid ends: no branch.
            cells.range[row + min(x, brick.size.x - 1u)] = uvec2(0u);
        }
    }
}
