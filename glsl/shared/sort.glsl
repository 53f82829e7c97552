// A pass of the least-significant-digit radix sort over tiles of pairs. Each invocation counts a run of consecutive keys in counters of its
// own: no atomic and no subgroup operation, and the order of equal digits is kept. A tile is the runs of a workgroup, whose counters are
// columns in shared memory; or a run alone, whose counters are a private array: a driver that runs on a CPU reaches that with half the
// instructions, and nothing has to be exchanged.
#ifndef SORT_GLSL
#define SORT_GLSL

#include "shared/build.glsl"
#include "shared/ping_pong.glsl"
#include "shared/sort_tile.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 8) in;
layout(constant_id = 1) const uint SORT_BITS = 10;
layout(constant_id = 2) const uint KEYS_EACH = 1024;

// A row a digit, a column an invocation; at most 8,192 counters (32 KiB).
shared uint counter[SORT_ALONE ? 1u : (1u << SORT_BITS) * gl_WorkGroupSize.x];

// `bits` a digit, at most SORT_BITS.
uint digit_of(uint key, uint pass, uint bits) { return (key >> (pass * bits)) & ((1u << bits) - 1u); }

void count_run(UintsIn keys, uint pass, uint bits, uint sentinel, uint first, uint last) {
    uint column = gl_LocalInvocationID.x;
    for (uint digit = 0u; digit < 1u << bits; ++digit) {
        counter[digit * gl_WorkGroupSize.x + column] = 0u;
    }
    for (uint i = first; i < last; ++i) {
        uint key = keys.word[i];
        counter[digit_of(key, pass, bits) * gl_WorkGroupSize.x + column] += uint(key != sentinel);
    }
}

#endif
