use gridwalk::kernels::CLEAR_CELLS;
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::layout::GridHeader;
use gridwalk_core::twin::clear_cells::{CELLS_EACH, clear_cells};
use gridwalk_tests::gpu::{CANARY, Gpu};

use super::{TINY, assert_same, devices, header, many_groups, sizes};

fn check(gpu: &Gpu, cell_count: u32) {
    let shape = gpu.tracer.shape();
    let header = GridHeader { cell_count, ..header(&Default::default(), 1.0, [0; 3]) };
    let size = cell_count.next_multiple_of(CELLS_EACH) as usize;
    let grid = gpu.upload("grid", &[header]);
    let cells = gpu.guarded("cells", 8 * size as u64);
    let groups = split_workgroups(cell_count.div_ceil(CELLS_EACH), shape.map_size);
    gpu.launch(&CLEAR_CELLS, 0, &[&grid, &cells], &[], groups);
    let mut expected = vec![[CANARY; 2]; size];
    clear_cells(&shape, groups, cell_count, &mut expected);
    assert_same(&format!("{cell_count} cells, {shape:?}"), &cells.read::<[u32; 2]>(0, size), &expected);
}

#[test]
fn clear_cells_of_every_size() {
    for gpu in devices() {
        for size in sizes(gpu.tracer.shape().map_size * CELLS_EACH) {
            check(gpu, size);
        }
    }
}

#[test]
fn clear_cells_of_many_workgroups() {
    for size in many_groups(TINY.map_size * CELLS_EACH) {
        check(Gpu::with_shape(TINY), size);
    }
}
