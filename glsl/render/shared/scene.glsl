// A scene in device memory, as the shading kernels read it. Host twins: gridwalk_render::scene.
#ifndef RENDER_SCENE_GLSL
#define RENDER_SCENE_GLSL

#include "render/shared/surround.glsl"
#include "shared/types.glsl"

const uint NO_MAP = 0xFFFFFFFFu;
const uint MATERIAL_MIRROR = 1u;
const uint MATERIAL_HEIGHT_MAP = 2u;
const uint MATERIAL_BLEND = 4u; // the opacity is a share, not a mask
const uint MATERIAL_UNLIT = 8u; // the colours of vertices multiply the emission

struct Material {
    vec3 diffuse;
    float shininess;
    vec3 specular;
    uint flags; // MATERIAL_* bits
    vec3 emission;
    float opacity;
    uint diffuse_map; // indices of textures, or NO_MAP
    uint specular_map;
    uint emission_map;
    uint opacity_map;
    uint normal_map;
    float bump_scale;
    uint number; // in the layer of numbers: that of the table but for what key-frames have added
    uint reserved;
};

// Rows from the top, RGBA of 8 bits a texel.
struct Texture {
    uint width;
    uint height;
    uint first_texel;
    uint srgb; // 1: colour channels go through the table
};

const uint LIGHT_POINT = 0u;
const uint LIGHT_DIRECTIONAL = 1u;
const uint LIGHT_SPOT = 2u;

struct Light {
    vec3 position;
    uint kind;
    vec3 direction; // from the light into the scene, of length one
    float cos_inner;
    vec3 intensity; // of a directional light: irradiance
    float cos_outer;
};

const uint BACKGROUND_COLOUR = 0u;
const uint BACKGROUND_GRADIENT = 1u;
const uint BACKGROUND_PANORAMA = 2u;

// The colour of all directions, or of straight down and straight up, or a panorama.
struct Background {
    vec3 bottom;
    uint kind;
    vec3 top;
    float rotation; // turns
    vec3 up;
    uint width;
    vec3 front; // z of the panorama's frame
    uint height;
};

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer SceneFloats { float word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer SceneUints { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer SceneUvs { vec2 uv[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Materials { Material material[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Textures { Texture texture[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Lights { Light light[]; };

// Addresses of everything else.
struct SceneTable {
    uvec2 positions;
    uvec2 indices;
    uvec2 normals;
    uvec2 uvs;
    uvec2 surrounds;
    uvec2 colours; // of vertices, three floats each; 0 where no mesh has any
    uvec2 mesh_starts; // first triangle of each mesh
    uvec2 materials;
    uvec2 textures;
    uvec2 texels;
    uvec2 srgb; // linear value of each of the 256 codes
    uvec2 lights;
    uvec2 panorama; // three floats a pixel, rows from the top
    uvec2 opacities; // of vertices, a float each; 0 where no mesh has any
    vec3 ambient;
    uint triangle_count;
    Background background;
};

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer SceneIn { SceneTable table; };

vec3 scene_vec3(SceneFloats values, uint i) {
    return vec3(values.word[3u * i], values.word[3u * i + 1u], values.word[3u * i + 2u]);
}

uvec3 scene_indices(SceneIn scene, uint triangle) {
    SceneUints indices = SceneUints(scene.table.indices);
    return uvec3(indices.word[3u * triangle], indices.word[3u * triangle + 1u], indices.word[3u * triangle + 2u]);
}

vec2 scene_uv(SceneIn scene, uvec3 vertex, float u, float v) {
    SceneUvs uvs = SceneUvs(scene.table.uvs);
    vec2 a = uvs.uv[vertex.x];
    vec2 b = uvs.uv[vertex.y];
    vec2 c = uvs.uv[vertex.z];
    return a * (1.0 - u - v) + b * u + c * v;
}

#endif
