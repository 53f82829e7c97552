#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// The closest hit of each ray on what its mask leaves solid.

#include "render/shared/queue.glsl"
#include "render/shared/sample.glsl"
#include "shared/grid.glsl"

layout(push_constant, std430) uniform MaskedClosestHit {
    GridwalkGrid grid;
    SceneIn scene;
    QueueIn queue;
    RaysIn rays;
    HitsOut hits;
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
        hits.hit[index] = hit;
    }
}
