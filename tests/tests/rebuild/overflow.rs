//! Too little room: a report that says so, no write beyond it, and sound grids.

use gridwalk::{BuildOptions, Capacity, Overlap};
use gridwalk_core::layout::{OVERFLOW_CELLS, OVERFLOW_PAIRS};
use gridwalk_tests::gpu::{Built, Gpu, Mesh};
use gridwalk_tests::meshes::soup;

use super::invariants::check;

/// What of a grid does not depend on where it lies.
#[derive(PartialEq)]
pub struct Contents {
    pub cells: Vec<[u32; 2]>,
    pub references: Vec<u32>,
    /// Bits of the vertices, and the words beside them.
    pub triangles: Vec<u32>,
    pub bricks: Vec<[u32; 4]>,
}

pub fn contents(gpu: &Gpu, built: &Built) -> Contents {
    let bricks: u32 = gridwalk_core::grid::brick_resolution(built.header().resolution).iter().product();
    Contents {
        cells: built.cells(),
        references: built.references(),
        triangles: built.triangles().into_iter().flatten().flatten().map(f32::to_bits).collect(),
        bricks: built.part(gpu, gridwalk::plan::Buffer::Bricks, bricks as usize),
    }
}

#[test]
fn too_many_pairs() {
    let gpu = Gpu::shared();
    let mesh = soup(4_000, 0.1, 31);
    for overlap in [Overlap::Box, Overlap::Exact] {
        let options = BuildOptions { density: 4.0, overlap, ..BuildOptions::default() };
        let room = Capacity { triangles: 4_000, cells: 40_000, pairs: 1 << 20, leaf_cells: 0 };
        let never = gpu.build(&mesh, room, options);
        assert_eq!(never.report.overflow, 0);
        for pairs in [0, 1, 1_000, never.report.pair_total - 1] {
            let built = gpu.build(&mesh, Capacity { pairs, ..room }, options);
            assert_eq!(built.report.overflow, OVERFLOW_PAIRS, "{pairs}");
            assert_eq!(built.report.needed_pairs(), Some(never.report.pair_total), "{pairs}");
            assert!(built.report.pairs <= pairs);
            check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{pairs} pairs: {error}"));
        }
        let grown = gpu.build(&mesh, Capacity { pairs: never.report.pair_total, ..room }, options);
        assert_eq!(grown.report, never.report);
        assert!(contents(gpu, &grown) == contents(gpu, &never), "{overlap:?}: another grid than without an overflow");
        check(gpu, &grown, &mesh).unwrap();
    }
}

#[test]
fn a_build_after_an_overflow_is_sound() {
    let gpu = Gpu::shared();
    let large = soup(2_000, 0.3, 32);
    let small = soup(2_000, 0.01, 33);
    let capacity = Capacity { triangles: 2_000, cells: 20_000, pairs: 20_000, leaf_cells: 0 };
    let mut built = gpu.build(&large, capacity, BuildOptions::default());
    assert!(built.report.pairs_overflowed());
    built.positions.write(0, &small.positions);
    gpu.rebuild(&mut built);
    assert_eq!(built.report.overflow, 0);
    check(gpu, &built, &small).unwrap();
    let fresh = gpu.build(&small, capacity, BuildOptions::default());
    assert!(contents(gpu, &built) == contents(gpu, &fresh), "another grid than one that is built afresh");
}

/// 5,000 triangles in each of 2^20 cells are more pairs than a number of 32 bits holds.
#[test]
fn a_saturated_number_of_pairs() {
    let gpu = Gpu::shared();
    let mesh = Mesh::from_triangles(&vec![[[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 0.0]]; 5_000]);
    let capacity = Capacity { triangles: 5_000, cells: 1 << 20, pairs: 100_000, leaf_cells: 0 };
    for overlap in [Overlap::Box, Overlap::Exact] {
        let cells = |n| BuildOptions { resolution: Some([n; 3]), overlap, ..BuildOptions::default() };
        let built = gpu.build(&mesh, capacity, cells(100));
        assert_eq!(built.report.overflow, OVERFLOW_PAIRS);
        assert_eq!(built.report.pair_total, u32::MAX);
        assert_eq!(built.report.needed_pairs(), None);
        check(gpu, &built, &mesh).unwrap();
        let coarser = gpu.build(&mesh, capacity, cells(2));
        assert_eq!((coarser.report.overflow, coarser.report.pair_total), (0, 40_000));
        check(gpu, &coarser, &mesh).unwrap();
    }
}

#[test]
fn too_many_cells() {
    let gpu = Gpu::shared();
    let mesh = soup(3_000, 0.05, 34);
    let needed =
        gpu.build(&mesh, Capacity { triangles: 3_000, cells: 30_000, pairs: 1 << 18, leaf_cells: 0 }, BuildOptions::default()).report;
    assert_eq!((needed.overflow, needed.density), (0, BuildOptions::DEFAULT_DENSITY));
    for cells in [0, 1, 2, 63, 1_000, 15_000] {
        let capacity = Capacity { triangles: 3_000, cells, pairs: 1 << 18, leaf_cells: 0 };
        let built = gpu.build(&mesh, capacity, BuildOptions::default());
        assert_eq!(built.report.overflow, OVERFLOW_CELLS, "{cells}");
        assert!(built.report.cells <= cells.max(1), "{cells}: {:?}", built.report);
        assert!(built.report.density < BuildOptions::DEFAULT_DENSITY, "{cells}: {:?}", built.report);
        check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{cells} cells: {error}"));
    }
}
