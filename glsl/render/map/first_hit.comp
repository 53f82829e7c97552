#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require
// What the camera's rays met, beside the light: the layers of a picture other than its beauty.

#include "render/shared/surface.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

// Host twin: gridwalk_render::wavefront::FirstHit.
struct FirstHitRecord {
    vec3 position;
    float distance;
    vec3 normal;
    float u;
    vec3 geometric_normal;
    float v;
    vec3 albedo;
    uint material;
    uint primitive; // within the mesh
    uint mesh;
    uint triangle; // within the grid
    uint reserved;
};

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer RecordsOut { FirstHitRecord record[]; };

layout(push_constant, std430) uniform FirstHit {
    SceneIn scene;
    QueueIn queue;
    RaysIn rays;
    HitsIn hits;
    RecordsOut records;
};

void main() {
    uint i = invocation_index();
    if (i >= queue.header.count) {
        return;
    }
    Ray ray = rays.ray[i];
    Hit hit = hits.hit[i];
    FirstHitRecord record;
    record.position = vec3(0.0);
    record.distance = GRIDWALK_INFINITY;
    record.normal = vec3(0.0);
    record.u = 0.0;
    record.geometric_normal = vec3(0.0);
    record.v = 0.0;
    record.albedo = vec3(0.0);
    record.material = GRIDWALK_MISS;
    record.primitive = GRIDWALK_MISS;
    record.mesh = GRIDWALK_MISS;
    record.triangle = hit.triangle;
    record.reserved = 0u;
    if (hit.triangle < scene.table.triangle_count) {
        HitPoint point = hit_point(scene, ray, hit);
        Material material = Materials(scene.table.materials).material[point.material];
        record.position = point.position;
        record.distance = hit.t;
        record.normal = point.normal;
        record.u = point.uv.x;
        record.geometric_normal = point.geometric_normal;
        record.v = point.uv.y;
        record.albedo = point.colour * mapped_colour(scene, material.diffuse, material.diffuse_map, point.uv);
        record.material = material.number;
        record.primitive = hit.triangle - SceneUints(scene.table.mesh_starts).word[point.mesh];
        record.mesh = point.mesh;
    }
    records.record[i] = record;
}
