//! Twin of kernel `morph`.

use crate::dispatch::workgroups;
use crate::twin::motion::{ActiveTarget, NO_DELTAS, put_vec3, vec3};
use crate::vector::Vec3;

/// Adds the weighted deltas of morph targets to a mesh.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn morph(
    map_size: u32,
    groups: [u32; 3],
    base_positions: &[f32],
    base_normals: &[f32],
    deltas: &[f32],
    targets: &[ActiveTarget],
    positions: &mut [f32],
    normals: &mut [f32],
    vertex_count: u32,
) {
    let invocations = workgroups(groups).flat_map(|group| group * map_size..(group + 1) * map_size);
    for vertex in invocations.filter(|vertex| *vertex < vertex_count) {
        let add = |base: Vec3, begin: u32, weight: f32| {
            if begin == NO_DELTAS {
                return base;
            }
            std::array::from_fn(|axis| base[axis] + deltas[begin as usize + 3 * vertex as usize + axis] * weight)
        };
        let start = (vec3(base_positions, vertex), vec3(base_normals, vertex));
        let (position, normal) = targets.iter().fold(start, |(position, normal), target| {
            (add(position, target.positions, target.weight), add(normal, target.normals, target.weight))
        });
        put_vec3(positions, vertex, position);
        put_vec3(normals, vertex, normal);
    }
}
