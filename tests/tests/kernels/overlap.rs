use gridwalk::Shape;
use gridwalk::kernels::{OVERLAP_COUNT, OVERLAP_EMIT, OVERLAP_EMIT_LARGE};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::gather::gathered_state;
use gridwalk_core::grid::{brick_resolution, cell_id, cell_of};
use gridwalk_core::layout::{BuildState, GridHeader};
use gridwalk_core::overlap::{SeparatingAxes, triangle_cells, triangle_overlaps_cell};
use gridwalk_core::sort::writes_a;
use gridwalk_core::twin::overlap_count::overlap_count;
use gridwalk_core::twin::overlap_emit::{Emission, overlap_emit, overlap_emit_large};
use gridwalk_core::twin::pair_args::exclusive_scan;
use gridwalk_tests::gpu::{CANARY, Gpu, Mesh};
use gridwalk_tests::meshes::{soup, spoil};
use gridwalk_tests::random::Random;

use crate::rebuild::invariants::{cell_box, overlaps};

use super::{TINY, assert_same, devices, gathered, header, many_groups, sizes, untouched};

/// What the count leaves for the emission.
struct Counted {
    triangles: Vec<[f32; 4]>,
    offsets: Vec<u32>,
    boxes: Vec<[u32; 3]>,
    used: Vec<u32>,
    state: BuildState,
}

/// Counts on the device and compares.
fn count(gpu: &Gpu, mesh: &Mesh, header: &GridHeader, exact: bool, what: &str) -> Counted {
    let shape = gpu.tracer.shape();
    let count = mesh.indices.len() as u32;
    let mut triangles = gathered(mesh);
    let mut state = gathered_state(count, count);
    let grid = gpu.upload("grid", &[*header]);
    let device_state = gpu.upload("state", &[state]);
    let moved = gpu.upload("triangles", &triangles);
    let counts = gpu.guarded("counts", 4 * (u64::from(count) + 1));
    let device_boxes = gpu.guarded("boxes", 12 * u64::from(count.max(1)));
    let groups = split_workgroups(count + 1, shape.map_size);
    let mut used = vec![0; brick_resolution(header.resolution).iter().product::<u32>() as usize];
    let device_used = gpu.upload("used", &used);
    gpu.launch(&OVERLAP_COUNT, exact.into(), &[&grid, &device_state, &moved, &counts, &device_boxes, &device_used], &[], groups);
    let (mut offsets, mut boxes) = (untouched(count as usize + 1), vec![[CANARY; 3]; count.max(1) as usize]);
    overlap_count(&shape, groups, exact, header, &mut state, &mut triangles, &mut offsets, &mut boxes, &mut used);
    assert_same(&format!("{what}: used bricks"), &device_used.read::<u32>(0, used.len()), &used);
    assert_same(&format!("{what}: counts"), &counts.read::<u32>(0, offsets.len()), &offsets);
    assert_same(&format!("{what}: boxes"), &device_boxes.read::<[u32; 3]>(0, boxes.len()), &boxes);
    assert_same(&format!("{what}: state"), &device_state.read::<BuildState>(0, 1), &[state]);
    let found: Vec<u32> = moved.read(0, 4 * triangles.len());
    assert_same(&format!("{what}: triangles"), &found, bytemuck::cast_slice(&triangles));
    exclusive_scan(&mut offsets, 0);
    Counted { triangles, offsets, boxes, used, state }
}

/// Emits on the device and compares, for a capacity of `part` of the pairs.
fn emit(gpu: &Gpu, header: &GridHeader, counted: &Counted, exact: bool, part: f64, what: &str) {
    let shape = gpu.tracer.shape();
    let Counted { triangles, offsets, boxes, used, state } = counted;
    let total = offsets[offsets.len() - 1];
    let pair_count = (f64::from(total) * part) as u32;
    let size = 4 * u64::from(pair_count.max(1));
    let pass_count = if exact { 3 } else { 2 };
    let grid = gpu.upload("grid", &[*header]);
    let device_offsets = gpu.upload("offsets", offsets);
    let device_boxes = gpu.upload("boxes", boxes);
    let device_triangles = gpu.upload("triangles", triangles);
    let device_state = gpu.upload("state", &[BuildState { pair_count, pass_count, ..*state }]);
    let [a, b, c, d] = ["keys a", "keys b", "values a", "values b"].map(|name| gpu.guarded(name, size));
    let memory = [&grid, &device_state, &device_offsets, &device_boxes, &a, &b, &c, &d];
    let groups = split_workgroups(state.offset_count, shape.map_size);
    let runs = split_workgroups(pair_count.div_ceil(shape.emit_pairs), shape.map_size);
    gpu.launch(&OVERLAP_EMIT, 0, &memory, &[], groups);
    let (mut used, device_used) = (used.clone(), gpu.upload("used", used));
    let of_large = [&grid, &device_state, &device_offsets, &device_triangles, &a, &b, &c, &d, &device_used];
    gpu.launch(&OVERLAP_EMIT_LARGE, exact.into(), &of_large, &[], runs);
    let count = pair_count as usize;
    let (mut keys, mut values) = (untouched(count), untouched(count));
    let (keys_of, values_of) = (&mut keys, &mut values);
    let used_of = &mut used;
    let mut emission = Emission { grid: header, pair_count, offsets, boxes, triangles, keys: keys_of, values: values_of, used: used_of };
    overlap_emit(&shape, groups, &mut emission);
    overlap_emit_large(&shape, runs, exact, &mut emission);
    let (written, left) = if writes_a(pass_count, 0) { ([&a, &c], [&b, &d]) } else { ([&b, &d], [&a, &c]) };
    let what = format!("{what}, {pair_count} of {total} pairs, exact {exact}");
    assert!(!keys.contains(&CANARY), "{what}: a pair that no triangle wrote");
    assert_same(&format!("{what}: triangles of pairs"), &written[1].read::<u32>(0, count), &values);
    assert_same(&format!("{what}: keys"), &written[0].read::<u32>(0, count), &keys);
    assert_same(&format!("{what}: used bricks"), &device_used.read::<u32>(0, used.len()), &used);
    for key in keys.iter().filter(|key| **key != header.cell_count) {
        let brick = cell_of(*key, header.resolution).map(|n| n / 4);
        assert_eq!(used[cell_id(brick, brick_resolution(header.resolution)) as usize], 1, "{what}: the brick of a cell that is listed");
    }
    for memory in left {
        assert_same(&format!("{what}: the other buffer"), &memory.read::<u32>(0, count), &untouched(count));
    }
}

fn check(gpu: &Gpu, mesh: &Mesh, density: f32, fixed: [u32; 3], parts: &[f64], what: &str) {
    let header = header(mesh, density, fixed);
    let what = format!("{what}, {:?}, {:?}", header.resolution, gpu.tracer.shape());
    for exact in [false, true] {
        let counted = count(gpu, mesh, &header, exact, &format!("{what}, exact {exact}"));
        for part in parts {
            emit(gpu, &header, &counted, exact, *part, &what);
        }
    }
}

#[test]
fn overlap_of_every_size() {
    for gpu in devices() {
        for size in sizes(gpu.tracer.shape().map_size) {
            let mut mesh = soup(size as usize, 0.2, u64::from(size));
            if size % 2 == 1 {
                spoil(&mut mesh, 3, u64::from(size));
            }
            check(gpu, &mesh, 8.0, [0; 3], &[1.0], &format!("{size} triangles"));
        }
    }
}

#[test]
fn overlap_with_empty_runs_and_cut_capacities() {
    for gpu in devices() {
        // Long runs without a pair, in front, in between and behind.
        let mut mesh = soup(3_000, 0.1, 11);
        for triangle in (0..500).chain(700..701).chain(900..2_000).chain(2_950..3_000) {
            mesh.indices[triangle][1] = u32::MAX;
        }
        check(gpu, &mesh, 6.0, [0; 3], &[0.0, 0.0001, 0.37, 0.999, 1.0], "runs of dropped triangles");
    }
}

#[test]
fn overlap_of_huge_triangles() {
    let mut random = Random::new(12);
    let mut triangles: Vec<_> = (0..300).map(|_| std::array::from_fn(|_| random.point(-0.1, 0.1))).collect();
    // Boxes of a million cells and more, one of them along a diagonal.
    triangles.insert(100, [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 0.5]]);
    triangles.push([[-1.0, 0.01, -1.0], [1.0, 0.01, -1.0], [0.0, 0.01, 1.0]]);
    let mesh = Mesh::from_triangles(&triangles);
    check(Gpu::with_shape(Shape::CPU), &mesh, 0.0, [128, 128, 90], &[1.0, 0.5], "huge triangles");
    check(Gpu::with_shape(Shape::GPU), &mesh, 0.0, [100, 100, 110], &[1.0], "huge triangles");
}

#[test]
fn overlap_of_many_workgroups() {
    let gpu = Gpu::with_shape(TINY);
    for size in many_groups(TINY.map_size) {
        // As many triangles, and about as many pairs.
        check(gpu, &soup(size as usize - 1, 0.001, 13), 0.1, [0; 3], &[1.0], &format!("{size} triangles"));
    }
}

#[test]
fn overlap_of_a_million() {
    for (size, shape) in [((1 << 20) - 1, Shape::GPU), ((1 << 20) + 1, Shape::CPU)] {
        check(Gpu::with_shape(shape), &soup(size, 0.005, 14), 2.0, [0; 3], &[1.0], &format!("{size} triangles"));
    }
}

/// Vertices exactly on boundaries of cells, at the corners of the grid, and a float away.
#[test]
fn overlap_on_boundaries() {
    let mut random = Random::new(15);
    let mut triangles = vec![[[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 0.0]]];
    let mesh = Mesh::from_triangles(&triangles);
    let fixed = [37, 20, 9];
    let grid = header(&mesh, 0.0, fixed);
    for _ in 0..2_000 {
        triangles.push(std::array::from_fn(|_| {
            let i = fixed.map(|n| random.below(n + 1) as f32);
            let edge = gridwalk_core::grid::boundary(grid.box_min, grid.cell_size, i);
            let away = [0.0, grid.pad, -grid.pad, 1e-7, -1e-7][random.below(5) as usize];
            edge.map(|x| ((x + away) * grid.inverse_scale).clamp(-1.0, 1.0))
        }));
    }
    let mesh = Mesh::from_triangles(&triangles);
    assert_eq!(header(&mesh, 0.0, fixed), GridHeader { triangle_count: 2_001, ..grid });
    for gpu in devices() {
        check(gpu, &mesh, 0.0, fixed, &[1.0], "vertices on boundaries");
    }
}

/// A cell grown by the padding on each side, which is how far a walk and a hit may stray together, is listed for each triangle that meets
/// it: rounding never takes away more than the second padding of the test. Triangles as large as the grid pass by corners of small cells.
#[test]
fn exact_overlap_keeps_the_padding() {
    let span = 1.999;
    let mesh = Mesh::from_triangles(&[[[-span; 3], [span; 3], [span, -span, span]]]);
    let grid = header(&mesh, 0.0, [2048, 2048, 64]);
    let (mut met, mut close) = (0, 0);
    for seed in 0..400_000 {
        let random = &mut Random::new(seed);
        let cell = grid.resolution.map(|n| random.below(n));
        let (low, high) = cell_box(&grid, cell);
        let out: [f64; 3] = std::array::from_fn(|_| if random.below(2) == 0 { -1.0 } else { 1.0 });
        let away = f64::from(grid.pad) * f64::from(random.range(0.9, 1.02));
        let corner: [f64; 3] = std::array::from_fn(|i| if out[i] < 0.0 { low[i] - away } else { high[i] + away });
        // A plane through the grown corner that leaves the cell on one side, and a triangle in it that holds the corner.
        let normal: [f64; 3] = std::array::from_fn(|i| out[i] * f64::from(random.range(0.05, 1.0)));
        let around = f64::from(random.unit()) * std::f64::consts::TAU;
        let v = [0.0, 1.0, 2.0].map(|third| {
            let angle = around + third * std::f64::consts::TAU / 3.0;
            let (x, y) = (1.5 * angle.cos(), 1.5 * angle.sin());
            let z = -(normal[0] * x + normal[1] * y) / normal[2];
            let point = [corner[0] + x, corner[1] + y, corner[2] + z];
            point.map(|x| x.clamp(-2.0, 2.0) as f32)
        });
        let double = v.map(|v| v.map(f64::from));
        let pad = f64::from(grid.pad);
        if overlaps(&double, low.map(|x| x - pad), high.map(|x| x + pad)) {
            met += 1;
            assert!(triangle_overlaps_cell(&grid, v, cell), "seed {seed}: cell {cell:?}, {v:?}");
            let first = triangle_cells(&grid, v).low;
            assert!(SeparatingAxes::new(&grid, v, first).meets(cell), "seed {seed}: cell {cell:?} seen from {first:?}, {v:?}");
        } else if overlaps(&double, low.map(|x| x - 1.2 * pad), high.map(|x| x + 1.2 * pad)) {
            close += 1;
        }
    }
    assert!(met > 20_000 && close > 2_000, "{met} met, {close} close");
}
