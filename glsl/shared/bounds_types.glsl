// The box of some triangles.
#ifndef BOUNDS_TYPES_GLSL
#define BOUNDS_TYPES_GLSL

#include "shared/types.glsl"

// Host twin: gridwalk_core::layout::Bounds.
struct Bounds {
    vec3 low;
    uint dropped;
    vec3 high;
    uint reserved;
};

Bounds empty_bounds() { return Bounds(vec3(GRIDWALK_INFINITY), 0u, vec3(-GRIDWALK_INFINITY), 0u); }

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer BoundsIn { Bounds bounds[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer BoundsOut { Bounds bounds[]; };

#endif
