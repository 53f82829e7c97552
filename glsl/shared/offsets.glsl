// The second step of the exclusive scan of counts: each workgroup scans its tile in place, from the sum of all tiles before, which it makes
// itself of theirs. The last one then knows the sum of all.
#ifndef OFFSETS_GLSL
#define OFFSETS_GLSL

#include "shared/scan.glsl"

layout(constant_id = 1) const uint ITEMS_EACH = 16;

// Whether the workgroup's tile is the last; its sum with all before is `sum`, in all invocations.
bool scan_tile(UintsIn partials, UintsInOut values, uint length, out uint sum) {
    uint tile_size = gl_WorkGroupSize.x * ITEMS_EACH;
    uint tiles = (length + tile_size - 1u) / tile_size;
    uint tile = workgroup_index();
    uint mine = 0u;
    for (uint i = gl_LocalInvocationID.x; i < min(tile, tiles); i += gl_WorkGroupSize.x) {
        mine = saturating_add(mine, partials.word[i]);
    }
    uint before_tile;
    workgroup_exclusive_scan(mine, before_tile);
    uint first = tile * tile_size + gl_LocalInvocationID.x * ITEMS_EACH;
    uint last = min(first + ITEMS_EACH, length);
    mine = 0u;
    for (uint i = first; i < last; ++i) {
        mine = saturating_add(mine, values.word[i]);
    }
    uint total;
    uint before = saturating_add(before_tile, workgroup_exclusive_scan(mine, total));
    for (uint i = first; i < last; ++i) {
        uint value = values.word[i];
        values.word[i] = before;
        before = saturating_add(before, value);
    }
    sum = saturating_add(before_tile, total);
    return tile + 1u == tiles;
}

#endif
