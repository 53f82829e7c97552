// What a trace reads and writes, and its state between dispatches.
#ifndef TRACE_TYPES_GLSL
#define TRACE_TYPES_GLSL

#include "shared/dispatch.glsl"
#include "shared/types.glsl"

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer RaysIn { Ray ray[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer HitsInOut { Hit hit[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer HitsOut { Hit hit[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer RayCountIn { uint rays; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer OrderIn { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MasksIn { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer HitCountsOut { uint count[]; };
// Geometry id, and number of the triangle within its geometry; GRIDWALK_MISS twice for a ray that hits nothing.
layout(buffer_reference, std430, buffer_reference_align = 8) writeonly buffer GeometriesOut { uvec2 geometry[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer OccludedOut { uint occluded[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer CountersInOut { uvec4 counters[]; };

// Host twin: gridwalk_core::layout::TraceState. At the head of a trace's scratch; written by trace_args and trace_continue_args.
struct TraceState {
    uvec4 arguments; // VkDispatchIndirectCommand of the next trace
    uint ray_count;
    uint unfinished; // 1: a walk was given up
    uvec2 reserved;
};

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer TraceStateOut { TraceState state; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer TraceStateInOut { TraceState state; };

// The number of rays: max_rays itself, or at most that if it lies in memory.
uint traced_rays(RayCountIn count, uint max_rays, uint indirect) {
    uint rays = max_rays;
    if (indirect != 0u) {
        rays = min(rays, count.rays);
    }
    return rays;
}

// Where a walk was given up. Host twin: gridwalk_core::layout::WalkState.
struct WalkState {
    uint given_up; // not 0: the rest is set; from bit WALK_FINE on the place within the cell
    uint cell;
    uint reference;
    float exit;
    float best_s;
    float best_u;
    float best_v;
    uint best_triangle;
};

const uint WALK_FINE = 8u; // eight bits an axis

layout(buffer_reference, std430, buffer_reference_align = 16) buffer WalkStatesInOut { WalkState walk[]; };

#endif
