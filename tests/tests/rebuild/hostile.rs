//! Geometry that has broken ray tracers: sound grids, or a clear report.

use gridwalk::{BuildOptions, Capacity, Overlap};
use gridwalk_tests::gpu::{Built, Gpu, Mesh};
use gridwalk_tests::meshes::hostile;

use super::invariants::check;

/// Builds as a renderer does: grows to what the report asks for, or lowers the density if that is too much.
fn build_to_fit(gpu: &Gpu, mesh: &Mesh, overlap: Overlap, most_pairs: u32) -> Built {
    let mut options = BuildOptions { overlap, ..BuildOptions::default() };
    let mut capacity = mesh.capacity();
    for _ in 0..12 {
        let built = gpu.build(mesh, capacity, options);
        if !built.report.pairs_overflowed() {
            return built;
        }
        check(gpu, &built, mesh).unwrap();
        match built.report.needed_pairs() {
            Some(needed) if needed <= most_pairs => capacity.pairs = needed,
            _ => options.density *= 0.01,
        }
    }
    panic!("no density fits");
}

#[test]
fn hostile_geometry() {
    let gpu = Gpu::shared();
    for (name, mesh) in hostile() {
        for overlap in [Overlap::Box, Overlap::Exact] {
            let built = build_to_fit(gpu, &mesh, overlap, 1 << 20);
            check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{name}, {overlap:?}: {error}"));
        }
    }
}

#[test]
fn hostile_geometry_is_reported() {
    let gpu = Gpu::shared();
    let meshes = hostile();
    let build = |name: &str| {
        let mesh = &meshes.iter().find(|(other, _)| *other == name).unwrap().1;
        build_to_fit(gpu, mesh, Overlap::Box, 1 << 20).report
    };
    let empty = build("empty");
    assert_eq!((empty.triangles, empty.dropped, empty.cells, empty.pairs), (0, 0, 1, 0));
    let dropped = build("all dropped");
    assert_eq!((dropped.triangles, dropped.dropped, dropped.cells, dropped.pairs), (50, 50, 1, 0));
    assert_eq!(build("index out of range").dropped, 3);
    assert!(build("not finite").dropped > 50);
    for (axis, name) in ["flat in x", "flat in y", "flat in z"].into_iter().enumerate() {
        let report = build(name);
        assert_eq!(report.resolution[axis], 1, "{name}");
        assert!(report.cells > 1_000, "{name}: a flat axis leaves its share to the others: {report:?}");
    }
    let line = build("a line");
    assert_eq!([line.resolution[1], line.resolution[2]], [1, 1]);
    assert_eq!(build("a point").cells, 1);
    for name in ["far from the origin", "coordinates of 1e-30", "coordinates of 1e18", "coordinates of 1e30"] {
        let report = build(name);
        assert!(report.cells > 2_000 && report.dropped == 0, "{name}: {report:?}");
    }
    assert_eq!(build("all in one cell").longest_list, 5_000);
}

#[test]
fn a_triangle_that_covers_a_million_cells() {
    let gpu = Gpu::shared();
    let mut triangles = vec![[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]; 1];
    triangles.push([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 0.9, -1.0]]);
    triangles.push([[0.1, 0.1, 0.1], [0.11, 0.1, 0.1], [0.1, 0.11, 0.1]]);
    let mesh = Mesh::from_triangles(&triangles);
    for overlap in [Overlap::Box, Overlap::Exact] {
        let options = BuildOptions { resolution: Some([128, 128, 80]), overlap, ..BuildOptions::default() };
        let built = gpu.build(&mesh, Capacity { triangles: 3, cells: 1 << 21, pairs: 1 << 21, leaf_cells: 0 }, options);
        assert_eq!(built.report.overflow, 0);
        assert!(built.report.pair_total > 1 << 20, "{:?}", built.report);
        check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{overlap:?}: {error}"));
    }
}
