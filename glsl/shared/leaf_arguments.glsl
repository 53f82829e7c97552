// The sizes of the steps that sort the second level's pairs all together, written by leaf_args, or by leaf_sort where it cannot.
#ifndef LEAF_ARGUMENTS_GLSL
#define LEAF_ARGUMENTS_GLSL

#include "shared/sort_arguments.glsl"

// `count` pairs by digits of so many bits in the passes that are in use; the emission takes as many workgroups as the count of pairs did. Zero
// pairs: no workgroup.
void write_sort(LeafArgumentsInOut arguments, uint count, uint passes, uint digit_bits, uint pass_capacity) {
    arguments.arguments.emit = count > 0u ? arguments.arguments.count : uvec4(0u);
    arguments.arguments.cell_ranges = range_groups(count);
    for (uint pass = 0u; pass < pass_capacity; ++pass) {
        uint sorted = pass < passes ? count : 0u;
        arguments.arguments.sort[pass] = sort_groups(sorted);
        arguments.arguments.table_scan[pass] = table_groups(sorted, digit_bits);
    }
}

#endif
