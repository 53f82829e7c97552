//! Twin of kernel `skin`.

use crate::dispatch::workgroups;
use crate::twin::motion::{Influence, put_vec3, renormalised, vec3};
use crate::vector::Vec3;

type Row = [f32; 4];

fn along(row: Row, p: Vec3) -> f32 {
    row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]
}

fn crossed(a: Row, b: Row) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dotted(a: Vec3, b: Vec3) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Moves each vertex by the blend of its joints' matrices (three rows each), and its normal by the cofactors of that blend.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn skin(
    map_size: u32,
    groups: [u32; 3],
    base_positions: &[f32],
    base_normals: &[f32],
    influences: &[Influence],
    matrices: &[[Row; 3]],
    positions: &mut [f32],
    normals: &mut [f32],
    vertex_count: u32,
    influences_each: u32,
) {
    let invocations = workgroups(groups).flat_map(|group| group * map_size..(group + 1) * map_size);
    for vertex in invocations.filter(|vertex| *vertex < vertex_count) {
        let mut rows = matrices[0];
        if influences_each > 0 {
            rows = [[0.0; 4]; 3];
            let first = vertex as usize * influences_each as usize;
            for influence in &influences[first..first + influences_each as usize] {
                for (row, source) in rows.iter_mut().zip(matrices[influence.joint as usize]) {
                    *row = std::array::from_fn(|i| row[i] + source[i] * influence.weight);
                }
            }
        }
        let p = vec3(base_positions, vertex);
        put_vec3(positions, vertex, rows.map(|row| along(row, p)));

        let [a, b, c] = rows;
        let n = vec3(base_normals, vertex);
        let first = crossed(b, c);
        let side = if dotted([a[0], a[1], a[2]], first) < 0.0 { -1.0 } else { 1.0 };
        let normal = [first, crossed(c, a), crossed(a, b)].map(|cofactors| dotted(cofactors, n) * side);
        put_vec3(normals, vertex, renormalised(normal));
    }
}
