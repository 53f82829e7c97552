#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The exclusive scan of a tile in place, from the scanned sum of all tiles before it.

#include "shared/scan.glsl"

layout(constant_id = 1) const uint ITEMS_EACH = 16;

layout(push_constant, std430) uniform ScanDownsweep {
    StateIn state;
    UintsIn partials;
    UintsInOut values;
    uint which;
};

void main() {
    uint tile = workgroup_index();
    uint length = scan_length(state, which);
    uint first = (tile * gl_WorkGroupSize.x + gl_LocalInvocationID.x) * ITEMS_EACH;
    uint last = min(first + ITEMS_EACH, length);
    uint sum = 0u;
    for (uint i = first; i < last; ++i) {
        sum = saturating_add(sum, values.word[i]);
    }
    uint total;
    uint before = workgroup_exclusive_scan(sum, total);
    before = saturating_add(before, first < last ? partials.word[tile] : 0u);
    for (uint i = first; i < last; ++i) {
        uint value = values.word[i];
        values.word[i] = before;
        before = saturating_add(before, value);
    }
}
