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

/// A grid with room for all its pairs and cells.
fn build(gpu: &Gpu, mesh: &Mesh, options: BuildOptions) -> Built {
    let triangles = mesh.indices.len() as u32;
    let cells = (triangles as f32 * options.density.max(1.0) * 1.01) as u32 + 4_096;
    let built = gpu.build(mesh, Capacity { triangles, cells, pairs: 16 * triangles + 4_096 }, options);
    if built.report.overflow == 0 {
        return built;
    }
    let pairs = built.report.needed_pairs().unwrap();
    let built = gpu.build(mesh, Capacity { triangles, cells, pairs }, options);
    assert_eq!(built.report.overflow, 0, "{:?}", built.report);
    built
}

/// Room for any grid of a small mesh.
fn roomy(mesh: &Mesh) -> Capacity {
    Capacity { triangles: mesh.indices.len() as u32, cells: 1 << 17, pairs: 1 << 19 }
}

/// Whether the tests may take long: `GRIDWALK_LONG=1`.
fn long() -> bool {
    std::env::var("GRIDWALK_LONG").is_ok_and(|value| value != "0")
}
