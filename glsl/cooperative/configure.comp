#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

// One workgroup unites the boxes of all tiles of triangles; its first invocation turns the scene box, the number of triangles and the density k
// into the grid's resolution (thesis Equation 3-1) and into the sizes of the steps that depend on it.

#include "shared/bounds.glsl"
#include "shared/build.glsl"
#include "shared/intersect.glsl"
#include "shared/split.glsl"

layout(constant_id = 1) const uint MAP_SIZE = 64;
layout(constant_id = 2) const uint SORT_BITS = 10;
layout(constant_id = 3) const uint BRICK_TILE = 1024;
layout(constant_id = 4) const uint BOUNDS_TILE = 2048;

layout(push_constant, std430) uniform Configure {
    BoundsIn partials;
    HeaderOut grid;
    StateInOut state;
    ArgumentsOut arguments;
    ReportOut report;
    // Only their addresses are taken, for the header.
    Cells cells;
    References references;
    Triangles triangles;
    Bricks bricks;
    uint cell_capacity;
    float density;
    uint fixed_x; // 0: by density
    uint fixed_y;
    uint fixed_z;
    uint levels; // 1: flat, 2: cells with many triangles are split
    uint exact; // 1: cells that a triangle's large box alone overlaps get the sentinel key
};

const float MAX_RESOLUTION = 4096.0;
const float PAD = 9.5367431640625e-07; // 2^-20
const float MIN_CELL_IN_PADS = 4.0;
const float FAR = 4.0;
const float LEAST_MIDDLE = 7.888609052210118e-31; // 2^-100

// The middle of an interval that lies far from zero, for the scene's size. All its points are then between half and twice the middle, and
// no difference is denormal: subtracting the middle is exact.
float middle_for(float low, float high, float longest) {
    float middle = 0.5 * low + 0.5 * high;
    return abs(middle) >= max(FAR * longest, LEAST_MIDDLE) ? middle : 0.0;
}

float cells_for(vec3 relative, vec3 limit, float s) {
    vec3 cells = min(max(relative * s, vec3(1.0)), limit);
    return cells.x * cells.y * cells.z;
}

// Equation 3-1 over the axes that are longer than one of its cells: N = d * s, with the s that gives `target` cells in all. A flat axis
// has one cell and leaves its share to the others, where the equation as it stands divides by a volume of nothing.
uvec3 resolution_for(vec3 extent, vec3 limit, float target) {
    float longest = max(extent.x, max(extent.y, extent.z));
    vec3 relative = extent / longest;
    float low = 1.0;
    float high = max(target, 1.0);
    // 48 halvings reach neighbouring floats from any start.
    for (int i = 0; i < 48; ++i) {
        float middle = 0.5 * (low + high);
        bool fits = cells_for(relative, limit, middle) <= target;
        low = fits ? middle : low;
        high = fits ? high : middle;
    }
    return uvec3(min(max(floor(relative * low), vec3(1.0)), limit));
}

// Two axes have at most 2^24 cells together, so nothing overflows.
bool fits(uvec3 resolution, uint capacity) { return resolution.x * resolution.y <= capacity / resolution.z; }

// The least size, from extent / count upwards, whose last boundary reaches `high`.
float cell_size_for(float low, float high, float count) {
    float size = (high - low) / count;
    for (int i = 0; i < 64; ++i) {
        float offset = count * size;
        if (low + offset >= high) {
            break;
        }
        size = uintBitsToFloat(floatBitsToUint(size) + 1u);
    }
    return size;
}

void main() {
    Bounds bounds = empty_bounds();
    uint partial_count = max((state.state.triangle_count + BOUNDS_TILE - 1u) / BOUNDS_TILE, 1u);
    for (uint i = gl_LocalInvocationID.x; i < partial_count; i += gl_WorkGroupSize.x) {
        bounds = unite(bounds, partials.bounds[i]);
    }
    bounds = workgroup_bounds(bounds);
    if (gl_LocalInvocationID.x != 0u) {
        return;
    }
    BuildState next = state.state;
    uint triangle_count = next.triangle_count;
    bool empty = bounds.dropped == triangle_count;
    vec3 low = empty ? vec3(0.0) : bounds.low;
    vec3 high = empty ? vec3(0.0) : bounds.high;

    vec3 size = high - low;
    float longest = max(size.x, max(size.y, size.z));
    vec3 middle = vec3(middle_for(low.x, high.x, longest), middle_for(low.y, high.y, longest), middle_for(low.z, high.z, longest));
    vec3 relative_low = low - middle;
    vec3 relative_high = high - middle;
    vec3 magnitude = max(abs(relative_low), abs(relative_high));
    float largest = max(magnitude.x, max(magnitude.y, magnitude.z));
    int exponent = largest > 0.0 ? clamped_exponent(largest) : 0;
    float scale = power_of_two(-exponent);
    float pad = max(largest * scale, 1.0) * PAD;
    vec3 box_min = relative_low * scale - vec3(pad);
    vec3 box_max = relative_high * scale + vec3(pad);

    vec3 extent = box_max - box_min;
    vec3 limit = min(max(floor(extent / (MIN_CELL_IN_PADS * pad)), vec3(1.0)), vec3(MAX_RESOLUTION));
    float used_density = density;
    uvec3 resolution = uvec3(1u);
    uint overflow = next.overflow;
    if (!empty) {
        float triangles_in_use = float(triangle_count - bounds.dropped);
        float wanted = max(triangles_in_use * density, 1.0);
        float capacity = max(float(cell_capacity), 1.0);
        if (fixed_x != 0u) {
            resolution = min(uvec3(fixed_x, fixed_y, fixed_z), uvec3(limit));
            if (!fits(resolution, cell_capacity)) {
                overflow |= OVERFLOW_CELLS;
                resolution = resolution_for(extent, limit, capacity);
            }
        } else {
            if (wanted > capacity) {
                overflow |= OVERFLOW_CELLS;
                wanted = capacity;
                used_density = wanted / triangles_in_use;
            }
            resolution = resolution_for(extent, limit, wanted);
        }
        // Beyond 2^24 cells the floats above may be off by a few; one slice less is at least 4,096 cells less.
        if (!fits(resolution, cell_capacity)) {
            uint longest = max(resolution.x, max(resolution.y, resolution.z));
            bvec3 is_longest = equal(resolution, uvec3(longest));
            resolution -= is_longest.x ? uvec3(1u, 0u, 0u) : (is_longest.y ? uvec3(0u, 1u, 0u) : uvec3(0u, 0u, 1u));
            resolution = max(resolution, uvec3(1u));
        }
    }
    uint cell_count = resolution.x * resolution.y * resolution.z;

    GridHeader header;
    header.box_min = box_min;
    header.scale = scale;
    header.pad = pad;
    // A walk must not leave the last cell before it leaves the box.
    header.cell_size = vec3(cell_size_for(box_min.x, box_max.x, float(resolution.x)), cell_size_for(box_min.y, box_max.y, float(resolution.y)),
                            cell_size_for(box_min.z, box_max.z, float(resolution.z)));
    header.box_max = box_max;
    header.inverse_scale = power_of_two(exponent);
    header.inverse_cell_size = vec3(1.0) / header.cell_size;
    header.cell_count = cell_count;
    header.resolution = resolution;
    header.triangle_count = triangle_count;
    header.cells = uvec2(cells);
    header.references = uvec2(references);
    header.triangles = uvec2(triangles);
    header.bricks = uvec2(bricks);
    header.middle = middle;
    // Leaf cells are no smaller than cells may be.
    float least = min(header.cell_size.x, min(header.cell_size.y, header.cell_size.z));
    uint fine_shift = 0u;
    for (uint i = 1u; i <= MAX_LEVEL && levels > 1u; ++i) {
        fine_shift = least >= float(1u << i) * (MIN_CELL_IN_PADS * pad) ? i : fine_shift;
    }
    GridHeader fine = refined(header, fine_shift);
    header.fine_shift = fine_shift;
    header.fine_cell_size = fine.cell_size;
    header.reserved0 = 0u;
    header.inverse_fine_cell_size = fine.inverse_cell_size;
    header.reserved1 = 0u;
    grid.header = header;

    uint largest_key = cell_count - 1u;
    next.key_bits = largest_key == 0u ? 0u : uint(findMSB(largest_key)) + 1u;
    next.pass_count = (next.key_bits + SORT_BITS - 1u) / SORT_BITS;
    // No wider than that many passes need.
    next.digit_bits = next.pass_count == 0u ? 0u : (next.key_bits + next.pass_count - 1u) / next.pass_count;
    next.sentinel = exact != 0u ? cell_count : SATURATED;
    next.overflow = overflow;
    state.state = next;

    uvec3 bricks_along = brick_resolution(resolution);
    uint brick_count = bricks_along.x * bricks_along.y * bricks_along.z;
    arguments.arguments.brick_reduce = uvec4(deal_workgroups((brick_count + BRICK_TILE - 1u) / BRICK_TILE, 1u), 0u);
    arguments.arguments.bricks = uvec4(split_workgroups(brick_count, MAP_SIZE), 0u);
    arguments.arguments.clear_cells = uvec4(deal_workgroups(BRICK_SIZE * brick_count, MAP_SIZE), 0u);

    report.report.triangles = triangle_count;
    report.report.dropped = bounds.dropped;
    report.report.cells = cell_count;
    report.report.cells_in_use = 0u;
    report.report.resolution = resolution;
    report.report.longest_list = 0u;
    report.report.pairs = 0u;
    report.report.pair_total = 0u;
    report.report.overflow = overflow;
    report.report.key_bits = next.key_bits;
    report.report.box_min = low;
    report.report.density = used_density;
    report.report.box_max = high;
    report.report.triangle_total = next.triangle_total;
    report.report.split_cells = 0u;
    report.report.leaf_cells = 0u;
    report.report.leaf_pairs = 0u;
    report.report.reserved = 0u;
}
