use bytemuck::Zeroable;
use gridwalk::kernels::{PAIR_ARGS, SCAN_REDUCE};
use gridwalk::{Report, Shape, split_workgroups};
use gridwalk_core::layout::{BuildState, DispatchArguments};
use gridwalk_core::twin::pair_args::scan_tiles;
use gridwalk_core::twin::scan_reduce::scan_reduce;
use gridwalk_tests::gpu::Gpu;
use gridwalk_tests::random::Random;

use super::{TINY, assert_same, devices, many_groups, sizes};

fn check(gpu: &Gpu, numbers: &[u32], what: &str) {
    let shape = gpu.tracer.shape();
    let length = numbers.len() as u32;
    let groups = gridwalk_core::dispatch::split_workgroups(length, shape.scan_tile());
    assert_eq!(groups, split_workgroups(length.div_ceil(shape.scan_tile())));
    let tiles = length.div_ceil(shape.scan_tile()) as usize;
    let state = gpu.upload("state", &[BuildState { offset_count: length, ..BuildState::default() }]);
    let values = gpu.upload("values", numbers);
    let partials = gpu.guarded("partials", 4 * tiles as u64);
    let arguments = gpu.upload("arguments", &[DispatchArguments::zeroed()]);
    let report = gpu.upload("report", &[Report::zeroed()]);

    let mut expected = numbers.to_vec();
    let mut sums = vec![0; tiles];
    gpu.launch(&SCAN_REDUCE, 0, &[&state, &values, &partials], &[], groups);
    scan_reduce(&shape, groups, length, &expected, &mut sums);
    assert_same(&format!("{what}: reduce"), &partials.read::<u32>(0, tiles), &sums);
    gpu.launch(&PAIR_ARGS, 0, &[&state, &partials, &values, &arguments, &report], &[u32::MAX, 0], groups);
    let sum = scan_tiles(&shape, groups, length, &sums, &mut expected);
    assert_same(&format!("{what}: tiles"), &values.read::<u32>(0, numbers.len()), &expected);
    assert_eq!(report.read::<Report>(0, 1)[0].pair_total, sum, "{what}: the sum of all");

    let total = numbers.iter().scan(0u64, |sum, value| {
        let before = *sum;
        *sum += u64::from(*value);
        Some(before.min(u32::MAX.into()) as u32)
    });
    assert_same(&format!("{what}: against a sum in 64 bits"), &values.read::<u32>(0, numbers.len()), &total.collect::<Vec<_>>());
}

fn numbers(count: u32, limit: u32, seed: u64) -> Vec<u32> {
    let mut random = Random::new(seed);
    (0..count).map(|_| random.below(limit)).collect()
}

#[test]
fn scan_of_every_size() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        for size in sizes(shape.scan_tile()) {
            let seed = u64::from(size);
            check(gpu, &numbers(size, 1000, seed), &format!("{size} numbers, {shape:?}, seed {seed}"));
        }
    }
}

#[test]
fn scan_saturates() {
    for gpu in devices() {
        for seed in 0..4 {
            let size = 10_000;
            // The sum passes 2^32 somewhere in the middle, within a tile, between tiles, or at once.
            let limit = [1 << 20, 1 << 21, 1 << 31, u32::MAX][seed as usize];
            check(gpu, &numbers(size, limit, seed), &format!("numbers below {limit}, seed {seed}, {:?}", gpu.tracer.shape()));
        }
        let mut edge = numbers(5000, 1, 0);
        (edge[17], edge[4000], edge[4001]) = (u32::MAX - 1, 1, 1);
        check(gpu, &edge, "a sum that just reaches the largest number");
    }
}

#[test]
fn scan_of_many_workgroups() {
    let gpu = Gpu::with_shape(TINY);
    for size in many_groups(TINY.scan_tile()) {
        check(gpu, &numbers(size, 100, 5), &format!("{size} numbers"));
    }
}

#[test]
fn scan_of_millions() {
    for (size, shape) in [((1 << 20) - 1, Shape::CPU), ((1 << 20) + 1, Shape::GPU), (5_000_011, Shape::CPU)] {
        check(Gpu::with_shape(shape), &numbers(size, 800, 6), &format!("{size} numbers, {shape:?}"));
    }
}
