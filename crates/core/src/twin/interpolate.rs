//! Twin of kernel `interpolate`.

use crate::dispatch::workgroups;
use crate::twin::motion::{between, renormalised};

/// The vertices of a key-frame as words.
#[derive(Clone, Copy, Debug)]
pub struct KeyVertices<'a> {
    /// Three a vertex.
    pub positions: &'a [u32],
    /// Three a vertex.
    pub normals: &'a [u32],
    /// Two a vertex.
    pub uvs: &'a [u32],
}

/// Vertices between two key-frames; at weight 0 the first's, bit for bit.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn interpolate(
    map_size: u32,
    groups: [u32; 3],
    first: KeyVertices<'_>,
    second: KeyVertices<'_>,
    positions: &mut [u32],
    normals: &mut [u32],
    uvs: &mut [u32],
    vertex_count: u32,
    weight: f32,
) {
    let invocations = workgroups(groups).flat_map(|group| group * map_size..(group + 1) * map_size);
    for vertex in invocations.filter(|vertex| *vertex < vertex_count) {
        let (threes, twos) = (3 * vertex as usize..3 * vertex as usize + 3, 2 * vertex as usize..2 * vertex as usize + 2);
        if weight == 0.0 {
            positions[threes.clone()].copy_from_slice(&first.positions[threes.clone()]);
            normals[threes.clone()].copy_from_slice(&first.normals[threes]);
            uvs[twos.clone()].copy_from_slice(&first.uvs[twos]);
            continue;
        }
        for i in threes.clone() {
            positions[i] = between(first.positions[i], second.positions[i], weight);
        }
        for i in twos {
            uvs[i] = between(first.uvs[i], second.uvs[i], weight);
        }
        let x = threes.start;
        let normal = |axis: usize| f32::from_bits(between(first.normals[x + axis], second.normals[x + axis], weight));
        let normal = renormalised(std::array::from_fn(normal));
        normals[threes].copy_from_slice(&normal.map(f32::to_bits));
    }
}
