//! Rays that go wrong elsewhere: along axes, on the boundaries of cells, from far outside, of odd lengths, reversed.

use gridwalk::{BuildOptions, Hit, Overlap, Ray};
use gridwalk_tests::gpu::{Gpu, Mesh};
use gridwalk_tests::random::Random;

use super::compare::{differences, explain_by_edge_on, occlusion_differences};
use super::rays::{add, ray, scaled, sub};
use super::{build, meshes, rays, twins};

#[test]
fn rays_on_boundaries_and_along_axes_agree_with_brute_force() {
    let gpu = Gpu::shared();
    for model in meshes::small() {
        for (density, overlap) in [(1.0, Overlap::Exact), (16.0, Overlap::Box)] {
            let label = format!("{} at density {density}, {overlap:?}", model.name);
            let built = build(gpu, &model.mesh, BuildOptions { density, overlap, ..BuildOptions::default() });
            let copy = built.copy();
            let grid = copy.view();
            let rays: Vec<_> = rays::hard_rays(&model.mesh, grid.header, 71).into_iter().skip(density as usize).step_by(3).collect();
            let found = gpu.closest(&built, &rays);
            let expected = twins::brute_force(&grid, &rays);
            explain_by_edge_on(&label, &grid, &rays, &found, &expected);
            assert_eq!(occlusion_differences(&gpu.any(&built, &rays), &found), [0; 0], "{label}: any hit");
        }
    }
}

#[test]
fn invalid_rays_miss() {
    let gpu = Gpu::shared();
    for mesh in [meshes::sphere([0.0; 3], 1.0, 24), meshes::soup(300, 0.3, 72)] {
        let built = build(gpu, &mesh, BuildOptions::default());
        let rays = rays::invalid_rays();
        assert_eq!(gpu.closest(&built, &rays), vec![Hit::MISS; rays.len()]);
        assert_eq!(gpu.any(&built, &rays), vec![0; rays.len()]);
        assert_eq!(gpu.brute_force(&built, &rays), vec![Hit::MISS; rays.len()]);
        let (_, counters) = gpu.closest_with(&built, &rays, &gridwalk_tests::gpu::TraceOptions { count: true, ..Default::default() });
        assert!(counters.iter().all(|counted| *counted == [0; 4]), "a ray that is not valid costs nothing: {counters:?}");
    }
}

/// Directions times a power of two: the same hits, at distances divided by it, bit for bit. Times any other number: but for rounding.
#[test]
fn the_length_of_a_direction_is_the_unit_of_t() {
    let gpu = Gpu::shared();
    let mesh = meshes::soup(500, 0.2, 73);
    let built = build(gpu, &mesh, BuildOptions::default());
    let rays: Vec<_> = rays::random_rays(&mesh, 5_000, 74).iter().map(|r| Ray { t_min: 0.25, t_max: 4.0, ..*r }).collect();
    let base = gpu.closest(&built, &rays);
    assert!(base.iter().filter(|hit| hit.is_hit()).count() > 500);
    let stretched = |factor: f32| -> Vec<Ray> {
        let stretch = |r: &Ray| Ray { direction: scaled(r.direction, factor), t_min: r.t_min / factor, t_max: r.t_max / factor, ..*r };
        rays.iter().map(stretch).collect()
    };
    for exponent in [-90, -10, 1, 20, 100] {
        let factor = 2.0_f32.powi(exponent);
        let expected: Vec<_> = base.iter().map(|hit| Hit { t: hit.t / factor, ..*hit }).collect();
        let found = gpu.closest(&built, &stretched(factor));
        assert_eq!(differences(&found, &expected), [0; 0], "directions times 2^{exponent}");
    }
    for factor in [1e-30_f32, 0.3, 7.0, 1e30] {
        let found = gpu.closest(&built, &stretched(factor));
        let different = |i: &usize| {
            let (a, b) = (&found[*i], &base[*i]);
            a.triangle != b.triangle || a.is_hit() && (f64::from(a.t) * f64::from(factor) - f64::from(b.t)).abs() > 1e-5 * f64::from(b.t)
        };
        let different: Vec<_> = (0..rays.len()).filter(different).collect();
        // An interval's end or an edge may round either way.
        assert!(different.len() <= 2, "directions times {factor}: {} of {} rays", different.len(), rays.len());
    }
    // Denormal directions: what is left of their digits decides, and they hit what the twin hits; but a device may take them for zero.
    let copy = built.copy();
    let denormal: Vec<_> =
        rays.iter().map(|r| Ray { t_min: 0.0, t_max: f32::INFINITY, direction: scaled(r.direction, 1e-41), ..*r }).collect();
    if gpu.context.is_cpu() {
        let found = gpu.closest(&built, &denormal);
        let flushed = found.iter().all(|hit| !hit.is_hit());
        assert!(flushed || differences(&found, &twins::closest_hits(&copy.view(), &denormal)).is_empty());
    }
}

#[test]
fn rays_from_far_outside_hit() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.0; 3], 1.0, 48);
    let built = build(gpu, &mesh, BuildOptions::default());
    let mut random = Random::new(75);
    for far in [10.0, 1e3, 1e6_f32] {
        let rays: Vec<_> = (0..5_000)
            .map(|_| {
                let direction = random.direction();
                // Straight at the middle: at a million radii the origin is rounded by a thirtieth of one.
                ray(scaled(direction, -far), direction)
            })
            .collect();
        for (ray, hit) in rays.iter().zip(gpu.closest(&built, &rays)) {
            assert!(hit.is_hit(), "{ray:?}");
            assert!((hit.t - (far - 1.0)).abs() < 0.02 + far * 1e-6, "{ray:?} hits at {}", hit.t);
        }
    }
    for far in [1e3, 1e6, 1e9_f32] {
        for direction in rays::axis_directions().into_iter().filter(|d| d.iter().filter(|x| **x != 0.0).count() == 1) {
            let hit = gpu.closest(&built, &[ray(scaled(direction, -far), direction)])[0];
            assert!(hit.is_hit() && (hit.t - far).abs() <= 1.0 + far * 1e-6, "{far} along {direction:?}: {hit:?}");
        }
    }
}

#[test]
fn a_ray_and_its_reverse_agree() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.1, 0.2, 0.3], 1.0, 48);
    let built = build(gpu, &mesh, BuildOptions::default());
    let mut random = Random::new(76);
    let pairs: Vec<_> = (0..20_000)
        .map(|_| {
            let centre = [0.1, 0.2, 0.3];
            let inside = add(centre, scaled(random.direction(), 0.9 * random.unit()));
            let outside = add(centre, scaled(random.direction(), 1.1 + 5.0 * random.unit()));
            (inside, outside)
        })
        .collect();
    let between = |a, b| Ray { origin: a, t_min: 0.0, direction: sub(b, a), t_max: 1.0 };
    // The body is convex: exactly one crossing.
    let there = gpu.closest(&built, &pairs.iter().map(|(a, b)| between(*a, *b)).collect::<Vec<_>>());
    let back = gpu.closest(&built, &pairs.iter().map(|(a, b)| between(*b, *a)).collect::<Vec<_>>());
    let mut neighbours = 0;
    for (pair, (a, b)) in pairs.iter().zip(there.iter().zip(&back)) {
        assert!(a.is_hit() && b.is_hit(), "{pair:?}: {a:?} there, {b:?} back");
        assert!((a.t + b.t - 1.0).abs() < 1e-5, "{pair:?}: {a:?} there, {b:?} back");
        neighbours += usize::from(a.triangle != b.triangle);
    }
    assert!(neighbours <= 5, "{neighbours} of {} pairs hit different triangles, as only rays on an edge may", pairs.len());
}

/// Boxes whose faces lie in one plane with each other and on boundaries of cells.
#[test]
fn rays_between_the_boxes_of_a_lattice_miss() {
    let gpu = Gpu::shared();
    let mesh = meshes::lattice(3);
    for resolution in [[1, 1, 1], [5, 5, 5], [10, 10, 10], [64, 3, 1]] {
        let built = gpu.build(&mesh, super::roomy(&mesh), BuildOptions { resolution: Some(resolution), ..BuildOptions::default() });
        assert_eq!(built.report.overflow, 0);
        for axis in 0..3 {
            for (offset, expected) in
                [(0.0, true), (0.49, true), (0.499_999, true), (0.51, false), (1.0, false), (1.49, false), (1.51, true)]
            {
                for sign in [1.0, -1.0] {
                    for zero in [0.0, -0.0] {
                        let mut origin = [offset; 3];
                        origin[axis] = -10.0 * sign;
                        if sign < 0.0 {
                            origin[axis] = 20.0;
                        }
                        let mut direction = [zero; 3];
                        direction[axis] = sign;
                        let hit = gpu.closest(&built, &[ray(origin, direction)])[0];
                        assert_eq!(hit.is_hit(), expected, "{resolution:?}: from {origin:?} along {direction:?}: {hit:?}");
                    }
                }
            }
        }
    }
}

/// Starts of rays that overran the end of the grid or stood still in other walks: see platform notes in the design.
#[test]
fn coordinates_of_any_size_give_the_same_hits() {
    let gpu = Gpu::shared();
    let mesh = meshes::soup(400, 0.2, 77);
    let rays = rays::random_rays(&mesh, 5_000, 78);
    let base = gpu.closest(&build(gpu, &mesh, BuildOptions::default()), &rays);
    let scaled_by = |factor: f32| {
        let mesh = Mesh { positions: mesh.positions.iter().map(|p| scaled(*p, factor)).collect(), indices: mesh.indices.clone() };
        let rays: Vec<_> =
            rays.iter().map(|r| Ray { origin: scaled(r.origin, factor), direction: scaled(r.direction, factor), ..*r }).collect();
        let built = build(gpu, &mesh, BuildOptions::default());
        (gpu.closest(&built, &rays), gpu.brute_force(&built, &rays))
    };
    // Powers of two change nothing at all: the grid lies in a frame of its own.
    for exponent in [-100, -20, 30, 100] {
        let (found, by_force) = scaled_by(2.0_f32.powi(exponent));
        assert_eq!(differences(&found, &base), [0; 0], "coordinates times 2^{exponent}");
        assert_eq!(differences(&found, &by_force), [0; 0], "coordinates times 2^{exponent}");
    }
    for factor in [1e-30_f32, 1e-6, 3e5, 1e18, 1e30] {
        let (found, by_force) = scaled_by(factor);
        assert_eq!(differences(&found, &by_force), [0; 0], "coordinates times {factor}");
        let different =
            |i: &usize| found[*i].triangle != base[*i].triangle || found[*i].is_hit() && (found[*i].t / base[*i].t - 1.0).abs() > 1e-4;
        let different = (0..rays.len()).filter(different).count();
        assert!(different <= 2, "coordinates times {factor}: {different} of {} rays", rays.len());
    }
}
