//! Rays in an order: the sort is one by their keys, and no order changes what a ray hits, or where that lies.

use gridwalk::{BuildOptions, Capacity, Cull, Hit, Ray, Region, Shape, TraceInfo};
use gridwalk_core::intersect::move_ray;
use gridwalk_core::twin::ray_keys::ray_key;
use gridwalk_tests::gpu::{Built, CANARY, Gpu, Guarded, Mesh, TraceOptions};
use gridwalk_tests::random::Random;

use super::filters::scene;
use super::{build, meshes, rays};

/// Rays of all kinds, mixed.
fn mixed(mesh: &Mesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut all = rays::random_rays(mesh, count / 2, seed);
    all.extend(rays::diffuse_rays(mesh, count - count / 2 - rays::invalid_rays().len(), seed + 1));
    all.extend(rays::invalid_rays());
    shuffled(all.len(), seed + 2).into_iter().map(|index| all[index as usize]).collect()
}

fn shuffled(count: usize, seed: u64) -> Vec<u32> {
    let mut random = Random::new(seed);
    let mut order: Vec<u32> = (0..count as u32).collect();
    for last in (1..count).rev() {
        order.swap(last, random.below(last as u32 + 1) as usize);
    }
    order
}

/// The keys of all rays by the twin.
fn keys(built: &Built, rays: &[Ray]) -> Vec<u32> {
    let header = built.header();
    rays.iter().map(|ray| ray_key(move_ray(ray, &header).as_ref(), &header)).collect()
}

/// Bits of a hit: a miss or a canary compares too.
fn bits(hits: &[Hit]) -> Vec<[u32; 4]> {
    bytemuck::cast_slice(hits).to_vec()
}

#[test]
fn the_order_is_a_stable_sort_by_key() {
    let mesh = meshes::soup(400, 0.2, 41);
    for shape in [Shape::CPU, Shape::GPU, crate::kernels::ODD] {
        let gpu = Gpu::with_shape(shape);
        let built = build(gpu, &mesh, BuildOptions::default());
        for count in [0, 1, 63, 64, 65, 10_000, 40_001] {
            let rays = mixed(&mesh, count.max(100), 42)[..count.max(100)].iter().copied().take(count).collect::<Vec<_>>();
            let keys = keys(&built, &rays);
            let mut expected: Vec<u32> = (0..count as u32).collect();
            expected.sort_by_key(|ray| keys[*ray as usize]);
            let what = format!("{count} rays, {shape:?}, seed 42");
            let found = gpu.sort_rays(&built, &rays, None);
            let mut all = found.clone();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..count as u32), "{what}: no permutation");
            if gpu.context.is_cpu() {
                assert_eq!(found, expected, "{what}");
            }
            // The rays as they come are in no such order: a sort that did nothing would be seen.
            assert!(count < 1_000 || keys.windows(2).filter(|pair| pair[0] > pair[1]).count() > count / 4, "{what}");
            let number = count as u32 / 3;
            let part = gpu.sort_rays(&built, &rays, Some(number));
            let mut all = part[..number as usize].to_vec();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..number), "{what}: {number} of them");
            assert!(part[number as usize..].iter().all(|word| *word == CANARY), "{what}: {number} of them");
        }
    }
}

#[test]
fn no_order_changes_what_rays_hit() {
    let gpu = Gpu::shared();
    for (name, mesh) in [("soup", meshes::soup(2_000, 0.15, 43)), ("sphere", meshes::sphere([0.3, -0.2, 0.1], 1.0, 32))] {
        let built = build(gpu, &mesh, BuildOptions::default());
        let rays = mixed(&mesh, 20_000, 44);
        let (expected, counted) = gpu.closest_with(&built, &rays, &TraceOptions { count: true, ..TraceOptions::default() });
        assert!(expected.iter().filter(|hit| hit.is_hit()).count() > 2_000);
        let existing: Vec<Hit> =
            (0..rays.len()).map(|ray| if ray % 3 == 0 { Hit::MISS } else { Hit { t: 0.4, u: 0.5, v: 0.25, triangle: 7 } }).collect();
        let (resumed, _) = gpu.closest_with(&built, &rays, &TraceOptions { resume: Some(&existing), ..TraceOptions::default() });
        let sorted = gpu.sort_rays(&built, &rays, None);
        let keys = keys(&built, &rays);
        assert!(!gpu.context.is_cpu() || sorted.is_sorted_by_key(|ray| keys[*ray as usize]));
        assert_ne!(sorted, (0..rays.len() as u32).collect::<Vec<_>>());
        for (which, order) in [("sorted", &sorted), ("shuffled", &shuffled(rays.len(), 45))] {
            let what = format!("{name}, {which}, seeds 43 to 45");
            let options = TraceOptions { order: Some(order), ..TraceOptions::default() };
            let (found, counters) = gpu.closest_with(&built, &rays, &TraceOptions { count: true, ..options });
            assert_eq!(bits(&found), bits(&expected), "{what}");
            assert_eq!(counters, counted, "{what}: counters");
            let (found, _) = gpu.closest_with(&built, &rays, &TraceOptions { resume: Some(&existing), ..options });
            assert_eq!(bits(&found), bits(&resumed), "{what}: resumed");
            // The first of an order: exactly those are traced.
            let number = 7_777;
            let (found, _) = gpu.closest_with(&built, &rays, &TraceOptions { indirect: Some(number), ..options });
            let mut partly = vec![[CANARY; 4]; rays.len()];
            order[..number as usize].iter().for_each(|ray| partly[*ray as usize] = bits(&expected)[*ray as usize]);
            assert!(bits(&found) == partly, "{what}: {number} in memory");
            let (found, _) = gpu.closest_with(&built, &rays, &TraceOptions { order: Some(&order[..number as usize]), ..options });
            assert!(bits(&found) == partly, "{what}: {number} given");
        }
    }
}

/// Masks, culling and geometries of any, all and the nearest hits in an order.
#[test]
fn all_queries_go_in_an_order() {
    let gpu = Gpu::shared();
    let scene = scene(gpu);
    let built = scene.build(gpu, BuildOptions { density: 4.0, ..BuildOptions::default() });
    let rays = mixed(&scene.flattened(), 6_000, 46);
    let mut random = Random::new(47);
    let own: Vec<u32> = rays.iter().map(|_| random.below(64)).collect();
    let masks = gpu.upload("masks", &own);
    let order = gpu.upload("order", &gpu.sort_rays(&built, &rays, None));
    let geometries = gpu.guarded("geometries", 8 * 4 * rays.len() as u64);
    let with = |info: &TraceInfo, order: Option<&Guarded>, geometries: Option<Region>| TraceInfo {
        masks: Some(masks.region()),
        cull: Cull::Back,
        order: order.map(Guarded::region),
        geometries,
        ..*info
    };
    let trace = |order: Option<&Guarded>| {
        let written = Some(geometries.region());
        // SAFETY: masks, order and geometries live until the submissions were waited for; here and below.
        let closest: Vec<[u32; 4]> =
            gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_closest_hit(cmd, at, &with(info, order, written)) });
        let of_closest: Vec<[u32; 2]> = geometries.read(0, rays.len());
        // SAFETY: as above.
        let any: Vec<u32> =
            gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_any_hit(cmd, at, &with(info, order, written)) });
        let of_any: Vec<[u32; 2]> = geometries.read(0, rays.len());
        // SAFETY: as above.
        let count: Vec<u32> =
            gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_count_hits(cmd, at, &with(info, order, None)) });
        // SAFETY: as above.
        let nearest: Vec<[[u32; 4]; 4]> =
            gpu.trace(&built, &rays, |cmd, at, info| unsafe { gpu.tracer.cmd_nearest_hits(cmd, at, &with(info, order, written), 4) });
        let of_nearest: Vec<[[u32; 2]; 4]> = geometries.read(0, rays.len());
        (closest, of_closest, any, of_any, count, nearest, of_nearest)
    };
    let expected = trace(None);
    assert!(expected.2.iter().filter(|word| **word == 1).count() > 500);
    assert!(trace(Some(&order)) == expected, "sorted, seeds 46 and 47");
    let order = gpu.upload("order", &shuffled(rays.len(), 48));
    assert!(trace(Some(&order)) == expected, "shuffled, seed 48");
    // Were masks looked up by place, other geometries would be hit.
    let moved: Vec<u32> = order.read::<u32>(0, rays.len()).iter().map(|ray| own[*ray as usize]).collect();
    masks.write(0, &moved);
    assert!(trace(Some(&order)) != expected);
}

/// Walks that are given up are continued, and in the end reported, at the places of their rays.
#[test]
fn long_walks_go_on_in_an_order() {
    let gpu = Gpu::shared();
    let far = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]];
    for (count, is_reported) in [(100_000, false), (300_000, true)] {
        let mesh = Mesh { positions: far.to_vec(), indices: vec![[0, 1, 2]; count] };
        let options = BuildOptions { resolution: Some([1, 1, 1]), ..BuildOptions::default() };
        let capacity = Capacity { triangles: count as u32, cells: 64, pairs: count as u32 + 64, leaf_cells: 0 };
        let built = gpu.build(&mesh, capacity, options);
        // Every third hits, every third passes by within the box, every third outside of it.
        let ray = |index: u32| rays::ray([[0.0, 0.0, 0.0], [0.9, 0.9, 0.0], [5.0, 0.0, 0.0]][index as usize % 3], [0.0, 0.0, 1.0]);
        let rays: Vec<Ray> = (0..200).map(ray).collect();
        let expected = gpu.closest(&built, &rays);
        assert_eq!(expected[0].triangle == gridwalk::UNFINISHED, is_reported);
        for order in [gpu.sort_rays(&built, &rays, None), shuffled(rays.len(), 49)] {
            let (found, _) = gpu.closest_with(&built, &rays, &TraceOptions { order: Some(&order), ..TraceOptions::default() });
            assert_eq!(bits(&found), bits(&expected), "{count} triangles");
        }
    }
}
