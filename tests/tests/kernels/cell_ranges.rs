use bytemuck::Zeroable;
use gridwalk::kernels::CELL_RANGES;
use gridwalk::{Report, Shape};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::layout::BuildState;
use gridwalk_core::twin::cell_ranges::cell_ranges;
use gridwalk_tests::gpu::Gpu;
use gridwalk_tests::random::Random;

use super::{TINY, assert_same, devices, many_groups, sizes};

fn check(gpu: &Gpu, cell_count: u32, keys: &[u32], what: &str) {
    let shape = gpu.tracer.shape();
    let count = keys.len() as u32;
    // Of the first level, and of the second, which lies behind another.
    for (first_pair, first_cell) in [(0, 0), (13, 5)] {
        let state = BuildState { pair_count: count + 7, kept_count: count, first_pair, first_cell, ..BuildState::default() };
        let all_keys: Vec<u32> = [vec![7; first_pair as usize], keys.to_vec()].concat();
        let device_state = gpu.upload("state", &[state]);
        let sorted = gpu.upload("keys", &all_keys);
        let mut expected = vec![[0u32; 2]; (first_cell + cell_count) as usize];
        let cells = gpu.upload("cells", &expected);
        let mut report = Report::zeroed();
        let device_report = gpu.upload("report", &[report]);
        let groups = split_workgroups(count.div_ceil(shape.range_pairs), shape.map_size);
        gpu.launch(&CELL_RANGES, 0, &[&device_state, &sorted, &cells, &device_report], &[], groups);
        cell_ranges(&shape, groups, &state, &all_keys, &mut expected, &mut report);
        assert_same(&format!("{what}: cells"), &cells.read::<[u32; 2]>(0, expected.len()), &expected);
        assert_same(&format!("{what}: report"), &device_report.read::<Report>(0, 1), &[report]);
        assert_eq!(report.pairs, if first_cell == 0 { count } else { 0 }, "{what}");
    }
}

/// Sorted keys of `cells` cells.
fn keys(count: u32, cells: u32, seed: u64) -> Vec<u32> {
    let mut random = Random::new(seed);
    let mut keys: Vec<u32> = (0..count).map(|_| random.below(cells)).collect();
    keys.sort_unstable();
    keys
}

#[test]
fn cell_ranges_of_every_size() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        for size in sizes(shape.map_size * shape.range_pairs) {
            for cells in [1, 2, 100] {
                let seed = u64::from(size);
                check(gpu, cells, &keys(size, cells, seed), &format!("{size} pairs, {cells} cells, {shape:?}, seed {seed}"));
            }
        }
        check(gpu, 5, &[4; 300], "one cell alone");
    }
}

#[test]
fn cell_ranges_of_many_pairs() {
    for size in many_groups(TINY.map_size) {
        check(Gpu::with_shape(TINY), 1000, &keys(size, 1000, 1), &format!("{size} pairs"));
    }
    let size = 2_000_003;
    check(Gpu::with_shape(Shape::CPU), 300_000, &keys(size, 300_000, 2), &format!("{size} pairs"));
}
