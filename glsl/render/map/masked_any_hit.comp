#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// Whether each ray hits anything that its mask leaves solid: 1, 0, or GRIDWALK_UNFINISHED.

#define TRACE_ANY
#include "render/shared/queue.glsl"
#include "render/shared/sample.glsl"
#include "shared/grid.glsl"

layout(push_constant, std430) uniform MaskedAnyHit {
    GridwalkGrid grid;
    SceneIn scene;
    QueueIn queue;
    RaysIn rays;
    OccludedOut occluded;
    WalkStatesInOut walks;
};

#include "render/shared/masked.glsl"

void main() {
    GridHeader header = load_header(grid);
    uint index = invocation_index();
    if (index >= queue.header.count) {
        return;
    }
    Hit hit;
    if (masked_walk(header, index, rays.ray[index], hit)) {
        occluded.occluded[index] = hit.triangle == GRIDWALK_MISS ? 0u : (hit.triangle == GRIDWALK_UNFINISHED ? hit.triangle : 1u);
    }
}
