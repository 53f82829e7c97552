// Which cells a triangle overlaps (thesis section 3.1, Figure 3.2): all cells of its box, or those that it really meets. Both tests are
// padded, so that a hit up to pad / 2 beside its triangle, found by a walk up to pad / 2 beside its cell, lies in a listed cell.
#ifndef OVERLAP_GLSL
#define OVERLAP_GLSL

#include "shared/grid.glsl"

// Vertices of the triangle whose first row it is.
void load_vertices(Triangles triangles, uint row, out vec3 v0, out vec3 v1, out vec3 v2) {
    vec3 x = triangles.row[row].xyz;
    vec3 y = triangles.row[row + 1u].xyz;
    vec3 z = triangles.row[row + 2u].xyz;
    v0 = vec3(x.x, y.x, z.x);
    v1 = vec3(x.y, y.y, z.y);
    v2 = vec3(x.z, y.z, z.z);
}

struct CellBox {
    uvec3 low;
    uvec3 high; // inclusive
};

// Cells whose boundaries enclose [low, high]. The quotient is rounded by less than a cell, so one step mends it; boundary() decides.
CellBox overlapped_box(GridHeader grid, vec3 low, vec3 high) {
    vec3 last = vec3(grid.resolution) - vec3(1.0);
    // Clamped as floats: a conversion out of range may give anything.
    vec3 first = min(max(floor((low - grid.box_min) * grid.inverse_cell_size), vec3(0.0)), last);
    vec3 end = min(max(floor((high - grid.box_min) * grid.inverse_cell_size), vec3(0.0)), last);
    first -= vec3(greaterThan(boundary(grid.box_min, grid.cell_size, first), low));
    end += vec3(lessThanEqual(boundary(grid.box_min, grid.cell_size, end + vec3(1.0)), high));
    CellBox box;
    box.low = whole(max(first, vec3(0.0)));
    box.high = whole(min(end, last));
    return box;
}

// Padded twice: the invariant asks for one pad where divisions are rounded to the nearest; with those of 2.5 ulp, walk and hit may each
// stray by up to three quarters of a pad.
CellBox triangle_cells(GridHeader grid, vec3 v0, vec3 v1, vec3 v2) {
    vec3 low = min(v0, min(v1, v2)) - vec3(grid.pad * 2.0);
    vec3 high = max(v0, max(v1, v2)) + vec3(grid.pad * 2.0);
    return overlapped_box(grid, low, high);
}

// Cells of a box whose overlap is told by one word. A box of more cells is a large one.
const uint SMALL_BOX = 32u;

uint cells_of(CellBox box) {
    uvec3 size = box.high - box.low + uvec3(1u);
    return size.x * size.y * size.z;
}

// Cells along x and y: the lower and the upper half of a word.
uint box_sizes(CellBox box) { return (box.high.x - box.low.x + 1u) | (box.high.y - box.low.y + 1u) << 16u; }

// The next cell of a box, x fastest.
uvec3 next_cell(CellBox box, uvec3 cell) {
    cell.x += 1u;
    bool row = cell.x > box.high.x;
    cell.x = row ? box.low.x : cell.x;
    cell.y += uint(row);
    bool slice = cell.y > box.high.y;
    cell.y = slice ? box.low.y : cell.y;
    cell.z += uint(slice);
    return cell;
}

uint small_whole(float x) { return floatBitsToUint(x + 8388608.0) & 0x7FFFFFu; }

// How much larger than the first cell's the id of cell n of a small box is, x fastest: from the last cell of a row to the first of the next
// there are `to_row` cells more, and `to_slice` from the last of a slice. `inverse` is 1 / cells along x and y: quotients of numbers below 32
// that lie half a one away from where rounding would count.
uint id_within(uint n, vec2 inverse, uint to_row, uint to_slice) {
    float row = floor((float(n) + 0.5) * inverse.x);
    float slice = floor((row + 0.5) * inverse.y);
    return n + small_whole(row) * to_row + small_whole(slice) * to_slice;
}

// A box of one row of cells is met by its triangle in each of them.
bool is_row(CellBox box) {
    uvec3 same = uvec3(equal(box.low, box.high));
    return same.x + same.y + same.z >= 2u;
}

// Axes that may part a triangle from a cell: its normal, and those at right angles to one of its edges and to a box axis (after the box axis;
// an element an edge). The box axes themselves are overlapped_box's. On each axis, seen from the middle of a first cell, the triangle's
// projection has a middle, and is parted from a cell whose middle is farther away than `reach`: half of both projections.
struct SeparatingAxes {
    vec3 edge_x;
    vec3 edge_y;
    vec3 edge_z;
    vec3 middle_x;
    vec3 middle_y;
    vec3 middle_z;
    vec3 reach_x;
    vec3 reach_y;
    vec3 reach_z;
    vec3 normal;
    float middle;
    float reach;
};

// The cells are padded four times: one and a half as above, the rest for rounding, which comes to little more than two pads. `end` and
// `across` are an end of each edge and the corner across: the two ends are projected to the same point but for rounding.
SeparatingAxes separating_axes(GridHeader grid, vec3 v0, vec3 v1, vec3 v2, uvec3 first) {
    vec3 half_size = grid.cell_size * 0.5;
    vec3 centre = boundary(grid.box_min, grid.cell_size, vec3(first)) + half_size;
    half_size += vec3(grid.pad * 4.0);
    vec3 a = v0 - centre;
    vec3 b = v1 - centre;
    vec3 c = v2 - centre;
    vec3 e0 = v1 - v0;
    vec3 e1 = v2 - v1;
    vec3 e2 = v0 - v2;
    SeparatingAxes axes;
    axes.edge_x = vec3(e0.x, e1.x, e2.x);
    axes.edge_y = vec3(e0.y, e1.y, e2.y);
    axes.edge_z = vec3(e0.z, e1.z, e2.z);
    vec3 end_x = vec3(a.x, b.x, c.x);
    vec3 end_y = vec3(a.y, b.y, c.y);
    vec3 end_z = vec3(a.z, b.z, c.z);
    vec3 across_x = vec3(c.x, a.x, b.x);
    vec3 across_y = vec3(c.y, a.y, b.y);
    vec3 across_z = vec3(c.z, a.z, b.z);
    vec3 length_x = abs(axes.edge_x);
    vec3 length_y = abs(axes.edge_y);
    vec3 length_z = abs(axes.edge_z);
    vec3 p = axes.edge_y * end_z - axes.edge_z * end_y;
    vec3 q = axes.edge_y * across_z - axes.edge_z * across_y;
    axes.middle_x = (p + q) * 0.5;
    axes.reach_x = length_z * half_size.y + length_y * half_size.z + abs(p - q) * 0.5;
    p = axes.edge_z * end_x - axes.edge_x * end_z;
    q = axes.edge_z * across_x - axes.edge_x * across_z;
    axes.middle_y = (p + q) * 0.5;
    axes.reach_y = length_x * half_size.z + length_z * half_size.x + abs(p - q) * 0.5;
    p = axes.edge_x * end_y - axes.edge_y * end_x;
    q = axes.edge_x * across_y - axes.edge_y * across_x;
    axes.middle_z = (p + q) * 0.5;
    axes.reach_z = length_y * half_size.x + length_x * half_size.y + abs(p - q) * 0.5;
    vec3 normal = vec3(e0.y * e1.z - e0.z * e1.y, e0.z * e1.x - e0.x * e1.z, e0.x * e1.y - e0.y * e1.x);
    vec3 heights = normal.x * end_x + normal.y * end_y + normal.z * end_z;
    float low = min(heights.x, min(heights.y, heights.z));
    float high = max(heights.x, max(heights.y, heights.z));
    axes.normal = normal;
    axes.middle = (low + high) * 0.5;
    axes.reach = abs(normal.x) * half_size.x + abs(normal.y) * half_size.y + abs(normal.z) * half_size.z + (high - low) * 0.5;
    return axes;
}

// Whether none of the axes parts the triangle from the cell that lies so many cells from the first one.
bool meets(SeparatingAxes axes, GridHeader grid, uvec3 cells_away) {
    vec3 away = vec3(cells_away) * grid.cell_size;
    vec3 x = axes.middle_x - (axes.edge_y * away.z - axes.edge_z * away.y);
    vec3 y = axes.middle_y - (axes.edge_z * away.x - axes.edge_x * away.z);
    vec3 z = axes.middle_z - (axes.edge_x * away.y - axes.edge_y * away.x);
    float along = axes.middle - (axes.normal.x * away.x + axes.normal.y * away.y + axes.normal.z * away.z);
    // No operator that leaves the rest out: that would be a branch for each.
    bvec4 apart = bvec4(any(greaterThan(abs(x), axes.reach_x)), any(greaterThan(abs(y), axes.reach_y)), any(greaterThan(abs(z), axes.reach_z)),
                        abs(along) > axes.reach);
    return !any(apart);
}

// Whether a triangle meets one cell.
bool triangle_overlaps_cell(GridHeader grid, vec3 v0, vec3 v1, vec3 v2, uvec3 cell) {
    return meets(separating_axes(grid, v0, v1, v2, cell), grid, uvec3(0u));
}

#endif
