// What the kernels that move vertices have in common. Words are uint where their bits must survive: a float that passes through a register
// may lose a denormal or the payload of a NaN. Host twins: gridwalk_core::twin::motion.
#ifndef RENDER_MOTION_GLSL
#define RENDER_MOTION_GLSL

#include "shared/dispatch.glsl"

// A joint's part in a vertex.
struct Influence {
    uint joint;
    float weight;
};

// A morph target that counts now: where in the deltas those of its positions and of its normals begin, or NO_DELTAS.
struct ActiveTarget {
    uint positions;
    uint normals;
    float weight;
    uint reserved;
};

const uint NO_DELTAS = 0xFFFFFFFFu;

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MotionWordsIn { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer MotionWordsOut { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MotionFloatsIn { float word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer MotionFloatsOut { float word[]; };
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer InfluencesIn { Influence influence[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer ActiveTargetsIn { ActiveTarget target[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer MatricesIn { vec4 row[]; };

vec3 motion_vec3(MotionFloatsIn values, uint i) {
    return vec3(values.word[3u * i], values.word[3u * i + 1u], values.word[3u * i + 2u]);
}

// The bits of a number on the way from one to another: exactly the first's where the two are equal, so that what stands still does not
// tremble.
uint between(uint first, uint second, float weight) {
    float a = uintBitsToFloat(first);
    float b = uintBitsToFloat(second);
    return floatBitsToUint(a + (b - a) * weight);
}

// At length one; what has no direction stays as it is. Scaled first: a square would overflow or vanish.
vec3 renormalised(vec3 v) {
    float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if (!(largest > 0.0) || isinf(largest)) {
        return v;
    }
    float x = v.x / largest;
    float y = v.y / largest;
    float z = v.z / largest;
    float size = sqrt(x * x + y * y + z * z);
    return vec3(x / size, y / size, z / size);
}

#endif
