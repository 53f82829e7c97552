// The key by which a trace sorts its rays, so that the invocations of a subgroup walk through the same cells in the same direction: where
// the ray begins its walk, then where it goes.
#ifndef RAY_KEY_GLSL
#define RAY_KEY_GLSL

#include "shared/intersect.glsl"

// Cells along the longest side of the box, 2^5; along the shortest they are at most 2^4.
const float KEY_CELLS = 32.0;
const uint KEY_DIRECTION_BITS = 6u;
const uint RAY_KEY_BITS = 14u + KEY_DIRECTION_BITS;

// The largest key, which no other ray has: no direction is short along all axes.
const uint RAY_KEY_WITHOUT_WALK = (1u << RAY_KEY_BITS) - 1u;

// Bits 0, 3, 6, 9, 12 of the five bits of each component.
uvec3 every_third_bit(uvec3 x) {
    x = (x | (x << 8u)) & 0x100Fu;
    x = (x | (x << 4u)) & 0x10C3u;
    return (x | (x << 2u)) & 0x1249u;
}

// Of the point where the ray enters the box, or of its start inside of it, the Morton code of its cell in the cube of the box's longest
// side, where cells are twice as long along the shortest side if that has more than 2^4. Then which of 56 kinds of directions it has: three
// signs, and the components that are less than half of its length.
uint ray_key(MovedRay ray, GridHeader grid) {
    if (!ray.valid) {
        return RAY_KEY_WITHOUT_WALK;
    }
    vec3 extent = grid.box_max - grid.box_min;
    float longest = max(extent.x, max(extent.y, extent.z));
    vec3 place = (ray.origin - grid.box_min) * (KEY_CELLS / longest);
    // Clamped as floats: a conversion out of range may give anything.
    uvec3 cell = whole(min(max(floor(place), vec3(0.0)), vec3(KEY_CELLS - 1.0)));
    bool z_is_shortest = extent.z <= extent.x && extent.z <= extent.y;
    bool y_is_shortest = !z_is_shortest && extent.y <= extent.x;
    cell = z_is_shortest ? cell : (y_is_shortest ? cell.zxy : cell.yzx);
    float shortest = min(extent.x, min(extent.y, extent.z));
    cell.z = shortest + shortest > longest ? cell.z >> 1u : min(cell.z, 15u);
    uvec3 bits = every_third_bit(cell);
    uint position = bits.x | (bits.y << 1u) | (bits.z << 2u);
    vec3 square = ray.direction * ray.direction;
    float quarter = 0.25 * (square.x + square.y + square.z);
    uvec3 up = uvec3(greaterThan(ray.direction, vec3(0.0)));
    uvec3 little = uvec3(lessThan(square, vec3(quarter)));
    uint signs = up.x | (up.y << 1u) | (up.z << 2u);
    return (position << KEY_DIRECTION_BITS) | (signs << 3u) | (little.x | (little.y << 1u) | (little.z << 2u));
}

#endif
