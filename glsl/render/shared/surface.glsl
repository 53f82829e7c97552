// From a hit to a surface point with its normals, textures and material.
#ifndef RENDER_SURFACE_GLSL
#define RENDER_SURFACE_GLSL

#include "render/shared/queue.glsl"
#include "render/shared/sample.glsl"

// A hit's place in the scene.
struct HitPoint {
    vec3 position;
    vec3 start; // of secondary rays, but for the offset
    float offset;
    vec3 normal;
    vec3 geometric_normal;
    vec2 uv;
    vec3 colour; // of the vertices
    uint material;
    uint mesh;
};

// Secondary rays start this share of the triangle's largest |coordinate| off its plane. The point itself is within 2^-23 of it, and the
// distance that the triangle test finds to the plane from such a point is rounded by up to 2^-21 of the triangle's extent.
const float OFFSET_SHARE = 1.9073486328125e-06; // 2^-19

float largest_component(vec3 v) { return max(v.x, max(v.y, v.z)); }

// Of length one, or the fallback for what has no direction. Scaled first: a square would overflow or vanish.
vec3 unit(vec3 v, vec3 fallback) {
    float largest = largest_component(abs(v));
    if (!(largest > 0.0) || isinf(largest)) {
        return fallback;
    }
    return normalize(v / largest);
}

// The shading normal after the normal or the height map.
vec3 mapped_normal(SceneIn scene, Material material, vec3 normal, vec3 edge1, vec3 edge2, vec2 uv, vec2 delta1, vec2 delta2) {
    float area = delta1.x * delta2.y - delta1.y * delta2.x;
    if (area == 0.0 || isnan(area) || isinf(area)) {
        return normal;
    }
    float side = area < 0.0 ? -1.0 : 1.0;
    vec3 along_u = (edge1 * delta2.y - edge2 * delta1.y) * side;
    vec3 along_v = (edge2 * delta1.x - edge1 * delta2.x) * side;
    vec3 tangent = unit(along_u - normal * dot(normal, along_u), vec3(0.0));
    vec3 bitangent = unit(along_v - normal * dot(normal, along_v) - tangent * dot(tangent, along_v), vec3(0.0));
    vec3 bent;
    if ((material.flags & MATERIAL_HEIGHT_MAP) != 0u) {
        Texture image = Textures(scene.table.textures).texture[material.normal_map];
        vec2 texel = vec2(1.0 / float(image.width), 1.0 / float(image.height));
        float right = sample_texture(scene, material.normal_map, uv + vec2(texel.x, 0.0)).r;
        float left = sample_texture(scene, material.normal_map, uv - vec2(texel.x, 0.0)).r;
        float above = sample_texture(scene, material.normal_map, uv + vec2(0.0, texel.y)).r;
        float below = sample_texture(scene, material.normal_map, uv - vec2(0.0, texel.y)).r;
        bent = normal - (tangent * (right - left) + bitangent * (above - below)) * material.bump_scale;
    } else {
        vec3 coded = sample_texture(scene, material.normal_map, uv).rgb * 2.0 - vec3(1.0);
        bent = tangent * coded.x + bitangent * coded.y + normal * coded.z;
    }
    return unit(bent, normal);
}

// A point of a triangle moved out to where it lies on the plane through a vertex at a right angle to the vertex's normal; where it lies
// outside of that plane it stays.
vec3 lifted(vec3 point, vec3 vertex, vec3 normal) { return point - normal * min(dot(point - vertex, normal), 0.0); }

HitPoint hit_point(SceneIn scene, Ray ray, Hit hit) {
    HitPoint point;
    uvec3 vertex = scene_indices(scene, hit.triangle);
    SceneFloats positions = SceneFloats(scene.table.positions);
    vec3 a = scene_vec3(positions, vertex.x);
    vec3 b = scene_vec3(positions, vertex.y);
    vec3 c = scene_vec3(positions, vertex.z);
    float w = 1.0 - hit.u - hit.v;
    point.position = a * w + b * hit.u + c * hit.v;
    point.offset = OFFSET_SHARE * largest_component(max(abs(a), max(abs(b), abs(c))));

    vec3 edge1 = b - a;
    vec3 edge2 = c - a;
    float extent = largest_component(max(abs(edge1), abs(edge2)));
    float shrink = extent > 0.0 ? 1.0 / extent : 0.0;
    edge1 *= shrink;
    edge2 *= shrink;
    vec3 backwards = unit(-ray.direction, vec3(0.0, 0.0, 1.0));
    vec3 geometric = unit(cross(edge1, edge2), backwards);

    SceneFloats normals = SceneFloats(scene.table.normals);
    vec3 normal_a = scene_vec3(normals, vertex.x);
    vec3 normal_b = scene_vec3(normals, vertex.y);
    vec3 normal_c = scene_vec3(normals, vertex.z);
    vec3 normal = unit(normal_a * w + normal_b * hit.u + normal_c * hit.v, geometric);
    // The file's normals say which side is outside, its windings often do not.
    geometric = dot(geometric, normal) < 0.0 ? -geometric : geometric;
    // Both sides are shaded alike: everything is turned to the viewer's side of the triangle.
    bool behind = dot(geometric, ray.direction) > 0.0;
    float side = behind ? -1.0 : 1.0;
    // Triangles lie inside of the smooth surface that their normals speak of, and would shadow each other where it is still lit: rays
    // start on that surface (Hanika 2021, "Hacking the shadow terminator").
    point.start = lifted(point.position, a, normal_a * side) * w + lifted(point.position, b, normal_b * side) * hit.u
        + lifted(point.position, c, normal_c * side) * hit.v;
    if (any(isnan(point.start)) || any(isinf(point.start))) {
        point.start = point.position;
    }

    SceneUvs uvs = SceneUvs(scene.table.uvs);
    vec2 uv_a = uvs.uv[vertex.x];
    vec2 uv_b = uvs.uv[vertex.y];
    vec2 uv_c = uvs.uv[vertex.z];
    point.uv = uv_a * w + uv_b * hit.u + uv_c * hit.v;
    point.colour = vec3(1.0);
    if (scene.table.colours != uvec2(0u)) {
        SceneFloats colours = SceneFloats(scene.table.colours);
        vec3 colour_a = scene_vec3(colours, vertex.x);
        vec3 colour_b = scene_vec3(colours, vertex.y);
        vec3 colour_c = scene_vec3(colours, vertex.z);
        // Where all are white it is exactly white, as without any colours.
        point.colour = colour_a + (colour_b - colour_a) * hit.u + (colour_c - colour_a) * hit.v;
    }
    Surround surround = Surrounds(scene.table.surrounds).triangle[hit.triangle];
    point.material = surround.material;
    point.mesh = surround.mesh;
    Material material = Materials(scene.table.materials).material[surround.material];
    if (material.normal_map != NO_MAP) {
        normal = mapped_normal(scene, material, normal, edge1, edge2, point.uv, uv_b - uv_a, uv_c - uv_a);
    }

    point.geometric_normal = geometric * side;
    point.normal = normal * side;
    return point;
}

vec3 mapped_colour(SceneIn scene, vec3 colour, uint map, vec2 uv) {
    return map == NO_MAP ? colour : colour * sample_texture(scene, map, uv).rgb;
}

#endif
