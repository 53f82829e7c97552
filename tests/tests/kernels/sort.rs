use gridwalk::Shape;
use gridwalk::kernels::{SORT_HISTOGRAM, SORT_SCATTER, TABLE_SCAN};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::layout::BuildState;
use gridwalk_core::sort::{passes_of, writes_a};
use gridwalk_core::twin::sort_histogram::sort_histogram;
use gridwalk_core::twin::sort_scatter::{Pairs, sort_scatter};
use gridwalk_core::twin::table_scan::table_scan;
use gridwalk_tests::gpu::{CANARY, Gpu};
use gridwalk_tests::random::Random;

use super::{ODD, TINY, assert_same, devices, many_groups, sizes};

/// Key of a pair without a cell.
const SENTINEL: u32 = 123_456_789;

/// Sorts pairs (key, place) as a build does and compares with the twins after each pass, and in the end with a stable sort.
fn check(gpu: &Gpu, keys: &[u32], key_bits: u32, what: &str) {
    let shape = gpu.tracer.shape();
    let count = keys.len() as u32;
    let tiles = shape.most_sort_tiles(count);
    let (pass_count, digit_bits) = passes_of(key_bits, shape.sort_bits);
    let table_count = tiles << digit_bits;
    let kept_count = keys.iter().filter(|key| **key != SENTINEL).count() as u32;
    let mut state =
        BuildState { pair_count: count, kept_count: count, key_bits, pass_count, digit_bits, sentinel: SENTINEL, ..BuildState::default() };
    let device_state = gpu.upload("state", &[state]);
    let table = gpu.guarded("table", 4 * u64::from(table_count));
    let sums = gpu.guarded("sums", 4 << digit_bits);
    let places: Vec<u32> = (0..count).collect();
    let empty = vec![CANARY; keys.len()];
    let in_a = writes_a(pass_count, 0);
    let [(keys_a, values_a), (keys_b, values_b)] = [in_a, !in_a].map(|full| {
        let of = |data| gpu.upload("pairs", if full { data } else { &empty });
        (of(keys), of(&places))
    });
    let (mut from, mut to) = ((keys.to_vec(), places), (empty.clone(), empty.clone()));
    let mut expected = vec![CANARY; table_count as usize];
    let mut expected_sums = vec![CANARY; 1 << digit_bits];
    for pass in 0..pass_count {
        let groups = shape.sort_workgroups(count);
        let scan_groups = split_workgroups(1 << digit_bits, shape.table_rows());
        gpu.launch(&SORT_HISTOGRAM, 0, &[&device_state, &keys_a, &keys_b, &table], &[pass], groups);
        sort_histogram(&shape, groups, &state, &from.0, &mut expected, pass);
        assert_same(&format!("{what}: histogram of pass {pass}"), &table.read::<u32>(0, expected.len()), &expected);
        gpu.launch(&TABLE_SCAN, 0, &[&device_state, &table, &sums], &[pass], scan_groups);
        table_scan(&shape, scan_groups, &state, &mut expected, &mut expected_sums, pass);
        assert_same(&format!("{what}: table of pass {pass}"), &table.read::<u32>(0, expected.len()), &expected);
        assert_same(&format!("{what}: sums of pass {pass}"), &sums.read::<u32>(0, expected_sums.len()), &expected_sums);
        let memory = [&device_state, &keys_a, &keys_b, &values_a, &values_b, &table, &sums, &device_state];
        gpu.launch(&SORT_SCATTER, 0, &memory, &[pass], groups);
        let pairs = Pairs { keys: from.0.as_slice(), values: from.1.as_slice() };
        sort_scatter(&shape, groups, &mut state, &pairs, &mut to.0, &mut to.1, &expected, &expected_sums, pass);
        if pass == 0 {
            assert_eq!(device_state.read::<BuildState>(0, 1)[0].kept_count, kept_count, "{what}");
            assert_eq!(state.kept_count, kept_count, "{what}");
        }
        let (found_keys, found_values) = if writes_a(pass_count, pass + 1) { (&keys_a, &values_a) } else { (&keys_b, &values_b) };
        assert_same(&format!("{what}: keys of pass {pass}"), &found_keys.read::<u32>(0, keys.len()), &to.0);
        assert_same(&format!("{what}: values of pass {pass}"), &found_values.read::<u32>(0, keys.len()), &to.1);
        std::mem::swap(&mut from, &mut to);
    }
    let kept = |place: &u32| pass_count == 0 || keys[*place as usize] != SENTINEL;
    let mut expected: Vec<u32> = (0..count).filter(kept).collect();
    expected.sort_by_key(|place| keys[*place as usize]);
    assert_same(&format!("{what}: against a stable sort"), &values_b.read::<u32>(0, expected.len()), &expected);
}

fn keys(count: u32, bits: u32, seed: u64) -> Vec<u32> {
    let mut random = Random::new(seed);
    (0..count).map(|_| random.below(1 << bits)).collect()
}

#[test]
fn sort_of_every_size() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        for size in sizes(shape.sort_tile()) {
            let seed = u64::from(size);
            check(gpu, &keys(size, 9, seed), 9, &format!("{size} pairs, {shape:?}, seed {seed}"));
        }
    }
}

#[test]
fn sort_of_every_number_of_key_bits() {
    for shape in [Shape::CPU, Shape::GPU, ODD, Shape { sort_alone: false, ..ODD }] {
        let gpu = Gpu::with_shape(shape);
        for bits in 0..=28 {
            let seed = u64::from(bits);
            check(gpu, &keys(2_000, bits, seed), bits, &format!("{bits} bits, {shape:?}, seed {seed}"));
        }
    }
}

#[test]
fn sort_of_special_orders() {
    let count = 9_001;
    let orders: [(&str, Vec<u32>); 6] = [
        ("all equal", vec![77; count]),
        ("all the largest", vec![(1 << 17) - 1; count]),
        ("sorted", (0..count as u32).map(|i| i * 13).collect()),
        ("reverse", (0..count as u32).rev().map(|i| i * 13).collect()),
        ("few distinct", keys(count as u32, 2, 1).into_iter().map(|key| key * 40_000).collect()),
        ("by turns", (0..count as u32).map(|i| i % 2 * 100_000).collect()),
    ];
    for gpu in devices() {
        for (name, keys) in &orders {
            check(gpu, keys, 17, &format!("{name}, {:?}", gpu.tracer.shape()));
        }
    }
}

#[test]
fn sort_leaves_pairs_without_a_cell_behind() {
    for gpu in devices() {
        for (part, seed) in [(0, 5), (1, 6), (50, 7), (99, 8), (100, 9)] {
            let mut random = Random::new(seed);
            let mut keys = keys(20_000, 17, seed);
            for key in &mut keys {
                if random.below(100) < part {
                    *key = SENTINEL;
                }
            }
            check(gpu, &keys, 17, &format!("{part} % without a cell, seed {seed}, {:?}", gpu.tracer.shape()));
        }
    }
}

#[test]
fn sort_of_many_workgroups() {
    let gpu = Gpu::with_shape(TINY);
    for size in many_groups(TINY.sort_tile()) {
        check(gpu, &keys(size, 4, 2), 4, &format!("{size} pairs"));
    }
}

#[test]
fn sort_of_millions() {
    for (size, shape) in [((1 << 20) - 1, Shape::GPU), ((1 << 20) + 1, Shape::CPU), (3_000_017, Shape::CPU)] {
        check(Gpu::with_shape(shape), &keys(size, 16, 3), 16, &format!("{size} pairs, {shape:?}"));
    }
}

#[test]
fn a_wrong_order_is_noticed() {
    let found = std::panic::catch_unwind(|| assert_same("order", &[1, 3, 2], &[1, 2, 3]));
    assert!(found.is_err());
}
