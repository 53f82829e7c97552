#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One workgroup unites the boxes of all tiles into the first: the scene box.

#include "shared/bounds.glsl"
#include "shared/build.glsl"

layout(constant_id = 1) const uint BOUNDS_TILE = 2048;

layout(push_constant, std430) uniform BoundsSpine {
    StateIn state;
    BoundsIn partials;
    BoundsOut scene;
};

void main() {
    Bounds bounds = empty_bounds();
    uint partial_count = max((state.state.triangle_count + BOUNDS_TILE - 1u) / BOUNDS_TILE, 1u);
    for (uint i = gl_LocalInvocationID.x; i < partial_count; i += gl_WorkGroupSize.x) {
        bounds = unite(bounds, partials.bounds[i]);
    }
    bounds = workgroup_bounds(bounds);
    if (gl_LocalInvocationID.x == 0u) {
        scene.bounds[0] = bounds;
    }
}
