use bytemuck::Zeroable;
use gridwalk::Report;
use gridwalk::kernels::CONFIGURE;
use gridwalk_core::gather::gathered_state;
use gridwalk_core::grid::boundary;
use gridwalk_core::layout::{Bounds, BuildState, DispatchArguments, GridHeader, OVERFLOW_CELLS};
use gridwalk_core::split::refined;
use gridwalk_core::twin::configure::{Configure, PAD, configure_header, configure_state};
use gridwalk_tests::gpu::Gpu;
use gridwalk_tests::random::Random;

use super::{assert_same, devices};

/// Divisions are off by up to 2.5 ulp on a device, and the sizes of cells come out of one or two of them.
fn close(device: f32, twin: f32) -> bool {
    (device - twin).abs() <= 8.0 * f32::EPSILON * twin.abs()
}

/// Equation 3-1 in double precision, over axes that are at least one and at most `limit` cells long.
fn resolution_in_double(extent: [f64; 3], limit: [f64; 3], target: f64) -> [f64; 3] {
    let longest = extent.into_iter().fold(0.0, f64::max);
    let cells = |s: f64| std::array::from_fn(|axis| (extent[axis] / longest * s).max(1.0).min(limit[axis]));
    let (mut low, mut high) = (1.0, target.max(1.0));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        let [x, y, z]: [f64; 3] = cells(middle);
        if x * y * z <= target { low = middle } else { high = middle }
    }
    cells(low).map(f64::floor)
}

fn check(gpu: &Gpu, info: Configure, scene: Bounds, what: &str) -> GridHeader {
    let shape = gpu.tracer.shape();
    // The box of the last tile of triangles is the scene's, and the others are of none.
    let mut boxes = vec![Bounds::EMPTY; shape.bounds_tiles(info.triangle_count) as usize];
    boxes[shape.bounds_tiles(info.triangle_count) as usize - 1] = scene;
    let partials = gpu.upload("partials", &boxes);
    let grid = gpu.guarded("grid", size_of::<GridHeader>() as u64);
    // More than fit, now and then.
    let total = info.triangle_count + u32::from(info.exact);
    let mut state = gathered_state(info.triangle_count, total);
    let mut arguments = DispatchArguments::zeroed();
    let mut report = Report::zeroed();
    let device_state = gpu.upload("state", &[state]);
    let device_arguments = gpu.upload("arguments", &[arguments]);
    let device_report = gpu.upload("report", &[report]);
    let parts = ["cells", "references", "triangles", "bricks"].map(|name| gpu.guarded(name, 16));
    let [a, b, c, d] = &parts;
    let memory = [&partials, &grid, &device_state, &device_arguments, &device_report, a, b, c, d];
    let [x, y, z] = info.fixed;
    let words = [info.cell_capacity, info.density.to_bits(), x, y, z, if info.splits { 2 } else { 1 }, info.exact.into()];
    gpu.launch(&CONFIGURE, 0, &memory, &words, [1, 1, 1]);

    let what = format!("{what}: {info:?} {scene:?}");
    let header: GridHeader = grid.read(0, 1)[0];
    let addresses = [a, b, c, d].map(|memory| {
        let address = memory.region().address;
        [address as u32, (address >> 32) as u32]
    });
    let (twin, density, overflow) = configure_header(&info, &scene, addresses);
    for axis in 0..3 {
        assert!(header.resolution[axis].abs_diff(twin.resolution[axis]) <= 1, "{what}: {header:?}, twin {twin:?}");
        if header.resolution[axis] == twin.resolution[axis] {
            assert!(close(header.cell_size[axis], twin.cell_size[axis]), "{what}: {header:?}, twin {twin:?}");
        }
        assert!(close(header.inverse_cell_size[axis], 1.0 / header.cell_size[axis]), "{what}: {header:?}");
    }
    // All that is no quotient is the twin's.
    let GridHeader { cell_size, inverse_cell_size, resolution, cell_count, fine_cell_size, inverse_fine_cell_size, .. } = header;
    let same = GridHeader { cell_size, inverse_cell_size, resolution, cell_count, fine_cell_size, inverse_fine_cell_size, ..twin };
    assert_eq!(header, same, "{what}");
    let fine = refined(&header, header.fine_shift);
    assert_eq!((fine.cell_size, fine.inverse_cell_size), (fine_cell_size, inverse_fine_cell_size), "{what}");
    let least = fine_cell_size.into_iter().fold(f32::INFINITY, f32::min);
    assert!(header.fine_shift == 0 || (info.splits && least >= 4.0 * header.pad), "{what}: {header:?}");
    assert_eq!(u64::from(cell_count), resolution.iter().map(|n| u64::from(*n)).product::<u64>(), "{what}");
    assert!(cell_count <= info.cell_capacity.max(1), "{what}: {header:?}");
    let end = boundary(header.box_min, header.cell_size, resolution.map(|n| n as f32));
    assert!((0..3).all(|axis| end[axis] >= header.box_max[axis]), "{what}: the last boundary {end:?} is inside of {header:?}");

    let found: Report = device_report.read(0, 1)[0];
    assert!(close(found.density, density), "{what}: density {}, twin {density}", found.density);
    configure_state(&shape, &info, &scene, &header, found.density, overflow, &mut state, &mut arguments, &mut report);
    assert_same(&format!("{what}: state"), &device_state.read::<BuildState>(0, 1), &[state]);
    assert_same(&format!("{what}: arguments"), &device_arguments.read::<DispatchArguments>(0, 1), &[arguments]);
    assert_same(&format!("{what}: report"), &[found], &[report]);

    let triangles = f64::from(info.triangle_count) - f64::from(scene.dropped);
    if triangles > 0.0 && info.fixed[0] == 0 {
        let extent: [f64; 3] = std::array::from_fn(|axis| f64::from(header.box_max[axis]) - f64::from(header.box_min[axis]));
        let limit = extent.map(|x| (x / (4.0 * f64::from(header.pad))).floor().clamp(1.0, 4096.0));
        let target = triangles * f64::from(found.density);
        let wanted = resolution_in_double(extent, limit, target);
        let off = (0..3).any(|axis| (f64::from(resolution[axis]) - wanted[axis]).abs() > 1.0);
        assert!(!off, "{what}: {resolution:?} where double precision has {wanted:?}");
        // The thesis's own form, where no axis is at a bound.
        let s = (target / extent.iter().product::<f64>()).cbrt();
        let plain = extent.map(|x| x * s);
        if (0..3).all(|axis| plain[axis] >= 1.0 && plain[axis] < limit[axis]) {
            let off = (0..3).any(|axis| (f64::from(resolution[axis]) - plain[axis].floor()).abs() > 1.0);
            assert!(!off, "{what}: {resolution:?} where Equation 3-1 has {plain:?}");
        }
    }
    header
}

const INFO: Configure = Configure { triangle_count: 1000, cell_capacity: 1 << 28, density: 8.0, fixed: [0; 3], splits: true, exact: false };

fn scene(low: [f32; 3], high: [f32; 3]) -> Bounds {
    Bounds { low, high, ..Bounds::EMPTY }
}

#[test]
fn configure_random_boxes() {
    let gpu = Gpu::shared();
    for seed in 0..400 {
        let mut random = Random::new(seed);
        // Axes and offsets over many orders of magnitude; some axes flat.
        let unit = 10f32.powf(random.range(-20.0, 20.0));
        let low: [f32; 3] = std::array::from_fn(|_| random.range(-1.0, 1.0) * unit);
        let high = low.map(|low| low + if random.below(6) == 0 { 0.0 } else { unit * 10f32.powf(random.range(-7.0, 1.0)) });
        let [magnitude, room] = [1 + random.below(24), random.below(29)];
        let info = Configure {
            triangle_count: 1 + random.below(1 << magnitude),
            cell_capacity: 1 + random.below(1 << room),
            density: 10f32.powf(random.range(-3.0, 3.0)),
            fixed: if random.below(4) == 0 { [1 + random.below(5000), 1 + random.below(50), 1 + random.below(500)] } else { [0; 3] },
            splits: random.below(4) > 0,
            exact: random.below(2) == 0,
        };
        check(gpu, info, scene(low, high), &format!("seed {seed}"));
    }
}

#[test]
fn configure_special_boxes() {
    for gpu in devices() {
        let unit = scene([-1.0; 3], [1.0; 3]);
        check(gpu, INFO, unit, "unit");
        check(gpu, Configure { triangle_count: 0, ..INFO }, Bounds::EMPTY, "no triangle");
        check(gpu, Configure { triangle_count: 9, ..INFO }, Bounds { dropped: 9, ..Bounds::EMPTY }, "all dropped");
        check(gpu, INFO, scene([0.0; 3], [0.0; 3]), "a point at the origin");
        let point = check(gpu, INFO, scene([5.0; 3], [5.0; 3]), "a point");
        assert_eq!(point.cell_count, 1);
        let flat = check(gpu, INFO, scene([0.0, 3.0, 0.0], [2.0, 3.0, 1.0]), "flat");
        assert_eq!(flat.resolution[1], 1);
        let line = check(gpu, INFO, scene([0.0, 3.0, 7.0], [2.0, 3.0, 7.0]), "a line");
        assert_eq!([line.resolution[1], line.resolution[2]], [1, 1]);
        check(gpu, INFO, scene([-1e30; 3], [1e30; 3]), "huge");
        check(gpu, INFO, scene([-3.4e38; 3], [3.4e38; 3]), "as large as floats are");
        check(gpu, INFO, scene([-1e-30; 3], [1e-30; 3]), "tiny");
        let far = check(gpu, INFO, scene([148_375.0, 1_233.0, -223_424.0], [148_377.0, 1_235.0, -223_422.0]), "far from the origin");
        assert_eq!(far.middle, [148_376.0, 1_234.0, -223_423.0]);
        // Of the same shape as without the distance.
        assert_eq!(far.resolution, check(gpu, INFO, unit, "the same at the origin").resolution);
        let near = check(gpu, INFO, scene([7.0, -9.0, 0.0], [9.0, -7.0, 2.0]), "near the origin");
        assert_eq!(near.middle, [8.0, -8.0, 0.0]);
        let nearer = check(gpu, INFO, scene([6.9, -8.9, 0.0], [8.9, -6.9, 2.0]), "as near as to be left where it is");
        assert_eq!(nearer.middle, [0.0; 3]);
        check(gpu, INFO, scene([1e-33; 3], [1.1e-33; 3]), "differences would be denormal");
        check(gpu, Configure { density: f32::MAX, ..INFO }, unit, "an infinite number of cells");
        check(gpu, Configure { density: f32::MIN_POSITIVE, ..INFO }, unit, "a density of nearly nothing");
        check(gpu, Configure { cell_capacity: 0, ..INFO }, unit, "no room for a cell");
        check(gpu, Configure { cell_capacity: 1, exact: true, ..INFO }, unit, "room for a cell");
        for exact in [false, true] {
            for cells in [1, 2, 3, 255, 256, 257] {
                check(gpu, Configure { fixed: [cells, 1, 1], exact, ..INFO }, unit, "a row of cells");
            }
        }
        let lowered = check(gpu, Configure { fixed: [1000, 1000, 1000], cell_capacity: 1 << 20, ..INFO }, unit, "too many fixed cells");
        assert!(lowered.cell_count > 1 << 19);
        assert_eq!(lowered.scale, 1.0);
        assert_eq!(lowered.pad, PAD);
    }
}

/// A fixed resolution may fill its capacity to the last cell, and may not exceed it by one.
#[test]
fn configure_counts_cells_exactly() {
    let gpu = Gpu::shared();
    let unit = scene([-1.0; 3], [1.0; 3]);
    for fixed in [[1, 1, 1], [3, 5, 7], [129, 1, 127], [255, 257, 4_095], [643, 645, 647]] {
        let cells: u32 = fixed.iter().product();
        let full = check(gpu, Configure { fixed, cell_capacity: cells, ..INFO }, unit, "full");
        assert_eq!(full.resolution, fixed);
        if cells > 1 {
            let info = Configure { fixed, cell_capacity: cells - 1, ..INFO };
            assert!(check(gpu, info, unit, "one cell short").cell_count < cells);
            assert_eq!(configure_header(&info, &unit, [[0; 2]; 4]).2, OVERFLOW_CELLS);
        }
    }
}

#[test]
fn configure_lowers_the_density() {
    let gpu = Gpu::shared();
    let unit = scene([-1.0; 3], [1.0; 3]);
    for capacity in [1, 7, 100, 5_000, 1 << 20] {
        let info = Configure { triangle_count: 1 << 20, cell_capacity: capacity, ..INFO };
        let header = check(gpu, info, unit, "lowered");
        let (_, density, overflow) = configure_header(&info, &unit, [[0; 2]; 4]);
        assert_eq!(overflow, OVERFLOW_CELLS);
        assert!(density < 8.0);
        assert!(header.cell_count <= capacity);
    }
}
