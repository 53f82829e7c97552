// A ray brought into the grid's frame, and the watertight ray-triangle test (Woop, Benthin and Wald 2013) there.
#ifndef INTERSECT_GLSL
#define INTERSECT_GLSL

#include "shared/grid.glsl"

// Points origin + s * direction. The direction is the ray's, times a power of two that brings its largest component into [1, 2); a
// component below 2^-40 of the largest is zero. The origin is where the ray enters the padded box, or a little before, or its own start.
struct MovedRay {
    vec3 origin;
    vec3 direction;
    vec3 inverse; // of the direction; 0 where that is 0
    float s_min;
    float s_max;
    // t = (start + s) * t_of_s.x * t_of_s.y: two powers of two, each representable where their product may not be.
    float start;
    vec2 t_of_s;
    // The shear of the triangle test and the axis that it maps to z.
    vec3 shear;
    bool z_is_x;
    bool z_is_y;
    bool valid;
};

const float NEGLIGIBLE_COMPONENT = 9.094947017729282e-13; // 2^-40
const float SLAB_TOLERANCE = 9.5367431640625e-07; // 2^-20, above the rounding of a slab's distance by 2.5 ulp divisions
const float LEAST_NORMAL = 1.1754943508222875e-38; // 2^-126

// 2^e for -126 <= e <= 127.
float power_of_two(int e) { return uintBitsToFloat(uint(e + 127) << 23); }

// floor(log2(x)) for normal x > 0, clamped so that the power of two and its inverse are normal numbers.
int clamped_exponent(float x) { return clamp(int((floatBitsToUint(x) >> 23) & 255u) - 127, -126, 126); }

bool is_finite(vec3 v) { return all(lessThan(abs(v), vec3(GRIDWALK_INFINITY))); }

vec3 select(bvec3 which, vec3 yes, vec3 no) {
    return vec3(which.x ? yes.x : no.x, which.y ? yes.y : no.y, which.z ? yes.z : no.z);
}

vec3 permute(MovedRay ray, vec3 v) { return ray.z_is_x ? v.yzx : (ray.z_is_y ? v.zxy : v); }

MovedRay move_ray(Ray ray, GridHeader grid) {
    MovedRay moved;
    vec3 magnitude = abs(ray.direction);
    moved.z_is_x = magnitude.x >= magnitude.y && magnitude.x >= magnitude.z;
    moved.z_is_y = !moved.z_is_x && magnitude.y >= magnitude.z;
    float largest = permute(moved, magnitude).z;
    moved.valid = is_finite(ray.origin) && is_finite(ray.direction) && largest > 0.0 && !isnan(ray.t_min) && !isnan(ray.t_max);
    if (!moved.valid) {
        return moved;
    }
    int exponent = clamped_exponent(largest);
    float shrink = power_of_two(-exponent);
    float grow = power_of_two(exponent);
    vec3 direction = select(lessThan(magnitude, vec3(largest * NEGLIGIBLE_COMPONENT)), vec3(0.0), ray.direction * shrink);
    bvec3 still = equal(direction, vec3(0.0));
    vec3 inverse = select(still, vec3(0.0), 1.0 / direction);
    vec3 origin = to_frame(grid, ray.origin);
    moved.t_of_s = vec2(grid.inverse_scale, shrink);
    float first = ray.t_min * grow * grid.scale;
    float last = ray.t_max * grow * grid.scale;

    // The interval of the box, and the tests of the axes along which the ray does not move.
    bvec3 beside = bvec3(uvec3(lessThan(origin, grid.box_min)) | uvec3(greaterThan(origin, grid.box_max)));
    moved.valid = !any(bvec3(uvec3(still) & uvec3(beside)));
    bvec3 up = greaterThan(direction, vec3(0.0));
    vec3 to_low = (grid.box_min - origin) * inverse;
    vec3 to_high = (grid.box_max - origin) * inverse;
    vec3 near = select(still, vec3(-GRIDWALK_INFINITY), select(up, to_low, to_high));
    vec3 far = select(still, vec3(GRIDWALK_INFINITY), select(up, to_high, to_low));
    float entry = max(near.x, max(near.y, near.z));
    float leave = min(far.x, min(far.y, far.z));
    // From far away both are rounded by more than the padding; what lies behind the origin is never visited.
    entry -= abs(entry) * SLAB_TOLERANCE;
    leave += abs(leave) * SLAB_TOLERANCE;
    moved.start = max(entry, first);
    // No >, which a NaN would pass.
    moved.valid = moved.valid && moved.start <= leave && moved.start <= last;
    vec3 travelled = moved.start * direction;
    moved.origin = origin + travelled;
    // A ray that starts 2^127 of the grid's units away is lost.
    moved.valid = moved.valid && is_finite(moved.origin);
    moved.s_min = first - moved.start;
    moved.s_max = last - moved.start;

    moved.direction = direction;
    moved.inverse = inverse;
    vec3 permuted = permute(moved, direction);
    float inverse_z = permute(moved, inverse).z;
    moved.shear = vec3(permuted.x * inverse_z, permuted.y * inverse_z, inverse_z);
    return moved;
}

// t of a hit at s, inside of the ray's interval in spite of rounding.
float hit_distance(MovedRay moved, Ray ray, float s) {
    float t = (moved.start + s) * moved.t_of_s.x * moved.t_of_s.y;
    return min(max(t, ray.t_min), ray.t_max);
}

// s of a t, as hit_distance has it.
float distance_to_s(MovedRay moved, float t) {
    return t / moved.t_of_s.y / moved.t_of_s.x - moved.start;
}

// Vertices of a triangle relative to the ray's origin, their components in the order of the triangle test.
struct Corners {
    vec3 a;
    vec3 b;
    vec3 c;
};

// What the triangle test of a ray has as x, y and z, as `permute` has it.
uvec3 axes_of(MovedRay ray) { return ray.z_is_x ? uvec3(1u, 2u, 0u) : (ray.z_is_y ? uvec3(2u, 0u, 1u) : uvec3(0u, 1u, 2u)); }

// From the vertices' coordinates along those axes, and the ray's origin's.
Corners corners_of(vec3 origin, vec3 x, vec3 y, vec3 z) {
    vec3 from_x = x - vec3(origin.x);
    vec3 from_y = y - vec3(origin.y);
    vec3 from_z = z - vec3(origin.z);
    return Corners(vec3(from_x.x, from_y.x, from_z.x), vec3(from_x.y, from_y.y, from_z.y), vec3(from_x.z, from_y.z, from_z.z));
}

// Edge functions of a triangle as the ray sees it: of the edges that lie opposite of a, b and c. Those of a shared edge differ in sign alone,
// because each is a difference of two products and nothing is contracted.
vec3 edge_functions(MovedRay ray, Corners corners) {
    float ax = corners.a.x - ray.shear.x * corners.a.z;
    float ay = corners.a.y - ray.shear.y * corners.a.z;
    float bx = corners.b.x - ray.shear.x * corners.b.z;
    float by = corners.b.y - ray.shear.y * corners.b.z;
    float cx = corners.c.x - ray.shear.x * corners.c.z;
    float cy = corners.c.y - ray.shear.y * corners.c.z;
    return vec3(cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
}

// Whether the ray's line passes within the edges. Zero counts as inside, so no ray passes between two neighbours. Compared as integers,
// which costs drivers that run on a CPU a third of what minima and maxima of floats cost that may be no number: as unsigned ones only
// negative floats exceed that of -0, as signed ones only positive ones exceed 0.
bool is_inside(vec3 edges) {
    uvec3 bits = floatBitsToUint(edges);
    ivec3 signed_bits = floatBitsToInt(edges);
    bool negative = max(bits.x, max(bits.y, bits.z)) > 0x80000000u;
    bool positive = max(signed_bits.x, max(signed_bits.y, signed_bits.z)) > 0;
    return !(negative && positive);
}

// Where a ray that passes within a triangle's edges meets it; false, and no values, if it is seen exactly edge-on. Both windings are met.
bool meet_triangle(MovedRay ray, Corners corners, vec3 edges, out float s, out float u, out float v) {
    float determinant = edges.x + edges.y + edges.z;
    // The distance is the plane's, not the edge functions': theirs is lost to cancellation where the triangle is long and thin. It is exact
    // for planes along the axes, and never beyond the triangle's vertices.
    vec3 a = corners.a;
    vec3 e1 = corners.b - a;
    vec3 e2 = corners.c - a;
    vec3 normal = vec3(e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x);
    float facing = normal.x * ray.shear.x + normal.y * ray.shear.y + normal.z;
    float along = (normal.x * a.x + normal.y * a.y + normal.z * a.z) / facing;
    s = min(max(along, min(a.z, min(corners.b.z, corners.c.z))), max(a.z, max(corners.b.z, corners.c.z))) * ray.shear.z;
    float inverse = 1.0 / determinant;
    u = edges.y * inverse;
    v = edges.z * inverse;
    // The inverse of a denormal may be infinite.
    return abs(determinant) >= LEAST_NORMAL && abs(facing) >= LEAST_NORMAL;
}

// Whether the ray's line meets the triangle; s, u and v are set if so.
bool intersect_triangle(MovedRay ray, Corners corners, out float s, out float u, out float v) {
    vec3 edges = edge_functions(ray, corners);
    return is_inside(edges) && meet_triangle(ray, corners, edges, s, u, v);
}

#endif
