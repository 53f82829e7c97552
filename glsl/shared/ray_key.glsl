// The key by which a trace sorts its rays, so that the invocations of a subgroup walk through the same cells in the same direction: where
// the ray begins its walk, then where it goes.
#ifndef RAY_KEY_GLSL
#define RAY_KEY_GLSL

#include "shared/intersect.glsl"

const uint KEY_BITS_AN_AXIS = 5u;
const uint KEY_DIRECTION_BITS = 5u;
const uint RAY_KEY_BITS = 3u * KEY_BITS_AN_AXIS + KEY_DIRECTION_BITS;

// The largest key, which no other ray has: its direction would be of the 32nd kind.
const uint RAY_KEY_WITHOUT_WALK = (1u << RAY_KEY_BITS) - 1u;

// Bits 0, 3, 6, 9, 12 of the five bits of each component.
uvec3 every_third_bit(uvec3 x) {
    x = (x | (x << 8u)) & 0x100Fu;
    x = (x | (x << 4u)) & 0x10C3u;
    return (x | (x << 2u)) & 0x1249u;
}

// Of the point where the ray enters the box, or of its start inside of it, the Morton code in the cube of the box's longest side; then
// which of 24 kinds of directions it has: its longest component, and three signs.
uint ray_key(MovedRay ray, GridHeader grid) {
    if (!ray.valid) {
        return RAY_KEY_WITHOUT_WALK;
    }
    vec3 extent = grid.box_max - grid.box_min;
    float count = float(1u << KEY_BITS_AN_AXIS);
    vec3 place = (ray.origin - grid.box_min) * (count / max(extent.x, max(extent.y, extent.z)));
    // Clamped as floats: a conversion out of range may give anything.
    uvec3 bits = every_third_bit(whole(min(max(floor(place), vec3(0.0)), vec3(count - 1.0))));
    uint position = bits.x | (bits.y << 1u) | (bits.z << 2u);
    uvec3 up = uvec3(greaterThan(ray.direction, vec3(0.0)));
    uint along = ray.z_is_x ? 0u : (ray.z_is_y ? 1u : 2u);
    return (position << KEY_DIRECTION_BITS) | (along << 3u) | (up.x | (up.y << 1u) | (up.z << 2u));
}

#endif
