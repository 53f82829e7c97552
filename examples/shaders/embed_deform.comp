// What an engine's skinning pass would be: writes this frame's vertices from the rest pose.
#version 460
#extension GL_EXT_buffer_reference : require

layout(local_size_x = 64) in;

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Rest { float of[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer Positions { float of[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer Normals { float of[]; };

layout(push_constant, std430) uniform EmbedDeform {
    Rest rest;
    Positions positions;
    Normals normals;
    uint vertex_count;
    uint fixed_count; // vertices in front that stay as they are: the floor
    float time;
};

// A sphere with waves that wander over it.
vec3 surface(vec3 direction) {
    float wave = sin(5.0 * direction.x + 2.0 * time) * sin(4.0 * direction.y - time) * sin(6.0 * direction.z + 1.5 * time);
    return vec3(0.0, 1.25, 0.0) + direction * (1.0 + 0.3 * wave);
}

void main() {
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= vertex_count) {
        return;
    }
    vec3 rest_position = vec3(rest.of[3u * vertex], rest.of[3u * vertex + 1u], rest.of[3u * vertex + 2u]);
    vec3 position = rest_position;
    vec3 normal = vec3(0.0, 1.0, 0.0);
    if (vertex >= fixed_count) {
        vec3 direction = normalize(rest_position);
        position = surface(direction);
        vec3 a = normalize(cross(direction, abs(direction.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
        vec3 b = cross(direction, a);
        vec3 along_a = surface(normalize(direction + 0.01 * a)) - position;
        vec3 along_b = surface(normalize(direction + 0.01 * b)) - position;
        normal = normalize(cross(along_a, along_b));
        normal = dot(normal, direction) < 0.0 ? -normal : normal;
    }
    for (uint axis = 0u; axis < 3u; ++axis) {
        positions.of[3u * vertex + axis] = position[axis];
        normals.of[3u * vertex + axis] = normal[axis];
    }
}
