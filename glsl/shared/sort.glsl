// A pass of the least-significant-digit radix sort over a tile of pairs. Each invocation counts a run of consecutive keys in a column of
// counters of its own: no atomic and no subgroup operation, and the order of equal digits is kept.
#ifndef SORT_GLSL
#define SORT_GLSL

#include "shared/build.glsl"
#include "shared/ping_pong.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 8) in;
layout(constant_id = 1) const uint SORT_BITS = 8;
layout(constant_id = 2) const uint KEYS_EACH = 512;

const uint DIGITS = 1u << SORT_BITS;

// A row a digit, a column an invocation; at most 4,096 counters (16 KiB).
shared uint counter[DIGITS * gl_WorkGroupSize.x];

uint digit_of(uint key, uint pass) { return (key >> (pass * SORT_BITS)) & (DIGITS - 1u); }

void count_run(UintsIn keys, uint pass, uint first, uint last) {
    uint column = gl_LocalInvocationID.x;
    for (uint digit = 0u; digit < DIGITS; ++digit) {
        counter[digit * gl_WorkGroupSize.x + column] = 0u;
    }
    for (uint i = first; i < last; ++i) {
        counter[digit_of(keys.word[i], pass) * gl_WorkGroupSize.x + column] += 1u;
    }
}

#endif
