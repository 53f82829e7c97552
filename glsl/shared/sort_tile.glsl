// How pairs are cut into tiles of the sort.
#ifndef SORT_TILE_GLSL
#define SORT_TILE_GLSL

#include "shared/dispatch.glsl"

layout(constant_id = 21) const uint SORT_TILE = 8192; // keys of a tile, at most
layout(constant_id = 22) const uint SORT_TILES = 1; // tiles a workgroup
layout(constant_id = 23) const bool SORT_ALONE = false; // whether a tile is an invocation's

// Fewer keys than that are not worth a column of the digit table, whose rows are scanned by an invocation each: a turn for each tile.
const uint LEAST_SORT_TILE = 512u;
const uint MOST_SORT_TILES = 32768u;

// Most tiles of so many pairs. Those of invocations fill the workgroups of each strand: one with a workgroup more than the others would be
// waited for. No more for fewer pairs, as later passes have.
uint most_sort_tiles(uint pairs) {
    uint tiles = pairs / SORT_TILE + uint(pairs % SORT_TILE != 0u);
    if (!SORT_ALONE) {
        return tiles;
    }
    uvec3 groups = deal_workgroups(tiles, SORT_TILES);
    uint least = min(LEAST_SORT_TILE, SORT_TILE);
    uint most = min(pairs / least + uint(pairs % least != 0u), MOST_SORT_TILES);
    return min(groups.x * groups.y * groups.z * SORT_TILES, most);
}

// Keys of a tile of so many pairs.
uint sort_tile_of(uint pairs) {
    uint tiles = max(most_sort_tiles(pairs), 1u);
    return SORT_ALONE ? max((pairs + tiles - 1u) / tiles, 1u) : SORT_TILE;
}

// Workgroups of sort_histogram and sort_scatter.
uvec3 sort_workgroups(uint pairs) { return deal_workgroups(most_sort_tiles(pairs), SORT_TILES); }

#endif
