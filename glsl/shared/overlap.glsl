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
    box.low = uvec3(max(first, vec3(0.0)));
    box.high = uvec3(min(end, last));
    return box;
}

// Padded twice: the invariant asks for one pad where divisions are rounded to the nearest; with those of 2.5 ulp, walk and hit may each
// stray by up to three quarters of a pad.
CellBox triangle_cells(GridHeader grid, vec3 v0, vec3 v1, vec3 v2) {
    vec3 low = min(v0, min(v1, v2)) - vec3(grid.pad * 2.0);
    vec3 high = max(v0, max(v1, v2)) + vec3(grid.pad * 2.0);
    return overlapped_box(grid, low, high);
}

// Whether `axis` parts the triangle from a box of the given half size around the origin. All three vertices are projected: the edge's
// two are equal only for an exact axis, and a rounded axis must stay a valid one.
bool separates(vec3 axis, vec3 half_size, vec3 v0, vec3 v1, vec3 v2) {
    float p0 = axis.x * v0.x + axis.y * v0.y + axis.z * v0.z;
    float p1 = axis.x * v1.x + axis.y * v1.y + axis.z * v1.z;
    float p2 = axis.x * v2.x + axis.y * v2.y + axis.z * v2.z;
    float reach = abs(axis.x) * half_size.x + abs(axis.y) * half_size.y + abs(axis.z) * half_size.z;
    return min(p0, min(p1, p2)) > reach || max(p0, max(p1, p2)) < -reach;
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
    vec3 normal = vec3(e0.y * e1.z - e0.z * e1.y, e0.z * e1.x - e0.x * e1.z, e0.x * e1.y - e0.y * e1.x);
    bool apart = separates(normal, half_size, a, b, c);
    apart = apart || separates(vec3(0.0, -e0.z, e0.y), half_size, a, b, c);
    apart = apart || separates(vec3(0.0, -e1.z, e1.y), half_size, a, b, c);
    apart = apart || separates(vec3(0.0, -e2.z, e2.y), half_size, a, b, c);
    apart = apart || separates(vec3(e0.z, 0.0, -e0.x), half_size, a, b, c);
    apart = apart || separates(vec3(e1.z, 0.0, -e1.x), half_size, a, b, c);
    apart = apart || separates(vec3(e2.z, 0.0, -e2.x), half_size, a, b, c);
    apart = apart || separates(vec3(-e0.y, e0.x, 0.0), half_size, a, b, c);
    apart = apart || separates(vec3(-e1.y, e1.x, 0.0), half_size, a, b, c);
    apart = apart || separates(vec3(-e2.y, e2.x, 0.0), half_size, a, b, c);
    return !apart;
}

#endif
