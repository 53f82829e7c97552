//! Every kernel of the rebuild against its twin: integers bit for bit, floats too where they are sums, products and comparisons.

mod bounds;
mod bricks;
mod cell_ranges;
mod clear_cells;
mod configure;
mod dispatch;
mod gather;
mod largest;
mod leaf_distance;
mod leaf_sort;
mod overlap;
mod pair_args;
mod ray_sort;
mod scan;
mod sort;
mod steps;

use gridwalk::kernels::CONFIGURE;
use gridwalk::{Report, Shape};
use gridwalk_core::layout::{Bounds, BuildState, DispatchArguments, GridHeader};
use gridwalk_core::twin::configure::{Configure, configure_header};
use gridwalk_core::twin::gather::gather;
use gridwalk_tests::gpu::{CANARY, Gpu, Guarded, Mesh};

/// Neither round numbers nor the defaults.
pub const ODD: Shape = Shape {
    map_size: 32,
    scan_size: 32,
    scan_items: 3,
    reduce_items: 5,
    reduce_bricks: 3,
    sort_bits: 5,
    sort_size: 64,
    sort_keys: 37,
    sort_alone: true,
    emit_pairs: 5,
    range_pairs: 3,
    leaf_run: 100,
    by_two: false,
    strands: 1,
};

/// So small that a few hundred thousand elements fill more than 65,535 workgroups. The scan's tiles are larger: each adds the sums of all
/// before it.
pub const TINY: Shape = Shape {
    map_size: 4,
    scan_size: 8,
    scan_items: 4,
    reduce_items: 1,
    reduce_bricks: 1,
    sort_bits: 4,
    sort_size: 4,
    sort_keys: 1,
    sort_alone: false,
    emit_pairs: 1,
    range_pairs: 1,
    leaf_run: 0,
    by_two: true,
    strands: 3,
};

/// All shapes under test.
pub fn devices() -> Vec<&'static Gpu> {
    [Shape::CPU, Shape::GPU, ODD, TINY].into_iter().map(Gpu::with_shape).collect()
}

/// Numbers of elements around the edges of subgroups, of workgroups and of tiles of `tile` elements.
pub fn sizes(tile: u32) -> Vec<u32> {
    let edges = [4, 8, 16, 32, 64, 256, tile, 3 * tile];
    let mut sizes: Vec<u32> = [0, 1, 2, 3].into_iter().chain(edges.iter().flat_map(|edge| [edge - 1, *edge, edge + 1])).collect();
    sizes.sort_unstable();
    sizes.dedup();
    sizes
}

/// Numbers of elements for 65,535 to 65,537 workgroups of `size` elements.
pub fn many_groups(size: u32) -> [u32; 3] {
    [65_535 * size, 65_535 * size + 1, 65_537 * size]
}

/// Fails with the first place where two buffers differ.
#[track_caller]
pub fn assert_same<T: PartialEq + std::fmt::Debug>(what: &str, device: &[T], twin: &[T]) {
    assert_eq!(device.len(), twin.len(), "{what}: lengths");
    if let Some(at) = device.iter().zip(twin).position(|(device, twin)| device != twin) {
        let count = device.iter().zip(twin).filter(|(device, twin)| device != twin).count();
        panic!("{what}: {count} of {} differ, first at {at}: device {:?}, twin {:?}", device.len(), device[at], twin[at]);
    }
}

/// A buffer that no kernel has written.
pub fn untouched(len: usize) -> Vec<u32> {
    vec![CANARY; len]
}

/// The triangles of a mesh as `gather` leaves them.
pub fn gathered(mesh: &Mesh) -> Vec<[f32; 4]> {
    let count = mesh.indices.len() as u32;
    let mut triangles = vec![[0.0; 4]; 3 * count as usize];
    let (positions, indices) = (bytemuck::cast_slice(&mesh.positions), bytemuck::cast_slice(&mesh.indices));
    let tiles = Shape::GPU.bounds_tiles(count);
    let (groups, mut partials) = (gridwalk::split_workgroups(tiles), vec![Bounds::EMPTY; tiles as usize]);
    let vertices = mesh.positions.len() as u32;
    gather(&Shape::GPU, groups, positions, indices, &mut triangles, &mut BuildState::default(), &mut partials, vertices, count);
    triangles
}

/// The scene box that `configure` makes of tiles' boxes and reports; of no triangle it reports none.
pub fn united(gpu: &Gpu, state: &Guarded, partials: &Guarded) -> Bounds {
    let memory = [size_of::<GridHeader>(), size_of::<DispatchArguments>(), size_of::<Report>(), 16, 16, 16, 16];
    let memory = memory.map(|size| gpu.guarded("written by configure", size as u64));
    let [grid, arguments, report, cells, references, triangles, bricks] = &memory;
    let memory = [partials, grid, state, arguments, report, cells, references, triangles, bricks];
    gpu.launch(&CONFIGURE, 0, &memory, &[1 << 20, 4.0_f32.to_bits(), 0, 0, 0, 2, 1], [1, 1, 1]);
    let Report { triangles, dropped, box_min, box_max, .. } = report.read(0, 1)[0];
    if triangles == dropped { Bounds { dropped, ..Bounds::EMPTY } } else { Bounds { low: box_min, dropped, high: box_max, reserved: 0 } }
}

/// The header that the twin makes for a mesh: good enough to test later steps, and the same for device and twin.
pub fn header(mesh: &Mesh, density: f32, fixed: [u32; 3]) -> GridHeader {
    let mut scene = Bounds::EMPTY;
    for triangle in 0..mesh.indices.len() as u32 {
        let positions: &[f32] = bytemuck::cast_slice(&mesh.positions);
        let vertices = mesh.positions.len() as u32;
        match gridwalk_core::gather::gather_triangle(positions, bytemuck::cast_slice(&mesh.indices), vertices, triangle) {
            None => scene.dropped += 1,
            Some(v) => {
                scene.low = v.into_iter().fold(scene.low, gridwalk_core::vector::min);
                scene.high = v.into_iter().fold(scene.high, gridwalk_core::vector::max);
            }
        }
    }
    let info = Configure { triangle_count: mesh.indices.len() as u32, cell_capacity: 1 << 28, density, fixed, splits: false, exact: true };
    configure_header(&info, &scene, [[0; 2]; 4]).0
}
