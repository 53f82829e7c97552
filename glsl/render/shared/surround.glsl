// What the scene knows of a triangle beside its vertices.
#ifndef RENDER_SURROUND_GLSL
#define RENDER_SURROUND_GLSL

// A triangle's material and the mesh that it belongs to.
struct Surround {
    uint material;
    uint mesh;
};

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer Surrounds { Surround triangle[]; };
layout(buffer_reference, std430, buffer_reference_align = 8) writeonly buffer SurroundsOut { Surround triangle[]; };

#endif
