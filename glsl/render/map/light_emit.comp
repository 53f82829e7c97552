#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// Writes the shadow rays of the flagged surfaces side by side, in order, each with what it lets through.

#include "render/shared/light.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform LightEmit {
    SceneIn scene;
    QueueIn queue;
    RaysIn rays;
    SurfacesIn surfaces;
    PathsIn paths;
    WordsIn shadows;
    WordsIn offsets;
    RaysOut shadow_rays;
    PathsOut shadow_paths;
    uint light;
};

void main() {
    uint i = invocation_index();
    if (i >= queue.header.count || shadows.word[i] == 0u) {
        return;
    }
    vec3 view = -normalize(rays.ray[i].direction);
    LightSample found = sample_light(Lights(scene.table.lights).light[light], surfaces.surface[i], view);
    Path path = paths.path[i];
    path.weight *= found.radiance;
    uint place = offsets.word[i];
    shadow_rays.ray[place] = found.shadow;
    shadow_paths.path[place] = path;
}
