// A pass of the engine's own that traces: a camera ray a pixel, ambient occlusion where it hits, and one reflection in the floor.
#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require

// The whole interface: a grid's address makes a GridwalkGrid, a Ray goes in, a Hit comes out. No binding is needed for it.
#include "gridwalk.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Normals { float of[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Indices { uint of[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer Picture { uint pixel[]; };

layout(push_constant, std430) uniform EmbedShade {
    uvec2 grid;
    Normals normals;
    Indices indices;
    Picture picture;
    uint width;
    uint height;
    uint mirror_count; // triangles in front that are mirrors
    uint occlusion_rays;
};

// A number in [0, 1) from a state that it advances (Jarzynski and Olano 2020).
float random(inout uint state) {
    state = state * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
    return float(((word >> 22) ^ word) >> 8) / 16777216.0;
}

vec3 vertex_normal(uint triangle, uint corner) {
    uint vertex = indices.of[3u * triangle + corner];
    return vec3(normals.of[3u * vertex], normals.of[3u * vertex + 1u], normals.of[3u * vertex + 2u]);
}

// Share of the cosine-weighted hemisphere that is not occluded within a distance.
float ambient(vec3 position, vec3 normal, inout uint state) {
    vec3 tangent = normalize(cross(normal, abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    vec3 bitangent = cross(normal, tangent);
    uint open = 0u;
    for (uint i = 0u; i < occlusion_rays; ++i) {
        float radius2 = random(state);
        float angle = 6.2831853 * random(state);
        vec2 disc = sqrt(radius2) * vec2(cos(angle), sin(angle));
        vec3 direction = disc.x * tangent + disc.y * bitangent + sqrt(1.0 - radius2) * normal;
        Hit hit = gridwalk_any_hit(GridwalkGrid(grid), Ray(position + 1e-3 * normal, 0.0, direction, 3.0));
        open += gridwalk_is_hit(hit) ? 0u : 1u;
    }
    return float(open) / float(occlusion_rays);
}

vec3 sky(vec3 direction) { return mix(vec3(0.85, 0.87, 0.9), vec3(0.25, 0.45, 0.8), clamp(direction.y, 0.0, 1.0)); }

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= width || pixel.y >= height) {
        return;
    }
    uint state = pixel.y * width + pixel.x;
    vec2 screen = (2.0 * (vec2(pixel) + 0.5) - vec2(width, height)) / float(height);
    vec3 origin = vec3(0.0, 2.1, 4.0);
    vec3 direction = normalize(vec3(screen.x, -screen.y - 0.6, -2.0));
    vec3 colour = vec3(0.0);
    vec3 weight = vec3(1.0);
    for (uint bounce = 0u; bounce < 2u; ++bounce) {
        Hit hit = gridwalk_closest_hit(GridwalkGrid(grid), Ray(origin, 0.0, direction, GRIDWALK_INFINITY));
        if (!gridwalk_is_hit(hit)) {
            colour += weight * sky(direction);
            break;
        }
        vec3 position = origin + hit.t * direction;
        vec3 normal = normalize((1.0 - hit.u - hit.v) * vertex_normal(hit.triangle, 0u) + hit.u * vertex_normal(hit.triangle, 1u) +
                                hit.v * vertex_normal(hit.triangle, 2u));
        bool mirror = hit.triangle < mirror_count;
        vec3 paint = mirror ? vec3(0.55) : vec3(0.9, 0.5, 0.25);
        float share = mirror && bounce == 0u ? 0.5 : 1.0;
        colour += weight * share * paint * ambient(position, normal, state);
        if (share == 1.0) {
            break;
        }
        weight *= 0.5;
        direction = reflect(direction, normal);
        origin = position + 1e-3 * normal;
    }
    uvec3 bytes = uvec3(255.0 * pow(clamp(colour, 0.0, 1.0), vec3(1.0 / 2.2)) + 0.5);
    picture.pixel[pixel.y * width + pixel.x] = bytes.r | (bytes.g << 8) | (bytes.b << 16) | 0xFF000000u;
}
