#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// Turns hits into surfaces, adds what needs no further ray (background, emission, ambient light), and flags the hits that reflect; with
// BLEND the pixels that have a ray more, reflected or straight on through a surface.

#include "render/shared/blend.glsl"
#include "render/shared/surface.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;
layout(constant_id = 1) const bool BLEND = false; // surfaces may be seen through

const uint SHADE_CAMERA = 1u; // these are camera rays
const uint SHADE_TRANSPARENT = 2u; // camera rays do not see the background
const uint SHADE_LAST = 4u; // no ray follows

// Reflections of a smaller share are not followed: four floors of varnish upon each other cost more rays than all the rest of a picture.
const float LEAST_WEIGHT = 2.44140625e-4; // 2^-12

layout(push_constant, std430) uniform Shade {
    SceneIn scene;
    QueueIn queue;
    RaysIn rays;
    HitsIn hits;
    PathsIn paths;
    FilmInOut film;
    SurfacesOut surfaces;
    WordsOut reflects;
    WordsInOut unfinished; // rays of each pixel that were given up
    WaysInOut ways; // this and what follows: only with BLEND
    WaitingOut waiting;
    uint flags;
    uint depth; // reflections
    uint capacity; // pixels of a batch
};

void main() {
    uint i = invocation_index();
    if (i >= queue.header.count) {
        return;
    }
    Ray ray = rays.ray[i];
    Hit hit = hits.hit[i];
    Path path = paths.path[i];
    bool is_hit = hit.triangle < scene.table.triangle_count;
    Surface surface;
    surface.is_hit = uint(is_hit);
    vec3 radiance = vec3(0.0);
    bool reflecting = false;
    bool sees_background = (flags & SHADE_TRANSPARENT) == 0u;
    Ways way = Ways(0u, 0u, 0u, 0u);
    if (BLEND) {
        way = ways.ways[path.slot];
        if ((flags & SHADE_CAMERA) != 0u) {
            way.level = 0u;
            way.waiting = 0u;
        }
        sees_background = sees_background || way.level > 0u;
    }
    if (is_hit) {
        HitPoint point = hit_point(scene, ray, hit);
        Material material = Materials(scene.table.materials).material[point.material];
        surface.start = point.start;
        surface.offset = point.offset;
        surface.normal = point.normal;
        surface.geometric_normal = point.geometric_normal;
        surface.shininess = material.shininess;
        surface.diffuse = point.colour * mapped_colour(scene, material.diffuse, material.diffuse_map, point.uv);
        surface.specular = mapped_colour(scene, material.specular, material.specular_map, point.uv);
        surface.reserved0 = 0.0;
        surface.reserved1 = 0.0;
        vec3 emission = mapped_colour(scene, material.emission, material.emission_map, point.uv);
        if ((material.flags & MATERIAL_UNLIT) != 0u) {
            emission *= point.colour;
        }
        radiance = emission + scene.table.ambient * surface.diffuse;
        bool may_reflect = (flags & SHADE_LAST) == 0u;
        if (BLEND) {
            may_reflect = way.level < depth;
            if ((material.flags & MATERIAL_BLEND) != 0u) {
                float opacity = blended_opacity(scene, material, hit.triangle, hit.u, hit.v);
                surface.diffuse *= opacity;
                surface.specular *= opacity;
                radiance *= opacity;
                vec3 rest = path.weight * (1.0 - opacity);
                if (largest_component(rest) > LEAST_WEIGHT) {
                    vec3 behind = point.position - point.geometric_normal * point.offset;
                    waiting.ray[way.waiting * capacity + path.slot] = WaitingRay(behind, way.level, ray.direction, 0u, rest, 0u);
                    way.waiting += 1u;
                }
            }
        }
        reflecting = (material.flags & MATERIAL_MIRROR) != 0u && may_reflect
            && largest_component(path.weight * surface.specular) > LEAST_WEIGHT;
        surfaces.surface[i] = surface;
    } else {
        surfaces.surface[i].is_hit = 0u;
        radiance = sees_background && hit.triangle != GRIDWALK_UNFINISHED ? background_radiance(scene, ray.direction) : vec3(0.0);
    }
    if (hit.triangle == GRIDWALK_UNFINISHED) {
        unfinished.word[path.slot] += 1u;
    }
    bool follows = reflecting;
    if (BLEND) {
        way.reflects = uint(reflecting);
        follows = reflecting || way.waiting > 0u;
        if (follows && (flags & SHADE_LAST) != 0u) {
            unfinished.word[path.slot] += way.waiting + way.reflects;
            follows = false;
        }
        ways.ways[path.slot] = way;
    }
    reflects.word[i] = uint(follows);
    Film pixel = film.film[path.slot];
    pixel.radiance += path.weight * radiance;
    if (!BLEND && (flags & SHADE_CAMERA) != 0u && (is_hit || sees_background)) {
        pixel.coverage += 1.0;
    }
    // All of a pixel is covered but for the share that comes from the background behind what is seen through.
    if (BLEND && way.level == 0u) {
        pixel.coverage += float((flags & SHADE_CAMERA) != 0u) - (is_hit || sees_background ? 0.0 : path.weight.x);
    }
    film.film[path.slot] = pixel;
}
