//! The walk against the device's own brute force: the same test, the same moved origin, every triangle.

use gridwalk::{BuildOptions, Overlap};
use gridwalk_tests::gpu::Gpu;

use super::compare::{differences, explain_by_edge_on, occlusion_differences};
use super::{build, long, meshes, rays};

const RAYS: usize = 100_000;

#[test]
fn the_walk_agrees_with_brute_force_at_every_density() {
    let gpu = Gpu::shared();
    for model in meshes::small() {
        let mut rays = rays::random_rays(&model.mesh, RAYS - 20_000, 51);
        rays.extend(rays::diffuse_rays(&model.mesh, 20_000, 52));
        // The box, and with it the frame and every moved ray, is the same at every density. Each grid gets its share of the rays, unless
        // the test may take long.
        let mut expected = None;
        let mut edge_on = 0;
        let grids: Vec<_> = [0.1, 1.0, 8.0, 64.0].into_iter().flat_map(|k| [(k, Overlap::Box), (k, Overlap::Exact)]).collect();
        for (at, &(density, overlap)) in grids.iter().enumerate() {
            let label = format!("{} at density {density}, {overlap:?}", model.name);
            let built = build(gpu, &model.mesh, BuildOptions { density, overlap, ..BuildOptions::default() });
            let expected = expected.get_or_insert_with(|| gpu.brute_force(&built, &rays));
            let (first, step) = if long() { (0, 1) } else { (at, grids.len()) };
            let rays: Vec<_> = rays.iter().skip(first).step_by(step).copied().collect();
            let expected: Vec<_> = expected.iter().skip(first).step_by(step).copied().collect();
            let found = gpu.closest(&built, &rays);
            let copy = built.copy();
            edge_on += explain_by_edge_on(&label, &copy.view(), &rays, &found, &expected);
            assert_eq!(occlusion_differences(&gpu.any(&built, &rays), &found), [0; 0], "{label}: any hit");
        }
        let hits = expected.unwrap().iter().filter(|hit| hit.is_hit()).count();
        eprintln!("{}: {} rays, {hits} hits, 8 grids: {edge_on} differ, all on triangles seen edge-on", model.name, rays.len());
    }
}

#[test]
fn a_triangle_that_no_cell_lists_is_missed_by_the_walk_alone() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.0; 3], 1.0, 24);
    let built = build(gpu, &mesh, BuildOptions::default());
    let rays = rays::random_rays(&mesh, 10_000, 53);
    let expected = gpu.brute_force(&built, &rays);
    assert_eq!(differences(&gpu.closest(&built, &rays), &expected), [0; 0]);
    let victim = expected.iter().find(|hit| hit.is_hit()).unwrap().triangle;
    built.forget_triangle(victim, (victim + 1) % mesh.indices.len() as u32);
    let found = gpu.closest(&built, &rays);
    let different = differences(&found, &expected);
    assert!(!different.is_empty());
    assert!(different.iter().all(|ray| expected[*ray].triangle == victim), "only rays on triangle {victim} change");
    // A flag that is turned around.
    let mut any = gpu.any(&built, &rays);
    assert_eq!(occlusion_differences(&any, &found), [0; 0]);
    any[17] ^= 1;
    assert_eq!(occlusion_differences(&any, &found), [17]);
}
