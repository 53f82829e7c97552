// What a pixel has still to follow where surfaces are seen through: a ray that meets a blended surface may go two ways, and of one queue no
// two paths have one pixel. The way straight on waits while the reflected one is followed, so at most one waits for each reflection.
#ifndef RENDER_BLEND_GLSL
#define RENDER_BLEND_GLSL

#include "shared/trace_types.glsl"

// Of a pixel. Host twin: gridwalk_render::layout::Ways.
struct Ways {
    uint level; // reflections behind the ray that is followed
    uint waiting; // rays that wait
    uint passed; // rays that went through a surface so far, over all samples
    uint reflects; // 1: the next ray is a reflected one
};

// A ray that waits. Host twin: gridwalk_render::layout::WaitingRay.
struct WaitingRay {
    vec3 origin;
    uint level;
    vec3 direction;
    uint reserved0;
    vec3 weight;
    uint reserved1;
};

layout(buffer_reference, std430, buffer_reference_align = 16) buffer WaysInOut { Ways ways[]; };
// The first of all pixels of the batch, then the second.
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer WaitingIn { WaitingRay ray[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer WaitingOut { WaitingRay ray[]; };

#endif
