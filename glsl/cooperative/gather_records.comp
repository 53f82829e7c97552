#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Triangles of all geometries, and the box of each tile of them, as kernel gather has them.

#include "shared/bounds.glsl"
#include "shared/gather.glsl"
#include "shared/geometry.glsl"

layout(constant_id = 1) const uint TRIANGLES_EACH = 8;

layout(push_constant, std430) uniform GatherRecords {
    RecordsIn records;
    UintsIn firsts;
    StateIn state;
    TriangleWordsOut triangles;
    BoundsOut partials;
    uint record_count;
};

// The last record whose first triangle is not after `triangle`: the one that has it. At most 17 turns.
uint owner(uint triangle) {
    uint low = 0u;
    uint high = record_count;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (firsts.word[middle] <= triangle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

void gather(uint triangle, inout Bounds bounds) {
    uint index = owner(triangle);
    GeometryRecord record = records.record[index];
    uint local = triangle - firsts.word[index];
    uvec3 vertex = vertices_of(record, local);
    bool is_whole = all(lessThan(vertex, uvec3(record.vertex_count)));
    vec3 v0 = vec3(0.0);
    vec3 v1 = vec3(0.0);
    vec3 v2 = vec3(0.0);
    if (is_whole) {
        v0 = position_of(record, vertex.x);
        v1 = position_of(record, vertex.y);
        v2 = position_of(record, vertex.z);
    }
    uint flags = local | ((record.flags & FLAG_FLIP_FACING) != 0u ? TRIANGLE_FLIPPED : 0u)
        | ((record.flags & FLAG_TWO_SIDED) != 0u ? TRIANGLE_TWO_SIDED : 0u);
    write_triangle(triangles, triangle, v0, v1, v2, is_whole, TriangleWords(flags, record.id, record.mask), bounds);
}

void main() {
    uint triangle_count = state.state.triangle_count;
    uint tile = workgroup_index();
    uint first = tile * gl_WorkGroupSize.x * TRIANGLES_EACH;
    Bounds bounds = empty_bounds();
    for (uint i = 0u; i < TRIANGLES_EACH; ++i) {
        uint triangle = first + i * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
        if (triangle < triangle_count) {
            gather(triangle, bounds);
        }
    }
    bounds = workgroup_bounds(bounds);
    if (gl_LocalInvocationID.x == 0u && first < max(triangle_count, 1u)) {
        partials.bounds[tile] = bounds;
    }
}
