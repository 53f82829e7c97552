//! Polygons into triangles: a fan where that is right, ears where the polygon is concave.

use crate::vector::{Vector, cross, dot, sub};

/// Concave polygons of more corners are cut as fans: ears are quadratic work.
const MAX_EAR_CORNERS: usize = 512;

/// Cuts a polygon of `n >= 3` corners into `n - 2` triangles, each given by places in the polygon, in winding order. A triangle or a convex
/// polygon is a fan about its first corner.
pub(crate) fn triangulate(corners: &[[f32; 3]], triangles: &mut Vec<[usize; 3]>) {
    triangles.clear();
    let count = corners.len();
    let fan = |triangles: &mut Vec<[usize; 3]>| triangles.extend((1..count.saturating_sub(1)).map(|at| [0, at, at + 1]));
    if count <= 3 || count > MAX_EAR_CORNERS {
        return fan(triangles);
    }
    let Some(flat) = flattened(corners) else { return fan(triangles) };
    let turn = |a: usize, b: usize, c: usize| area(flat[a], flat[b], flat[c]);
    if (0..count).all(|at| turn(at, (at + 1) % count, (at + 2) % count) >= 0.0) {
        return fan(triangles);
    }
    cut_ears(&flat, triangles);
    if triangles.len() != count - 2 {
        triangles.clear();
        fan(triangles);
    }
}

/// The polygon on the coordinate plane nearest to its own, wound counterclockwise. `None` where it has no area or is not finite.
fn flattened(corners: &[[f32; 3]]) -> Option<Vec<[f64; 2]>> {
    let origin = corners.first()?.map(f64::from);
    let points: Vec<Vector> = corners.iter().map(|corner| sub(corner.map(f64::from), origin)).collect();
    // Newell's normal, as a sum of fans about the first corner.
    let mut normal = [0.0; 3];
    for pair in points.windows(2) {
        let part = cross(pair[0], pair[1]);
        normal = std::array::from_fn(|axis| normal[axis] + part[axis]);
    }
    let square = dot(normal, normal);
    if !(square.is_finite() && square > 0.0) {
        return None;
    }
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()))?;
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    let (x, y) = if normal[axis] > 0.0 { (x, y) } else { (y, x) };
    Some(points.iter().map(|point| [point[x], point[y]]).collect())
}

/// Twice the signed area.
fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Ear clipping (Meisters 1975). Stops early, with fewer triangles, where no ear is left (the polygon crosses itself), or where finding them
/// takes far longer than in any polygon that a person made.
fn cut_ears(flat: &[[f64; 2]], triangles: &mut Vec<[usize; 3]>) {
    let mut budget = 16 * flat.len() * flat.len();
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut at = 0;
    let mut tried = 0;
    while left.len() > 3 {
        let count = left.len();
        if tried == count || budget < count {
            return;
        }
        budget -= count;
        at %= count;
        let (a, b, c) = (left[(at + count - 1) % count], left[at], left[(at + 1) % count]);
        let ear = area(flat[a], flat[b], flat[c]) >= 0.0
            && !left.iter().any(|&other| {
                let point = flat[other];
                // Corners that coincide with the ear's (a bridge to a hole) do not block it.
                ![a, b, c].iter().any(|&corner| flat[corner] == point)
                    && area(flat[a], flat[b], point) >= 0.0
                    && area(flat[b], flat[c], point) >= 0.0
                    && area(flat[c], flat[a], point) >= 0.0
            });
        if ear {
            triangles.push([a, b, c]);
            left.remove(at);
            tried = 0;
        } else {
            at += 1;
            tried += 1;
        }
    }
    if let [a, b, c] = left[..] {
        triangles.push([a, b, c]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total_area(corners: &[[f32; 3]]) -> (usize, f64, f64) {
        let mut triangles = Vec::new();
        triangulate(corners, &mut triangles);
        let mut signed = 0.0;
        let mut absolute = 0.0;
        for [a, b, c] in &triangles {
            let point = |at: usize| [f64::from(corners[at][0]), f64::from(corners[at][1])];
            let twice = area(point(*a), point(*b), point(*c));
            signed += twice / 2.0;
            absolute += twice.abs() / 2.0;
        }
        (triangles.len(), signed, absolute)
    }

    #[test]
    fn a_concave_polygon_is_covered_once() {
        // A comb: the fan about its first corner would cover places twice.
        let comb = [
            [0.0, 0.0, 0.0],
            [5.0, 0.0, 0.0],
            [5.0, 3.0, 0.0],
            [4.0, 3.0, 0.0],
            [4.0, 1.0, 0.0],
            [3.0, 1.0, 0.0],
            [3.0, 3.0, 0.0],
            [2.0, 3.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let (count, signed, absolute) = total_area(&comb);
        assert_eq!(count, 8);
        assert!((signed - 9.0).abs() < 1e-9 && (absolute - 9.0).abs() < 1e-9, "{signed} {absolute}");
        let reversed: Vec<_> = comb.iter().rev().copied().collect();
        let (count, signed, absolute) = total_area(&reversed);
        assert_eq!(count, 8);
        assert!((signed + 9.0).abs() < 1e-9 && (absolute - 9.0).abs() < 1e-9, "{signed} {absolute}");
    }

    #[test]
    fn every_polygon_gives_two_triangles_fewer_than_corners() {
        let arrow = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.5, 1.0, 0.0]];
        assert_eq!(total_area(&arrow), (2, 1.5, 1.5));
        let point = [[1.0_f32; 3]; 7];
        assert_eq!(total_area(&point).0, 5);
        let bow = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.0]];
        assert_eq!(total_area(&bow).0, 3);
        let broken = [[0.0, 0.0, 0.0], [f32::NAN, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, f32::INFINITY, 0.0]];
        assert_eq!(total_area(&broken).0, 2);
    }
}
