// Queues of the wavefront: rays of one kind, side by side. Host twins: gridwalk_render::wavefront.
#ifndef RENDER_QUEUE_GLSL
#define RENDER_QUEUE_GLSL

#include "shared/dispatch.glsl"
#include "shared/trace_types.glsl"

// How many entries a queue holds, and the workgroups of 64 that it takes to walk over them.
struct QueueHeader {
    uint count;
    uint groups_x;
    uint groups_y;
    uint groups_z;
};

// What a ray's radiance is multiplied with, and which pixel of the batch it is added to. Of one queue, no two paths have one pixel.
struct Path {
    vec3 weight;
    uint slot;
};

// A hit, ready to be lit. Both normals are on the side of the viewer.
struct Surface {
    vec3 start; // secondary rays start here, and off the surface by
    float offset; // as much along the geometric normal
    vec3 normal;
    float shininess;
    vec3 geometric_normal;
    uint is_hit;
    vec3 diffuse;
    float reserved0;
    vec3 specular;
    float reserved1;
};

// Sum over the samples: radiance, and how many of them saw the scene.
struct Film {
    vec3 radiance;
    float coverage;
};

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer QueueIn { QueueHeader header; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer QueueOut { QueueHeader header; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer RaysOut { Ray ray[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer HitsIn { Hit hit[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer PathsIn { Path path[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer PathsOut { Path path[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer SurfacesIn { Surface surface[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer SurfacesOut { Surface surface[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer FilmInOut { Film film[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer WordsIn { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer WordsOut { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) buffer WordsInOut { uint word[]; };

#endif
