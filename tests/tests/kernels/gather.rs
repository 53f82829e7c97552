use bytemuck::Zeroable;
use gridwalk::GeometryRecord;
use gridwalk::ash::vk::DeviceAddress;
use gridwalk::kernels::{GATHER, GATHER_RECORDS, GEOMETRY_SCAN};
use gridwalk::{MAX_GEOMETRIES, Shape, split_workgroups};
use gridwalk_core::geometry::*;
use gridwalk_core::layout::{Bounds, BuildState, DispatchArguments, OVERFLOW_TRIANGLES};
use gridwalk_core::twin::gather::gather;
use gridwalk_core::twin::gather_records::gather_records;
use gridwalk_core::twin::geometry_scan::geometry_scan;
use gridwalk_tests::gpu::{Gpu, Guarded};
use gridwalk_tests::meshes::{soup, spoil};
use gridwalk_tests::random::Random;

use super::{TINY, assert_same, devices, many_groups, sizes, untouched};

#[test]
fn gather_of_every_size() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        let many = if shape == TINY { many_groups(TINY.bounds_tile()).to_vec() } else { Vec::new() };
        for size in sizes(shape.bounds_tile()).into_iter().chain(many) {
            let mut mesh = soup(size as usize, 0.1, u64::from(size));
            spoil(&mut mesh, 5, u64::from(size));
            let vertices = mesh.positions.len() as u32;
            let positions = gpu.upload("positions", &mesh.positions);
            let indices = gpu.upload("indices", &mesh.indices);
            let triangles = gpu.guarded("triangles", 48 * u64::from(size.max(1)));
            let state = gpu.guarded("state", size_of::<BuildState>() as u64);
            let tiles = shape.bounds_tiles(size);
            let partials = gpu.guarded("partials", 32 * u64::from(tiles));
            let groups = split_workgroups(tiles);
            gpu.launch(&GATHER, 0, &[&positions, &indices, &triangles, &state, &partials], &[vertices, size], groups);
            let mut expected = vec![[0.0; 4]; 3 * size as usize];
            let mut expected_state = BuildState::default();
            let (positions, indices) = (bytemuck::cast_slice(&mesh.positions), bytemuck::cast_slice(&mesh.indices));
            let mut boxes = vec![Bounds::zeroed(); tiles as usize];
            gather(&shape, groups, positions, indices, &mut expected, &mut expected_state, &mut boxes, vertices, size);
            let what = format!("{size} triangles, {shape:?}");
            assert_same(&what, &triangles.read::<u32>(0, 12 * size as usize), bytemuck::cast_slice(&expected));
            assert_same(&what, &state.read::<BuildState>(0, 1), &[expected_state]);
            assert_same(&what, &partials.read::<Bounds>(0, boxes.len()), &boxes);
        }
    }
}

/// Memory that records name, on the device and as the twin reads it.
struct Pool {
    memory: Guarded,
    words: Vec<u32>,
}

impl Pool {
    fn new(gpu: &Gpu, words: Vec<u32>) -> Pool {
        Pool { memory: gpu.upload("geometry", &words), words }
    }

    fn address(&self) -> DeviceAddress {
        self.memory.region().address
    }

    fn addressed(&self) -> AddressedMemory {
        let mut memory = AddressedMemory::default();
        memory.add(self.address(), self.words.clone());
        memory
    }
}

/// Counts, first triangles and arguments of some records; returns the state and the first triangles.
fn scan(gpu: &Gpu, pool: &Pool, records: &[GeometryRecord], capacity: u32, what: &str) -> (BuildState, Vec<u32>) {
    let shape = gpu.tracer.shape();
    let device_records = gpu.upload("records", records);
    let firsts = gpu.guarded("firsts", 4 * (records.len() as u64 + 1));
    let state = gpu.guarded("state", size_of::<BuildState>() as u64);
    let zero: DispatchArguments = bytemuck::Zeroable::zeroed();
    let arguments = gpu.upload("arguments", &[zero]);
    let words = [records.len() as u32, capacity];
    gpu.launch(&GEOMETRY_SCAN, 0, &[&device_records, &firsts, &state, &arguments], &words, [1, 1, 1]);
    let mut expected = untouched(records.len() + 1);
    let (mut expected_state, mut expected_arguments) = (BuildState::default(), zero);
    geometry_scan(&shape, &pool.addressed(), records, &mut expected, &mut expected_state, &mut expected_arguments, capacity);
    assert_same(&format!("{what}: firsts"), &firsts.read::<u32>(0, expected.len()), &expected);
    assert_same(&format!("{what}: state"), &state.read::<BuildState>(0, 1), &[expected_state]);
    assert_same(&format!("{what}: arguments"), &arguments.read::<DispatchArguments>(0, 1), &[expected_arguments]);
    (expected_state, expected)
}

/// Records over a pool of random words, whose indices are mostly in range.
fn random_records(random: &mut Random, address: u64, words: u32, count: usize, each: u32) -> Vec<GeometryRecord> {
    (0..count)
        .map(|id| {
            let triangle_count = random.below(each + 1);
            let [format, index_type] = [random.below(3), random.below(3)];
            let half = words / 2;
            let mut word = |below: u32| 4 * u64::from(random.below(below));
            let (positions, indices) =
                (address + word(half / 2), address + word(half / 2) + if index_type == INDEX_UINT16 { 2 } else { 0 });
            let counted = word(3) == 0;
            let count = if counted { address + word(words) } else { 0 };
            let stride = 12 + 4 * random.below(3);
            GeometryRecord {
                transform: std::array::from_fn(|_| std::array::from_fn(|_| random.range(-2.0, 2.0))),
                scale: random.point(-1.0, 2.0),
                stride,
                offset: random.point(-1.0, 1.0),
                vertex_count: half / 2 * 4 / stride,
                positions,
                indices,
                count,
                triangle_count: triangle_count.min(half / 6),
                format,
                index_type,
                id: 1_000 + id as u32,
                mask: 1 << (id % 32),
                flags: random.below(4),
            }
        })
        .collect()
}

/// Words that are small numbers, as floats, as pairs of halves and as pairs of indices alike, and now and then anything.
fn random_words(random: &mut Random, count: u32, vertices: u32) -> Vec<u32> {
    (0..count)
        .map(|_| match random.below(8) {
            0 => random.below(u32::MAX),
            1 | 2 => random.range(-1.0, 1.0).to_bits(),
            3 => f32::NAN.to_bits(),
            _ => random.below(vertices) | random.below(vertices) << 16,
        })
        .collect()
}

#[test]
fn records_of_every_kind() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        for (seed, count) in [0_usize, 1, 2, 3, 17, 63, 300, 2_000].into_iter().enumerate() {
            let mut random = Random::new(100 + seed as u64);
            let words = 40_000;
            let values = random_words(&mut random, words, 150);
            let pool = Pool::new(gpu, values);
            let mut records = random_records(&mut random, pool.address(), words, count, 200);
            // Runs without a triangle, in front and behind.
            records.iter_mut().take(count / 5).for_each(|record| record.triangle_count = 0);
            records.iter_mut().rev().take(count / 7).for_each(|record| record.triangle_count = 0);
            let total: u32 = records.iter().map(|record| count_of(&pool.addressed(), record)).sum();
            for capacity in [total, total / 2, total + 100] {
                let capacity = capacity.max(count as u32);
                let what = format!("{count} records, {total} triangles of {capacity}, {shape:?}");
                let (state, firsts) = scan(gpu, &pool, &records, capacity, &what);
                assert_eq!(state.overflow, if total > capacity { OVERFLOW_TRIANGLES } else { 0 }, "{what}");
                let device_records = gpu.upload("records", &records);
                let device_firsts = gpu.upload("firsts", &firsts);
                let device_state = gpu.upload("state", &[state]);
                let triangles = gpu.guarded("triangles", 48 * u64::from(capacity.max(1)));
                let tiles = shape.bounds_tiles(state.triangle_count);
                let partials = gpu.guarded("partials", 32 * u64::from(tiles));
                let groups = split_workgroups(tiles);
                let memory = [&device_records, &device_firsts, &device_state, &triangles, &partials];
                gpu.launch(&GATHER_RECORDS, 0, &memory, &[records.len() as u32], groups);
                let mut expected: Vec<[f32; 4]> = bytemuck::cast_slice(&untouched(12 * capacity as usize)).to_vec();
                let mut boxes = vec![Bounds::zeroed(); tiles as usize];
                gather_records(&shape, groups, &pool.addressed(), &records, &firsts, state.triangle_count, &mut expected, &mut boxes);
                assert_same(&what, &partials.read::<Bounds>(0, boxes.len()), &boxes);
                let found: Vec<[u32; 4]> = triangles.read(0, expected.len());
                // A device may take denormals for zero, of either sign.
                let flush = |x: u32| if x & 0x7F80_0000 == 0 { 0 } else { x };
                let plain = |v: [u32; 4]| [flush(v[0]), flush(v[1]), flush(v[2]), v[3]];
                let found: Vec<_> = found.into_iter().map(plain).collect();
                let expected: Vec<_> = expected.into_iter().map(|v| plain(v.map(f32::to_bits))).collect();
                assert_same(&what, &found, &expected);
                if count > 100 {
                    let dropped = expected.iter().step_by(3).filter(|v| v[3] >> 31 != 0).count() as u32;
                    assert!(dropped > 0 && dropped < state.triangle_count.min(capacity), "{what}: {dropped} dropped");
                }
            }
        }
    }
}

#[test]
fn the_most_geometries() {
    for gpu in [Gpu::with_shape(Shape::CPU), Gpu::with_shape(Shape::GPU), Gpu::with_shape(TINY)] {
        let pool = Pool::new(gpu, vec![3; 16]);
        let mut random = Random::new(5);
        let record = |i: u32| GeometryRecord {
            triangle_count: i % 5,
            count: if i.is_multiple_of(3) { pool.address() } else { 0 },
            ..Default::default()
        };
        let mut records: Vec<_> = (0..MAX_GEOMETRIES).map(record).collect();
        scan(gpu, &pool, &records, 1 << 20, "the most geometries");
        // Their sum does not overflow.
        records.iter_mut().for_each(|record| record.triangle_count = 1 << random.below(32));
        let (state, _) = scan(gpu, &pool, &records, 1 << 20, "the most triangles");
        assert_eq!((state.triangle_count, state.triangle_total), (1 << 20, u32::MAX));
    }
}
