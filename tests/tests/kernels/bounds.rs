use bytemuck::Zeroable;
use gridwalk::kernels::GATHER;
use gridwalk::split_workgroups;
use gridwalk_core::gather::tile_bounds;
use gridwalk_core::layout::{Bounds, BuildState};
use gridwalk_core::twin::configure::unite_bounds;
use gridwalk_tests::gpu::{Gpu, Mesh};
use gridwalk_tests::meshes::{soup, spoil};

use super::{TINY, assert_same, devices, gathered, many_groups, sizes, united};

fn check(gpu: &Gpu, mesh: &Mesh, what: &str) {
    let shape = gpu.tracer.shape();
    let triangles = mesh.indices.len() as u32;
    let tiles = shape.bounds_tiles(triangles);
    let positions = gpu.upload("positions", &mesh.positions);
    let indices = gpu.upload("indices", &mesh.indices);
    let device_triangles = gpu.guarded("triangles", 48 * u64::from(triangles.max(1)));
    let state = gpu.guarded("state", size_of::<BuildState>() as u64);
    let partials = gpu.guarded("partials", 32 * u64::from(tiles));
    let memory = [&positions, &indices, &device_triangles, &state, &partials];
    gpu.launch(&GATHER, 0, &memory, &[mesh.positions.len() as u32, triangles], split_workgroups(tiles));

    let mut expected = vec![Bounds::zeroed(); tiles as usize];
    tile_bounds(&shape, &gathered(mesh), &mut expected);
    assert_same(&format!("{what}: partials"), &partials.read::<Bounds>(0, tiles as usize), &expected);
    let whole = unite_bounds(&expected, tiles);
    assert_same(&format!("{what}: scene"), &[united(gpu, &state, &partials)], &[whole]);
}

#[test]
fn bounds_of_every_size() {
    for gpu in devices() {
        let shape = gpu.tracer.shape();
        for size in sizes(shape.bounds_tile()) {
            let mut mesh = soup(size as usize, 0.1, u64::from(size));
            if size % 2 == 0 {
                spoil(&mut mesh, 7, u64::from(size));
            }
            check(gpu, &mesh, &format!("{size} triangles, {shape:?}"));
        }
    }
}

#[test]
fn bounds_of_many_workgroups() {
    let gpu = Gpu::with_shape(TINY);
    for size in many_groups(TINY.bounds_tile()) {
        let mut mesh = soup(size as usize, 0.1, 1);
        spoil(&mut mesh, 1000, 2);
        check(gpu, &mesh, &format!("{size} triangles"));
    }
}

#[test]
fn bounds_of_a_million() {
    for (size, gpu) in [((1 << 20) - 1, Gpu::with_shape(gridwalk::Shape::CPU)), ((1 << 20) + 1, Gpu::with_shape(gridwalk::Shape::GPU))] {
        check(gpu, &soup(size, 0.1, 3), &format!("{size} triangles"));
    }
}

#[test]
fn bounds_of_dropped_triangles_alone() {
    let gpu = Gpu::shared();
    let mut mesh = soup(1000, 0.1, 4);
    for vertex in &mut mesh.positions {
        vertex[1] = f32::NAN;
    }
    check(gpu, &mesh, "all dropped");
}
