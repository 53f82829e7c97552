// Rays and hits as they lie in device memory. Host twins: gridwalk_core::Ray and gridwalk_core::Hit.
#ifndef GRIDWALK_TYPES_GLSL
#define GRIDWALK_TYPES_GLSL

// Points origin + t * direction, t in [t_min, t_max]; any length of direction but zero.
struct Ray {
    vec3 origin;
    float t_min;
    vec3 direction;
    float t_max;
};

// The point (1 - u - v) a + u b + v c of a triangle, at distance t.
struct Hit {
    float t;
    float u;
    float v;
    uint triangle;
};

const uint GRIDWALK_MISS = 0xFFFFFFFFu;
const uint GRIDWALK_UNFINISHED = 0xFFFFFFFEu;
// No constant expression in GLSL, hence a macro.
#define GRIDWALK_INFINITY uintBitsToFloat(0x7F800000u)

#endif
