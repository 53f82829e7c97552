//! Kernels of one workgroup, or of one a row, at the largest sizes that the library admits. lavapipe ends all loops of an invocation, silently,
//! after 65,535 turns: here it would show.

use gridwalk::kernels::TABLE_SCAN;
use gridwalk::{MAX_PAIRS, MAX_TRIANGLES, Shape};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::gather::gathered_state;
use gridwalk_core::grid::brick_resolution;
use gridwalk_core::layout::{Bounds, BuildState, GridHeader, TileOccupancy};
use gridwalk_core::twin::configure::unite_bounds;
use gridwalk_core::twin::table_scan::table_scan;
use gridwalk_tests::gpu::Gpu;
use gridwalk_tests::random::Random;

use super::{assert_same, header, united};

fn devices() -> [&'static Gpu; 2] {
    [Shape::CPU, Shape::GPU].map(Gpu::with_shape)
}

#[test]
fn the_largest_digit_table() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        let (tiles, digit_bits) = (MAX_PAIRS.div_ceil(shape.sort_tile_of(MAX_PAIRS)), 3);
        let mut random = Random::new(1);
        let mut counts: Vec<u32> = (0..tiles << digit_bits).map(|_| random.below(10_000)).collect();
        let mut sums = vec![0; 1 << digit_bits];
        let state = BuildState { pair_count: MAX_PAIRS, digit_bits, ..BuildState::default() };
        let state_memory = gpu.upload("state", &[state]);
        let (table, sums_memory) = (gpu.upload("table", &counts), gpu.guarded("sums", 4 << digit_bits));
        let groups = split_workgroups(1 << digit_bits, shape.table_rows());
        gpu.launch(&TABLE_SCAN, 0, &[&state_memory, &table, &sums_memory], &[0], groups);
        table_scan(&shape, groups, &state, &mut counts, &mut sums, 0);
        assert_same(&format!("{tiles} tiles, {shape:?}"), &table.read::<u32>(0, counts.len()), &counts);
        assert_same(&format!("{tiles} tiles, {shape:?}: sums"), &sums_memory.read::<u32>(0, sums.len()), &sums);
    }
}

#[test]
fn the_largest_scene_box() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        let count = shape.bounds_tiles(MAX_TRIANGLES);
        let mut random = Random::new(1);
        let mut corner = || random.point(-1.0, 1.0);
        let boxes: Vec<Bounds> = (0..count).map(|i| Bounds { low: corner(), dropped: i % 3, high: corner(), reserved: 0 }).collect();
        let partials = gpu.upload("partials", &boxes);
        let state = gpu.upload("state", &[gathered_state(MAX_TRIANGLES, MAX_TRIANGLES)]);
        let expected = unite_bounds(&boxes, count);
        assert_same(&format!("{count} tiles, {shape:?}"), &[united(gpu, &state, &partials)], &[expected]);
    }
}

#[test]
fn the_largest_report() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        for resolution in [[4096, 4096, 16], [645, 645, 645]] {
            let grid = GridHeader { resolution, cell_count: resolution.iter().product(), ..header(&Default::default(), 1.0, [0; 3]) };
            let bricks: u32 = brick_resolution(resolution).iter().product();
            let mut random = Random::new(2);
            let partials: Vec<TileOccupancy> = (0..bricks.div_ceil(shape.brick_tile()))
                .map(|_| TileOccupancy {
                    cells_in_use: random.below(4_000),
                    longest_list: random.below(1 << 20),
                    split_cells: [random.below(400), random.below(200)],
                    split_references: [random.below(600), random.below(400)],
                    leaf_cells: [random.below(1 << 18), random.below(1 << 10)],
                    ..TileOccupancy::default()
                })
                .collect();
            for kept_count in [1000, 1 << 28] {
                super::bricks::check_report(gpu, &grid, kept_count, &mut partials.clone(), &format!("{resolution:?}, {shape:?}"));
            }
        }
    }
}
