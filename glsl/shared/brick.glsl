// Bricks and their cells, as the rebuild goes through them.
#ifndef BRICK_GLSL
#define BRICK_GLSL

#include "shared/grid.glsl"

uint brick_id(uvec3 brick, uvec3 bricks_along) { return brick.x + bricks_along.x * (brick.y + bricks_along.y * brick.z); }

uint brick_count_of(uvec3 bricks_along) { return bricks_along.x * bricks_along.y * bricks_along.z; }

// The cells of a brick.
struct BrickCells {
    uvec3 low;
    uvec3 size; // below BRICK_SIZE at the grid's upper sides
};

BrickCells brick_cells(uint index, uvec3 resolution) {
    uvec3 bricks_along = brick_resolution(resolution);
    uint slice = index / bricks_along.x;
    BrickCells cells;
    cells.low = BRICK_SIZE * uvec3(index - slice * bricks_along.x, slice % bricks_along.y, slice / bricks_along.y);
    cells.size = min(uvec3(BRICK_SIZE), resolution - cells.low);
    return cells;
}

#endif
