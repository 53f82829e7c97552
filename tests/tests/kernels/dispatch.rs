//! Workgroups that are dealt: each index has one, whatever their number.

use gridwalk::Shape;
use gridwalk::kernels::CLEAR_BRICKS;
use gridwalk_core::layout::GridHeader;
use gridwalk_tests::gpu::{CANARY, Gpu};
use gridwalk_tests::random::Random;

use super::{TINY, header};

/// The bricks that a launch of these workgroups, of a brick each, leaves as they were.
fn left(gpu: &Gpu, bricks: u32, groups: [u32; 3]) -> Vec<u32> {
    let resolution = [4 * bricks, 1, 1];
    let grid = gpu.upload("grid", &[GridHeader { cell_count: 4 * bricks, resolution, ..header(&Default::default(), 1.0, [0; 3]) }]);
    let used = gpu.guarded("bricks", 4 * u64::from(bricks));
    gpu.launch(&CLEAR_BRICKS, 0, &[&grid, &used], &[], groups);
    let words = used.read::<u32>(0, bricks as usize);
    assert!(words.iter().all(|word| [0, CANARY].contains(word)));
    (0..bricks).filter(|brick| words[*brick as usize] != 0).collect()
}

#[test]
fn every_workgroup_has_one_place() {
    let seed = 311;
    let mut random = Random::new(seed);
    // Blocks that are short, of four workgroups, of more; what is left over; more than 65,535.
    let around = [64, 256, 512, 1_024, 2_048, 4_096, 65_535, 131_070].into_iter().flat_map(|edge: u32| [edge - 1, edge, edge + 1]);
    let any = std::iter::repeat_with(|| 1 + random.below(140_000)).take(20);
    let all: Vec<u32> = (1..=130).chain(around).chain(any).collect();
    for strands in [1, 2, 3, 64, 1_000] {
        let gpu = Gpu::with_shape(Shape { map_size: 1, strands, ..TINY });
        for groups in &all {
            assert_eq!(left(gpu, *groups, gpu.tracer.shape().deal_workgroups(*groups, 1)), [0; 0], "{groups} workgroups, seed {seed}");
        }
    }
}

#[test]
fn a_workgroup_too_few_leaves_a_brick() {
    for strands in [1, 2, 3, 64] {
        let gpu = Gpu::with_shape(Shape { map_size: 1, strands, ..TINY });
        for bricks in [5_000_u32, 131_070] {
            let [x, y, z] = gpu.tracer.shape().deal_workgroups(bricks, 1);
            assert!(!left(gpu, bricks, [x - 1, y, z]).is_empty(), "{bricks} bricks, {strands} strands");
        }
    }
}
