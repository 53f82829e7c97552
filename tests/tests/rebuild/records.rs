//! Geometry as engines have it: formats, indices, instances, counts in memory; each against the same triangles as one plain mesh.

use gridwalk::{BuildOptions, Capacity, GeometryRecord, Input, MAX_GEOMETRIES, Records, Region};
use gridwalk_core::geometry::*;
use gridwalk_core::layout::{OVERFLOW_TRIANGLES, TRIANGLE_NUMBER};
use gridwalk_tests::gpu::{Built, Gpu, Guarded, Mesh};
use gridwalk_tests::meshes::{soup, spoil};
use gridwalk_tests::random::Random;

use super::invariants::check;
use super::overflow::{Contents, contents};

/// Records on the device and in the twin's words.
pub struct Scene {
    pub records: Vec<GeometryRecord>,
    pub memory: AddressedMemory,
    device: Vec<Guarded>,
}

impl Scene {
    pub fn new() -> Scene {
        Scene { records: Vec::new(), memory: AddressedMemory::default(), device: Vec::new() }
    }

    /// Puts words into memory of the device; gives their address.
    pub fn words(&mut self, gpu: &Gpu, words: Vec<u32>) -> u64 {
        let memory = gpu.upload("geometry", &words);
        let address = memory.region().address;
        self.memory.add(address, words);
        self.device.push(memory);
        address
    }

    /// A record of a mesh, tightly packed.
    pub fn mesh(&mut self, gpu: &Gpu, mesh: &Mesh) -> GeometryRecord {
        GeometryRecord {
            positions: self.words(gpu, bytemuck::cast_slice(&mesh.positions).to_vec()),
            vertex_count: mesh.positions.len() as u32,
            indices: self.words(gpu, bytemuck::cast_slice(&mesh.indices).to_vec()),
            triangle_count: mesh.indices.len() as u32,
            ..GeometryRecord::default()
        }
    }

    /// All triangles as the records describe them, as one plain mesh.
    pub fn flattened(&self) -> Mesh {
        let mut mesh = Mesh::default();
        for record in &self.records {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend((0..record.vertex_count).map(|vertex| position_of(&self.memory, record, vertex)));
            for triangle in 0..count_of(&self.memory, record) {
                let shifted = |vertex: u32| if vertex < record.vertex_count { first + vertex } else { u32::MAX };
                mesh.indices.push(vertices_of(&self.memory, record, triangle).map(shifted));
            }
        }
        mesh
    }

    /// Memory for a build of the records, which is not built yet; and the memory of the records.
    pub fn prepare(&self, gpu: &Gpu, capacity: Capacity, options: BuildOptions) -> (Built, Guarded) {
        let mut built = gpu.prepare(&Mesh::default(), capacity, options);
        let memory = gpu.upload("records", &self.records);
        built.info.input = Input::Records(Records { records: memory.region(), count: self.records.len() as u32 });
        (built, memory)
    }

    /// Builds with room for everything.
    pub fn build(&self, gpu: &Gpu, options: BuildOptions) -> Built {
        let mesh = self.flattened();
        let (mut built, memory) = self.prepare(gpu, roomy(&mesh), options);
        gpu.rebuild(&mut built);
        memory.check();
        self.device.iter().for_each(Guarded::check);
        assert_eq!(built.report.overflow, 0);
        built
    }
}

fn roomy(mesh: &Mesh) -> Capacity {
    Capacity { triangles: mesh.indices.len() as u32 + 10, pairs: 1 << 21, ..mesh.capacity() }
}

/// All but the words beside the vertices.
fn without_words(contents: Contents) -> Contents {
    let bits = contents.triangles.iter().enumerate().map(|(i, word)| if i % 4 == 3 { 0 } else { *word });
    // Zeros of either sign are the same.
    Contents { triangles: bits.map(|word| if word == 1 << 31 { 0 } else { word }).collect(), ..contents }
}

/// Fails if the grid of the records is not that of their flattened mesh.
#[track_caller]
fn assert_flattened(gpu: &Gpu, scene: &Scene, what: &str) -> Built {
    let mesh = scene.flattened();
    let built = scene.build(gpu, BuildOptions::default());
    let plain = gpu.build(&mesh, roomy(&mesh), BuildOptions::default());
    check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!((built.report.triangles, built.report.triangle_total), (plain.report.triangles, plain.report.triangles), "{what}");
    assert!(
        without_words(contents(gpu, &built)) == without_words(contents(gpu, &plain)),
        "{what}: another grid than of the flattened mesh"
    );
    built
}

#[test]
fn one_plain_record_is_the_mesh() {
    let gpu = Gpu::shared();
    let mut mesh = soup(2_000, 0.1, 61);
    spoil(&mut mesh, 40, 62);
    let mut scene = Scene::new();
    let record = scene.mesh(gpu, &mesh);
    scene.records.push(record);
    let built = scene.build(gpu, BuildOptions::default());
    let plain = gpu.build(&mesh, roomy(&mesh), BuildOptions::default());
    let positive = |contents: Contents| Contents {
        triangles: contents.triangles.iter().enumerate().map(|(i, w)| if *w == 1 << 31 && i % 4 != 3 { 0 } else { *w }).collect(),
        ..contents
    };
    assert!(positive(contents(gpu, &built)) == positive(contents(gpu, &plain)), "words beside the vertices included");
    assert_eq!(built.report, plain.report);
    // A negative control: the comparison sees one vertex.
    scene.records[0].offset[1] = 1e-3;
    let moved = scene.build(gpu, BuildOptions::default());
    assert!(without_words(contents(gpu, &moved)) != without_words(contents(gpu, &plain)));
}

fn pairs(halves: impl IntoIterator<Item = [u16; 4]>) -> Vec<u32> {
    halves.into_iter().flat_map(|[x, y, z, w]| [u32::from(x) | u32::from(y) << 16, u32::from(z) | u32::from(w) << 16]).collect()
}

#[test]
fn every_format_and_index_type() {
    let gpu = Gpu::shared();
    let mut random = Random::new(63);
    let vertices = 900;
    for format in [FORMAT_FLOAT32X3, FORMAT_FLOAT16X4, FORMAT_SNORM16X4] {
        for index_type in [INDEX_NONE, INDEX_UINT16, INDEX_UINT32] {
            let mut scene = Scene::new();
            let (words, least) = match format {
                FORMAT_FLOAT32X3 => ((0..vertices).flat_map(|_| random.point(-1.0, 1.0).map(f32::to_bits)).collect(), 12),
                // Halves of either sign below 2, denormal ones included, and now and then an infinity.
                FORMAT_FLOAT16X4 => {
                    let half = |random: &mut Random| match random.below(400) {
                        0 => 0x7C00,
                        1..10 => random.below(1024) as u16,
                        _ => random.below(0x4000) as u16 | (random.below(2) << 15) as u16,
                    };
                    (pairs((0..vertices).map(|_| std::array::from_fn(|_| half(&mut random)))), 8)
                }
                _ => (pairs((0..vertices).map(|_| std::array::from_fn(|_| random.below(65_536) as u16))), 8),
            };
            // Vertices a word apart from each other, and from the first byte.
            let stride: u32 = least + 4;
            let each = least as usize / 4;
            let spaced =
                std::iter::once(7).chain(words.chunks(each).flat_map(|vertex| vertex.iter().copied().chain([0x7FC0_0000]))).collect();
            let positions = scene.words(gpu, spaced) + 4;
            let triangle_count = if index_type == INDEX_NONE { vertices / 3 } else { 501 };
            let index: Vec<u32> = (0..3 * triangle_count).map(|_| random.below(vertices + 2)).collect();
            let indices = match index_type {
                INDEX_NONE => 0,
                INDEX_UINT32 => scene.words(gpu, index),
                // Begins in the middle of a word.
                _ => {
                    let mut halves = vec![0xFFFF];
                    halves.extend(index);
                    halves.resize(halves.len().next_multiple_of(2), 0xFFFF);
                    scene.words(gpu, halves.chunks(2).map(|pair| pair[0] | pair[1] << 16).collect()) + 2
                }
            };
            scene.records.push(GeometryRecord {
                positions,
                stride,
                vertex_count: vertices,
                indices,
                triangle_count,
                format,
                index_type,
                scale: [2.0, 0.7, -1.0],
                offset: [0.0, 5.0, -0.25],
                ..GeometryRecord::default()
            });
            let built = assert_flattened(gpu, &scene, &format!("format {format}, index type {index_type}"));
            assert!(built.report.dropped < triangle_count / 4, "{:?}", built.report);
        }
    }
}

/// A rotation about the y axis, a scale and a translation.
pub fn placed(angle: f32, scale: f32, to: [f32; 3]) -> [[f32; 4]; 3] {
    let (sin, cos) = (scale * angle.sin(), scale * angle.cos());
    [[cos, 0.0, sin, to[0]], [0.0, scale, 0.0, to[1]], [-sin, 0.0, cos, to[2]]]
}

#[test]
fn instances_are_their_flattened_meshes() {
    let gpu = Gpu::shared();
    let mut random = Random::new(64);
    let mut scene = Scene::new();
    let meshes: Vec<_> = [(300, 71), (1, 72), (50, 73)].map(|(count, seed)| soup(count, 0.2, seed)).into_iter().collect();
    let plain: Vec<_> = meshes.iter().map(|mesh| scene.mesh(gpu, mesh)).collect();
    for id in 0..200 {
        let record = plain[random.below(3) as usize];
        let transform = placed(random.range(0.0, 6.3), random.range(-0.3, 0.5), random.point(-5.0, 5.0));
        let triangle_count = if random.below(4) == 0 { 0 } else { record.triangle_count };
        scene.records.push(GeometryRecord { transform, triangle_count, id: 7 * id, mask: id, ..record });
    }
    let built = assert_flattened(gpu, &scene, "instances");
    // Ids, masks and numbers within the geometry lie beside the vertices.
    let mut triangles = built.triangles().into_iter();
    for record in &scene.records {
        for number in 0..record.triangle_count {
            let words = triangles.next().unwrap().map(|row| row[3].to_bits());
            assert_eq!([words[0] & TRIANGLE_NUMBER, words[1], words[2]], [number, record.id, record.mask]);
        }
    }
    assert_eq!(triangles.next(), None);
}

#[test]
fn counts_in_memory_change_between_submissions() {
    let gpu = Gpu::shared();
    let mut scene = Scene::new();
    let record = scene.mesh(gpu, &soup(500, 0.1, 65));
    let far = [[1.0, 0.0, 0.0, 9.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let counts = gpu.upload("counts", &[500u32, 20]);
    let at = counts.region().address;
    scene.records = vec![GeometryRecord { count: at, ..record }, GeometryRecord { count: at + 4, transform: far, ..record }];
    let capacity = Capacity { triangles: 800, cells: 10_000, pairs: 40_000, leaf_cells: 0 };
    let (mut built, _records) = scene.prepare(gpu, capacity, BuildOptions::default());
    let changes = [[500, 20], [0, 0], [3, 497], [500, 500], [u32::MAX, 0], [7, 7]];
    let mut reports = Vec::new();
    gpu.submit_again(&mut built, changes.len() + 1, |built, _| {
        let turn = reports.len();
        let report: gridwalk::Report = built.report_memory.read(0, 1)[0];
        let [a, b] = if turn == 0 { [500, 20] } else { changes[turn - 1] };
        let total = u32::min(a, 500) + u32::min(b, 500);
        assert_eq!((report.triangles, report.triangle_total), (total.min(800), total), "turn {turn}");
        assert_eq!(report.overflow, if total > 800 { OVERFLOW_TRIANGLES } else { 0 }, "turn {turn}");
        if turn > 0 {
            // The grid of the counts as they are now.
            let now = [[a, b]].map(|[a, b]| {
                vec![
                    GeometryRecord { count: 0, triangle_count: a.min(500), ..scene.records[0] },
                    GeometryRecord { count: 0, triangle_count: b.min(500), ..scene.records[1] },
                ]
            });
            let [records] = now;
            let memory = AddressedMemory::default();
            let plain = Scene { records, memory, device: Vec::new() };
            let (mut fresh, _memory) = plain.prepare(gpu, capacity, BuildOptions::default());
            gpu.rebuild(&mut fresh);
            built.report = report;
            assert!(contents(gpu, built) == contents(gpu, &fresh), "turn {turn}: another grid than of counts in the records");
        }
        counts.write(0, &changes[turn.min(changes.len() - 1)]);
        reports.push(report);
    });
    assert!(reports.iter().any(|report| report.triangles_overflowed()));
    counts.check();
}

#[test]
fn too_many_triangles_are_left_out() {
    let gpu = Gpu::shared();
    let mut scene = Scene::new();
    let mesh = soup(1_000, 0.1, 66);
    let record = scene.mesh(gpu, &mesh);
    scene.records = vec![record, GeometryRecord { offset: [4.0, 0.0, 0.0], ..record }];
    for triangles in [2, 3, 999, 1_000, 1_001, 1_999] {
        let capacity = Capacity { triangles, cells: 20_000, pairs: 60_000, leaf_cells: 0 };
        let (mut built, records) = scene.prepare(gpu, capacity, BuildOptions::default());
        gpu.rebuild(&mut built);
        records.check();
        let report = built.report;
        assert_eq!((report.triangles, report.triangle_total, report.overflow), (triangles, 2_000, OVERFLOW_TRIANGLES));
        assert!(report.triangles_overflowed());
        let mut kept = scene.flattened();
        kept.indices.truncate(triangles as usize);
        check(gpu, &built, &kept).unwrap_or_else(|error| panic!("{triangles}: {error}"));
    }
}

#[test]
fn records_that_are_refused() {
    let gpu = Gpu::shared();
    let capacity = Capacity { triangles: 100, cells: 100, pairs: 100, leaf_cells: 0 };
    let built = gpu.prepare(&Mesh::default(), capacity, BuildOptions::default());
    let memory = gpu.guarded("records", 128 * 100);
    let refused = |records: Region, count, triangles| {
        let capacity = Capacity { triangles, ..capacity };
        let info = gridwalk::BuildInfo { input: Input::Records(Records { records, count }), capacity, ..built.info };
        gpu.refused(&info).to_string()
    };
    let region = memory.region();
    for message in [refused(region, 101, 100), refused(Region::NONE, MAX_GEOMETRIES + 1, 1 << 20)] {
        assert!(message.contains("geometries"), "{message}");
    }
    for message in [refused(region.part(0, 127), 1, 100), refused(Region { address: region.address + 8, ..region }, 1, 100)] {
        assert!(message.contains("records"), "{message}");
    }
}
