use gridwalk::kernels::LEAF_DISTANCE;
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::grid::cell_of;
use gridwalk_core::layout::{BuildState, SplitCell};
use gridwalk_core::split::{LEAST_MEASURED, MAX_LEVEL, leaf_count_of, max_leaf_distance};
use gridwalk_core::twin::leaf_distance::leaf_distance;
use gridwalk_tests::gpu::Gpu;
use gridwalk_tests::random::Random;

use super::{TINY, assert_same, devices};

const FIRST_CELL: u32 = 11;

/// Split cells of such levels (0: one that stays whole), and the ranges of cells and leaf cells, of which a part lists something.
fn split_cells(levels: &[u32], fill: f32, random: &mut Random) -> (Vec<SplitCell>, Vec<[u32; 2]>) {
    let mut cells = vec![[3, 4]; FIRST_CELL as usize];
    let records = levels
        .iter()
        .map(|level| {
            let leaf_begin = cells.len() as u32 - FIRST_CELL;
            // One that stays whole has no leaf cells of its own: there is no room for them.
            let leaves = if *level == 0 { 0 } else { leaf_count_of(*level) };
            cells.extend((0..leaves).map(|_| if random.unit() < fill { [random.below(5), 5 + random.below(9)] } else { [0, 0] }));
            SplitCell { level: *level, leaf_begin, ..SplitCell::default() }
        })
        .collect();
    cells.push([1, 2]);
    (records, cells)
}

fn check(gpu: &Gpu, levels: &[u32], fill: f32, seed: u64) {
    let shape = gpu.tracer.shape();
    let what = format!("{} split cells, {fill} full, seed {seed}, {shape:?}", levels.len());
    let (records, mut expected) = split_cells(levels, fill, &mut Random::new(seed));
    let state = BuildState { split_cells: levels.len() as u32, first_cell: FIRST_CELL, ..BuildState::default() };
    let memory = [gpu.upload("leaf state", &[state]), gpu.upload("split cells", &records), gpu.upload("cells", &expected)];
    let groups = split_workgroups(levels.len() as u32, shape.measured_cells());
    gpu.launch(&LEAF_DISTANCE, 0, &memory.each_ref(), &[], groups);
    leaf_distance(&shape, groups, &state, &records, &mut expected);
    assert_same(&what, &memory[2].read::<[u32; 2]>(0, expected.len()), &expected);
}

#[test]
fn leaf_cells_of_every_level() {
    for gpu in devices() {
        for (seed, fill) in [0.0, 0.0002, 0.003, 0.05, 1.0].into_iter().enumerate() {
            for levels in [&[5][..], &[4], &[3], &[0, 5, 1, 4, 2, 3, 3, 0, 4, 4, 5, 0]] {
                check(gpu, levels, fill, seed as u64);
            }
        }
        // As many as a workgroup takes, each with as many leaf cells as there can be.
        check(gpu, &[5; 8], 0.001, 9);
    }
}

#[test]
fn leaf_cells_of_many_workgroups() {
    let mut levels = vec![1; 65_540];
    (levels[0], levels[65_534], levels[65_539]) = (4, 4, 5);
    check(Gpu::with_shape(TINY), &levels, 0.002, 10);
}

/// The distance of a leaf cell is what a search through all of its split cell finds.
#[test]
fn leaf_distances_are_the_nearest() {
    let mut random = Random::new(11);
    let levels = [5, 4, 3, 4, 5];
    let (records, before) = split_cells(&levels, 0.001, &mut random);
    let mut cells = before.clone();
    let state = BuildState { split_cells: levels.len() as u32, first_cell: FIRST_CELL, ..BuildState::default() };
    leaf_distance(&TINY, split_workgroups(levels.len() as u32, TINY.measured_cells()), &state, &records, &mut cells);
    let mut seen = [0; max_leaf_distance(MAX_LEVEL) as usize + 1];
    for split in &records {
        let first = (FIRST_CELL + split.leaf_begin) as usize;
        let place = |leaf: usize| cell_of(leaf as u32, [1 << split.level; 3]);
        let leaves = leaf_count_of(split.level) as usize;
        let full: Vec<_> = (0..leaves).filter(|leaf| before[first + leaf][1] != 0).map(place).collect();
        for leaf in 0..leaves {
            let (here, was) = (place(leaf), before[first + leaf]);
            let apart = |there: &[u32; 3]| (0..3).map(|axis| there[axis].abs_diff(here[axis])).max().unwrap();
            let nearest = full.iter().map(apart).min().unwrap_or(u32::MAX).min(max_leaf_distance(split.level.max(LEAST_MEASURED)));
            let measured = was[1] == 0 && nearest > 1 && split.level >= LEAST_MEASURED;
            assert_eq!(cells[first + leaf], if measured { [nearest, 0] } else { was }, "leaf cell {here:?} of level {}", split.level);
            seen[nearest as usize] += 1;
        }
    }
    assert!(seen.iter().all(|count| *count > 0), "leaf cells of each distance: {seen:?}");
}
