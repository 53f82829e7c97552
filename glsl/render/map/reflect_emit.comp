#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Writes the reflected rays of the flagged surfaces side by side, in order.

#include "render/shared/reflect.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform ReflectEmit {
    QueueIn queue;
    RaysIn rays;
    SurfacesIn surfaces;
    PathsIn paths;
    WordsIn reflects;
    WordsIn offsets;
    RaysOut next_rays;
    PathsOut next_paths;
};

void main() {
    uint i = invocation_index();
    if (i >= queue.header.count || reflects.word[i] == 0u) {
        return;
    }
    Surface surface = surfaces.surface[i];
    Path path = paths.path[i];
    path.weight *= surface.specular;
    uint place = offsets.word[i];
    next_rays.ray[place] = reflected_ray(surface, rays.ray[i].direction);
    next_paths.path[place] = path;
}
