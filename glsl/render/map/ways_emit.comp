#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Writes the next ray of every flagged pixel side by side, in order: the reflected one where there is one, else the last of those that wait.

#include "render/shared/blend.glsl"
#include "render/shared/reflect.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform WaysEmit {
    QueueIn queue;
    RaysIn rays;
    SurfacesIn surfaces;
    PathsIn paths;
    WordsIn flags;
    WordsIn offsets;
    WaysInOut ways;
    WaitingIn waiting;
    RaysOut next_rays;
    PathsOut next_paths;
    uint capacity; // pixels of a batch
};

void main() {
    uint i = invocation_index();
    if (i >= queue.header.count || flags.word[i] == 0u) {
        return;
    }
    Path path = paths.path[i];
    Ways way = ways.ways[path.slot];
    Ray ray;
    if (way.reflects != 0u) {
        Surface surface = surfaces.surface[i];
        ray = reflected_ray(surface, rays.ray[i].direction);
        path.weight *= surface.specular;
        way.level += 1u;
    } else {
        way.waiting -= 1u;
        way.passed += 1u;
        WaitingRay next = waiting.ray[way.waiting * capacity + path.slot];
        ray = Ray(next.origin, 0.0, next.direction, GRIDWALK_INFINITY);
        path.weight = next.weight;
        way.level = next.level;
    }
    ways.ways[path.slot] = way;
    uint place = offsets.word[i];
    next_rays.ray[place] = ray;
    next_paths.path[place] = path;
}
