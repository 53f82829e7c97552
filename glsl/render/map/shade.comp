#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// Turns hits into surfaces, adds what needs no further ray (background, emission, ambient light), and flags the hits that reflect.

#include "render/shared/surface.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

const uint SHADE_CAMERA = 1u; // these are camera rays
const uint SHADE_TRANSPARENT = 2u; // camera rays do not see the background
const uint SHADE_LAST = 4u; // nothing reflects any more

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
    uint flags;
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
        radiance = mapped_colour(scene, material.emission, material.emission_map, point.uv) + scene.table.ambient * surface.diffuse;
        reflecting = (material.flags & MATERIAL_MIRROR) != 0u && (flags & SHADE_LAST) == 0u
            && largest_component(path.weight * surface.specular) > LEAST_WEIGHT;
        surfaces.surface[i] = surface;
    } else {
        surfaces.surface[i].is_hit = 0u;
        bool sees = (flags & SHADE_TRANSPARENT) == 0u && hit.triangle != GRIDWALK_UNFINISHED;
        radiance = sees ? background_radiance(scene, ray.direction) : vec3(0.0);
    }
    if (hit.triangle == GRIDWALK_UNFINISHED) {
        unfinished.word[path.slot] += 1u;
    }
    reflects.word[i] = uint(reflecting);
    Film pixel = film.film[path.slot];
    pixel.radiance += path.weight * radiance;
    if ((flags & SHADE_CAMERA) != 0u && (is_hit || (flags & SHADE_TRANSPARENT) == 0u)) {
        pixel.coverage += 1.0;
    }
    film.film[path.slot] = pixel;
}
