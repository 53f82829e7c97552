#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_GOOGLE_include_directive : require
// Moves each vertex by the blend of its joints' matrices, and its normal by the cofactors of that blend.

#include "render/shared/motion.glsl"

layout(local_size_x_id = 0, local_size_x = 64) in;

layout(push_constant, std430) uniform Skin {
    MotionFloatsIn base_positions;
    MotionFloatsIn base_normals;
    InfluencesIn influences;
    MatricesIn matrices; // three rows each
    MotionFloatsOut positions;
    MotionFloatsOut normals;
    uint vertex_count;
    uint influences_each; // 0: the first matrix moves all; below 32,768
};

float along(vec4 row, vec3 p) { return row.x * p.x + row.y * p.y + row.z * p.z + row.w; }

// Of three rows without their translation.
vec3 crossed(vec4 a, vec4 b) { return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }

float dotted(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

void main() {
    uint vertex = invocation_index();
    if (vertex >= vertex_count) {
        return;
    }
    vec4 a = matrices.row[0];
    vec4 b = matrices.row[1];
    vec4 c = matrices.row[2];
    if (influences_each > 0u) {
        a = vec4(0.0);
        b = vec4(0.0);
        c = vec4(0.0);
        for (uint i = 0u; i < influences_each; ++i) {
            Influence influence = influences.influence[vertex * influences_each + i];
            a += matrices.row[3u * influence.joint] * influence.weight;
            b += matrices.row[3u * influence.joint + 1u] * influence.weight;
            c += matrices.row[3u * influence.joint + 2u] * influence.weight;
        }
    }
    vec3 p = motion_vec3(base_positions, vertex);
    uint x = 3u * vertex;
    positions.word[x] = along(a, p);
    positions.word[x + 1u] = along(b, p);
    positions.word[x + 2u] = along(c, p);

    // The cofactors are the inverse transpose times the determinant, whose sign a mirroring blend would leave in the normal.
    vec3 n = motion_vec3(base_normals, vertex);
    vec3 first = crossed(b, c);
    float side = dotted(a.xyz, first) < 0.0 ? -1.0 : 1.0;
    vec3 normal = renormalised(vec3(
        dotted(first, n) * side,
        dotted(crossed(c, a), n) * side,
        dotted(crossed(a, b), n) * side
    ));
    normals.word[x] = normal.x;
    normals.word[x + 1u] = normal.y;
    normals.word[x + 2u] = normal.z;
}
