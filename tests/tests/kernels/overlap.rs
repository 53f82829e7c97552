use gridwalk::Shape;
use gridwalk::kernels::{OVERLAP_COUNT, OVERLAP_EMIT};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::gather::gathered_state;
use gridwalk_core::layout::{BuildState, GridHeader};
use gridwalk_core::overlap::triangle_overlaps_cell;
use gridwalk_core::sort::writes_a;
use gridwalk_core::twin::overlap_count::overlap_count;
use gridwalk_core::twin::overlap_emit::overlap_emit;
use gridwalk_core::twin::scan_spine::exclusive_scan;
use gridwalk_tests::gpu::{Gpu, Mesh};
use gridwalk_tests::meshes::{soup, spoil};
use gridwalk_tests::random::Random;

use crate::rebuild::invariants::{cell_box, overlaps};

use super::{TINY, assert_same, devices, gathered, header, many_groups, sizes, untouched};

/// Counts on the device and compares; returns triangles and offsets.
fn count(gpu: &Gpu, mesh: &Mesh, header: &GridHeader, what: &str) -> (Vec<[f32; 4]>, Vec<u32>) {
    let shape = gpu.tracer.shape();
    let triangles = mesh.indices.len() as u32;
    let mut expected = gathered(mesh);
    let grid = gpu.upload("grid", &[*header]);
    let state = gpu.upload("state", &[gathered_state(triangles, triangles)]);
    let moved = gpu.upload("triangles", &expected);
    let counts = gpu.guarded("counts", 4 * (u64::from(triangles) + 1));
    let groups = split_workgroups(triangles + 1, shape.map_size);
    gpu.launch(&OVERLAP_COUNT, 0, &[&grid, &state, &moved, &counts], &[], groups);
    let mut expected_counts = untouched(triangles as usize + 1);
    overlap_count(&shape, groups, header, triangles, &mut expected, &mut expected_counts);
    assert_same(&format!("{what}: counts"), &counts.read::<u32>(0, expected_counts.len()), &expected_counts);
    let found: Vec<u32> = moved.read(0, 4 * expected.len());
    assert_same(&format!("{what}: triangles"), &found, bytemuck::cast_slice(&expected));
    exclusive_scan(&mut expected_counts, 0);
    (expected, expected_counts)
}

/// Emits on the device and compares, for a capacity of `part` of the pairs.
fn emit(gpu: &Gpu, header: &GridHeader, triangles: &[[f32; 4]], offsets: &[u32], part: f64, what: &str) {
    let shape = gpu.tracer.shape();
    let total = offsets[offsets.len() - 1];
    let pair_count = (f64::from(total) * part) as u32;
    let grid = gpu.upload("grid", &[*header]);
    let device_offsets = gpu.upload("offsets", offsets);
    let device_triangles = gpu.upload("triangles", triangles);
    let size = 4 * u64::from(pair_count.max(1));
    for (exact, pass_count) in [(false, 2), (true, 3)] {
        let triangle_count = offsets.len() as u32 - 1;
        let state = BuildState { triangle_count, offset_count: triangle_count + 1, pair_count, pass_count, ..BuildState::default() };
        let state = gpu.upload("state", &[state]);
        let [a, b, c, d] = ["keys a", "keys b", "values a", "values b"].map(|name| gpu.guarded(name, size));
        let groups = split_workgroups(pair_count.div_ceil(shape.emit_pairs), shape.map_size);
        let memory = [&grid, &state, &device_offsets, &device_triangles, &a, &b, &c, &d];
        gpu.launch(&OVERLAP_EMIT, exact.into(), &memory, &[], groups);
        let count = pair_count as usize;
        let (mut keys, mut values) = (untouched(count), untouched(count));
        overlap_emit(&shape, groups, exact, header, pair_count, offsets, triangles, &mut keys, &mut values);
        let (written, left) = if writes_a(pass_count, 0) { ([&a, &c], [&b, &d]) } else { ([&b, &d], [&a, &c]) };
        let what = format!("{what}, {pair_count} of {total} pairs, exact {exact}");
        assert_same(&format!("{what}: triangles of pairs"), &written[1].read::<u32>(0, count), &values);
        assert_same(&format!("{what}: keys"), &written[0].read::<u32>(0, count), &keys);
        for memory in left {
            assert_same(&format!("{what}: the other buffer"), &memory.read::<u32>(0, count), &untouched(count));
        }
    }
}

fn check(gpu: &Gpu, mesh: &Mesh, density: f32, fixed: [u32; 3], parts: &[f64], what: &str) {
    let header = header(mesh, density, fixed);
    let what = format!("{what}, {:?}, {:?}", header.resolution, gpu.tracer.shape());
    let (triangles, offsets) = count(gpu, mesh, &header, &what);
    for part in parts {
        emit(gpu, &header, &triangles, &offsets, *part, &what);
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
        } else if overlaps(&double, low.map(|x| x - 1.2 * pad), high.map(|x| x + 1.2 * pad)) {
            close += 1;
        }
    }
    assert!(met > 20_000 && close > 2_000, "{met} met, {close} close");
}
