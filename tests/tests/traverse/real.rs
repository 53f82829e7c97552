//! Real scenes against two oracles that share nothing with the grid: all triangles in double precision, and the tree of crate `obvhs`.

use std::time::Duration;

use glam::{Vec3A, vec3a};
use gridwalk::{BuildOptions, Hit, Overlap, Ray};
use gridwalk_tests::gpu::{Gpu, Mesh};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::ray::RayHit;
use rayon::prelude::*;

use super::compare::{D, along, cross, dot, length, occlusion_differences, sub, to_segment};
use super::meshes::{self, Model};
use super::{build, long, rays};

/// A triangle in double precision, and the ball around it.
struct Triangle {
    vertices: [D; 3],
    centre: D,
    square_radius: f64,
}

impl Triangle {
    fn new(vertices: [[f32; 3]; 3]) -> Triangle {
        let vertices = vertices.map(|vertex| vertex.map(f64::from));
        let centre = std::array::from_fn(|axis| vertices.iter().map(|vertex| vertex[axis]).sum::<f64>() / 3.0);
        let radius = vertices.iter().map(|vertex| length(sub(*vertex, centre))).fold(0.0, f64::max);
        Triangle { vertices, centre, square_radius: radius * radius * (1.0 + 1e-9) }
    }

    /// t of the hit. The edge functions of neighbours differ in sign alone.
    fn hit(&self, origin: D, direction: D) -> Option<f64> {
        let to_centre = sub(self.centre, origin);
        let forward = dot(to_centre, direction);
        let square = dot(direction, direction);
        if (dot(to_centre, to_centre) - self.square_radius) * square > forward * forward * (1.0 + 1e-12) {
            return None;
        }
        let [a, b, c] = self.vertices.map(|vertex| sub(vertex, origin));
        let edges = [dot(direction, cross(c, b)), dot(direction, cross(a, c)), dot(direction, cross(b, a))];
        let sum: f64 = edges.iter().sum();
        if edges.iter().any(|e| *e < 0.0) && edges.iter().any(|e| *e > 0.0) || sum == 0.0 {
            return None;
        }
        let point: D = std::array::from_fn(|axis| (edges[0] * a[axis] + edges[1] * b[axis] + edges[2] * c[axis]) / sum);
        Some(dot(point, direction) / square)
    }
}

/// t and triangle of the closest hit.
type Found = Option<(f64, u32)>;

/// What single precision moves a vertex or a ray by, relative to the largest coordinate.
const ROUNDING: f64 = 1e-6;

struct Oracle {
    triangles: Vec<Triangle>,
    tree: Bvh2,
    scale: f64,
}

impl Oracle {
    fn new(mesh: &Mesh) -> Oracle {
        let triangles: Vec<_> = (0..mesh.indices.len()).map(|index| Triangle::new(mesh.triangle(index))).collect();
        let bounds = rays::bounds(mesh);
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0_f32, |largest, x| largest.max(x.abs()));
        // The tree's boxes are not padded, and its ray is single precision.
        let pad = Vec3A::splat(largest * 1e-6);
        let boxes: Vec<Aabb> = (0..mesh.indices.len())
            .map(|index| {
                let corners = mesh.triangle(index).map(|[x, y, z]| vec3a(x, y, z));
                let hull = Aabb::from_points(&corners);
                Aabb { min: hull.min - pad, max: hull.max + pad }
            })
            .collect();
        let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        Oracle { triangles, tree, scale: f64::from(largest) }
    }

    fn by_force(&self, ray: &Ray) -> Found {
        let (origin, direction) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
        let mut best = None;
        for (index, triangle) in self.triangles.iter().enumerate() {
            if let Some(t) = triangle.hit(origin, direction)
                && t >= f64::from(ray.t_min)
                && t <= f64::from(ray.t_max)
                && best.is_none_or(|(nearest, _)| t < nearest)
            {
                best = Some((t, index as u32));
            }
        }
        best
    }

    fn by_tree(&self, ray: &Ray) -> Found {
        let (origin, direction) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
        let [[x, y, z], [dx, dy, dz]] = [ray.origin, ray.direction];
        let tree_ray = obvhs::ray::Ray::new(vec3a(x, y, z), vec3a(dx, dy, dz), ray.t_min, ray.t_max);
        let mut best: Found = None;
        let tested = |_: &obvhs::ray::Ray, at: usize| {
            let index = self.tree.primitive_indices[at];
            match self.triangles[index as usize].hit(origin, direction) {
                Some(t) if t >= f64::from(ray.t_min) && t <= f64::from(ray.t_max) => {
                    if best.is_none_or(|(nearest, _)| t < nearest) {
                        best = Some((t, index));
                    }
                    t as f32
                }
                _ => f32::INFINITY,
            }
        };
        self.tree.ray_traverse(tree_ray, &mut RayHit::none(), tested);
        best
    }

    /// The sine of the angle between a ray and a triangle's plane, and a length per t along the triangle's normal.
    fn steepness(&self, ray: &Ray, triangle: u32) -> (f64, f64) {
        let [a, b, c] = self.triangles[triangle as usize].vertices;
        let (normal, direction) = (cross(sub(b, a), sub(c, a)), ray.direction.map(f64::from));
        let across = dot(normal, direction).abs() / length(normal);
        (across / length(direction), across)
    }

    /// Whether two hits are at the same place but for rounding, which moves vertices, and so planes, by a part of the scene's size.
    fn agree(&self, ray: &Ray, hit: &Hit, expected: &Found) -> bool {
        let Some((t, triangle)) = *expected else { return !hit.is_hit() };
        let apart = (f64::from(hit.t) - t).abs();
        hit.is_hit() && (apart <= 1e-4 * t.abs() || apart * self.steepness(ray, triangle).1 <= ROUNDING * self.scale)
    }

    /// Why two hits may differ: the one that is nearer passes an edge of its triangle, or is seen edge-on, or its plane passes an end of the
    /// interval.
    fn explained(&self, ray: &Ray, hit: &Hit, expected: &Found) -> bool {
        let (t, triangle) = match expected {
            Some((t, triangle)) if !hit.is_hit() || *t < f64::from(hit.t) => (*t, *triangle),
            _ => (f64::from(hit.t), hit.triangle),
        };
        let point = along(ray.origin.map(f64::from), ray.direction.map(f64::from), t);
        let [a, b, c] = self.triangles[triangle as usize].vertices;
        let to_edge = to_segment(point, a, b).min(to_segment(point, b, c)).min(to_segment(point, c, a));
        let (sine, across) = self.steepness(ray, triangle);
        let to_end = (t - f64::from(ray.t_min)).abs() * across;
        to_edge <= ROUNDING * self.scale || to_end <= ROUNDING * self.scale || sine < 1e-3 || sine.is_nan()
    }

    /// Rays whose hits do not agree, each demanded to be explained.
    fn mismatches(&self, label: &str, rays: &[Ray], found: &[Hit], expected: &[Found]) -> usize {
        let differ: Vec<_> = (0..rays.len()).filter(|i| !self.agree(&rays[*i], &found[*i], &expected[*i])).collect();
        let unexplained = differ.iter().filter(|i| !self.explained(&rays[**i], &found[**i], &expected[**i]));
        for &index in unexplained.clone().take(10) {
            eprintln!("{label}: ray {index} {:?}: {:?}, oracle {:?}", rays[index], found[index], expected[index]);
        }
        assert_eq!(unexplained.count(), 0, "{label}: of {} mismatches these are not at an edge", differ.len());
        differ.len()
    }
}

/// Rays in pieces that a slow device traces well within the time limit of a submission.
fn trace(gpu: &Gpu, built: &gridwalk_tests::gpu::Built, rays: &[Ray]) -> Vec<Hit> {
    rays.chunks(1 << 16).flat_map(|rays| gpu.closest(built, rays)).collect()
}

fn compare(model: &Model) {
    let gpu = Gpu::shared();
    let Model { name, mesh } = model;
    let oracle = Oracle::new(mesh);
    let built = build(gpu, mesh, BuildOptions { overlap: Overlap::Exact, ..BuildOptions::default() });
    eprintln!("{name}: {} triangles, {:?}", mesh.indices.len(), built.report.resolution);
    let (width, height) = (800, 625);
    for (kind, rays) in [("camera", rays::camera_rays(mesh, width, height)), ("diffuse", rays::diffuse_rays(mesh, width * height, 101))] {
        let found = trace(gpu, &built, &rays);
        let hits = found.iter().filter(|hit| hit.is_hit()).count();
        assert!(hits > rays.len() / 50, "{name}: {hits} {kind} rays hit");
        let occluded: Vec<u32> = rays.chunks(1 << 16).flat_map(|rays| gpu.any(&built, rays)).collect();
        assert_eq!(occlusion_differences(&occluded, &found), [0; 0], "{name}: {kind} rays");

        let expected: Vec<_> = rays.par_iter().map(|ray| oracle.by_tree(ray)).collect();
        let differ = oracle.mismatches(&format!("{name}, {kind}, obvhs"), &rays, &found, &expected);
        eprintln!("{name}: {kind}: {differ} of {} rays differ from obvhs, {hits} hit", rays.len());
        assert!(differ as f64 <= 3e-5 * rays.len() as f64, "{name}: {kind}: {differ} of {} rays", rays.len());

        // Spread over the picture; fewer where there are very many triangles.
        let count = if mesh.indices.len() > 300_000 && !long() { 1_000 } else { 5_000 };
        let step = rays.len() / count;
        let few: Vec<_> = rays.iter().skip(step / 2).step_by(step).copied().collect();
        let found: Vec<_> = found.iter().skip(step / 2).step_by(step).copied().collect();
        let expected: Vec<_> = few.par_iter().map(|ray| oracle.by_force(ray)).collect();
        let differ = oracle.mismatches(&format!("{name}, {kind}, brute force"), &few, &found, &expected);
        eprintln!("{name}: {kind}: {differ} of {} rays differ from brute force in double precision", few.len());
        assert_eq!(differ, 0, "{name}: {kind}: of {} rays", few.len());
    }
}

#[test]
fn the_teapot_agrees_with_both_oracles() {
    compare(&meshes::committed("teapot/teapot.obj"));
}

#[test]
fn a_bear_and_a_cake_agree_with_both_oracles() {
    compare(&meshes::committed("furniture/teddyBear/teddyBear.obj"));
    compare(&meshes::committed("furniture/cupcake/cupcake.obj"));
}

#[test]
fn furniture_agrees_with_both_oracles() {
    compare(&meshes::committed("furniture/plantie/plantie.obj"));
    if long() {
        compare(&meshes::committed("furniture/poolTable/poolTable.obj"));
    }
}

#[test]
fn fetched_scenes_agree_with_both_oracles() {
    for variable in ["GRIDWALK_BUNNY", "GRIDWALK_ELEPHANT", "GRIDWALK_SPONZA", "GRIDWALK_DRAGON"] {
        if let Some(model) = meshes::named_by(variable) {
            compare(&model);
        }
    }
}

#[test]
fn the_oracles_find_what_is_wrong() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.0; 3], 1.0, 24);
    let built = build(gpu, &mesh, BuildOptions::default());
    let rays = rays::camera_rays(&mesh, 100, 100);
    let found = gpu.closest(&built, &rays);
    let hits_of = |triangle: u32| found.iter().filter(|hit| hit.triangle == triangle).count();
    let victim = (0..mesh.indices.len() as u32).max_by_key(|triangle| hits_of(*triangle)).unwrap();
    let mut broken = mesh.clone();
    broken.indices[victim as usize] = [0; 3];
    let (whole, broken) = (Oracle::new(&mesh), Oracle::new(&broken));
    let differ = |oracle: &Oracle, by: fn(&Oracle, &Ray) -> Found| {
        let wrong = |(ray, hit): &(&Ray, &Hit)| !oracle.agree(ray, hit, &by(oracle, ray));
        let wrong: Vec<_> = rays.iter().zip(&found).filter(wrong).collect();
        (wrong.len(), wrong.iter().filter(|(ray, hit)| !whole.explained(ray, hit, &by(oracle, ray))).count())
    };
    assert_eq!([differ(&whole, Oracle::by_force), differ(&whole, Oracle::by_tree)], [(0, 0); 2]);
    for by in [Oracle::by_force, Oracle::by_tree] {
        let (wrong, unexplained) = differ(&broken, by);
        assert!(wrong > 0 && unexplained > 0, "{wrong} wrong, {unexplained} of them not at an edge");
    }
}
