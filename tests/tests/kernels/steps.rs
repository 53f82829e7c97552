//! Whole builds, a step at a time: each buffer after each step is the player's.

use bytemuck::bytes_of;
use gridwalk::plan::{Buffer, BuildInputs, Dispatch, Item, Source, Step, build_plan};
use gridwalk::{BuildInfo, BuildOptions, Capacity, GeometryRecord, Overlap, Report};
use gridwalk_core::layout::{BuildState, CELL_SPLIT, DispatchArguments, GridHeader};
use gridwalk_core::split::refined;
use gridwalk_core::twin::player::{Groups, Level, Memory, PlayedStep};
use gridwalk_tests::gpu::{Built, CANARY, Gpu, Mesh};
use gridwalk_tests::meshes::{soup, spoil};

use super::devices;
use crate::rebuild::records::{Scene, placed};

const COMPARED: [Buffer; 21] = [
    Buffer::Header,
    Buffer::State,
    Buffer::Arguments,
    Buffer::BoundsPartials,
    Buffer::Triangles,
    Buffer::Offsets,
    Buffer::CellBoxes,
    Buffer::ScanPartials,
    Buffer::KeysA,
    Buffer::KeysB,
    Buffer::ValuesA,
    Buffer::References,
    Buffer::Table,
    Buffer::Cells,
    Buffer::Bricks,
    Buffer::Occupancy,
    Buffer::DistancesX,
    Buffer::DistancesY,
    Buffer::LeafState,
    Buffer::LeafArguments,
    Buffer::SplitCells,
];

fn words(memory: &Memory, buffer: Buffer) -> &[u32] {
    match buffer {
        Buffer::Header => bytemuck::cast_slice(bytes_of(&memory.header)),
        Buffer::State => bytemuck::cast_slice(bytes_of(&memory.state)),
        Buffer::Arguments => bytemuck::cast_slice(bytes_of(&memory.arguments)),
        Buffer::Report => bytemuck::cast_slice(bytes_of(&memory.report)),
        Buffer::BoundsPartials => bytemuck::cast_slice(&memory.bounds_partials),
        Buffer::Triangles => bytemuck::cast_slice(&memory.triangles),
        Buffer::Offsets => &memory.offsets,
        Buffer::CellBoxes => bytemuck::cast_slice(&memory.cell_boxes),
        Buffer::ScanPartials => &memory.scan_partials,
        Buffer::KeysA => &memory.keys_a,
        Buffer::KeysB => &memory.keys_b,
        Buffer::ValuesA => &memory.values_a,
        Buffer::References => &memory.references,
        Buffer::Table => &memory.table,
        Buffer::Cells => bytemuck::cast_slice(&memory.cells),
        Buffer::Bricks => bytemuck::cast_slice(&memory.bricks),
        Buffer::Occupancy => bytemuck::cast_slice(&memory.occupancy),
        Buffer::DistancesX => &memory.distances_x,
        Buffer::DistancesY => &memory.distances_y,
        Buffer::LeafState => bytemuck::cast_slice(bytes_of(&memory.leaf_state)),
        Buffer::LeafArguments => bytemuck::cast_slice(bytes_of(&memory.leaf_arguments)),
        Buffer::SplitCells => bytemuck::cast_slice(&memory.split_cells),
        other => panic!("{other:?} is no memory of a build"),
    }
}

/// The first word of a buffer in which device and player differ; zeros of either sign are the same.
fn first_difference(gpu: &Gpu, built: &Built, memory: &Memory, buffer: Buffer) -> Option<String> {
    let expected = words(memory, buffer);
    let size = gpu.tracer.build_region(&built.info, buffer).size;
    assert_eq!(size, 4 * expected.len() as u64, "{buffer:?}: the player's memory has another size");
    let found: Vec<u32> = built.part(gpu, buffer, expected.len());
    let unsigned = |word: u32| if word == 1 << 31 { 0 } else { word };
    let at = found.iter().zip(expected).position(|(a, b)| unsigned(*a) != unsigned(*b))?;
    Some(format!("{buffer:?} word {at}: device {:#x}, player {:#x}", found[at], expected[at]))
}

/// Takes what the device configured, after a look at whether it may be so: quotients are not the same on every device.
fn adopt(gpu: &Gpu, built: &Built, memory: &mut Memory) {
    let header: GridHeader = built.part(gpu, Buffer::Header, 1)[0];
    let close = (0..3).all(|axis| {
        let sizes = [header.cell_size[axis], memory.header.cell_size[axis]];
        header.resolution[axis].abs_diff(memory.header.resolution[axis]) <= 1
            && (header.resolution != memory.header.resolution || (sizes[0] - sizes[1]).abs() <= 1e-6 * sizes[1])
    });
    assert!(close, "configure: device {header:?}, player {:?}", memory.header);
    let GridHeader { cell_size, inverse_cell_size, resolution, cell_count, fine_cell_size, inverse_fine_cell_size, .. } = header;
    let adopted =
        GridHeader { cell_size, inverse_cell_size, resolution, cell_count, fine_cell_size, inverse_fine_cell_size, ..memory.header };
    assert_eq!(header, adopted);
    let fine = refined(&header, header.fine_shift);
    assert_eq!((fine.cell_size, fine.inverse_cell_size), (fine_cell_size, inverse_fine_cell_size));
    memory.header = header;
    if resolution != built_resolution(memory) {
        memory.state = built.part::<BuildState>(gpu, Buffer::State, 1)[0];
        memory.arguments = built.part::<DispatchArguments>(gpu, Buffer::Arguments, 1)[0];
        memory.report = built.part::<Report>(gpu, Buffer::Report, 1)[0];
    }
}

fn built_resolution(memory: &Memory) -> [u32; 3] {
    memory.report.resolution
}

fn played<'a>(step: &Step, words: &'a [u32]) -> PlayedStep<'a> {
    let groups = match step.dispatch {
        Dispatch::Direct(groups) => Groups::Direct(groups),
        Dispatch::Indirect(Buffer::LeafArguments, offset) => Groups::Indirect(Level::Second, offset),
        Dispatch::Indirect(_, offset) => Groups::Indirect(Level::First, offset),
    };
    let of_leaves = (0..step.kernel.accesses.len()).any(|access| step.buffer(access) == Buffer::LeafState);
    let level = if of_leaves { Level::Second } else { Level::First };
    PlayedStep { kernel: step.kernel.name, groups, words, level, exact: step.variant == 1 }
}

/// Runs a build a step at a time and names the first step after which a buffer is not the player's.
fn first_wrong_step(
    gpu: &Gpu,
    mesh: &Mesh,
    capacity: Capacity,
    options: BuildOptions,
    after: impl FnMut(&str, &mut Memory),
) -> Option<String> {
    let built = gpu.prepare(mesh, capacity, options);
    let positions = mesh.positions.iter().flatten().copied().collect();
    let indices = mesh.indices.iter().flatten().copied().collect();
    let source = Source::Mesh { triangle_count: mesh.indices.len() as u32, vertex_count: mesh.positions.len() as u32 };
    first_wrong_step_of(gpu, &built, source, |memory| (memory.positions, memory.indices) = (positions, indices), after)
}

/// Likewise, of a build that is prepared; `given` puts its input into the player's memory, and `after` is shown this after each kernel.
fn first_wrong_step_of(
    gpu: &Gpu,
    built: &Built,
    source: Source,
    given: impl FnOnce(&mut Memory),
    mut after: impl FnMut(&str, &mut Memory),
) -> Option<String> {
    let shape = gpu.tracer.shape();
    let BuildInfo { capacity, options, second_level, .. } = built.info;
    let exact = options.overlap == Overlap::Exact;
    let inputs = BuildInputs { source, density: options.density, resolution: options.resolution, exact, second_level };
    let plan = build_plan(&capacity, &inputs, &shape);
    let bricks = gpu.tracer.build_region(&built.info, Buffer::Bricks).size / 16;
    let sizes = [capacity.triangles, capacity.cells, capacity.pairs, capacity.leaf_cells, bricks as u32];
    let mut memory = Memory::filled(CANARY, &shape, Vec::new(), Vec::new(), sizes);
    given(&mut memory);
    let addresses = [Buffer::Cells, Buffer::References, Buffer::Triangles, Buffer::Bricks].map(|buffer| {
        let address = gpu.tracer.build_region(&built.info, buffer).address;
        [address as u32, (address >> 32) as u32]
    });
    for (index, item) in plan.items().iter().enumerate() {
        let Item::Step(step) = item else { continue };
        gpu.run_item(built, item);
        let words = step.words();
        memory.play(&shape, &played(step, &words), addresses).unwrap();
        if step.kernel.name == "configure" {
            adopt(gpu, built, &mut memory);
        }
        after(step.kernel.name, &mut memory);
        let wrong = COMPARED.into_iter().chain([Buffer::Report]).find_map(|buffer| first_difference(gpu, built, &memory, buffer));
        if let Some(wrong) = wrong {
            return Some(format!("step {index}, {}: {wrong}", step.kernel.name));
        }
    }
    None
}

#[test]
fn every_step_of_a_build_is_the_players() {
    let mut mesh = soup(3_000, 0.05, 21);
    spoil(&mut mesh, 50, 22);
    for gpu in devices() {
        for overlap in [Overlap::Box, Overlap::Exact] {
            for density in [0.01, 2.0] {
                let options = BuildOptions { density, overlap, ..BuildOptions::default() };
                // Flat, with room for some of the leaf cells, and for all.
                for leaf_cells in [0, 3_000, 60_000] {
                    let capacity = Capacity { triangles: 4_000, cells: 10_000, pairs: 160_000, leaf_cells };
                    let wrong = first_wrong_step(gpu, &mesh, capacity, options, |_, _| ());
                    assert_eq!(wrong, None, "{leaf_cells}, {options:?} {:?}", gpu.tracer.shape());
                }
            }
        }
    }
}

#[test]
fn every_step_of_special_builds_is_the_players() {
    let gpu = Gpu::shared();
    let room = Capacity { triangles: 3_000, cells: 5_000, pairs: 90_000, leaf_cells: 100_000 };
    let options = BuildOptions::default();
    let one_cell = BuildOptions { resolution: Some([1, 1, 1]), ..options };
    let cases = [
        ("empty", soup(0, 0.0, 0), room, options),
        ("one triangle", soup(1, 0.5, 1), room, options),
        ("no capacity", soup(0, 0.0, 0), Capacity { triangles: 0, cells: 0, pairs: 0, leaf_cells: 0 }, options),
        ("too many pairs", soup(3_000, 0.2, 2), Capacity { pairs: 7_777, ..room }, options),
        ("too many cells", soup(3_000, 0.05, 3), Capacity { cells: 1_000, ..room }, options),
        ("too many pairs of leaf cells", soup(3_000, 0.2, 2), Capacity { pairs: 50_000, ..room }, options),
        ("split into 32 x 32 x 32", soup(3_000, 0.01, 6), room, BuildOptions { resolution: Some([1, 2, 1]), ..options }),
        ("fixed", soup(100, 0.3, 4), room, BuildOptions { resolution: Some([7, 30, 2]), ..options }),
        ("one cell", soup(500, 0.3, 5), room, one_cell),
    ];
    for (name, mesh, capacity, options) in cases {
        for overlap in [Overlap::Box, Overlap::Exact] {
            let wrong = first_wrong_step(gpu, &mesh, capacity, BuildOptions { overlap, ..options }, |_, _| ());
            assert_eq!(wrong, None, "{name}, {overlap:?}");
        }
    }
}

/// Cells beside one another along x: this many triangles of this size in each.
fn row_of_cells(cells: &[(usize, f32)]) -> Mesh {
    let mut all = Mesh::default();
    for (cell, (count, size)) in cells.iter().enumerate() {
        let mesh = soup(*count, *size, cell as u64);
        let first = all.positions.len() as u32;
        // A soup's middles lie between -1 and 1.
        let reach = 1.0 + size + 0.01;
        all.positions.extend(mesh.positions.iter().map(|[x, y, z]| [x / reach + 2.0 * cell as f32, y / reach, z / reach]));
        all.indices.extend(mesh.indices.iter().map(|triangle| triangle.map(|vertex| first + vertex)));
    }
    all
}

/// Where an invocation of `leaf_sort` would take too many turns, the sort makes all lists, also those that other invocations have made.
#[test]
fn every_step_of_a_build_whose_leaf_cells_are_sorted_is_the_players() {
    let capacity = Capacity { triangles: 4_000, cells: 100, pairs: 1 << 19, leaf_cells: 100_000 };
    for gpu in devices().into_iter().filter(|gpu| gpu.tracer.shape().leaf_run > 0) {
        for overlap in [Overlap::Box, Overlap::Exact] {
            let long = (1_100, if overlap == Overlap::Box { 0.2 } else { 0.4 });
            for cells in [&[long][..], &[(200, 0.2), (200, 0.2), (300, 0.1), (200, 0.2), long, (200, 0.2), (100, 0.1), (200, 0.1)]] {
                let mesh = row_of_cells(cells);
                let options = BuildOptions { resolution: Some([cells.len() as u32, 1, 1]), overlap, ..BuildOptions::default() };
                let (mut made, mut is_sorted) = (0, false);
                let wrong = first_wrong_step(gpu, &mesh, capacity, options, |kernel, memory| {
                    if kernel == "leaf_sort" {
                        made = memory.cells[..cells.len()].iter().filter(|range| range[1] & CELL_SPLIT != 0).count();
                        is_sorted = memory.leaf_arguments.emit != [0; 4];
                    }
                });
                let what = format!("{overlap:?}, {} cells, {:?}", cells.len(), gpu.tracer.shape());
                assert_eq!(wrong, None, "{what}");
                assert!(is_sorted && (cells.len() == 1 || (1..cells.len()).contains(&made)), "{what}: {made} made");
            }
        }
    }
}

#[test]
fn every_step_of_a_build_of_records_is_the_players() {
    for gpu in devices() {
        let mut scene = Scene::new();
        let mut mesh = soup(700, 0.1, 24);
        spoil(&mut mesh, 50, 25);
        let record = scene.mesh(gpu, &mesh);
        let count = scene.words(gpu, vec![33]);
        scene.records = (0..20)
            .map(|i| GeometryRecord {
                transform: placed(i as f32, 0.5, [i as f32, 0.0, 1.0]),
                count: if i % 3 == 0 { count } else { 0 },
                triangle_count: if i == 7 { 0 } else { record.triangle_count },
                flags: i % 4,
                id: i,
                ..record
            })
            .collect();
        // The last two have too little room, of triangles and of pairs.
        for (triangles, pairs) in [(20_000, 100_000), (5_000, 100_000), (9_000, 7_777)] {
            let capacity = Capacity { triangles, cells: 20_000, pairs, leaf_cells: 40_000 };
            let (built, _records) = scene.prepare(gpu, capacity, BuildOptions { density: 1.0, ..BuildOptions::default() });
            let source = Source::Records { record_count: scene.records.len() as u32 };
            let given = |memory: &mut Memory| (memory.records, memory.addressed) = (scene.records.clone(), scene.memory.clone());
            let wrong = first_wrong_step_of(gpu, &built, source, given, |_, _| ());
            assert_eq!(wrong, None, "{capacity:?} {:?}", gpu.tracer.shape());
        }
    }
}

#[test]
fn a_wrong_step_is_named() {
    let mesh = soup(100, 0.1, 23);
    let wrong = first_wrong_step(Gpu::shared(), &mesh, mesh.capacity(), BuildOptions::default(), |kernel, memory| {
        if kernel == "overlap_count" {
            memory.offsets[1] ^= 1;
        }
    });
    assert!(wrong.as_deref().is_some_and(|wrong| wrong.contains("overlap_count: Offsets word 1")), "{wrong:?}");
}
