#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Triangles of all geometries, one an invocation.

#include "shared/gather.glsl"
#include "shared/geometry.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;

layout(push_constant, std430) uniform GatherRecords {
    RecordsIn records;
    UintsIn firsts;
    StateIn state;
    TriangleWordsOut triangles;
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

void main() {
    uint triangle = invocation_index();
    if (triangle >= state.state.triangle_count) {
        return;
    }
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
    write_triangle(triangles, triangle, v0, v1, v2, is_whole, TriangleWords(flags, record.id, record.mask));
}
