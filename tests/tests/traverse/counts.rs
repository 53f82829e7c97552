//! How many rays: given, in memory, more than a row of workgroups holds; several grids in turn.

use bytemuck::Zeroable;
use gridwalk::{BuildOptions, Hit, Ray, Shape, UNFINISHED};
use gridwalk_tests::gpu::{CANARY, Gpu, TraceOptions};

use super::compare::differences;
use super::{build, meshes, rays};

fn canary() -> Hit {
    let word = f32::from_bits(CANARY);
    Hit { t: word, u: word, v: word, triangle: CANARY }
}

#[test]
fn the_number_of_rays_may_lie_in_memory() {
    let gpu = Gpu::shared();
    let mesh = meshes::soup(300, 0.2, 91);
    let built = build(gpu, &mesh, BuildOptions::default());
    let rays = rays::random_rays(&mesh, 1_000, 92);
    let all = gpu.closest(&built, &rays);
    let any = gpu.any(&built, &rays);
    for number in [0, 1, 63, 64, 65, 999, 1_000, 1_001, u32::MAX] {
        let (found, counters) =
            gpu.closest_with(&built, &rays, &TraceOptions { indirect: Some(number), count: true, ..TraceOptions::default() });
        let traced = rays.len().min(number as usize);
        assert_eq!(differences(&found[..traced], &all[..traced]), [0; 0], "{number} rays");
        assert!(found[traced..].iter().all(|hit| hit.triangle == canary().triangle && hit.t.to_bits() == CANARY), "{number} rays");
        assert!(counters[traced..].iter().all(|counted| *counted == [CANARY; 4]), "{number} rays");
        let found = gpu.any_indirect(&built, &rays, number);
        assert_eq!(found[..traced], any[..traced], "{number} rays");
        assert!(found[traced..].iter().all(|word| *word == CANARY), "{number} rays");
    }
    assert!(gpu.closest(&built, &[]).is_empty() && gpu.any(&built, &[]).is_empty());
    for number in [1, 63, 64, 65] {
        assert_eq!(differences(&gpu.closest(&built, &rays[..number]), &all[..number]), [0; 0], "{number} rays");
    }
}

#[test]
fn more_rays_than_a_row_of_workgroups_holds() {
    let shape = Gpu::shared().tracer.shape();
    let gpu = Gpu::with_shape(Shape { map_size: 8, ..shape });
    let mesh = meshes::soup(200, 0.2, 93);
    let built = build(gpu, &mesh, BuildOptions::default());
    let pattern = rays::random_rays(&mesh, 1_000, 94);
    let expected = gpu.closest(&built, &pattern);
    let row = 65_535 * 8;
    for count in [row, row + 1, 2 * row + 3] {
        let rays: Vec<Ray> = pattern.iter().cycle().take(count).copied().collect();
        let hits: Vec<Hit> = expected.iter().cycle().take(count).copied().collect();
        assert_eq!(differences(&gpu.closest(&built, &rays), &hits), [0; 0], "{count} rays");
        let (found, _) = gpu.closest_with(&built, &rays, &TraceOptions { indirect: Some(count as u32 - 2), ..TraceOptions::default() });
        assert_eq!(differences(&found[..count - 2], &hits[..count - 2]), [0; 0], "{count} rays, 2 fewer in memory");
        assert_eq!(found[count - 1].triangle, CANARY);
    }
    let rays: Vec<Ray> = pattern.iter().cycle().take(row + 9).copied().collect();
    let any = gpu.any(&built, &rays);
    assert!(any.iter().zip(expected.iter().cycle()).all(|(any, hit)| *any == u32::from(hit.is_hit())));
}

#[test]
fn grids_are_traced_one_after_another() {
    let gpu = Gpu::shared();
    let first = meshes::soup(300, 0.2, 95);
    let second = meshes::sphere([0.4, 0.1, -0.2], 0.7, 24);
    let rays = rays::random_rays(&first, 20_000, 96);
    let grids = [&first, &second].map(|mesh| build(gpu, mesh, BuildOptions::default()));
    let alone = [&grids[0], &grids[1]].map(|grid| gpu.closest(grid, &rays));
    for (a, b) in [(0, 1), (1, 0)] {
        let (both, _) = gpu.closest_with(&grids[b], &rays, &TraceOptions { resume: Some(&alone[a]), ..TraceOptions::default() });
        let mut from_second = 0;
        for (index, hit) in both.iter().enumerate() {
            let (before, other) = (alone[a][index], alone[b][index]);
            // A hit that stays is the same to the bit.
            assert!(*hit == before || *hit == other, "{:?}: {before:?} and {other:?} become {hit:?}", rays[index]);
            let nearest = before.t.min(other.t);
            assert!(hit.t <= nearest * (1.0 + 1e-6) + 1e-6, "{:?}: {before:?} and {other:?} become {hit:?}", rays[index]);
            from_second += usize::from(*hit != before);
        }
        assert!(from_second > 500);
    }
    // From nothing it is a trace like any other, and nothing is closer than what was found in the same grid.
    let nothing = vec![Hit::MISS; rays.len()];
    let (found, _) = gpu.closest_with(&grids[0], &rays, &TraceOptions { resume: Some(&nothing), ..TraceOptions::default() });
    assert_eq!(differences(&found, &alone[0]), [0; 0]);
    // Nobody knows what is the closest hit of a ray that was given up in an earlier grid.
    let given_up = vec![Hit { triangle: UNFINISHED, ..Hit::MISS }; rays.len()];
    let (found, _) = gpu.closest_with(&grids[0], &rays, &TraceOptions { resume: Some(&given_up), ..TraceOptions::default() });
    assert_eq!(found, given_up);
}

#[test]
fn counters_count() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.0; 3], 1.0, 48);
    let rays = rays::camera_rays(&mesh, 100, 80);
    let mut tests = Vec::new();
    for density in [0.5, 16.0] {
        let built = build(gpu, &mesh, BuildOptions { density, ..BuildOptions::default() });
        let (hits, counters) = gpu.closest_with(&built, &rays, &TraceOptions { count: true, ..TraceOptions::default() });
        assert_eq!(differences(&hits, &gpu.closest(&built, &rays)), [0; 0]);
        let most: u32 = built.header().resolution.iter().sum::<u32>() + 3;
        for (hit, [steps, tested, cells, zero]) in hits.iter().zip(&counters) {
            assert!(*steps <= most && cells <= steps && *zero == 0);
            assert!(!hit.is_hit() || *tested >= 1 && *cells >= 1);
        }
        tests.push(counters.iter().map(|counted| u64::from(counted[1])).sum::<u64>());
    }
    assert!(tests[1] < tests[0], "a finer grid tests fewer triangles: {tests:?}");
    assert_eq!(Hit::zeroed().triangle, 0);
}
