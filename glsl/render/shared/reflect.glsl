// The ray that a mirror sends on.
#ifndef RENDER_REFLECT_GLSL
#define RENDER_REFLECT_GLSL

#include "render/shared/queue.glsl"

Ray reflected_ray(Surface surface, vec3 direction) {
    vec3 incoming = normalize(direction);
    vec3 outgoing = reflect(incoming, surface.normal);
    // A smooth or mapped normal may mirror the ray into the surface: the triangle's own does not.
    if (!(dot(outgoing, surface.geometric_normal) > 0.0)) {
        outgoing = reflect(incoming, surface.geometric_normal);
    }
    Ray ray;
    ray.origin = surface.start + surface.geometric_normal * surface.offset;
    ray.t_min = 0.0;
    ray.direction = normalize(outgoing);
    ray.t_max = GRIDWALK_INFINITY;
    return ray;
}

#endif
