//! Builds again: after the vertices changed, by the same command buffer, and with the same result.

use gridwalk::{BuildOptions, Capacity, Overlap, Shape};
use gridwalk_tests::gpu::{Gpu, Mesh};
use gridwalk_tests::meshes::soup;

use super::invariants::check;
use super::overflow::contents;

/// Box, resolution, number of digits in use, and pairs change; the same recording serves.
#[test]
fn one_recording_many_submissions() {
    let gpu = Gpu::shared();
    let first = soup(3_000, 0.05, 41);
    let squeeze = |f: fn([f32; 3]) -> [f32; 3]| Mesh { positions: first.positions.iter().map(|p| f(*p)).collect(), ..first.clone() };
    let frames = [
        first.clone(),
        squeeze(|p| p.map(|x| 3.0 * x + 100.0)),
        squeeze(|p| [p[0], 0.001 * p[1], p[2] * p[0]]),
        squeeze(|_| [1.0; 3]),
        squeeze(|p| [p[0], f32::NAN, p[2]]),
        squeeze(|p| [p[0], -p[1], 2.0 * p[2]]),
        first.clone(),
    ];
    for overlap in [Overlap::Box, Overlap::Exact] {
        let options = BuildOptions { density: 2.0, overlap, ..BuildOptions::default() };
        let capacity = Capacity { triangles: 3_000, cells: 8_000, pairs: 60_000, leaf_cells: 0 };
        let mut built = gpu.prepare(&first, capacity, options);
        let mut seen = Vec::new();
        gpu.submit_again(&mut built, frames.len() + 1, |built, time| {
            let before = &frames[time - 1];
            check(gpu, built, before).unwrap_or_else(|error| panic!("frame {}: {error}", time - 1));
            let fresh = gpu.build(before, capacity, options);
            assert_eq!(fresh.report, built.report, "frame {}", time - 1);
            assert!(contents(gpu, &fresh) == contents(gpu, built), "frame {}: another grid than a fresh one", time - 1);
            seen.push(built.report);
            if let Some(next) = frames.get(time) {
                built.positions.write(0, &next.positions);
            }
        });
        assert!(seen[0].resolution != seen[2].resolution && seen[0].pairs != seen[2].pairs, "{seen:?}");
        assert!(seen[3].key_bits < seen[0].key_bits && seen[4].pairs == 0, "{seen:?}");
        assert_eq!(seen[0], seen[6]);
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let mesh = soup(20_000, 0.03, 42);
    let capacity = Capacity { pairs: 1 << 20, ..mesh.capacity() };
    for overlap in [Overlap::Box, Overlap::Exact] {
        let options = BuildOptions { overlap, ..BuildOptions::default() };
        let gpu = Gpu::shared();
        let mut built = gpu.build(&mesh, capacity, options);
        let bytes = |built: &gridwalk_tests::gpu::Built| {
            let (grid, scratch) = (built.grid.region().size, built.scratch.region().size);
            (built.grid.read::<u8>(0, grid as usize), built.scratch.read::<u8>(0, scratch as usize), built.report)
        };
        let first = bytes(&built);
        for _ in 0..3 {
            gpu.rebuild(&mut built);
            assert!(bytes(&built) == first, "{overlap:?}: a second build left other bytes");
        }
        // However the kernels are cut, the grid is the same.
        for shape in [Shape::CPU, Shape::GPU, crate::kernels::ODD, crate::kernels::TINY] {
            let gpu = Gpu::with_shape(shape);
            let other = gpu.build(&mesh, capacity, options);
            assert_eq!(other.report, built.report, "{shape:?}");
            assert!(contents(gpu, &other) == contents(Gpu::shared(), &built), "{overlap:?}: {shape:?} makes another grid");
        }
    }
}

/// Several grids in one submission, with one scratch; and fewer triangles than before in the same memory.
#[test]
fn builds_share_scratch() {
    let gpu = Gpu::shared();
    let meshes = [soup(3_000, 0.05, 44), soup(10, 0.5, 45), soup(2_000, 0.02, 46)];
    let capacity = Capacity { triangles: 3_000, cells: 30_000, pairs: 60_000, leaf_cells: 0 };
    let options = BuildOptions { density: 4.0, ..BuildOptions::default() };
    let mut grids = meshes.each_ref().map(|mesh| gpu.prepare(mesh, capacity, options));
    let scratch = grids[0].info.scratch;
    grids.iter_mut().for_each(|grid| grid.info.scratch = scratch);
    gpu.rebuild_all(&mut grids.each_mut());
    for (grid, mesh) in grids.iter().zip(&meshes) {
        let alone = gpu.build(mesh, capacity, options);
        assert_eq!((grid.report, grid.report.overflow), (alone.report, 0));
        assert!(contents(gpu, grid) == contents(gpu, &alone), "another grid than one that is built alone");
    }
    let [mut first, second, _] = grids;
    first.info.input = second.info.input;
    gpu.rebuild(&mut first);
    assert_eq!(first.report, second.report);
    assert!(contents(gpu, &first) == contents(gpu, &second), "another grid than in fresh memory");
    check(gpu, &first, &meshes[1]).unwrap();
}

#[test]
fn timestamps_ascend() {
    let gpu = Gpu::shared();
    let mesh = soup(5_000, 0.05, 43);
    let mut built = gpu.build(&mesh, mesh.capacity(), BuildOptions::default());
    let before = contents(gpu, &built);
    for _ in 0..2 {
        let Some(stamps) = gpu.timestamps(&mut built) else {
            eprintln!("skipped: the device has no timestamps");
            return;
        };
        assert_eq!(stamps.len(), gpu.tracer.build_steps(&built.info.capacity).len() + 1);
        assert!(stamps.windows(2).all(|pair| pair[0] <= pair[1]), "{stamps:?}");
        assert!(stamps[0] < stamps[stamps.len() - 1], "{stamps:?}");
        assert!(contents(gpu, &built) == before, "timestamps change the grid");
    }
}
