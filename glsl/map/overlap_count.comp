#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// Brings a triangle into the grid's frame and counts its cells: of a small box those that it overlaps, a bit of its mask each, of a large
// one all; that has no bit. A small box is kept with its mask, for the emission. The count after the last triangle is zero, so that the scan
// leaves the total there.

#include "shared/brick.glsl"
#include "shared/gather.glsl"
#include "shared/overlap.glsl"

layout(local_size_x_id = 0) in;
layout(local_size_x = 64) in;
layout(constant_id = 1) const bool EXACT = false;

layout(push_constant, std430) uniform OverlapCount {
    GridwalkGrid grid;
    StateInOut state;
    TriangleWordsInOut triangles;
    UintsOut counts;
    UintsOut boxes; // three words a triangle: mask, first cell, sizes along x and y
    UintsOut used; // a word a brick: 1 if a triangle may lie in it; of large boxes their emission tells
};

// Of a small box. All invocations that write a word write the same.
void mark_bricks(CellBox box, uint count, uvec3 along) {
    uvec3 low = box.low / BRICK_SIZE;
    uvec3 more = box.high / BRICK_SIZE - low;
    uint brick = brick_id(low, along);
    if (max(more.x, max(more.y, more.z)) > 1u) {
        uvec3 cell = box.low;
        for (uint i = 0u; i < count; ++i) {
            used.word[brick_id(cell / BRICK_SIZE, along)] = 1u;
            cell = next_cell(box, cell);
        }
        return;
    }
    uint y = more.y * along.x;
    uint z = more.z * along.x * along.y;
    used.word[brick] = 1u;
    if ((more.x | more.y) != 0u) {
        used.word[brick + more.x] = 1u;
        used.word[brick + y] = 1u;
        used.word[brick + more.x + y] = 1u;
    }
    if (z != 0u) {
        used.word[brick + z] = 1u;
        used.word[brick + more.x + z] = 1u;
        used.word[brick + y + z] = 1u;
        used.word[brick + more.x + y + z] = 1u;
    }
}

void main() {
    GridHeader header = load_header(grid);
    uint triangle = invocation_index();
    uint triangle_count = state.state.triangle_count;
    if (triangle > triangle_count) {
        return;
    }
    if (triangle == triangle_count) {
        counts.word[triangle] = 0u;
        return;
    }
    uvec4 x = triangles.row[3u * triangle];
    uint count = 0u;
    uint mask = 0u;
    uint low = 0u;
    uint sizes = 0u;
    if ((x.w & TRIANGLE_DROPPED) == 0u) {
        uvec4 y = triangles.row[3u * triangle + 1u];
        uvec4 z = triangles.row[3u * triangle + 2u];
        vec3 v0 = to_frame(header, uintBitsToFloat(uvec3(x.x, y.x, z.x)));
        vec3 v1 = to_frame(header, uintBitsToFloat(uvec3(x.y, y.y, z.y)));
        vec3 v2 = to_frame(header, uintBitsToFloat(uvec3(x.z, y.z, z.z)));
        triangles.row[3u * triangle] = uvec4(floatBitsToUint(vec3(v0.x, v1.x, v2.x)), x.w);
        triangles.row[3u * triangle + 1u] = uvec4(floatBitsToUint(vec3(v0.y, v1.y, v2.y)), y.w);
        triangles.row[3u * triangle + 2u] = uvec4(floatBitsToUint(vec3(v0.z, v1.z, v2.z)), z.w);
        CellBox box = triangle_cells(header, v0, v1, v2);
        count = cells_of(box);
        low = cell_id(box.low, header.resolution);
        sizes = box_sizes(box);
        if (count > SMALL_BOX) {
            state.state.has_large = 1u;
        } else if (!EXACT || is_row(box)) {
            mask = 0xFFFFFFFFu >> (SMALL_BOX - count);
        } else {
            SeparatingAxes axes = separating_axes(header, v0, v1, v2, box.low);
            uvec3 cell = box.low;
            for (uint i = 0u; i < count; ++i) {
                mask |= uint(meets(axes, header, cell - box.low)) << i;
                cell = next_cell(box, cell);
            }
            count = uint(bitCount(mask));
        }
        if (count <= SMALL_BOX) {
            mark_bricks(box, cells_of(box), brick_resolution(header.resolution));
        }
    }
    counts.word[triangle] = count;
    boxes.word[3u * triangle] = mask;
    boxes.word[3u * triangle + 1u] = low;
    boxes.word[3u * triangle + 2u] = sizes;
}
