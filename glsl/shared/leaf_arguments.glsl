// The sizes of the steps that sort the second level's pairs all together, written by leaf_args, or by leaf_sort where it cannot.
#ifndef LEAF_ARGUMENTS_GLSL
#define LEAF_ARGUMENTS_GLSL

#include "shared/build.glsl"

layout(constant_id = 2) const uint MAP_SIZE = 64;
layout(constant_id = 3) const uint SORT_TILE = 8192;
layout(constant_id = 4) const uint SORT_TILES = 1; // tiles a workgroup of the sort
layout(constant_id = 5) const uint RANGE_PAIRS = 1; // pairs an invocation of cell_ranges
layout(constant_id = 6) const uint TABLE_ROWS = 1; // rows of the digit table a workgroup of table_scan

// `count` pairs by digits of so many bits in the passes that are in use; the emission takes as many workgroups as the count of pairs did. Zero
// pairs: no workgroup.
void write_sort(LeafArgumentsInOut arguments, uint count, uint passes, uint digit_bits, uint pass_capacity) {
    uint tiles = (count + SORT_TILE - 1u) / SORT_TILE;
    arguments.arguments.emit = count > 0u ? arguments.arguments.count : uvec4(0u);
    arguments.arguments.cell_ranges = uvec4(split_workgroups((count + RANGE_PAIRS - 1u) / RANGE_PAIRS, MAP_SIZE), 0u);
    for (uint pass = 0u; pass < pass_capacity; ++pass) {
        bool used = pass < passes && count > 0u;
        arguments.arguments.sort[pass] = used ? uvec4(split_workgroups(tiles, SORT_TILES), 0u) : uvec4(0u);
        arguments.arguments.table_scan[pass] = used ? uvec4(split_workgroups(1u << digit_bits, TABLE_ROWS), 0u) : uvec4(0u);
    }
}

#endif
