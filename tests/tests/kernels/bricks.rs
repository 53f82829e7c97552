use bytemuck::Zeroable;
use gridwalk::Report;
use gridwalk::kernels::{BRICK_DISTANCE_X, BRICK_DISTANCE_Y, BRICK_DISTANCE_Z, BRICK_REDUCE, REPORT_SPINE};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::grid::brick_resolution;
use gridwalk_core::layout::{Brick, GridHeader};
use gridwalk_core::twin::brick_distance_x::brick_distance_x;
use gridwalk_core::twin::brick_distance_y::brick_distance_y;
use gridwalk_core::twin::brick_distance_z::brick_distance_z;
use gridwalk_core::twin::brick_reduce::brick_reduce;
use gridwalk_core::twin::report_spine::report_spine;
use gridwalk_tests::gpu::{CANARY, Gpu};
use gridwalk_tests::random::Random;

use super::{TINY, assert_same, devices, header, untouched};

fn check(gpu: &Gpu, resolution: [u32; 3], fill: f32, seed: u64) {
    let shape = gpu.tracer.shape();
    let what = format!("{resolution:?}, {fill} full, seed {seed}, {shape:?}");
    let cell_count: u32 = resolution.iter().product();
    let header = GridHeader { cell_count, resolution, ..header(&Default::default(), 1.0, [0; 3]) };
    let mut random = Random::new(seed);
    let mut next = 0;
    let cells: Vec<[u32; 2]> = (0..cell_count)
        .map(|_| {
            if random.unit() >= fill {
                return [0, 0];
            }
            let begin = next;
            next += 1 + random.below(9);
            [begin, next]
        })
        .collect();
    let count: u32 = brick_resolution(resolution).iter().product();
    let tiles = count.div_ceil(shape.brick_tile()) as usize;
    let len = count as usize;
    let grid = gpu.upload("grid", &[header]);
    let cell_memory = gpu.upload("cells", &cells);
    let bricks = gpu.guarded("bricks", 16 * len as u64);
    let partials = gpu.guarded("partials", 8 * tiles as u64);
    let distances = [gpu.guarded("distances x", 4 * len as u64), gpu.guarded("distances y", 4 * len as u64)];
    let report = gpu.upload("report", &[Report::zeroed()]);
    let reduce_groups = split_workgroups(tiles as u32, 1);
    let groups = split_workgroups(count, shape.map_size);
    gpu.launch(&BRICK_REDUCE, 0, &[&grid, &cell_memory, &bricks, &partials], &[], reduce_groups);

    let mut expected = vec![Brick::zeroed(); len];
    let mut sums = vec![[CANARY; 2]; tiles];
    brick_reduce(&shape, reduce_groups, resolution, &cells, &mut expected, &mut sums);
    assert_same(&format!("{what}: bricks"), &bricks.read::<Brick>(0, len), &expected);
    assert_same(&format!("{what}: partials"), &partials.read::<[u32; 2]>(0, tiles), &sums);

    gpu.launch(&REPORT_SPINE, 0, &[&grid, &partials, &report], &[], [1, 1, 1]);
    let mut whole = Report::zeroed();
    report_spine(&shape, resolution, &sums, &mut whole);
    assert_same(&format!("{what}: report"), &report.read::<Report>(0, 1), &[whole]);
    assert_eq!(whole.cells_in_use as usize, cells.iter().filter(|[_, end]| *end != 0).count(), "{what}");

    let [x, y] = &distances;
    gpu.launch(&BRICK_DISTANCE_X, 0, &[&grid, &bricks, x], &[], groups);
    gpu.launch(&BRICK_DISTANCE_Y, 0, &[&grid, x, y], &[], groups);
    gpu.launch(&BRICK_DISTANCE_Z, 0, &[&grid, y, &bricks], &[], groups);
    let (mut expected_x, mut expected_y) = (untouched(len), untouched(len));
    brick_distance_x(&shape, groups, resolution, &expected, &mut expected_x);
    brick_distance_y(&shape, groups, resolution, &expected_x, &mut expected_y);
    brick_distance_z(&shape, groups, resolution, &expected_y, &mut expected);
    assert_same(&format!("{what}: x"), &x.read::<u32>(0, len), &expected_x);
    assert_same(&format!("{what}: y"), &y.read::<u32>(0, len), &expected_y);
    assert_same(&format!("{what}: z"), &bricks.read::<Brick>(0, len), &expected);
}

#[test]
fn bricks_of_every_resolution() {
    let resolutions =
        [[1, 1, 1], [2, 1, 3], [4, 4, 4], [5, 4, 3], [63, 1, 1], [1, 130, 1], [1, 1, 257], [17, 19, 23], [64, 32, 16], [33, 200, 2]];
    for gpu in devices() {
        for (seed, resolution) in resolutions.into_iter().enumerate() {
            for fill in [0.0, 0.0005, 0.02, 1.0] {
                check(gpu, resolution, fill, seed as u64);
            }
        }
    }
}

#[test]
fn bricks_of_many_workgroups() {
    // 64 x 64 x 64 and a little more bricks, four a workgroup.
    for resolution in [[256, 256, 255], [256, 260, 256]] {
        check(Gpu::with_shape(TINY), resolution, 0.001, 9);
    }
}

/// The distance of a brick is what a search through all bricks finds.
#[test]
fn brick_distances_are_the_nearest() {
    let resolution = [40, 24, 80];
    let along = brick_resolution(resolution);
    let shape = TINY;
    let count: u32 = along.iter().product();
    let mut random = Random::new(5);
    let mut bricks: Vec<Brick> = (0..count).map(|_| Brick { mask: [u32::from(random.below(300) == 0), 0], ..Brick::default() }).collect();
    let groups = split_workgroups(count, shape.map_size);
    let (mut x, mut y) = (untouched(count as usize), untouched(count as usize));
    brick_distance_x(&shape, groups, resolution, &bricks, &mut x);
    brick_distance_y(&shape, groups, resolution, &x, &mut y);
    brick_distance_z(&shape, groups, resolution, &y, &mut bricks);
    let place = |index| gridwalk_core::grid::cell_of(index, along);
    for index in 0..count {
        let here = place(index);
        let full = (0..count).filter(|other| bricks[*other as usize].mask != [0, 0]);
        let nearest = full.map(|other| (0..3).map(|axis| place(other)[axis].abs_diff(here[axis])).max().unwrap()).min().unwrap();
        assert_eq!(bricks[index as usize].distance, nearest.min(15), "brick {here:?}");
    }
}
