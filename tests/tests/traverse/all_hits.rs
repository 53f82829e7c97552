//! All hits of a ray: their number, and the nearest in order, against a search through all triangles.

use gridwalk::{BuildOptions, Cull, Hit, MAX_NEAREST, MAX_RAYS, Overlap, Ray, RayCount, TraceInfo, UNFINISHED};
use gridwalk_core::layout::WalkState;
use gridwalk_core::twin::count_hits::count_hits_of;
use gridwalk_core::twin::nearest_hits::nearest_hits_of;
use gridwalk_core::walk::{Filter, Grid};
use gridwalk_tests::gpu::{Built, CANARY, Gpu, Mesh};
use rayon::prelude::*;

use super::compare::{EDGE_ON, edge_on};
use super::filters::{hits_of, meets_edge_on, scene};
use super::twins::launches;
use super::{meshes, rays};

pub fn counts(gpu: &Gpu, built: &Built, rays: &[Ray]) -> Vec<u32> {
    // SAFETY: see `trace`.
    gpu.trace(built, rays, |cmd, at, info| unsafe { gpu.tracer.cmd_count_hits(cmd, at, info) })
}

/// The nearest hits, and the next, portion after portion.
pub fn nearest<const N: usize>(gpu: &Gpu, built: &Built, rays: &[Ray], portions: usize) -> Vec<Vec<[Hit; N]>>
where
    [Hit; N]: bytemuck::Pod,
{
    let mut all: Vec<Vec<[Hit; N]>> = Vec::new();
    for portion in 0..portions {
        let existing = all.last().map(|hits| gpu.upload("existing hits", hits));
        let found = gpu.trace(built, rays, |cmd, at, info| {
            let info = match &existing {
                Some(existing) => TraceInfo { resume: true, hits: existing.region(), ..*info },
                None => *info,
            };
            // SAFETY: see `trace`; the existing hits live until then too.
            unsafe { gpu.tracer.cmd_nearest_hits(cmd, at, &info, N as u32) }
        });
        all.push(existing.map_or(found, |existing| existing.read(0, rays.len())));
        assert_eq!(all.len(), portion + 1);
    }
    all
}

/// The nearest hits found are those of the search through all triangles, bit for bit and in order; what is left out is a triangle that the ray
/// sees edge-on, whose hit may lie beside its cells. How many are left out; `None` if anything else is wrong, of which no part is allowed.
fn left_out(grid: &Grid, ray: &Ray, all: &[Hit], found: &[Hit]) -> Option<usize> {
    let mut missing = 0;
    let mut rest = all.iter();
    for hit in found.iter().filter(|hit| hit.is_hit()) {
        for skipped in rest.by_ref().take_while(|expected| *expected != hit) {
            missing += is_edge_on(grid, ray, skipped)?;
        }
    }
    let kept = found.iter().filter(|hit| hit.is_hit()).count();
    // A hit that is none of them has used up the rest.
    let last = found.iter().rfind(|hit| hit.is_hit());
    if last.is_some_and(|last| !all.contains(last)) || found[kept..].iter().any(|hit| *hit != Hit::MISS) {
        return None;
    }
    if kept < found.len() {
        for skipped in rest {
            missing += is_edge_on(grid, ray, skipped)?;
        }
    }
    Some(missing)
}

/// 1 for a hit whose triangle the ray sees edge-on.
fn is_edge_on(grid: &Grid, ray: &Ray, hit: &Hit) -> Option<usize> {
    (edge_on(grid, ray, hit.triangle) < EDGE_ON).then_some(1)
}

fn check(gpu: &Gpu, built: &Built, rays: &[Ray], what: &str) -> (usize, usize) {
    let copy = built.copy();
    let grid = copy.view();
    let filter = Filter::default();
    let expected: Vec<Vec<Hit>> = rays.par_iter().map(|ray| hits_of(&grid, ray, filter)).collect();
    let counted = counts(gpu, built, rays);
    let (one, four) = (nearest::<1>(gpu, built, rays, 3), nearest::<4>(gpu, built, rays, 3));
    let mut missing = 0;
    for (index, ray) in rays.iter().enumerate() {
        let all = &expected[index];
        let counted = counted[index] as usize;
        let edge_on = all.iter().filter_map(|hit| is_edge_on(&grid, ray, hit)).count();
        assert!((all.len() - edge_on..=all.len()).contains(&counted), "{what}: ray {index} {ray:?}: {counted} hits, not {all:?}");
        missing += all.len() - counted;
        let portions = [one.iter().flat_map(|hits| hits[index]).collect(), four.iter().flat_map(|hits| hits[index]).collect()];
        for found in portions as [Vec<Hit>; 2] {
            let left = left_out(&grid, ray, all, &found);
            missing += left.unwrap_or_else(|| panic!("{what}: ray {index} {ray:?}: {found:?}, not {all:?}"));
        }
    }
    // The twins, bit for bit.
    let twin = |ray: &Ray| {
        let (mut count, mut walk) = (0, WalkState::default());
        let (mut hits, mut other) = ([Hit::MISS; 4], WalkState::default());
        for launch in launches(false, filter) {
            count_hits_of(&grid, ray, &mut count, &mut walk, launch);
            nearest_hits_of(&grid, ray, &mut hits, &mut other, launch);
        }
        (count, hits)
    };
    let twins: Vec<_> = rays.par_iter().map(twin).collect();
    if gpu.context.is_cpu() {
        for (index, (count, hits)) in twins.into_iter().enumerate() {
            assert_eq!((counted[index], four[0][index]), (count, hits), "{what}: ray {index}, the twin");
        }
    }
    // A control: a hit that is left out, or in the wrong place, and is not edge-on.
    let index = (0..rays.len())
        .find(|index| expected[*index].len() > 1 && expected[*index].iter().all(|hit| is_edge_on(&grid, &rays[*index], hit).is_none()));
    if let Some(index) = index {
        let (ray, all) = (&rays[index], &expected[index]);
        assert_eq!(left_out(&grid, ray, all, all), Some(0));
        assert_eq!(left_out(&grid, ray, all, &all[1..]), None);
        assert_eq!(left_out(&grid, ray, all, &[all[1], all[0]]), None);
        assert_eq!(left_out(&grid, ray, all, &[all[0], Hit::MISS]), None);
        assert_eq!(left_out(&grid, ray, all, &[Hit { triangle: u32::MAX / 2, ..all[0] }]), None);
    }
    (expected.iter().map(Vec::len).sum(), missing)
}

#[test]
fn all_hits_are_those_of_a_full_search() {
    let gpu = Gpu::shared();
    for model in meshes::small() {
        for (density, overlap) in [(0.5, Overlap::Box), (16.0, Overlap::Exact)] {
            let what = format!("{} at density {density}", model.name);
            let built = super::build(gpu, &model.mesh, BuildOptions { density, overlap, ..BuildOptions::default() });
            let mut rays = rays::random_rays(&model.mesh, 1_500, 91);
            rays.extend(rays::diffuse_rays(&model.mesh, 300, 92));
            rays.extend(rays::invalid_rays());
            for (index, ray) in rays.iter_mut().enumerate() {
                match index % 8 {
                    0 => ray.t_max = 0.7,
                    1 => ray.t_min = 0.3,
                    2 => (ray.t_min, ray.t_max) = (-1.0, 1.0),
                    _ => {}
                }
            }
            let (hits, missing) = check(gpu, &built, &rays, &what);
            eprintln!("{what}: {hits} hits of {} rays, {missing} left out of three searches, all edge-on", rays.len());
        }
    }
}

/// Triangles at the same distance, in the same cells: each is counted once, and they come in order of their numbers.
#[test]
fn ties_are_kept_in_order() {
    let gpu = Gpu::shared();
    let sheet = [[-1.0, -1.0, 0.25], [1.0, -1.0, 0.25], [0.0, 1.0, 0.25]];
    let mut triangles = vec![sheet; 11];
    triangles.extend([sheet.map(|[x, y, _]| [x, y, 0.75]); 3]);
    let mesh = Mesh::from_triangles(&triangles);
    for resolution in [[1, 1, 1], [16, 16, 16]] {
        let options = BuildOptions { resolution: Some(resolution), ..BuildOptions::default() };
        let built = gpu.build(&mesh, super::roomy(&mesh), options);
        let ray = rays::ray([0.01, 0.02, -1.0], [0.0, 0.0, 1.0]);
        assert_eq!(counts(gpu, &built, &[ray]), [14]);
        let order: Vec<u32> = nearest::<4>(gpu, &built, &[ray], 4).iter().flat_map(|hits| hits[0]).map(|hit| hit.triangle).collect();
        assert_eq!(order[..14], (0..14).collect::<Vec<_>>());
        assert!(order[14..].iter().all(|triangle| *triangle == gridwalk::MISS));
        // The interval is closed at both ends.
        let within = Ray { t_min: 1.25, t_max: 1.75, ..ray };
        assert_eq!(counts(gpu, &built, &[within, Ray { t_max: 1.74, ..within }, Ray { t_min: 1.26, ..within }]), [14, 11, 3]);
    }
}

/// Lists so long that walks are given up and go on.
#[test]
fn all_hits_of_walks_that_are_continued() {
    let gpu = Gpu::shared();
    let sheet = |i: usize| {
        let z = i as f32 / 40_000.0;
        [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]]
    };
    let triangles: Vec<_> = (0..40_000).map(sheet).collect();
    let mesh = Mesh::from_triangles(&triangles);
    let options = BuildOptions { resolution: Some([1, 1, 2]), ..BuildOptions::default() };
    let built = gpu.build(&mesh, gridwalk::Capacity { triangles: 40_000, cells: 8, pairs: 200_000, leaf_cells: 0 }, options);
    let rays = [
        rays::ray([0.01, 0.02, -1.0], [0.0, 0.0, 1.0]),
        rays::ray([0.01, 0.02, 2.0], [0.0, 0.0, -1.0]),
        rays::ray([5.0; 3], [1.0, 0.0, 0.0]),
    ];
    assert_eq!(counts(gpu, &built, &rays), [40_000, 40_000, 0]);
    let found = nearest::<4>(gpu, &built, &rays, 2);
    assert_eq!(found[0][0].map(|hit| hit.triangle), [0, 1, 2, 3]);
    assert_eq!(found[1][0].map(|hit| hit.triangle), [4, 5, 6, 7]);
    assert_eq!(found[1][1].map(|hit| hit.triangle), [39_995, 39_994, 39_993, 39_992]);
    // Too many tests even for all continuations: the rest is unknown, not missing.
    let many: Vec<[Hit; 32]> = nearest::<32>(gpu, &built, &rays, 1).remove(0);
    let triangles = many[0].map(|hit| hit.triangle);
    let known = triangles.iter().take_while(|triangle| **triangle != UNFINISHED).count();
    assert!(known > 4 && known < 32, "{known}");
    assert_eq!(triangles[..known], (0..known as u32).collect::<Vec<_>>());
    assert!(triangles[known..].iter().all(|triangle| *triangle == UNFINISHED));
}

#[test]
fn all_hits_with_masks_and_a_number_in_memory() {
    let gpu = Gpu::shared();
    let scene = scene(gpu);
    let built = scene.build(gpu, BuildOptions { density: 4.0, ..BuildOptions::default() });
    let copy = built.copy();
    let grid = copy.view();
    let rays = rays::random_rays(&scene.flattened(), 500, 93);
    let number = gpu.upload("number", &[400u32]);
    let with = |info: &TraceInfo| TraceInfo {
        mask: 11,
        cull: Cull::Back,
        count: RayCount::Indirect { count: number.region(), max: 500 },
        ..*info
    };
    // SAFETY: the number lives until the submissions were waited for.
    let counted: Vec<u32> = gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_count_hits(cmd, at, &with(info)) });
    // SAFETY: as above.
    let found: Vec<[Hit; 2]> = gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_nearest_hits(cmd, at, &with(info), 2) });
    let mut hits = 0;
    for (index, ray) in rays.iter().enumerate() {
        if index >= 400 {
            assert_eq!((counted[index], found[index][1].triangle), (CANARY, CANARY), "ray {index} is beyond the number");
            continue;
        }
        let all = hits_of(&grid, ray, Filter { mask: 11, cull: gridwalk_core::walk::CULL_BACK });
        let at = |i: usize| all.get(i).copied().unwrap_or(Hit::MISS);
        let fits = counted[index] == all.len() as u32 && found[index] == [at(0), at(1)];
        assert!(fits || meets_edge_on(&grid, ray, &all), "ray {index}: {} {:?}, not {all:?}", counted[index], found[index]);
        hits += all.len();
    }
    assert!(hits > 100, "{hits}");
}

#[test]
fn all_hits_that_are_refused() {
    let gpu = Gpu::shared();
    let memory = gpu.guarded("memory", 1 << 16);
    let at = memory.region().address;
    let part = |offset, size| memory.region().part(offset, size);
    let info = TraceInfo::new(part(0, 64), part(1024, 64), RayCount::Direct(2), part(2048, 4096));
    let refused = |info: TraceInfo, nearest: Option<u32>| {
        let mut error = None;
        gpu.submit(|cmd| {
            // SAFETY: what is refused records nothing.
            error = unsafe {
                match nearest {
                    Some(nearest) => gpu.tracer.cmd_nearest_hits(cmd, at, &info, nearest).err(),
                    None => gpu.tracer.cmd_count_hits(cmd, at, &info).err(),
                }
            };
        });
        error.unwrap_or_else(|| panic!("not refused: {info:?} {nearest:?}")).to_string()
    };
    let cases = [
        ("nearest", refused(info, Some(0))),
        ("nearest", refused(info, Some(MAX_NEAREST + 1))),
        ("hits", refused(info, Some(3))),
        ("hits", refused(TraceInfo { count: RayCount::Direct(MAX_RAYS / 2), ..info }, Some(3))),
        ("resume", refused(TraceInfo { resume: true, ..info }, None)),
        ("geometries", refused(TraceInfo { geometries: Some(info.hits), ..info }, None)),
        ("geometries", refused(TraceInfo { geometries: Some(part(8192, 31)), ..info }, Some(2))),
        ("masks", refused(TraceInfo { masks: Some(part(0, 4)), ..info }, None)),
        ("counters", refused(TraceInfo { counters: Some(info.hits), ..info }, Some(2))),
    ];
    for (name, message) in cases {
        assert!(message.contains(name), "{name}: {message}");
    }
}
