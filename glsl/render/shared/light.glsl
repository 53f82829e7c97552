// What one light adds to a surface point, and the ray that asks whether it does.
#ifndef RENDER_LIGHT_GLSL
#define RENDER_LIGHT_GLSL

#include "render/shared/queue.glsl"
#include "render/shared/scene.glsl"

struct LightSample {
    vec3 radiance; // towards the viewer, if nothing is in between; 0 when no ray is worth it
    Ray shadow;
};

// How much of the way to a light is looked at: what holds the light itself casts no shadow.
const float LIGHT_REACH = 0.9999;

// Diffuse + Blinn-Phong of MTL, as a BRDF: (Kd + Ks (n h)^Ns) / pi.
LightSample sample_light(Light light, Surface surface, vec3 view) {
    LightSample result;
    result.radiance = vec3(0.0);
    vec3 origin = surface.start + surface.geometric_normal * surface.offset;
    vec3 direction = -light.direction;
    vec3 irradiance = light.intensity;
    result.shadow.origin = origin;
    result.shadow.t_min = 0.0;
    result.shadow.direction = direction;
    result.shadow.t_max = GRIDWALK_INFINITY;
    if (light.kind != LIGHT_DIRECTIONAL) {
        vec3 way = light.position - origin;
        float square = dot(way, way);
        if (!(square > 0.0)) {
            return result;
        }
        result.shadow.direction = way;
        result.shadow.t_max = LIGHT_REACH;
        direction = way * inversesqrt(square);
        irradiance = light.intensity / square;
        if (light.kind == LIGHT_SPOT) {
            float cosine = -dot(direction, light.direction);
            float width = light.cos_inner - light.cos_outer;
            float inside = width > 0.0 ? clamp((cosine - light.cos_outer) / width, 0.0, 1.0) : float(cosine >= light.cos_outer);
            irradiance *= inside * inside * (3.0 - 2.0 * inside);
        }
    }
    float cosine = dot(surface.normal, direction);
    if (!(cosine > 0.0)) {
        return result;
    }
    vec3 halfway = normalize(direction + view);
    // pow(0, 0) is undefined.
    float lobe = surface.shininess > 0.0 ? pow(max(dot(surface.normal, halfway), 0.0), surface.shininess) : 1.0;
    const float INVERSE_PI = 0.318309886183791;
    vec3 radiance = (surface.diffuse + surface.specular * lobe) * irradiance * (cosine * INVERSE_PI);
    if (!any(isnan(radiance)) && !any(isinf(radiance))) {
        result.radiance = radiance;
    }
    return result;
}

#endif
