#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// One ray a pixel of the batch, in tiles of 8 x 8 pixels and in Morton order inside of these: neighbours in the queue walk through the
// same cells, and the invocations of a subgroup, 4 to 64, cover a square of pixels or two side by side.

#include "render/shared/queue.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

// Host twin: gridwalk_render::wavefront::CameraFrame.
struct CameraFrame {
    vec3 eye;
    uint is_orthographic;
    vec3 forward;
    float reserved0;
    vec3 right; // half the picture's width at distance 1, or in world units
    float reserved1;
    vec3 up;
    float reserved2;
    uvec2 size; // of the whole picture in pixels
    uvec2 crop_origin;
    uvec2 crop_size;
    uvec2 reserved3;
};

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer CameraIn { CameraFrame frame; };

layout(push_constant, std430) uniform CameraRays {
    CameraIn camera;
    RaysOut rays;
    PathsOut paths;
    uint first_pixel;
    uint pixel_count;
    vec2 sample_offset; // within the pixel, 0 to 1
};

const uint TILE = 8u;

// The pixel at a place in the order of tiles. Tiles at the right and lower edge are smaller, so that no place is without a pixel; these go
// row by row.
uvec2 tiled_pixel(uint place, uvec2 size) {
    uint band = place / (TILE * size.x);
    place -= band * TILE * size.x;
    uint height = min(TILE, size.y - band * TILE);
    uint column = place / (TILE * height);
    place -= column * TILE * height;
    uint width = min(TILE, size.x - column * TILE);
    uvec2 inside = uvec2(place % width, place / width);
    if (width == TILE && height == TILE) {
        // Bits 0, 2, 4 and 1, 3, 5.
        uvec2 spread = uvec2(place, place >> 1u) & 0x15u;
        inside = (spread & 1u) | ((spread >> 1u) & 2u) | ((spread >> 2u) & 4u);
    }
    return uvec2(column, band) * TILE + inside;
}

void main() {
    uint i = invocation_index();
    if (i >= pixel_count) {
        return;
    }
    CameraFrame frame = camera.frame;
    uvec2 pixel = tiled_pixel(first_pixel + i, frame.crop_size) + frame.crop_origin;
    vec2 at = (vec2(pixel) + sample_offset) / vec2(frame.size) * 2.0 - vec2(1.0);
    vec3 sideways = frame.right * at.x - frame.up * at.y;
    Ray ray;
    ray.t_min = 0.0;
    ray.t_max = GRIDWALK_INFINITY;
    if (frame.is_orthographic != 0u) {
        ray.origin = frame.eye + sideways;
        ray.direction = frame.forward;
    } else {
        ray.origin = frame.eye;
        ray.direction = normalize(frame.forward + sideways);
    }
    rays.ray[i] = ray;
    Path path;
    path.weight = vec3(1.0);
    path.slot = i;
    paths.path[i] = path;
}
