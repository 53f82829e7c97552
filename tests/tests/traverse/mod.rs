//! Rays through grids.

mod all_hits;
mod brute_force;
mod compare;
mod conventions;
mod counts;
mod divergent;
mod filters;
mod frames;
mod hard_rays;
mod long_lists;
pub mod meshes;
mod order;
pub mod rays;
mod real;
mod twins;
mod watertight;

use gridwalk::{BuildOptions, Capacity};
use gridwalk_tests::gpu::{Built, Gpu, Mesh};

/// A grid of two levels with room for all its pairs and cells.
fn build(gpu: &Gpu, mesh: &Mesh, options: BuildOptions) -> Built {
    let triangles = mesh.indices.len() as u32;
    let cells = (triangles as f32 * options.density.max(1.0) * 1.01) as u32 + 4_096;
    let mut capacity = Capacity { triangles, cells, pairs: 16 * triangles + 4_096, leaf_cells: 1 << 12 };
    let mut built = gpu.build(mesh, capacity, options);
    // Pairs, then leaf cells, then the leaf cells' pairs.
    for _ in 0..3 {
        if built.report.overflow == 0 {
            break;
        }
        let pairs = built.report.needed_pairs().unwrap().max(capacity.pairs);
        capacity = Capacity { pairs, leaf_cells: built.report.leaf_cells.max(capacity.leaf_cells), ..capacity };
        built = gpu.build(mesh, capacity, options);
    }
    assert_eq!(built.report.overflow, 0, "{:?}", built.report);
    built
}

/// Room for any grid of a small mesh.
fn roomy(mesh: &Mesh) -> Capacity {
    Capacity { triangles: mesh.indices.len() as u32, cells: 1 << 17, pairs: 1 << 19, leaf_cells: 1 << 16 }
}

/// Whether the tests may take long: `GRIDWALK_LONG=1`.
fn long() -> bool {
    std::env::var("GRIDWALK_LONG").is_ok_and(|value| value != "0")
}
