// Geometry as the caller describes it, and how it is read: by 64-bit addresses, in words of 4 bytes.
#ifndef GEOMETRY_GLSL
#define GEOMETRY_GLSL

#include "shared/build.glsl"

// Host twin: gridwalk_core::geometry::GeometryRecord, which documents the fields.
struct GeometryRecord {
    vec4 transform[3];
    vec3 scale;
    uint stride;
    vec3 offset;
    uint vertex_count;
    uvec2 positions;
    uvec2 indices;
    uvec2 count;
    uint triangle_count;
    uint format;
    uint index_type;
    uint id;
    uint mask;
    uint flags;
};

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer RecordsIn { GeometryRecord record[]; };

const uint FORMAT_FLOAT32X3 = 0u;
const uint FORMAT_FLOAT16X4 = 1u;
const uint FORMAT_SNORM16X4 = 2u;
const uint INDEX_NONE = 0u;
const uint INDEX_UINT16 = 1u;
const uint FLAG_FLIP_FACING = 1u;
const uint FLAG_TWO_SIDED = 2u;

// address + index * stride.
uvec2 element_address(uvec2 address, uint index, uint stride) {
    uint high;
    uint low;
    umulExtended(index, stride, high, low);
    uint carry;
    uint sum = uaddCarry(address.x, low, carry);
    return uvec2(sum, address.y + high + carry);
}

// Exact on every device, where unpackHalf2x16 may take denormals for zero.
float half_to_float(uint bits) {
    uint exponent = (bits >> 10) & 31u;
    uint mantissa = bits & 1023u;
    uint sign = (bits & 32768u) << 16;
    if (exponent == 0u) {
        float magnitude = float(mantissa) * 5.9604644775390625e-08; // 2^-24
        return sign != 0u ? -magnitude : magnitude;
    }
    uint wide = exponent == 31u ? 255u : exponent + 112u;
    return uintBitsToFloat(sign | (wide << 23) | (mantissa << 13));
}

float snorm_to_float(uint bits) {
    int value = max(int(bits << 16) >> 16, -32767);
    return float(value) * 3.0518509447574615e-05; // the float next to 1 / 32767; 32767 gives 1
}

// Triangles of a geometry: no more than its bound, if the number lies in memory.
uint count_of(RecordsIn records, uint index) {
    uint count = records.record[index].triangle_count;
    uvec2 address = records.record[index].count;
    return any(notEqual(address, uvec2(0u))) ? min(count, UintsIn(address).word[0]) : count;
}

uvec3 vertices_of(GeometryRecord record, uint triangle) {
    if (record.index_type == INDEX_NONE) {
        return uvec3(0u, 1u, 2u) + uvec3(3u * triangle);
    }
    if (record.index_type == INDEX_UINT16) {
        uvec2 address = element_address(record.indices, triangle, 6u);
        UintsIn words = UintsIn(uvec2(address.x & ~3u, address.y));
        uint first = words.word[0];
        uint second = words.word[1];
        return (address.x & 2u) == 0u ? uvec3(first & 65535u, first >> 16, second & 65535u)
                                      : uvec3(first >> 16, second & 65535u, second >> 16);
    }
    UintsIn words = UintsIn(element_address(record.indices, triangle, 12u));
    return uvec3(words.word[0], words.word[1], words.word[2]);
}

float transformed(vec4 row, vec3 p) { return row.x * p.x + row.y * p.y + row.z * p.z + row.w; }

// A vertex in the grid's input coordinates. One function of the record and the vertex alone: neighbours share it bit for bit.
vec3 position_of(GeometryRecord record, uint vertex) {
    UintsIn words = UintsIn(element_address(record.positions, vertex, record.stride));
    vec3 stored;
    if (record.format == FORMAT_FLOAT32X3) {
        stored = uintBitsToFloat(uvec3(words.word[0], words.word[1], words.word[2]));
    } else {
        uvec2 pair = uvec2(words.word[0], words.word[1]);
        uvec3 halves = uvec3(pair.x & 65535u, pair.x >> 16, pair.y & 65535u);
        stored = record.format == FORMAT_FLOAT16X4
            ? vec3(half_to_float(halves.x), half_to_float(halves.y), half_to_float(halves.z))
            : vec3(snorm_to_float(halves.x), snorm_to_float(halves.y), snorm_to_float(halves.z));
    }
    vec3 scaled = stored * record.scale;
    vec3 p = scaled + record.offset;
    return vec3(transformed(record.transform[0], p), transformed(record.transform[1], p), transformed(record.transform[2], p));
}

#endif
