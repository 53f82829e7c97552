#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// Flags the surfaces that one light may reach.

#include "render/shared/light.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform LightCount {
    SceneIn scene;
    QueueIn queue;
    RaysIn rays;
    SurfacesIn surfaces;
    WordsOut shadows;
    uint light;
};

void main() {
    uint i = invocation_index();
    if (i >= queue.header.count) {
        return;
    }
    bool lit = surfaces.surface[i].is_hit != 0u;
    if (lit) {
        vec3 view = -normalize(rays.ray[i].direction);
        LightSample found = sample_light(Lights(scene.table.lights).light[light], surfaces.surface[i], view);
        lit = any(greaterThan(found.radiance, vec3(0.0)));
    }
    shadows.word[i] = uint(lit);
}
