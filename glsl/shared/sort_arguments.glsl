// The sizes of the steps that sort pairs and make lists of them.
#ifndef SORT_ARGUMENTS_GLSL
#define SORT_ARGUMENTS_GLSL

#include "shared/build.glsl"
#include "shared/sort_tile.glsl"

layout(constant_id = 2) const uint MAP_SIZE = 64;
layout(constant_id = 5) const uint RANGE_PAIRS = 1; // pairs an invocation of cell_ranges
layout(constant_id = 6) const uint TABLE_ROWS = 1; // rows of the digit table a workgroup of table_scan

// Of sort_histogram and sort_scatter.
uvec4 sort_groups(uint pairs) { return pairs > 0u ? uvec4(sort_workgroups(pairs), 0u) : uvec4(0u); }

// Of table_scan; none without a pair.
uvec4 table_groups(uint pairs, uint digit_bits) {
    return pairs > 0u ? uvec4(split_workgroups(1u << digit_bits, TABLE_ROWS), 0u) : uvec4(0u);
}

// Of cell_ranges.
uvec4 range_groups(uint pairs) { return uvec4(deal_workgroups((pairs + RANGE_PAIRS - 1u) / RANGE_PAIRS, MAP_SIZE), 0u); }

#endif
