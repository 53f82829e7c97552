//! Triangles to build grids over.

use crate::gpu::Mesh;
use crate::random::Random;

/// Triangles of about `size` around random points of [-1, 1)^3.
pub fn soup(count: usize, size: f32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let triangles: Vec<_> = (0..count)
        .map(|_| {
            let centre = random.point(-1.0, 1.0);
            std::array::from_fn(|_| {
                let offset = random.point(-size, size);
                std::array::from_fn(|axis| centre[axis] + offset[axis])
            })
        })
        .collect();
    Mesh::from_triangles(&triangles)
}

/// Spoils about one triangle of `every`: a vertex that is not finite, or an index out of range.
pub fn spoil(mesh: &mut Mesh, every: u32, seed: u64) {
    let mut random = Random::new(seed);
    let vertices = mesh.positions.len() as u32;
    for triangle in 0..mesh.indices.len() {
        if random.below(every) != 0 {
            continue;
        }
        let corner = random.below(3) as usize;
        let vertex = mesh.indices[triangle][corner] as usize;
        let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        match random.below(4) {
            3 => mesh.indices[triangle][corner] = if random.below(2) == 0 { vertices } else { u32::MAX },
            which => mesh.positions[vertex][random.below(3) as usize] = bad[which as usize],
        }
    }
}
