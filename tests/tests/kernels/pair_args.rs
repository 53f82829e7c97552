use bytemuck::Zeroable;
use gridwalk::Report;
use gridwalk::kernels::PAIR_ARGS;
use gridwalk_core::layout::{BuildState, DispatchArguments, MAX_PASSES};
use gridwalk_core::twin::pair_args::pair_args;
use gridwalk_tests::gpu::Gpu;

use super::{assert_same, devices};

fn check(gpu: &Gpu, total: u32, capacity: u32, passes: u32, has_large: u32) {
    let shape = gpu.tracer.shape();
    let what = format!("{total} pairs, capacity {capacity}, {passes} passes, large {has_large}, {shape:?}");
    let digit_bits = shape.sort_bits - 1;
    let mut state =
        BuildState { triangle_count: 2, offset_count: 3, pass_count: passes, digit_bits, has_large, overflow: 2, ..BuildState::default() };
    let mut arguments = DispatchArguments::zeroed();
    let mut report = Report { overflow: 2, ..Report::zeroed() };
    let mut offsets = [total.min(1), total.saturating_sub(1), 0];
    let device_state = gpu.upload("state", &[state]);
    let device_offsets = gpu.upload("offsets", &offsets);
    let partials = gpu.upload("partials", &[total]);
    let device_arguments = gpu.upload("arguments", &[arguments]);
    let device_report = gpu.upload("report", &[report]);
    let pass_capacity = (passes + 1).min(MAX_PASSES as u32);
    let memory = [&device_state, &partials, &device_offsets, &device_arguments, &device_report];
    gpu.launch(&PAIR_ARGS, 0, &memory, &[capacity, pass_capacity], [1, 1, 1]);
    pair_args(&shape, [1, 1, 1], &mut state, &[total], &mut offsets, &mut arguments, &mut report, capacity, pass_capacity);
    assert_eq!(offsets[2], total, "{what}");
    assert_same(&format!("{what}: offsets"), &device_offsets.read::<u32>(0, 3), &offsets);
    assert_same(&format!("{what}: state"), &device_state.read::<BuildState>(0, 1), &[state]);
    assert_same(&format!("{what}: arguments"), &device_arguments.read::<DispatchArguments>(0, 1), &[arguments]);
    assert_same(&format!("{what}: report"), &device_report.read::<Report>(0, 1), &[report]);
    let groups: u64 = arguments.emit_large[..3].iter().copied().map(u64::from).product();
    assert!(has_large == 0 || groups * u64::from(shape.map_size * shape.emit_pairs) >= u64::from(total.min(capacity)), "{what}");
}

#[test]
fn pair_args_of_every_size() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        let group = shape.map_size * shape.emit_pairs;
        let edges = [1, 64, shape.sort_tile(), 65_535 * shape.map_size, 1 << 20, 1 << 28, u32::MAX - 1];
        let mut totals: Vec<u32> = edges.iter().flat_map(|edge| [edge - 1, *edge, edge + 1]).collect();
        // Beyond 65,535 workgroups of the emission.
        totals.extend((65_534..65_537).filter_map(|groups| group.checked_mul(groups)));
        for total in totals {
            // Shapes this small run out of numbers of workgroups; no build uses them for so many pairs.
            let capacity = if shape.sort_tile() < 64 { 1 << 24 } else { 1 << 28 };
            for capacity in [0, 1000, capacity] {
                check(gpu, total, capacity, total % 8, total / 8 % 2);
            }
        }
    }
}
