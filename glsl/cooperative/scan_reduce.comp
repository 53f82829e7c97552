#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// The saturating sum of a tile of counts: the first step of their exclusive scan. The second is pair_args's, or leaf_args's.

#include "shared/scan.glsl"

layout(constant_id = 1) const uint ITEMS_EACH = 16;

layout(push_constant, std430) uniform ScanReduce {
    StateIn state;
    UintsIn values;
    UintsOut partials;
};

void main() {
    uint tile = workgroup_index();
    uint length = state.state.offset_count;
    uint first = (tile * gl_WorkGroupSize.x + gl_LocalInvocationID.x) * ITEMS_EACH;
    uint sum = 0u;
    for (uint i = first; i < min(first + ITEMS_EACH, length); ++i) {
        sum = saturating_add(sum, values.word[i]);
    }
    uint total;
    workgroup_exclusive_scan(sum, total);
    if (gl_LocalInvocationID.x == 0u && tile * gl_WorkGroupSize.x * ITEMS_EACH < length) {
        partials.word[tile] = total;
    }
}
