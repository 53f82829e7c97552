#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Puts a mesh's triangles among those of the scene: vertices count over all meshes there, and each triangle tells its mesh.

#include "render/shared/motion.glsl"
#include "render/shared/surround.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform Place {
    MotionWordsIn mesh_indices;
    MotionWordsIn mesh_materials;
    MotionWordsOut indices;
    SurroundsOut surrounds;
    uint triangle_count;
    uint first_triangle; // of the mesh, among those of the scene
    uint first_vertex;
    uint mesh;
};

void main() {
    uint triangle = invocation_index();
    if (triangle >= triangle_count) {
        return;
    }
    uint target = first_triangle + triangle;
    for (uint corner = 0u; corner < 3u; ++corner) {
        indices.word[3u * target + corner] = mesh_indices.word[3u * triangle + corner] + first_vertex;
    }
    surrounds.triangle[target] = Surround(mesh_materials.word[triangle], mesh);
}
