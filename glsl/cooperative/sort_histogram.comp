#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// How often each digit occurs in a tile of keys that have a cell.

#include "shared/sort.glsl"

layout(push_constant, std430) uniform SortHistogram {
    StateIn state;
    UintsIn keys_a;
    UintsIn keys_b;
    UintsOut table;
    uint pass;
};

UintsIn keys_of(uint pass) { return UintsIn(writes_a(state.state.pass_count, pass) ? uvec2(keys_a) : uvec2(keys_b)); }

void histogram_alone() {
    uint tile = invocation_index();
    uint pair_count = pairs_of(state, pass);
    uint bits = state.state.digit_bits;
    uint sentinel = state.state.sentinel;
    uint tile_size = sort_tile_of(pair_count);
    uint tile_count = (pair_count + tile_size - 1u) / tile_size;
    if (tile >= tile_count) {
        return;
    }
    UintsIn keys = keys_of(pass);
    uint count[1u << SORT_BITS];
    for (uint digit = 0u; digit < 1u << bits; ++digit) {
        count[digit] = 0u;
    }
    uint begin = state.state.first_pair;
    uint first = begin + tile * tile_size;
    uint last = min(first + tile_size, begin + pair_count);
    for (uint i = first; i < last; ++i) {
        uint key = keys.word[i];
        count[digit_of(key, pass, bits)] += uint(key != sentinel);
    }
    for (uint digit = 0u; digit < 1u << bits; ++digit) {
        table.word[digit * tile_count + tile] = count[digit];
    }
}

void histogram_together() {
    uint tile = workgroup_index();
    uint tile_size = gl_WorkGroupSize.x * KEYS_EACH;
    uint pair_count = pairs_of(state, pass);
    uint bits = state.state.digit_bits;
    uint sentinel = state.state.sentinel;
    uint tile_count = (pair_count + tile_size - 1u) / tile_size;
    if (tile >= tile_count) {
        return;
    }
    uint begin = state.state.first_pair;
    uint first = tile * tile_size + gl_LocalInvocationID.x * KEYS_EACH;
    count_run(keys_of(pass), pass, bits, sentinel, begin + first, begin + min(first + KEYS_EACH, pair_count));
    barrier();
    for (uint digit = gl_LocalInvocationID.x; digit < 1u << bits; digit += gl_WorkGroupSize.x) {
        uint sum = 0u;
        for (uint column = 0u; column < gl_WorkGroupSize.x; ++column) {
            sum += counter[digit * gl_WorkGroupSize.x + column];
        }
        table.word[digit * tile_count + tile] = sum;
    }
}

void main() {
    if (SORT_ALONE) {
        histogram_alone();
    } else {
        histogram_together();
    }
}
