// Texture and background look-ups.
#ifndef RENDER_SAMPLE_GLSL
#define RENDER_SAMPLE_GLSL

#include "render/shared/scene.glsl"

vec4 decode_texel(SceneIn scene, Texture image, uint x, uint y) {
    uint code = SceneUints(scene.table.texels).word[image.first_texel + y * image.width + x];
    uvec4 channel = uvec4(code & 255u, (code >> 8) & 255u, (code >> 16) & 255u, code >> 24);
    vec4 value = vec4(channel) * (1.0 / 255.0);
    if (image.srgb != 0u) {
        SceneFloats table = SceneFloats(scene.table.srgb);
        value.rgb = vec3(table.word[channel.r], table.word[channel.g], table.word[channel.b]);
    }
    return value;
}

// The part after the comma, 0 for what is no number: a conversion of it to an index would be undefined.
float repeated(float x) {
    float part = x - floor(x);
    return part >= 0.0 && part < 1.0 ? part : 0.0;
}

// The two texels around a coordinate in [0, 1) of a repeated axis, and the weight of the second.
void neighbours(float coordinate, uint size, out uint first, out uint second, out float weight) {
    float at = coordinate * float(size) - 0.5;
    float below = floor(at);
    weight = at - below;
    int i = int(below);
    first = i < 0 ? size - 1u : min(uint(i), size - 1u);
    second = first + 1u == size ? 0u : first + 1u;
}

// Bilinear, repeated, in linear light. (0, 0) is the lower left corner of the picture.
vec4 sample_texture(SceneIn scene, uint index, vec2 uv) {
    Texture image = Textures(scene.table.textures).texture[index];
    uint x0;
    uint x1;
    uint y0;
    uint y1;
    vec2 weight;
    neighbours(repeated(uv.x), image.width, x0, x1, weight.x);
    neighbours(repeated(1.0 - uv.y), image.height, y0, y1, weight.y);
    vec4 upper = mix(decode_texel(scene, image, x0, y0), decode_texel(scene, image, x1, y0), weight.x);
    vec4 lower = mix(decode_texel(scene, image, x0, y1), decode_texel(scene, image, x1, y1), weight.x);
    return mix(upper, lower, weight.y);
}

vec3 panorama_texel(SceneIn scene, uint x, uint y) {
    return scene_vec3(SceneFloats(scene.table.panorama), y * scene.table.background.width + x);
}

// What a ray sees that leaves the scene; the direction has length one.
vec3 background_radiance(SceneIn scene, vec3 direction) {
    Background background = scene.table.background;
    if (background.kind == BACKGROUND_COLOUR) {
        return background.bottom;
    }
    float height = dot(direction, background.up);
    if (background.kind == BACKGROUND_GRADIENT) {
        return background.bottom + (background.top - background.bottom) * ((height + 1.0) * 0.5);
    }
    const float PI = 3.14159265358979;
    vec3 right = cross(background.up, background.front);
    float u = 0.5 + atan(dot(direction, right), -dot(direction, background.front)) / (2.0 * PI) + background.rotation;
    float v = 0.5 + asin(clamp(height, -1.0, 1.0)) / PI;
    uint x0;
    uint x1;
    float weight_x;
    neighbours(repeated(u), background.width, x0, x1, weight_x);
    // Rows do not go around: the poles end the picture.
    float at = clamp((1.0 - v) * float(background.height) - 0.5, 0.0, float(background.height - 1u));
    uint y0 = min(uint(at), background.height - 1u);
    uint y1 = min(y0 + 1u, background.height - 1u);
    vec3 upper = mix(panorama_texel(scene, x0, y0), panorama_texel(scene, x1, y0), weight_x);
    vec3 lower = mix(panorama_texel(scene, x0, y1), panorama_texel(scene, x1, y1), weight_x);
    return mix(upper, lower, at - float(y0));
}

// How much a blended surface holds back of what comes from behind, 0 to 1.
float blended_opacity(SceneIn scene, Material material, uint triangle, float u, float v) {
    float opacity = material.opacity;
    uvec3 vertex = scene_indices(scene, triangle);
    if (material.opacity_map != NO_MAP) {
        opacity *= sample_texture(scene, material.opacity_map, scene_uv(scene, vertex, u, v)).a;
    }
    if (scene.table.opacities != uvec2(0u)) {
        SceneFloats opacities = SceneFloats(scene.table.opacities);
        float a = opacities.word[vertex.x];
        // Where all are one it is exactly one, as without any.
        opacity *= a + (opacities.word[vertex.y] - a) * u + (opacities.word[vertex.z] - a) * v;
    }
    return clamp(opacity, 0.0, 1.0);
}

// Whether a candidate is solid: its mask, where it has one, is at least one half. Of a blended surface: whether there is anything of it.
bool is_solid(SceneIn scene, uint triangle, float u, float v) {
    Material material = Materials(scene.table.materials).material[Surrounds(scene.table.surrounds).triangle[triangle].material];
    if ((material.flags & MATERIAL_BLEND) != 0u) {
        return blended_opacity(scene, material, triangle, u, v) > 0.0;
    }
    if (material.opacity_map == NO_MAP) {
        return true;
    }
    vec2 uv = scene_uv(scene, scene_indices(scene, triangle), u, v);
    return material.opacity * sample_texture(scene, material.opacity_map, uv).a >= 0.5;
}

#endif
