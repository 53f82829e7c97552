//! Masks, culling and geometry ids, against a search through all triangles.

use gridwalk::{BuildOptions, Cull, GeometryRecord, Hit, MISS, Ray, Region, Shape, TraceInfo};
use gridwalk_core::geometry::{FLAG_FLIP_FACING, FLAG_TWO_SIDED};
use gridwalk_core::intersect::{Intersection, hit_distance, intersect_triangle, move_ray};
use gridwalk_core::twin::closest_candidate::{gridwalk_candidates_filtered, gridwalk_commit, gridwalk_committed, gridwalk_next};
use gridwalk_core::twin::closest_hit::{Slot, closest_hit_of};
use gridwalk_core::walk::{CULL_BACK, CULL_FRONT, Filter, Grid};
use gridwalk_tests::gpu::{Built, Gpu, Mesh};
use gridwalk_tests::random::Random;
use rayon::prelude::*;

use super::compare::{EDGE_ON, dot, edge_on, sub};
use super::twins::launches;
use super::{meshes, rays};
use crate::rebuild::records::{Scene, placed};

/// Whether a ray may hit a triangle, in double precision and by the words beside its vertices.
fn admits(grid: &Grid, ray: &Ray, triangle: u32, Filter { mask, cull }: Filter) -> bool {
    let [flags, _, of_geometry] = grid.triangles[triangle as usize].map(|row| row[3].to_bits());
    let [a, b, c] = grid.triangle(triangle).map(|vertex| vertex.map(f64::from));
    let normal = super::compare::cross(sub(b, a), sub(c, a));
    let front = (dot(normal, ray.direction.map(f64::from)) < 0.0) != (flags >> 30 & 1 != 0);
    let culled = cull & if front { CULL_FRONT } else { CULL_BACK } != 0 && flags >> 29 & 1 == 0;
    !culled && (mask == u32::MAX || mask & of_geometry != 0)
}

/// All hits of a ray in order of distance, then of triangle, among all triangles.
pub fn hits_of(grid: &Grid, ray: &Ray, filter: Filter) -> Vec<Hit> {
    let Some(moved) = move_ray(ray, grid.header) else { return Vec::new() };
    let mut hits: Vec<(Intersection, u32)> = (0..grid.header.triangle_count)
        .filter_map(|triangle| Some((intersect_triangle(&moved, grid.triangle(triangle))?, triangle)))
        .filter(|(hit, triangle)| hit.s >= moved.s_min && hit.s <= moved.s_max && admits(grid, ray, *triangle, filter))
        .collect();
    hits.sort_by(|(a, i), (b, j)| a.s.total_cmp(&b.s).then(i.cmp(j)));
    let hit = |(Intersection { s, u, v }, triangle): &_| Hit { t: hit_distance(&moved, ray, *s), u: *u, v: *v, triangle: *triangle };
    hits.iter().map(hit).collect()
}

/// Whether a ray meets a triangle edge-on: then its hit may lie beside its cells.
pub fn meets_edge_on(grid: &Grid, ray: &Ray, hits: &[Hit]) -> bool {
    hits.iter().any(|hit| edge_on(grid, ray, hit.triangle) < EDGE_ON)
}

/// Instances of a sphere and of a soup: of either winding, masked, two-sided, mirrored.
pub fn scene(gpu: &Gpu) -> Scene {
    let mut scene = Scene::new();
    let mut random = Random::new(81);
    let ball = scene.mesh(gpu, &meshes::sphere([0.0; 3], 1.0, 12));
    let chaff = scene.mesh(gpu, &meshes::soup(200, 0.3, 82));
    for id in 0..24 {
        let record = if id % 3 == 0 { chaff } else { ball };
        let transform = placed(id as f32, random.range(0.3, 1.0), random.point(-2.0, 2.0));
        let flags = [0, 0, FLAG_FLIP_FACING, FLAG_TWO_SIDED][id as usize % 4];
        scene.records.push(GeometryRecord { transform, id: 100 + id, mask: 1 << (id % 5), flags, ..record });
    }
    scene
}

fn built(gpu: &Gpu, scene: &Scene) -> (Built, Mesh, Vec<Ray>) {
    let built = scene.build(gpu, BuildOptions { density: 4.0, ..BuildOptions::default() });
    let mesh = scene.flattened();
    let mut rays = rays::random_rays(&mesh, 3_000, 83);
    rays.iter_mut().step_by(5).for_each(|ray| ray.t_max = 1.5);
    (built, mesh, rays)
}

fn cull_of(cull: u32) -> Cull {
    match cull {
        0 => Cull::None,
        CULL_BACK => Cull::Back,
        _ => Cull::Front,
    }
}

#[test]
fn masks_and_culling_are_those_of_a_full_search() {
    for_masks_and_culling(Gpu::with_shape(Shape::CPU));
}

/// Rays load the rows of triangles otherwise there.
#[test]
fn masks_and_culling_on_a_gpu_are_those_of_a_full_search() {
    for_masks_and_culling(Gpu::with_shape(Shape::GPU));
}

fn for_masks_and_culling(gpu: &Gpu) {
    let scene = scene(gpu);
    let (built, _, rays) = built(gpu, &scene);
    let copy = built.copy();
    let grid = copy.view();
    let mut random = Random::new(84);
    let own: Vec<u32> = rays.iter().map(|_| random.below(64)).collect();
    let masks = gpu.upload("masks", &own);
    let mut plain = 0;
    for (mask, cull, masked) in [
        (u32::MAX, 0, false),
        (u32::MAX, 1, false),
        (u32::MAX, 2, false),
        (5, 0, false),
        (26, 1, false),
        (31, 2, true),
        (u32::MAX, 0, true),
        (0, 0, false),
        (u32::MAX, 1, true),
    ] {
        let what = format!("mask {mask:#x}, cull {cull}, masks of the rays {masked}");
        let filter = |ray: usize| Filter { mask: if masked { mask & own[ray] } else { mask }, cull };
        let with = |info: &TraceInfo| TraceInfo { mask, cull: cull_of(cull), masks: masked.then(|| masks.region()), ..*info };
        // SAFETY: the masks live until the submission was waited for.
        let found: Vec<Hit> = gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_closest_hit(cmd, at, &with(info)) });
        // SAFETY: as above.
        let any: Vec<u32> = gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_any_hit(cmd, at, &with(info)) });
        let expected: Vec<Vec<Hit>> = rays.par_iter().enumerate().map(|(index, ray)| hits_of(&grid, ray, filter(index))).collect();
        for (index, ray) in rays.iter().enumerate() {
            let nearest = expected[index].first().copied().unwrap_or(Hit::MISS);
            let fits = found[index] == nearest && any[index] == u32::from(nearest.is_hit());
            assert!(
                fits || meets_edge_on(&grid, ray, &expected[index]),
                "{what}: ray {index} {ray:?}: {:?}, not {nearest:?}",
                found[index]
            );
        }
        let twins: Vec<Hit> = rays
            .par_iter()
            .enumerate()
            .map(|(index, ray)| {
                let mut slot = Slot::NEW;
                for launch in launches(false, filter(index)) {
                    closest_hit_of(&grid, ray, &mut slot, launch, &mut ());
                }
                slot.hit
            })
            .collect();
        assert_eq!(super::compare::differences_from_twin(gpu, &found, &twins), [0; 0], "{what}: the twin");
        if !masked {
            // SAFETY: as above.
            let by_include: Vec<Hit> =
                gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_closest_candidate(cmd, at, &with(info)) });
            assert_eq!(super::compare::differences(&by_include, &found), [0; 0], "{what}: the include");
            let committed = |ray: &Ray| {
                let mut candidates = gridwalk_candidates_filtered(&grid, ray, Filter { mask, cull });
                while gridwalk_next(&grid, &mut candidates) {
                    gridwalk_commit(&mut candidates);
                }
                gridwalk_committed(&candidates)
            };
            let twins: Vec<Hit> = rays.par_iter().map(committed).collect();
            assert_eq!(super::compare::differences_from_twin(gpu, &by_include, &twins), [0; 0], "{what}: the include's twin");
        }
        let hits = found.iter().filter(|hit| hit.is_hit()).count();
        if mask == u32::MAX && cull == 0 && !masked {
            plain = hits;
        }
        assert_eq!(hits == 0, mask == 0, "{what}");
        assert!(hits <= plain, "{what}: {hits} of {plain}");
    }
}

/// Rays from inside of a closed surface see backs, those from outside fronts.
#[test]
fn a_sphere_has_an_outside() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.0; 3], 1.0, 16);
    let inward = mesh.triangle(40);
    let [a, b, c] = inward.map(|vertex| vertex.map(f64::from));
    let outward = dot(super::compare::cross(sub(b, a), sub(c, a)), a) > 0.0;
    let built = super::build(gpu, &mesh, BuildOptions::default());
    let from_inside = rays::ray([0.01, 0.02, 0.03], [0.3, 0.5, -0.7]);
    let from_outside = rays::ray([3.0, 3.1, 2.9], [-1.0, -1.0, -1.0]);
    let hit = |cull: Cull| -> Vec<bool> {
        // SAFETY: see `trace`.
        let any: Vec<u32> = gpu.trace(&built, &[from_inside, from_outside], |cmd, at, info| unsafe {
            gpu.tracer.cmd_any_hit(cmd, at, &TraceInfo { cull, ..*info })
        });
        any.into_iter().map(|word| word == 1).collect()
    };
    assert_eq!(hit(Cull::None), [true, true]);
    // What is culled from inside, if the mesh's fronts are outside; from outside the far side is left.
    assert_eq!(hit(Cull::Back), [!outward, true]);
    assert_eq!(hit(Cull::Front), [outward, true]);
}

#[test]
fn geometries_of_hits() {
    let gpu = Gpu::shared();
    let scene = scene(gpu);
    let (built, _, rays) = built(gpu, &scene);
    let first: Vec<u32> = scene.records.iter().scan(0, |sum, record| Some(std::mem::replace(sum, *sum + record.triangle_count))).collect();
    let expected = |hit: &Hit| match hit.is_hit() {
        true => {
            let record = first.partition_point(|first| *first <= hit.triangle) - 1;
            [scene.records[record].id, hit.triangle - first[record]]
        }
        false => [MISS, MISS],
    };
    let geometries = gpu.guarded("geometries", 8 * rays.len() as u64);
    // SAFETY: the geometries live until the submission was waited for.
    let found: Vec<Hit> = gpu.trace(&built, &rays, |cmd, at, info| unsafe {
        gpu.tracer.cmd_closest_hit(cmd, at, &TraceInfo { geometries: Some(geometries.region()), ..*info })
    });
    geometries.check();
    let written: Vec<[u32; 2]> = geometries.read(0, rays.len());
    assert_eq!(found, gpu.closest(&built, &rays));
    assert_eq!(written, found.iter().map(expected).collect::<Vec<_>>());
    assert!(found.iter().filter(|hit| hit.is_hit()).count() > 1_000);

    // Any hit: of one that the ray has. With masks, which the hit has to pass too.
    let with = |info: &TraceInfo| TraceInfo { geometries: Some(geometries.region()), mask: 11, cull: Cull::Back, ..*info };
    // SAFETY: as above.
    let any: Vec<u32> = gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_any_hit(cmd, at, &with(info)) });
    geometries.check();
    let written: Vec<[u32; 2]> = geometries.read(0, rays.len());
    let copy = built.copy();
    let grid = copy.view();
    let mut farther = 0;
    for (index, ray) in rays.iter().enumerate() {
        let all = hits_of(&grid, ray, Filter { mask: 11, cull: CULL_BACK });
        let of: Vec<[u32; 2]> = all.iter().map(expected).collect();
        match any[index] {
            0 => assert_eq!(written[index], [MISS, MISS], "ray {index}"),
            _ => assert!(of.contains(&written[index]), "ray {index}: {:?} is none of {of:?}", written[index]),
        }
        farther += usize::from(any[index] == 1 && of.first() != Some(&written[index]));
    }
    assert!(farther > 10, "only {farther} hits are not the closest: one could not tell them from each other");

    // The nearest hits, a geometry each, in portions.
    let geometries = gpu.guarded("geometries of nearest hits", 3 * 8 * rays.len() as u64);
    let mut portions: Vec<Vec<[Hit; 3]>> = Vec::new();
    for portion in 0..2 {
        let existing = gpu.upload("existing hits", portions.last().unwrap_or(&vec![[Hit::MISS; 3]; rays.len()]));
        // SAFETY: as above.
        let _: Vec<[Hit; 3]> = gpu.trace(&built, &rays, |cmd, at, info| unsafe {
            let with = TraceInfo { resume: portion > 0, geometries: Some(geometries.region()), hits: existing.region(), ..*info };
            gpu.tracer.cmd_nearest_hits(cmd, at, &with, 3)
        });
        geometries.check();
        let found: Vec<[Hit; 3]> = existing.read(0, rays.len());
        let written: Vec<[[u32; 2]; 3]> = geometries.read(0, rays.len());
        assert_eq!(written, found.iter().map(|hits| hits.each_ref().map(expected)).collect::<Vec<_>>(), "portion {portion}");
        let hits = found.iter().flatten().filter(|hit| hit.is_hit()).count();
        assert!(hits > [2_000, 100][portion], "portion {portion}: {hits} hits");
        portions.push(found);
    }
    assert_ne!(portions[0], portions[1]);
}

/// Several grids traced one after another into the same hits are one grid of all their triangles; geometries follow the hits.
#[test]
fn several_grids_into_the_same_hits() {
    let gpu = Gpu::shared();
    let whole = scene(gpu);
    let (together, mesh, rays) = built(gpu, &whole);
    let halves: Vec<Built> = [0, 1]
        .map(|half| {
            let mut part = scene(gpu);
            let mut index = 0;
            part.records.retain(|_| {
                index += 1;
                (index > 12) == (half == 1)
            });
            part.build(gpu, BuildOptions { density: 4.0, ..BuildOptions::default() })
        })
        .into_iter()
        .collect();
    let number = |region: &gridwalk_tests::gpu::Guarded| -> Vec<[u32; 2]> { region.read(0, rays.len()) };
    let [all, parts] = ["geometries", "geometries of parts"].map(|name| gpu.guarded(name, 8 * rays.len() as u64));
    let with = |info: &TraceInfo, geometries: Region| TraceInfo { geometries: Some(geometries), ..*info };
    // SAFETY: the geometries live until the submission was waited for.
    let expected: Vec<Hit> =
        gpu.trace(&together, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_closest_hit(cmd, at, &with(info, all.region())) });
    let found: Vec<Hit> = gpu.trace(&halves[0], &rays, |cmd, at, info| {
        let first = with(info, parts.region());
        let device = gpu.context.device();
        // SAFETY: the other grid lives until the submission was waited for too; the barrier orders the traces.
        unsafe {
            gpu.tracer.cmd_closest_hit(cmd, at, &first)?;
            gridwalk::cmd_barrier(device, cmd, gridwalk::Tracer::TRACE, gridwalk::Tracer::TRACE);
            gpu.tracer.cmd_closest_hit(cmd, halves[1].grid.region().address, &TraceInfo { resume: true, ..first })
        }
    });
    // The grids have frames and boxes of their own, in which distances are rounded in their own way.
    let extent = rays::extent(&mesh);
    let (all, parts) = (number(&all), number(&parts));
    let mut same = 0;
    for index in 0..rays.len() {
        let (a, b) = (found[index], expected[index]);
        assert_eq!(a.is_hit(), b.is_hit(), "ray {index}");
        assert!(!a.is_hit() || (a.t - b.t).abs() <= 1e-4 * extent, "ray {index}: {a:?}, not {b:?}");
        same += usize::from(all[index] == parts[index]);
    }
    assert!(same > rays.len() * 99 / 100, "{same} of {} rays hit the same geometry", rays.len());
}
