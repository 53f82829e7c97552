//! Kernels of one workgroup at the largest sizes that the library admits. lavapipe ends all loops of an invocation, silently, after 65,535
//! turns: here it would show.

use gridwalk::kernels::{BOUNDS_SPINE, SCAN_SPINE};
use gridwalk::{MAX_PAIRS, MAX_TRIANGLES, Shape};
use gridwalk_core::gather::gathered_state;
use gridwalk_core::grid::brick_resolution;
use gridwalk_core::layout::{Bounds, BuildState, GridHeader, TileOccupancy};
use gridwalk_core::twin::bounds_spine::bounds_spine;
use gridwalk_core::twin::scan_spine::scan_spine;
use gridwalk_tests::gpu::Gpu;
use gridwalk_tests::random::Random;

use super::{assert_same, header};

fn devices() -> [&'static Gpu; 2] {
    [Shape::CPU, Shape::GPU].map(Gpu::with_shape)
}

#[test]
fn the_largest_scans() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        let table_count = shape.table_entries(MAX_PAIRS) as u32;
        let state = BuildState { offset_count: MAX_TRIANGLES + 1, table_count, ..BuildState::default() };
        let state_memory = gpu.upload("state", &[state]);
        for (which, length) in [(0, state.offset_count), (1, state.table_count)] {
            let mut random = Random::new(which.into());
            let mut sums: Vec<u32> = (0..length.div_ceil(shape.scan_tile())).map(|_| random.below(10_000)).collect();
            let partials = gpu.upload("partials", &sums);
            gpu.launch(&SCAN_SPINE, 0, &[&state_memory, &partials, &state_memory], &[which], [1, 1, 1]);
            scan_spine(&shape, length, &mut sums);
            assert_same(&format!("{length} numbers, {shape:?}"), &partials.read::<u32>(0, sums.len()), &sums);
        }
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
        let scene = gpu.guarded("scene", 32);
        let state = gpu.upload("state", &[gathered_state(MAX_TRIANGLES, MAX_TRIANGLES)]);
        gpu.launch(&BOUNDS_SPINE, 0, &[&state, &partials, &scene], &[], [1, 1, 1]);
        let mut expected = Bounds::EMPTY;
        bounds_spine(&boxes, &mut expected, count);
        assert_same(&format!("{count} tiles, {shape:?}"), &scene.read::<Bounds>(0, 1), &[expected]);
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
