#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One workgroup scans the tiles' sums in place; the sum of all is wanted of the first digit table.

#include "shared/scan.glsl"

layout(constant_id = 1) const uint ITEMS_EACH = 16;
layout(constant_id = 2) const uint SCAN_TILE = 4096;

layout(push_constant, std430) uniform ScanSpine {
    StateIn state;
    UintsInOut partials;
    StateOut kept; // the same state, of which one word is written
    uint which;
};

void main() {
    uint length = (scan_length(state, which) + SCAN_TILE - 1u) / SCAN_TILE;
    uint stride = gl_WorkGroupSize.x * ITEMS_EACH;
    uint carry = 0u;
    for (uint base = 0u; base < length; base += stride) {
        uint first = base + gl_LocalInvocationID.x * ITEMS_EACH;
        uint last = min(first + ITEMS_EACH, length);
        uint sum = 0u;
        for (uint i = first; i < last; ++i) {
            sum = saturating_add(sum, partials.word[i]);
        }
        uint total;
        uint before = saturating_add(carry, workgroup_exclusive_scan(sum, total));
        for (uint i = first; i < last; ++i) {
            uint value = partials.word[i];
            partials.word[i] = before;
            before = saturating_add(before, value);
        }
        carry = saturating_add(carry, total);
    }
    if (which == SCAN_FIRST_TABLE && gl_LocalInvocationID.x == 0u) {
        kept.state.kept_count = carry;
    }
}
