//! What the documentation promises of rays and hits.

use gridwalk::{BuildOptions, Hit, Ray};
use gridwalk_tests::gpu::{Built, Gpu, Mesh};
use gridwalk_tests::random::Random;

use super::rays::ray;
use super::{build, meshes};

/// Three squares across the z axis at 1, 2 and 3, two triangles each, wound alternately.
fn squares() -> Mesh {
    let mut triangles = Vec::new();
    for z in [1.0, 2.0, 3.0] {
        let corner = |x: f32, y: f32| [x, y, z];
        triangles.push([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
        triangles.push([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)]);
    }
    Mesh::from_triangles(&triangles)
}

fn one(gpu: &Gpu, built: &Built, ray: Ray) -> Hit {
    let hit = gpu.closest(built, &[ray])[0];
    assert_eq!(gpu.any(built, &[ray])[0], u32::from(hit.is_hit()), "{ray:?}");
    assert_eq!(gpu.closest_by_include(built, &[ray])[0], hit, "{ray:?}");
    assert_eq!(gpu.brute_force(built, &[ray])[0], hit, "{ray:?}");
    hit
}

const ORIGIN: [f32; 3] = [0.25, -0.5, 0.0];
const Z: [f32; 3] = [0.0, 0.0, 1.0];

#[test]
fn the_interval_is_closed_and_counts_in_the_direction() {
    let gpu = Gpu::shared();
    let built = build(gpu, &squares(), BuildOptions::default());
    let above = |x: f32| f32::from_bits(x.to_bits() + 1);
    let below = |x: f32| f32::from_bits(x.to_bits() - 1);
    let infinity = f32::INFINITY;
    let cases = [
        (0.0, infinity, Some(1.0)),
        (1.0, infinity, Some(1.0)),
        (above(1.0), infinity, Some(2.0)),
        (1.5, infinity, Some(2.0)),
        (2.0, 2.0, Some(2.0)),
        (1.0, 1.0, Some(1.0)),
        (0.0, 1.0, Some(1.0)),
        (0.0, below(1.0), None),
        (1.25, 1.75, None),
        (3.0, infinity, Some(3.0)),
        (above(3.0), infinity, None),
        (4.0, infinity, None),
        (-5.0, infinity, Some(1.0)),
        (-infinity, infinity, Some(1.0)),
        (-5.0, -1.0, None),
        (2.0, 1.0, None),
        (infinity, infinity, None),
        (-infinity, -infinity, None),
    ];
    for (t_min, t_max, expected) in cases {
        for stretch in [1.0, 4.0, 0.125] {
            let stretched = Ray { origin: ORIGIN, t_min: t_min / stretch, direction: [0.0, 0.0, stretch], t_max: t_max / stretch };
            let hit = one(gpu, &built, stretched);
            let t = expected.map_or(infinity, |t| t / stretch);
            assert_eq!((hit.is_hit(), hit.t), (expected.is_some(), t), "{stretched:?}: {hit:?}");
        }
    }
    // Behind the origin.
    let back = Ray { origin: [0.25, -0.5, 2.5], t_min: -1.0, direction: Z, t_max: 0.0 };
    assert_eq!(one(gpu, &built, back).t, -0.5);
    // On a surface.
    assert_eq!(one(gpu, &built, ray([0.25, -0.5, 2.0], Z)).t, 0.0);
}

#[test]
fn a_miss_is_all_of_hit_miss() {
    let gpu = Gpu::shared();
    let built = build(gpu, &squares(), BuildOptions::default());
    for direction in [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [5.0, 0.0, 1.0]] {
        let hit = one(gpu, &built, ray(ORIGIN, direction));
        assert_eq!((hit.t, hit.u.to_bits(), hit.v.to_bits(), hit.triangle), (f32::INFINITY, 0, 0, gridwalk_core::MISS));
    }
}

#[test]
fn both_windings_are_hit_from_both_sides() {
    let gpu = Gpu::shared();
    let built = build(gpu, &squares(), BuildOptions::default());
    for (x, y, triangle) in [(0.5, -0.5, 0), (-0.5, 0.5, 1)] {
        let hit = one(gpu, &built, ray([x, y, 0.0], Z));
        assert_eq!(hit.triangle, triangle);
        let hit = one(gpu, &built, ray([x, y, 4.0], [0.0, 0.0, -1.0]));
        assert_eq!((hit.triangle, hit.t), (4 + triangle, 1.0));
    }
}

#[test]
fn of_equal_hits_the_lower_index_wins() {
    let gpu = Gpu::shared();
    let single = [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]];
    // The first of each group of equal triangles, among others behind.
    let behind = single.map(|[x, y, _]| [x, y, 2.0]);
    for first in [0, 1, 5, 11] {
        let triangles: Vec<_> = (0..12).map(|i| if i >= first { single } else { behind }).collect();
        let built = build(gpu, &Mesh::from_triangles(&triangles), BuildOptions::default());
        assert_eq!(one(gpu, &built, ray([0.0, 0.0, 0.0], Z)).triangle, first);
    }
    // A shared edge and a shared vertex: met exactly, in any order of the two.
    let built = build(gpu, &squares(), BuildOptions::default());
    for point in [0.0, 0.5, -0.25, -1.0, 1.0] {
        assert_eq!(one(gpu, &built, ray([point, point, 0.0], Z)).triangle, 0);
    }
}

#[test]
fn barycentrics_give_the_point() {
    let gpu = Gpu::shared();
    let mesh = meshes::soup(500, 0.3, 81);
    let built = build(gpu, &mesh, BuildOptions::default());
    let mut random = Random::new(82);
    let rays: Vec<_> = (0..20_000).map(|_| ray(random.point(-1.5, 1.5), random.direction())).collect();
    let mut checked = 0;
    for (ray, hit) in rays.iter().zip(gpu.closest(&built, &rays)).filter(|(_, hit)| hit.is_hit()) {
        let [a, b, c] = mesh.triangle(hit.triangle as usize);
        assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0 + 1e-6, "{hit:?}");
        for axis in 0..3 {
            let on_triangle = (1.0 - hit.u - hit.v) * a[axis] + hit.u * b[axis] + hit.v * c[axis];
            let on_ray = ray.origin[axis] + hit.t * ray.direction[axis];
            assert!((on_triangle - on_ray).abs() < 2e-4, "{ray:?} {hit:?}: {on_triangle} and {on_ray}");
        }
        checked += 1;
    }
    assert!(checked > 5_000);
    // Exact at the vertices of a simple one.
    let corner = Mesh::from_triangles(&[[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]]);
    let built = build(gpu, &corner, BuildOptions::default());
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.25, 0.5)] {
        let hit = one(gpu, &built, ray([x, y, 0.0], Z));
        assert_eq!((hit.u, hit.v, hit.t), (x, y, 1.0));
    }
}

#[test]
fn nothing_is_hit_where_there_is_nothing() {
    let gpu = Gpu::shared();
    let rays = [ray(ORIGIN, Z), ray([0.0; 3], [1.0, 1.0, 1.0]), ray([0.0, 0.0, -1e30], Z)];
    let nan = Mesh::from_triangles(&[[[f32::NAN; 3]; 3]; 5]);
    let point = Mesh::from_triangles(&[[[0.0; 3]; 3]; 5]);
    for mesh in [Mesh { positions: vec![[0.0; 3]], indices: Vec::new() }, nan, point] {
        let built = build(gpu, &mesh, BuildOptions::default());
        assert_eq!(gpu.closest(&built, &rays), vec![Hit::MISS; rays.len()]);
        assert_eq!(gpu.any(&built, &rays), [0; 3]);
    }
}
