//! No ray escapes from a closed body: the scenes of Embree's `verify`, at its offset.

use gridwalk::{BuildOptions, Overlap, Ray};
use gridwalk_tests::gpu::{Built, Gpu, Mesh};
use gridwalk_tests::random::Random;

use super::rays::{add, ray, scaled, sub};
use super::{build, meshes};

const FAR: [f32; 3] = [148_376.0, 1_234.0, -223_423.0];
const RADIUS: f32 = 2.0;
const RAYS: usize = 1_000_000;

/// Rays that hit nothing, of so many.
fn escaping(gpu: &Gpu, built: &Built, count: usize, seed: u64, make: impl Fn(&mut Random) -> Ray) -> Vec<Ray> {
    // Short of the time limit of a submission.
    const BATCH: usize = 50_000;
    let mut random = Random::new(seed);
    let mut escaped = Vec::new();
    let rays: Vec<_> = (0..count).map(|_| make(&mut random)).collect();
    for rays in rays.chunks(BATCH) {
        let hits = gpu.closest(built, rays);
        escaped.extend(rays.iter().zip(&hits).filter(|(_, hit)| !hit.is_hit()).map(|(ray, _)| *ray));
    }
    escaped
}

fn from_inside(random: &mut Random) -> Ray {
    let offset = scaled(random.direction(), 0.9 * RADIUS * random.unit());
    ray(add(FAR, offset), random.direction())
}

#[test]
fn no_ray_escapes_from_a_sphere_far_from_the_origin() {
    let gpu = Gpu::shared();
    for segments in [50, 200] {
        // Embree's sphere of n subdivisions has 2n meridians.
        let mesh = meshes::sphere(FAR, RADIUS, 2 * segments);
        for overlap in [Overlap::Box, Overlap::Exact] {
            let built = build(gpu, &mesh, BuildOptions { overlap, ..BuildOptions::default() });
            let escaped = escaping(gpu, &built, RAYS, 61, from_inside);
            assert!(escaped.is_empty(), "{segments} subdivisions, {overlap:?}: {} rays, first {:?}", escaped.len(), escaped[0]);
            // At vertices and edges, where cracks would be.
            let mut random = Random::new(62);
            let aimed: Vec<_> = (0..RAYS / 10)
                .map(|i| {
                    let triangle = mesh.triangle(random.below(mesh.indices.len() as u32) as usize);
                    let weight = if i & 1 == 0 { 0.0 } else { random.unit() };
                    let target = add(scaled(triangle[0], 1.0 - weight), scaled(triangle[1], weight));
                    let origin = from_inside(&mut random).origin;
                    ray(origin, sub(target, origin))
                })
                .collect();
            let missed = gpu.closest(&built, &aimed).iter().filter(|hit| !hit.is_hit()).count();
            assert_eq!(missed, 0, "{segments} subdivisions, {overlap:?}: rays at vertices and edges");
        }
    }
}

#[test]
fn no_ray_escapes_through_a_plane_far_from_the_origin() {
    let gpu = Gpu::shared();
    let (size, segments) = (4.0_f32, 50);
    let mut mesh = meshes::terrain(segments);
    for position in &mut mesh.positions {
        let [x, _, z] = *position;
        *position = add(FAR, [x * 0.5 * size, 0.0, z * 0.5 * size]);
    }
    for overlap in [Overlap::Box, Overlap::Exact] {
        let built = build(gpu, &mesh, BuildOptions { overlap, ..BuildOptions::default() });
        let escaped = escaping(gpu, &built, RAYS, 63, |random| {
            let origin = add(FAR, [random.range(-1.0, 1.0), random.range(0.2, 1.0), random.range(-1.0, 1.0)]);
            let target = add(FAR, [random.range(-1.9, 1.9), 0.0, random.range(-1.9, 1.9)]);
            ray(origin, sub(target, origin))
        });
        assert!(escaped.is_empty(), "{overlap:?}: {} rays, first {:?}", escaped.len(), escaped[0]);
    }
}

#[test]
fn no_ray_escapes_from_a_sphere_around_the_origin() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.0; 3], RADIUS, 100);
    for density in [1.0, 32.0] {
        let built = build(gpu, &mesh, BuildOptions { density, ..BuildOptions::default() });
        let escaped = escaping(gpu, &built, RAYS, 64, |random| {
            let inside = from_inside(random);
            Ray { origin: sub(inside.origin, FAR), ..inside }
        });
        assert!(escaped.is_empty(), "density {density}: {} rays, first {:?}", escaped.len(), escaped[0]);
    }
}

#[test]
fn a_sphere_with_a_hole_lets_rays_escape() {
    let gpu = Gpu::shared();
    let mut mesh: Mesh = meshes::sphere(FAR, RADIUS, 50);
    let middle = mesh.indices.len() / 2;
    mesh.indices.remove(middle);
    let built = build(gpu, &mesh, BuildOptions::default());
    assert!(!escaping(gpu, &built, 20_000, 65, from_inside).is_empty());
}
