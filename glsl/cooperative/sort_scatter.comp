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
    UintsIn table; // scanned: how many keys of a digit stand in the tiles before
    UintsIn sums; // keys of each digit
    StateOut kept; // the same state, of which the first pass writes a word
    uint pass;
};

struct Buffers {
    UintsIn keys;
    UintsIn values;
    UintsOut keys_out;
    UintsOut values_out;
};

Buffers buffers_of(uint pass) {
    bool from_a = writes_a(state.state.pass_count, pass);
    return Buffers(UintsIn(from_a ? uvec2(keys_a) : uvec2(keys_b)), UintsIn(from_a ? uvec2(values_a) : uvec2(values_b)),
                   UintsOut(from_a ? uvec2(keys_b) : uvec2(keys_a)), UintsOut(from_a ? uvec2(values_b) : uvec2(values_a)));
}

void scatter_alone() {
    uint tile = invocation_index();
    uint pair_count = pairs_of(state, pass);
    uint bits = state.state.digit_bits;
    uint sentinel = state.state.sentinel;
    uint tile_size = sort_tile_of(pair_count);
    uint tile_count = (pair_count + tile_size - 1u) / tile_size;
    if (tile >= tile_count) {
        return;
    }
    Buffers buffers = buffers_of(pass);
    uint begin = state.state.first_pair;
    uint next[1u << SORT_BITS]; // where the next key of a digit goes
    uint row = begin; // where the first key of a digit goes
    for (uint digit = 0u; digit < 1u << bits; ++digit) {
        next[digit] = row + table.word[digit * tile_count + tile];
        row += sums.word[digit];
    }
    if (pass == 0u && tile == 0u) {
        kept.state.kept_count = row - begin;
    }
    uint first = begin + tile * tile_size;
    uint last = min(first + tile_size, begin + pair_count);
    for (uint i = first; i < last; ++i) {
        uint key = buffers.keys.word[i];
        uint value = buffers.values.word[i];
        uint digit = digit_of(key, pass, bits);
        if (key != sentinel) {
            uint destination = next[digit];
            next[digit] = destination + 1u;
            buffers.keys_out.word[destination] = key;
            buffers.values_out.word[destination] = value;
        }
    }
}

void scatter_together() {
    uint tile = workgroup_index();
    uint tile_size = gl_WorkGroupSize.x * KEYS_EACH;
    uint pair_count = pairs_of(state, pass);
    uint bits = state.state.digit_bits;
    uint sentinel = state.state.sentinel;
    uint tile_count = (pair_count + tile_size - 1u) / tile_size;
    if (tile >= tile_count) {
        return;
    }
    Buffers buffers = buffers_of(pass);
    uint begin = state.state.first_pair;
    uint first = begin + tile * tile_size + gl_LocalInvocationID.x * KEYS_EACH;
    uint last = min(first + KEYS_EACH, begin + pair_count);
    count_run(buffers.keys, pass, bits, sentinel, first, last);
    barrier();
    uint row = begin; // where the first key of digit `reached` goes
    uint reached = 0u;
    for (uint digit = gl_LocalInvocationID.x; digit < 1u << bits; digit += gl_WorkGroupSize.x) {
        for (; reached < digit; ++reached) {
            row += sums.word[reached];
        }
        uint next = row + table.word[digit * tile_count + tile];
        for (uint column = 0u; column < gl_WorkGroupSize.x; ++column) {
            uint i = digit * gl_WorkGroupSize.x + column;
            uint count = counter[i];
            counter[i] = next;
            next += count;
        }
    }
    if (pass == 0u && tile == 0u && gl_LocalInvocationID.x == 0u) {
        for (; reached < 1u << bits; ++reached) {
            row += sums.word[reached];
        }
        kept.state.kept_count = row - begin;
    }
    barrier();
    for (uint i = first; i < last; ++i) {
        uint key = buffers.keys.word[i];
        uint slot = digit_of(key, pass, bits) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (key != sentinel) {
            uint destination = counter[slot];
            counter[slot] = destination + 1u;
            buffers.keys_out.word[destination] = key;
            buffers.values_out.word[destination] = buffers.values.word[i];
        }
    }
}

void main() {
    if (SORT_ALONE) {
        scatter_alone();
    } else {
        scatter_together();
    }
}
