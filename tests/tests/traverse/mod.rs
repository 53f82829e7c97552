//! Rays through grids.

use gridwalk::{BuildOptions, Overlap, Ray};
use gridwalk_tests::gpu::{Gpu, Mesh};
use gridwalk_tests::random::Random;

fn soup(count: usize, size: f32, seed: u64) -> Mesh {
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

fn random_rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    (0..count).map(|_| Ray { origin: random.point(-2.0, 2.0), t_min: 0.0, direction: random.direction(), t_max: f32::INFINITY }).collect()
}

#[test]
fn the_walk_agrees_with_brute_force() {
    let gpu = Gpu::shared();
    let mesh = soup(5_000, 0.1, 1);
    let rays = random_rays(20_000, 2);
    for overlap in [Overlap::Box, Overlap::Exact] {
        for density in [0.1, 1.0, 8.0] {
            let built = gpu.build(&mesh, mesh.capacity(), BuildOptions { density, overlap, ..BuildOptions::default() });
            eprintln!("{:?}", built.report);
            assert_eq!(built.report.overflow, 0, "{:?}", built.report);
            let expected = gpu.brute_force(&built, &rays);
            let found = gpu.closest(&built, &rays);
            let different = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
            assert_eq!(different, 0, "{overlap:?} {density}: of {} rays", rays.len());
            assert!(expected.iter().filter(|hit| hit.is_hit()).count() > 1_000);
            assert_eq!(gpu.closest_by_include(&built, &rays), found);
            let any = gpu.any(&built, &rays);
            assert!(any.iter().zip(&found).all(|(any, hit)| (*any == 1) == hit.is_hit()));
        }
    }
}
