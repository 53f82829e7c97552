#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Moves a tile of pairs to where their digit puts them; those without a cell go nowhere.

#include "shared/sort.glsl"

layout(push_constant, std430) uniform SortScatter {
    StateIn state;
    UintsInOut keys_a;
    UintsInOut keys_b;
    UintsInOut values_a;
    UintsInOut values_b;
    UintsIn table; // scanned: where the tile's first key of a digit goes
    uint pass;
};

void main() {
    uint tile = workgroup_index();
    uint tile_size = gl_WorkGroupSize.x * KEYS_EACH;
    uint pair_count = pairs_of(state, pass);
    uint bits = state.state.digit_bits;
    uint sentinel = state.state.sentinel;
    uint tile_count = (pair_count + tile_size - 1u) / tile_size;
    if (tile >= tile_count) {
        return;
    }
    bool from_a = writes_a(state.state.pass_count, pass);
    UintsIn keys = UintsIn(from_a ? uvec2(keys_a) : uvec2(keys_b));
    UintsIn values = UintsIn(from_a ? uvec2(values_a) : uvec2(values_b));
    UintsOut keys_out = UintsOut(from_a ? uvec2(keys_b) : uvec2(keys_a));
    UintsOut values_out = UintsOut(from_a ? uvec2(values_b) : uvec2(values_a));
    uint first = tile * tile_size + gl_LocalInvocationID.x * KEYS_EACH;
    uint last = min(first + KEYS_EACH, pair_count);
    count_run(keys, pass, bits, sentinel, first, last);
    barrier();
    for (uint digit = gl_LocalInvocationID.x; digit < 1u << bits; digit += gl_WorkGroupSize.x) {
        uint next = table.word[digit * tile_count + tile];
        for (uint column = 0u; column < gl_WorkGroupSize.x; ++column) {
            uint i = digit * gl_WorkGroupSize.x + column;
            uint count = counter[i];
            counter[i] = next;
            next += count;
        }
    }
    barrier();
    for (uint i = first; i < last; ++i) {
        uint key = keys.word[i];
        uint slot = digit_of(key, pass, bits) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (key != sentinel) {
            uint destination = counter[slot];
            counter[slot] = destination + 1u;
            keys_out.word[destination] = key;
            values_out.word[destination] = values.word[i];
        }
    }
}
