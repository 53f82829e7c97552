//! Shading normals where a file has none.

use crate::Mesh;
use crate::vector::{Vector, add, cross, dot, normalised, scale, sub};

/// Where the normal of a vertex comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Smooth {
    /// From the file; any length but zero.
    Given([f32; 3]),
    /// The mean over all triangles at all vertices that share these two numbers.
    Shared { place: u32, group: u32 },
}

/// Fills `mesh.normals`. The mean of triangle normals is weighted by the triangles' angles at the vertex (Thürmer and Wüthrich 1998), so that
/// it depends on the surface and not on how it was cut into triangles. Which vertices share a normal depends on the faces alone, not on
/// positions: key-frames of one face list stay vertex for vertex comparable.
pub(crate) fn compute_normals(mesh: &mut Mesh, smooth: &[Smooth]) {
    let mut sums: Vec<Vector> = Vec::new();
    if smooth.iter().any(|smooth| matches!(smooth, Smooth::Shared { .. })) {
        sums = vec![[0.0; 3]; smooth.len()];
        for triangle in &mesh.indices {
            add_triangle(&mesh.positions, *triangle, &mut sums);
        }
        share(smooth, &mut sums);
    }
    mesh.normals = smooth
        .iter()
        .enumerate()
        .map(|(at, smooth)| {
            let normal = match smooth {
                Smooth::Given(normal) => normal.map(f64::from),
                Smooth::Shared { .. } => sums.get(at).copied().unwrap_or_default(),
            };
            // A vertex of triangles without area has no normal of its own: any will do, since no ray hits there.
            normalised(normal).unwrap_or([0.0, 1.0, 0.0]).map(|value| value as f32)
        })
        .collect();
}

fn add_triangle(positions: &[[f32; 3]], triangle: [u32; 3], sums: &mut [Vector]) {
    let [a, b, c] = triangle.map(|at| positions.get(at as usize).copied().unwrap_or([f32::NAN; 3]).map(f64::from));
    let Some(normal) = normalised(cross(sub(b, a), sub(c, a))) else { return };
    for (at, (from, left, right)) in triangle.into_iter().zip([(a, b, c), (b, c, a), (c, a, b)]) {
        let (Some(left), Some(right)) = (normalised(sub(left, from)), normalised(sub(right, from))) else { continue };
        let angle = dot(left, right).clamp(-1.0, 1.0).acos();
        if let Some(sum) = sums.get_mut(at as usize) {
            *sum = add(*sum, scale(normal, angle));
        }
    }
}

/// Gives all vertices of equal numbers the sum over them, added in vertex order.
fn share(smooth: &[Smooth], sums: &mut [Vector]) {
    let mut order: Vec<(u32, u32, u32)> = smooth
        .iter()
        .enumerate()
        .filter_map(|(at, smooth)| match smooth {
            Smooth::Shared { place, group } => Some((*group, *place, at as u32)),
            Smooth::Given(_) => None,
        })
        .collect();
    order.sort_unstable();
    for run in order.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|run| run.len() > 1) {
        let total = run.iter().fold([0.0; 3], |total, vertex| add(total, sums[vertex.2 as usize]));
        for vertex in run {
            sums[vertex.2 as usize] = total;
        }
    }
}
