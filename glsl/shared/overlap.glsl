// Which cells a triangle overlaps (thesis section 3.1, Figure 3.2): all cells of its box, or those that it really meets. Both tests are
// padded, so that a hit up to pad / 2 beside its triangle, found by a walk up to pad / 2 beside its cell, lies in a listed cell.
#ifndef OVERLAP_GLSL
#define OVERLAP_GLSL

#include "shared/grid.glsl"

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

// A box of one row of cells is met by its triangle in each of them.
bool is_row(CellBox box) {
    uvec3 same = uvec3(equal(box.low, box.high));
    return same.x + same.y + same.z >= 2u;
}

// Whether the axis at right angles to an edge of a triangle and to a box axis parts the triangle from a box of the given half size around
// the origin, in the plane of the two other box axes. `a` is an end of the edge, `c` the corner across: the ends are projected to the same
// point but for rounding.
bool separates(vec2 edge, vec2 half_size, vec2 a, vec2 c) {
    float p = edge.x * a.y - edge.y * a.x;
    float q = edge.x * c.y - edge.y * c.x;
    float reach = abs(edge.y) * half_size.x + abs(edge.x) * half_size.y;
    return min(p, q) > reach || max(p, q) < -reach;
}

// Separating axes: the triangle's normal and the nine products of an edge and a box axis; the box axes are overlapped_box's. The box is
// padded three times: one and a half as above, the rest for the rounding of the projections, which comes to little more than one pad.
bool triangle_overlaps_cell(GridHeader grid, vec3 v0, vec3 v1, vec3 v2, uvec3 cell) {
    vec3 low = boundary(grid.box_min, grid.cell_size, vec3(cell));
    vec3 half_size = grid.cell_size * 0.5;
    vec3 centre = low + half_size;
    half_size += vec3(grid.pad * 3.0);
    vec3 a = v0 - centre;
    vec3 b = v1 - centre;
    vec3 c = v2 - centre;
    vec3 e0 = b - a;
    vec3 e1 = c - b;
    vec3 e2 = a - c;
    // No operator that leaves the rest out: that would be a branch for each.
    bvec3 apart_x = bvec3(separates(e0.yz, half_size.yz, a.yz, c.yz), separates(e1.yz, half_size.yz, b.yz, a.yz),
                          separates(e2.yz, half_size.yz, c.yz, b.yz));
    bvec3 apart_y = bvec3(separates(e0.zx, half_size.zx, a.zx, c.zx), separates(e1.zx, half_size.zx, b.zx, a.zx),
                          separates(e2.zx, half_size.zx, c.zx, b.zx));
    bvec3 apart_z = bvec3(separates(e0.xy, half_size.xy, a.xy, c.xy), separates(e1.xy, half_size.xy, b.xy, a.xy),
                          separates(e2.xy, half_size.xy, c.xy, b.xy));
    vec3 normal = vec3(e0.y * e1.z - e0.z * e1.y, e0.z * e1.x - e0.x * e1.z, e0.x * e1.y - e0.y * e1.x);
    float p0 = normal.x * a.x + normal.y * a.y + normal.z * a.z;
    float p1 = normal.x * b.x + normal.y * b.y + normal.z * b.z;
    float p2 = normal.x * c.x + normal.y * c.y + normal.z * c.z;
    float reach = abs(normal.x) * half_size.x + abs(normal.y) * half_size.y + abs(normal.z) * half_size.z;
    bvec4 apart = bvec4(any(apart_x), any(apart_y), any(apart_z), min(p0, min(p1, p2)) > reach || max(p0, max(p1, p2)) < -reach);
    return !any(apart);
}

#endif
