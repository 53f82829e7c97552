//! Twin of kernel `place`.

use crate::dispatch::workgroups;

/// Puts a mesh's triangles among those of the scene. `surrounds` holds material and mesh of each triangle.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn place(
    map_size: u32,
    groups: [u32; 3],
    mesh_indices: &[[u32; 3]],
    mesh_materials: &[u32],
    indices: &mut [[u32; 3]],
    surrounds: &mut [[u32; 2]],
    triangle_count: u32,
    first_triangle: u32,
    first_vertex: u32,
    mesh: u32,
) {
    let invocations = workgroups(groups).flat_map(|group| group * map_size..(group + 1) * map_size);
    for triangle in invocations.filter(|triangle| *triangle < triangle_count) {
        let target = (first_triangle + triangle) as usize;
        indices[target] = mesh_indices[triangle as usize].map(|index| index.wrapping_add(first_vertex));
        surrounds[target] = [mesh_materials[triangle as usize], mesh];
    }
}
