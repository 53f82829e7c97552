#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One workgroup finds the first triangle of each geometry, and from the number of all triangles the sizes of the steps that follow.

#include "shared/gather.glsl"
#include "shared/geometry.glsl"
#include "shared/scan.glsl"

layout(constant_id = 1) const uint ITEMS_EACH = 16;
layout(constant_id = 2) const uint MAP_SIZE = 64;
layout(constant_id = 3) const uint SCAN_TILE = 4096;
layout(constant_id = 4) const uint BOUNDS_TILE = 2048;

layout(push_constant, std430) uniform GeometryScan {
    RecordsIn records;
    UintsOut firsts;
    StateOut state;
    ArgumentsOut arguments;
    uint record_count; // at most 65,536: no invocation has more than 16,384 turns
    uint triangle_capacity;
};

void main() {
    uint stride = gl_WorkGroupSize.x * ITEMS_EACH;
    uint total = 0u;
    for (uint base = 0u; base < record_count; base += stride) {
        uint first = base + gl_LocalInvocationID.x * ITEMS_EACH;
        uint last = min(first + ITEMS_EACH, record_count);
        uint sum = 0u;
        for (uint i = first; i < last; ++i) {
            sum = saturating_add(sum, count_of(records, i));
        }
        uint tile_total;
        uint before = saturating_add(total, workgroup_exclusive_scan(sum, tile_total));
        for (uint i = first; i < last; ++i) {
            firsts.word[i] = before;
            before = saturating_add(before, count_of(records, i));
        }
        total = saturating_add(total, tile_total);
    }
    if (gl_LocalInvocationID.x == 0u) {
        uint count = min(total, triangle_capacity);
        state.state = gathered_state(count, total);
        arguments.arguments.gather = uvec4(split_workgroups(max(count, 1u), BOUNDS_TILE), 0u);
        arguments.arguments.overlap_count = uvec4(split_workgroups(count + 1u, MAP_SIZE), 0u);
        arguments.arguments.offsets_scan = uvec4(split_workgroups(count + 1u, SCAN_TILE), 0u);
    }
}
