use gridwalk::kernels::{CLEAR_BRICKS, CLEAR_CELLS};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::grid::brick_resolution;
use gridwalk_core::layout::GridHeader;
use gridwalk_core::twin::clear_bricks::clear_bricks;
use gridwalk_core::twin::clear_cells::clear_cells;
use gridwalk_tests::gpu::{CANARY, Gpu};
use gridwalk_tests::random::Random;

use super::{TINY, assert_same, devices, header, sizes};

fn check(gpu: &Gpu, resolution: [u32; 3]) {
    let shape = gpu.tracer.shape();
    let what = format!("{resolution:?}, {shape:?}");
    let cell_count: u32 = resolution.iter().product();
    let header = GridHeader { cell_count, resolution, ..header(&Default::default(), 1.0, [0; 3]) };
    let bricks: u32 = brick_resolution(resolution).iter().product();
    let groups = split_workgroups(bricks, shape.map_size);
    let grid = gpu.upload("grid", &[header]);
    let cleared = gpu.guarded("bricks", 4 * u64::from(bricks));
    gpu.launch(&CLEAR_BRICKS, 0, &[&grid, &cleared], &[], groups);
    let mut used = vec![CANARY; bricks as usize];
    clear_bricks(&shape, groups, resolution, &mut used);
    assert_eq!(used, vec![0; bricks as usize]);
    assert_same(&format!("{what}: bricks"), &cleared.read::<u32>(0, bricks as usize), &used);

    let mut random = Random::new(cell_count.into());
    used.fill_with(|| u32::from(random.below(3) == 0));
    let (used_memory, cells) = (gpu.upload("used", &used), gpu.guarded("cells", 8 * u64::from(cell_count)));
    let groups = split_workgroups(4 * bricks, shape.map_size);
    gpu.launch(&CLEAR_CELLS, 0, &[&grid, &used_memory, &cells], &[], groups);
    let mut expected = vec![[CANARY; 2]; cell_count as usize];
    clear_cells(&shape, groups, resolution, &used, &mut expected);
    assert_same(&what, &cells.read::<[u32; 2]>(0, cell_count as usize), &expected);
}

#[test]
fn clear_cells_of_every_size() {
    for gpu in devices() {
        for size in sizes(gpu.tracer.shape().map_size).into_iter().filter(|size| *size > 0) {
            check(gpu, [4 * size - 3, 1, 2]);
            check(gpu, [5, 7, size]);
        }
    }
}

#[test]
fn clear_cells_of_many_workgroups() {
    // A brick a workgroup.
    for resolution in [[4 * 65_535, 1, 1], [161, 160, 160], [256, 260, 256]] {
        check(Gpu::with_shape(TINY), resolution);
    }
}
