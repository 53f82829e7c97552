//! Cells with more triangles than one launch may test: the walk goes on, or says that it is unfinished; it never misses.

use gridwalk::{BuildOptions, Capacity, Hit, Ray};
use gridwalk_core::UNFINISHED;
use gridwalk_tests::gpu::{Built, Gpu, Mesh, TraceOptions};

use super::rays::ray;
use super::{build, twins};

/// One cell with `count` triangles across the z axis: equal ones at z = 2, and the last at z = 1 and smaller.
fn stack(gpu: &Gpu, count: u32) -> Built {
    let far = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]];
    let near = [[-0.5, -0.5, 1.0], [0.5, -0.5, 1.0], [0.0, 0.5, 1.0]];
    let mut indices = vec![[0, 1, 2]; count as usize];
    indices[count as usize - 1] = [3, 4, 5];
    let mesh = Mesh { positions: [far, near].concat(), indices };
    let options = BuildOptions { resolution: Some([1, 1, 1]), ..BuildOptions::default() };
    let built = gpu.build(&mesh, Capacity { triangles: count, cells: 64, pairs: count + 64, leaf_cells: 0 }, options);
    assert_eq!((built.report.longest_list, built.report.overflow), (count, 0));
    built
}

const Z: [f32; 3] = [0.0, 0.0, 1.0];

/// At the near triangle, at the far ones alone, at none but inside of the box, and past the box.
fn four_rays() -> [Ray; 4] {
    [ray([0.0; 3], Z), ray([0.0, -0.75, 0.0], Z), ray([0.9, 0.9, 0.0], Z), ray([2.0, 0.0, 0.0], Z)]
}

#[test]
fn a_hundred_thousand_triangles_in_a_cell_are_tested() {
    let gpu = Gpu::shared();
    let count = 100_000;
    let built = stack(gpu, count);
    let rays = four_rays();
    let hits = gpu.closest(&built, &rays);
    assert_eq!((hits[0].triangle, hits[0].t), (count - 1, 1.0));
    assert_eq!((hits[1].triangle, hits[1].t), (0, 2.0));
    assert_eq!(hits[2..], [Hit::MISS; 2]);
    assert_eq!(gpu.any(&built, &rays), [1, 1, 0, 0]);
    let (_, counters) = gpu.closest_with(&built, &rays, &gridwalk_tests::gpu::TraceOptions { count: true, ..Default::default() });
    assert_eq!(counters.map_tests(), [count, count, count, 0]);
    // Going on from a hit that is nearer than all of them keeps it through every launch.
    let existing = [Hit { t: 0.5, u: 0.0, v: 0.0, triangle: 3 }; 4];
    let (resumed, _) =
        gpu.closest_with(&built, &rays, &gridwalk_tests::gpu::TraceOptions { resume: Some(&existing), ..Default::default() });
    assert_eq!(resumed, existing);
    let copy = built.copy();
    assert_eq!(twins::closest_hits(&copy.view(), &rays), hits);
    // A shader has one loop for all: it says so.
    let by_include = gpu.closest_by_include(&built, &rays);
    assert!(by_include[..3].iter().all(|hit| hit.triangle == UNFINISHED && hit.t == f32::INFINITY), "{by_include:?}");
    assert_eq!(by_include[3], Hit::MISS);
}

trait Tests {
    fn map_tests(&self) -> Vec<u32>;
}

impl Tests for Vec<[u32; 4]> {
    fn map_tests(&self) -> Vec<u32> {
        self.iter().map(|counted| counted[1]).collect()
    }
}

#[test]
fn a_million_triangles_in_a_cell_are_reported_as_unfinished() {
    let gpu = Gpu::shared();
    let built = stack(gpu, 1_000_000);
    let rays = four_rays();
    let hits = gpu.closest(&built, &rays);
    let unfinished = Hit { triangle: UNFINISHED, ..Hit::MISS };
    assert_eq!(hits, [unfinished, unfinished, unfinished, Hit::MISS]);
    // The first triangle that is hit settles the question; where none is, it stays open.
    assert_eq!(gpu.any(&built, &rays), [1, 1, UNFINISHED, 0]);
    let copy = built.copy();
    assert_eq!(twins::closest_hits(&copy.view(), &rays), hits);
    assert_eq!(rays.map(|ray| twins::any(&copy.view(), &ray)), [1, 1, UNFINISHED, 0]);
}

#[test]
fn walks_that_go_on_stand_beside_walks_that_ended() {
    let gpu = Gpu::shared();
    // Every third ray needs more than one launch, and its neighbours in the subgroup do not.
    let built = stack(gpu, 60_000);
    let rays: Vec<_> = (0..3_000_u32)
        .map(|i| {
            let x = 0.3 * (i as f32 / 3_000.0 - 0.5);
            ray([if i.is_multiple_of(3) { x } else { 5.0 + x }, -0.1, 0.0], Z)
        })
        .collect();
    let hits = gpu.closest(&built, &rays);
    for (index, hit) in hits.iter().enumerate() {
        let expected = if index.is_multiple_of(3) { (59_999, 1.0) } else { (Hit::MISS.triangle, f32::INFINITY) };
        assert_eq!((hit.triangle, hit.t), expected, "ray {index}");
    }
}

/// Walks are given up in the middle of a leaf cell's list and go on there, in every kind of search.
#[test]
fn walks_go_on_in_leaf_cells() {
    let gpu = Gpu::shared();
    let count = 60_000;
    // One large triangle spans a cell; all others crowd in one of its leaf cells, the last of them nearest.
    let large = [[-1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]];
    let small = |z: f32| [[0.3, 0.3, z], [0.301, 0.3, z], [0.3, 0.301, z]];
    let mut triangles = vec![large];
    triangles.extend((0..count - 1).map(|_| small(0.31)));
    triangles.push(small(0.309));
    let mesh = Mesh::from_triangles(&triangles);
    let options = BuildOptions { resolution: Some([1, 1, 1]), ..BuildOptions::default() };
    let built = gpu.build(&mesh, Capacity { triangles: count + 1, cells: 64, pairs: 1 << 20, leaf_cells: 1 << 15 }, options);
    assert_eq!((built.report.split_cells, built.report.overflow), (1, 0), "{:?}", built.report);
    assert!(built.report.leaf_pairs > count);
    let rays = [ray([0.3001, 0.3001, -2.0], Z), ray([0.3001, 0.3001, 2.0], [0.0, 0.0, -1.0]), ray([0.9, 0.9, -2.0], Z)];
    let hits = gpu.closest(&built, &rays);
    assert_eq!((hits[0].triangle, hits[2]), (count, Hit::MISS));
    assert_eq!(hits[1].triangle, 1, "the first of equal ones");
    assert_eq!(gpu.any(&built, &rays), [1, 1, 0]);
    assert_eq!(twins::closest_hits(&built.copy().view(), &rays), hits);
    assert_eq!(super::all_hits::counts(gpu, &built, &rays), [count, count, 0]);
    let nearest = super::all_hits::nearest::<2>(gpu, &built, &rays, 1);
    assert_eq!(nearest[0][0].map(|hit| hit.triangle), [count, 1]);
    assert_eq!(nearest[0][1].map(|hit| hit.triangle), [1, 2]);
}

/// Rays cross the empty part of a cell with 32^3 leaf cells in jumps, in every direction, by as many steps as the twin.
#[test]
fn empty_leaf_cells_are_jumped_across() {
    let gpu = Gpu::shared();
    let corners = [[[-1.0, -1.0, -1.0], [-0.9, -1.0, -1.0], [-1.0, -0.9, -1.0]], [[1.0, 1.0, 1.0], [0.9, 1.0, 1.0], [1.0, 0.9, 1.0]]];
    let crowd = (0..2_000).map(|_| [[-0.95, -0.95, -0.95], [-0.949, -0.95, -0.95], [-0.95, -0.949, -0.95]]);
    let mesh = Mesh::from_triangles(&corners.into_iter().chain(crowd).collect::<Vec<_>>());
    let options = BuildOptions { resolution: Some([1, 1, 1]), ..BuildOptions::default() };
    let built = gpu.build(&mesh, Capacity { triangles: 2_002, cells: 64, pairs: 1 << 16, leaf_cells: 1 << 15 }, options);
    assert_eq!((built.report.split_cells, built.report.leaf_cells), (1, 1 << 15), "{:?}", built.report);
    let turned = |v: [f32; 3], axis: usize| std::array::from_fn(|i| v[(i + axis) % 3]);
    let ways = [[0.0, 0.0, 1.0], [0.02, -0.01, 1.0], [-0.3, 0.2, 1.0]];
    let rays: Vec<_> = (0..3)
        .flat_map(|axis| ways.map(|way| (turned(way, axis), turned([0.1, 0.2, 0.0], axis))))
        .flat_map(|(way, middle)| [(way, middle), (way.map(|x: f32| -x), middle)])
        .map(|(way, middle): ([f32; 3], [f32; 3])| ray(std::array::from_fn(|i| middle[i] - 2.0 * way[i]), way))
        .collect();
    let (hits, counters) = gpu.closest_with(&built, &rays, &TraceOptions { count: true, ..TraceOptions::default() });
    let copy = built.copy();
    for ((ray, hit), counted) in rays.iter().zip(&hits).zip(&counters) {
        let twin = twins::closest(&copy.view(), ray, None, &mut ());
        assert_eq!((hit.triangle, twin.hit.triangle), (Hit::MISS.triangle, Hit::MISS.triangle), "{ray:?}");
        assert!(!gpu.context.is_cpu() || counted[0] == twin.counters.steps, "{ray:?}: {counted:?}, twin {:?}", twin.counters);
        // One by one there would be 32 at least.
        assert!(counted[0] <= 12, "{ray:?} takes {} steps", counted[0]);
    }
}

/// In a brick of which one corner cell holds triangles, the other octants are crossed at once, and that of the corner cell by cell.
#[test]
fn empty_octants_of_a_brick_are_blocks() {
    let gpu = Gpu::shared();
    // The grid is [-1, 1]^3 and a little: a triangle in its lowest cell, and points that hold the box open and are in its highest.
    let low = [[-1.0, -1.0, -1.0], [-0.9, -1.0, -1.0], [-1.0, -0.9, -0.9]];
    let high = [[1.0, 1.0, 1.0], [0.9, 1.0, 1.0], [1.0, 0.9, 0.9]];
    let mesh = Mesh::from_triangles(&[low, high]);
    let built = gpu.build(
        &mesh,
        Capacity { triangles: 2, cells: 64, pairs: 64, leaf_cells: 0 },
        BuildOptions { resolution: Some([4, 4, 4]), ..BuildOptions::default() },
    );
    assert_eq!(built.report.cells_in_use, 2, "{:?}", built.report);
    let copy = built.copy();
    for axis in 0..3 {
        for sign in [1.0_f32, -1.0] {
            // Through two empty octants; through the two cells along an edge of the lowest octant, then an empty one.
            for (beside, blocks) in [([0.6, -0.6], 2), ([-0.6, -0.4], 3)] {
                let along: [f32; 3] = std::array::from_fn(|i| if i == axis { sign } else { 0.0 });
                let origin = std::array::from_fn(|i| if i == axis { -2.0 * sign } else { beside[(i + 2 - axis) % 3] });
                let ray = ray(origin, along);
                let (_, counters) = gpu.closest_with(&built, &[ray], &TraceOptions { count: true, ..TraceOptions::default() });
                let twin = twins::closest(&copy.view(), &ray, None, &mut ());
                assert_eq!((counters[0][0], twin.counters.steps), (blocks, blocks), "{ray:?}");
            }
        }
    }
}

#[test]
fn a_long_way_is_walked() {
    let gpu = Gpu::shared();
    // The longest grid: most of its cells are empty, and none may be jumped over wrongly.
    let triangles: Vec<_> = (0..2_000)
        .map(|i| {
            let x = i as f32 * 0.5;
            [[x, -0.5, -0.5], [x, 0.5, -0.5], [x, 0.0, 0.5]]
        })
        .collect();
    let mesh = Mesh::from_triangles(&triangles);
    let built = build(gpu, &mesh, BuildOptions { density: 8.0, ..BuildOptions::default() });
    let rays: Vec<_> = (0..2_000).map(|i| Ray { t_min: i as f32 * 0.5 + 1.25, ..ray([-1.0, 0.0, -0.25], [1.0, 0.0, 0.0]) }).collect();
    let expected: Vec<_> = (0..2_000_u32).map(|i| if i < 1_999 { i + 1 } else { Hit::MISS.triangle }).collect();
    assert_eq!(gpu.closest(&built, &rays).iter().map(|hit| hit.triangle).collect::<Vec<_>>(), expected);
}
