//! Comparisons of hits, each as the list of rays that differ, so that a control can demand that it finds something.

use gridwalk::{Hit, Ray};
use gridwalk_core::intersect::move_ray;
use gridwalk_core::walk::Grid;
use gridwalk_tests::gpu::Gpu;

/// Rays whose hits differ by a bit (the sign of zero aside).
pub fn differences(found: &[Hit], expected: &[Hit]) -> Vec<usize> {
    assert_eq!(found.len(), expected.len());
    (0..found.len()).filter(|ray| found[*ray] != expected[*ray]).collect()
}

/// Rays whose hits differ between the device and its twin: by a bit on a CPU, whose divisions are rounded correctly, by more than rounding on
/// a GPU.
pub fn differences_from_twin(gpu: &Gpu, found: &[Hit], expected: &[Hit]) -> Vec<usize> {
    if gpu.context.is_cpu() {
        return differences(found, expected);
    }
    let near = |a: f32, b: f32, bound: f32| a == b || (a - b).abs() <= bound * (1.0 + a.abs());
    let same = |a: &Hit, b: &Hit| {
        a.is_hit() == b.is_hit() && near(a.t, b.t, 1e-5) && (a.triangle != b.triangle || near(a.u, b.u, 1e-3) && near(a.v, b.v, 1e-3))
    };
    (0..found.len()).filter(|ray| !same(&found[*ray], &expected[*ray])).collect()
}

/// Rays for which "any hit" and "a closest hit exists" disagree.
pub fn occlusion_differences(any: &[u32], closest: &[Hit]) -> Vec<usize> {
    assert_eq!(any.len(), closest.len());
    (0..any.len()).filter(|ray| any[*ray] != u32::from(closest[*ray].is_hit())).collect()
}

/// How edge-on a ray sees a triangle: the determinant of the triangle test over the sum of the magnitudes of the products that it is made
/// of, in double precision. Slivers count as seen edge-on from everywhere.
pub fn edge_on(grid: &Grid, ray: &Ray, triangle: u32) -> f64 {
    let Some(moved) = move_ray(ray, grid.header) else { return 1.0 };
    let [shear_x, shear_y, _] = moved.shear.map(f64::from);
    let sheared = |vertex: [f32; 3]| {
        let v = moved.permute(std::array::from_fn(|axis| vertex[axis] - moved.origin[axis])).map(f64::from);
        [v[0] - shear_x * v[2], v[1] - shear_y * v[2]]
    };
    let [a, b, c] = grid.triangle(triangle).map(sheared);
    let products = [c[0] * b[1], -c[1] * b[0], a[0] * c[1], -a[1] * c[0], b[0] * a[1], -b[1] * a[0]];
    let magnitude: f64 = products.iter().map(|x| x.abs()).sum();
    if magnitude == 0.0 { 0.0 } else { products.iter().sum::<f64>().abs() / magnitude }
}

/// A relative determinant below this counts as edge-on.
pub const EDGE_ON: f64 = 1e-2;

/// Differences that are printed in full, of one grid.
const LISTED: usize = 20;

/// Fails unless every ray that differs does so because of a triangle seen edge-on; lists those.
pub fn explain_by_edge_on(label: &str, grid: &Grid, rays: &[Ray], found: &[Hit], expected: &[Hit]) -> usize {
    let different = differences(found, expected);
    for (at, &index) in different.iter().enumerate() {
        let determinant = [found[index], expected[index]]
            .iter()
            .filter(|hit| hit.is_hit())
            .map(|hit| edge_on(grid, &rays[index], hit.triangle))
            .fold(f64::MAX, f64::min);
        let text = format!(
            "{label}: ray {index} {:?}: {:?} instead of {:?}, determinant {determinant:.1e}",
            rays[index], found[index], expected[index]
        );
        assert!(determinant < EDGE_ON, "{text}");
        // Thousands where a mesh is made of nothing else.
        match at {
            0..LISTED => eprintln!("{text}"),
            LISTED => eprintln!("{label}: {} more", different.len() - LISTED),
            _ => {}
        }
    }
    different.len()
}

pub type D = [f64; 3];

pub fn sub(a: D, b: D) -> D {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

pub fn along(origin: D, direction: D, t: f64) -> D {
    std::array::from_fn(|axis| origin[axis] + t * direction[axis])
}

pub fn dot(a: D, b: D) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: D, b: D) -> D {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn length(a: D) -> f64 {
    dot(a, a).sqrt()
}

/// Distance of a point from a segment.
pub fn to_segment(p: D, a: D, b: D) -> f64 {
    let edge = sub(b, a);
    let square = dot(edge, edge);
    let t = if square > 0.0 { (dot(sub(p, a), edge) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(sub(p, along(a, edge, t)))
}

/// Distance of a point from a triangle.
pub fn to_triangle(p: D, [a, b, c]: [D; 3]) -> f64 {
    let edges = to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a));
    let normal = cross(sub(b, a), sub(c, a));
    let square = dot(normal, normal);
    if square == 0.0 {
        return edges;
    }
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(a, b)| dot(cross(sub(*b, *a), sub(p, *a)), normal) >= 0.0);
    if inside { dot(sub(p, a), normal).abs() / square.sqrt() } else { edges }
}
