use bytemuck::Zeroable;
use gridwalk::Report;
use gridwalk::kernels::{BRICK_DISTANCE_X, BRICK_DISTANCE_Y, BRICK_DISTANCE_Z, BRICK_REDUCE, REPORT_SPINE, SPLIT_CELLS};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::grid::{brick_resolution, cell_id, cell_of};
use gridwalk_core::layout::{Brick, BuildState, GridHeader, LeafArguments, SplitCell, TileOccupancy};
use gridwalk_core::split::{leaf_count_of, leaf_level, owner_shift};
use gridwalk_core::twin::brick_distance_x::brick_distance_x;
use gridwalk_core::twin::brick_distance_y::brick_distance_y;
use gridwalk_core::twin::brick_distance_z::brick_distance_z;
use gridwalk_core::twin::brick_reduce::brick_reduce;
use gridwalk_core::twin::report_spine::report_spine;
use gridwalk_core::twin::split_cells::split_cells;
use gridwalk_tests::gpu::{CANARY, Gpu};
use gridwalk_tests::random::Random;

use super::{TINY, assert_same, devices, header, untouched};

fn check(gpu: &Gpu, resolution: [u32; 3], fill: f32, seed: u64) {
    let shape = gpu.tracer.shape();
    let what = format!("{resolution:?}, {fill} full, seed {seed}, {shape:?}");
    let cell_count: u32 = resolution.iter().product();
    let header = GridHeader { cell_count, resolution, fine_shift: seed as u32 % 6, ..header(&Default::default(), 1.0, [0; 3]) };
    let mut random = Random::new(seed);
    let mut next = 0;
    let mut cells: Vec<[u32; 2]> = (0..cell_count)
        .map(|_| {
            if random.unit() >= fill {
                return [0, 0];
            }
            let begin = next;
            next += 1 + if random.below(20) == 0 { random.below(1_000) } else { random.below(40) };
            [begin, next]
        })
        .collect();
    let count: u32 = brick_resolution(resolution).iter().product();
    let tiles = count.div_ceil(shape.brick_tile()) as usize;
    let len = count as usize;
    // All bricks with a triangle, and some others, whose cells hold what is never looked at.
    let mut used: Vec<u32> = (0..count).map(|_| u32::from(random.below(2) == 0)).collect();
    for (index, _) in cells.iter().enumerate().filter(|(_, range)| range[1] != 0) {
        let brick = cell_of(index as u32, resolution).map(|n| n / 4);
        used[cell_id(brick, brick_resolution(resolution)) as usize] = 1;
    }
    for (index, range) in cells.iter_mut().enumerate() {
        let brick = cell_of(index as u32, resolution).map(|n| n / 4);
        if used[cell_id(brick, brick_resolution(resolution)) as usize] == 0 {
            *range = [0, CANARY];
        }
    }
    let used_memory = gpu.upload("used", &used);
    let grid = gpu.upload("grid", &[header]);
    let cell_memory = gpu.upload("cells", &cells);
    let bricks = gpu.guarded("bricks", 16 * len as u64);
    let partials = gpu.guarded("partials", (size_of::<TileOccupancy>() * tiles) as u64);
    let distances = [gpu.guarded("distances x", 4 * len as u64), gpu.guarded("distances y", 4 * len as u64)];
    let reduce_groups = split_workgroups(tiles as u32, 1);
    let groups = split_workgroups(count, shape.map_size);
    gpu.launch(&BRICK_REDUCE, 0, &[&grid, &used_memory, &cell_memory, &bricks, &partials], &[], reduce_groups);

    let mut expected = vec![Brick::zeroed(); len];
    let mut sums = vec![TileOccupancy::default(); tiles];
    brick_reduce(&shape, reduce_groups, &header, &used, &cells, &mut expected, &mut sums);
    assert_same(&format!("{what}: bricks"), &bricks.read::<Brick>(0, len), &expected);
    assert_same(&format!("{what}: partials"), &partials.read::<TileOccupancy>(0, tiles), &sums);

    // Lists that are short on average, and lists that are long.
    for kept_count in [next, 100 * next] {
        let leaf_state = check_report(gpu, &header, kept_count, &mut sums, &what);
        check_split_cells(gpu, &header, &cells, &expected, &leaf_state, &sums, &what);
    }

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

/// The state of the second level, after comparing it and all else that the kernel writes.
pub fn check_report(gpu: &Gpu, header: &GridHeader, kept_count: u32, sums: &mut [TileOccupancy], what: &str) -> BuildState {
    let shape = gpu.tracer.shape();
    let what = format!("{what}, {kept_count} pairs");
    let state = BuildState { kept_count, overflow: 2, ..BuildState::default() };
    let grid = gpu.upload("grid", &[*header]);
    let main = gpu.upload("state", &[state]);
    let partials = gpu.upload("partials", sums);
    let memory = [
        gpu.guarded("leaf state", size_of::<BuildState>() as u64),
        gpu.upload("leaf arguments", &[LeafArguments::zeroed()]),
        gpu.upload("report", &[Report::zeroed()]),
    ];
    let capacity = 10_000;
    let [leaf_memory, argument_memory, report_memory] = &memory;
    gpu.launch(&REPORT_SPINE, 0, &[&grid, &main, &partials, leaf_memory, argument_memory, report_memory], &[capacity], [1, 1, 1]);
    let (mut leaf_state, mut arguments, mut report) = (BuildState::default(), LeafArguments::zeroed(), Report::zeroed());
    report_spine(&shape, header, &state, sums, &mut leaf_state, &mut arguments, &mut report, capacity);
    assert_same(&format!("{what}: partials"), &partials.read::<TileOccupancy>(0, sums.len()), sums);
    assert_same(&format!("{what}: state"), &leaf_memory.read::<BuildState>(0, 1), &[leaf_state]);
    assert_same(&format!("{what}: arguments"), &argument_memory.read::<LeafArguments>(0, 1), &[arguments]);
    assert_same(&format!("{what}: report"), &report_memory.read::<Report>(0, 1), &[report]);
    leaf_state
}

/// The records are the twin's, and cover the lists of all cells that are long enough, without gap or overlap.
fn check_split_cells(
    gpu: &Gpu,
    header: &GridHeader,
    cells: &[[u32; 2]],
    bricks: &[Brick],
    state: &BuildState,
    sums: &[TileOccupancy],
    what: &str,
) {
    let shape = gpu.tracer.shape();
    let len = state.split_cells as usize;
    let groups = split_workgroups(sums.len() as u32, 1);
    let capacity = 10_000;
    let memory = [
        gpu.upload("grid", &[*header]),
        gpu.upload("leaf state", &[*state]),
        gpu.upload("cells", cells),
        gpu.upload("bricks", bricks),
        gpu.upload("partials", sums),
        gpu.guarded("split cells", ((len + 1) * size_of::<SplitCell>()) as u64),
    ];
    let blocks = (state.offset_count - 1).div_ceil(1 << owner_shift(shape.owner_shift(), state.offset_count - 1)) as usize;
    assert!(blocks <= 1 << 14, "{what}");
    let owners = gpu.guarded("owners", 4 * blocks.max(1) as u64);
    let all: Vec<_> = memory.iter().chain([&owners]).collect();
    gpu.launch(&SPLIT_CELLS, 0, &all, &[capacity], groups);
    let unwritten: SplitCell = bytemuck::cast([CANARY; 8]);
    let mut expected = vec![unwritten; len + 1];
    let mut expected_owners = untouched(blocks.max(1));
    split_cells(&shape, groups, header, state, cells, bricks, sums, &mut expected, &mut expected_owners, capacity);
    assert_same(&format!("{what}: owners"), &owners.read::<u32>(0, blocks.max(1)), &expected_owners);
    assert!(blocks == 0 || !expected_owners.contains(&CANARY), "{what}: a block that no split cell has");
    let found = memory[5].read::<SplitCell>(0, len + 1);
    assert_same(&format!("{what}: split cells"), &found, &expected);
    let (mut references, mut leaves) = (0, 0);
    for (index, record) in found[..len].iter().enumerate() {
        let cell = cell_of(record.cell, header.resolution);
        assert_eq!([record.xy & 0xFFFF, record.xy >> 16, record.z], cell, "{what}: record {index}");
        assert_eq!([record.list_begin, record.list_begin + record.list_length], cells[record.cell as usize], "{what}: record {index}");
        assert_eq!((record.first_reference, record.leaf_begin), (references, leaves), "{what}: record {index}");
        let level = leaf_level(record.list_length, state.least_split, header.fine_shift);
        references += record.list_length;
        leaves += leaf_count_of(level);
        assert_eq!(record.level, if leaves <= capacity { level } else { 0 }, "{what}: record {index}");
    }
    assert_eq!(references, state.offset_count - 1, "{what}");
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
