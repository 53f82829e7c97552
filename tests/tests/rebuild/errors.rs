//! What cannot be built is refused when it is recorded, by name, and nothing is written.

use gridwalk::{BuildInfo, BuildOptions, Capacity, Error, Geometry, MAX_CELLS, MAX_PAIRS, MAX_TRIANGLES, Region};
use gridwalk_tests::gpu::{CANARY, Gpu};
use gridwalk_tests::meshes::soup;

#[test]
fn capacities_beyond_the_limits() {
    let tracer = &Gpu::shared().tracer;
    let small = Capacity { triangles: 1, cells: 1, pairs: 1, leaf_cells: 0 };
    assert!(tracer.build_sizes(&small).is_ok());
    for (what, limit, capacity) in [
        ("triangles", MAX_TRIANGLES, Capacity { triangles: MAX_TRIANGLES + 1, ..small }),
        ("cells", MAX_CELLS, Capacity { cells: MAX_CELLS + 1, ..small }),
        ("pairs", MAX_PAIRS, Capacity { pairs: u32::MAX, ..small }),
    ] {
        match tracer.build_sizes(&capacity) {
            Err(Error::Capacity { what: found, limit: found_limit, .. }) => assert_eq!((found, found_limit), (what, limit.into())),
            other => panic!("{capacity:?}: {other:?}"),
        }
    }
    assert!(matches!(tracer.trace_scratch_size(gridwalk::MAX_RAYS + 1), Err(Error::Capacity { what: "rays", .. })));

    // Tiles of 37 keys, of which an invocation of table_scan gets through 32,768.
    let odd = &Gpu::with_shape(crate::kernels::ODD).tracer;
    let most: u32 = 37 * 32_768;
    assert!(odd.build_sizes(&Capacity { pairs: most, ..small }).is_ok() && odd.ray_sort_scratch_size(most).is_ok());
    assert!(
        matches!(odd.build_sizes(&Capacity { pairs: most + 1, ..small }), Err(Error::Capacity { what: "pairs", limit, .. }) if limit == u64::from(most))
    );
    assert!(matches!(odd.ray_sort_scratch_size(most + 1), Err(Error::Capacity { what: "rays", .. })));
}

/// A size is either given or refused for the device's limit, never wrong by an overflow.
#[test]
fn sizes_grow_with_capacities() {
    let tracer = &Gpu::shared().tracer;
    let mut last = (0, 0);
    for bits in 0..=26 {
        let capacity = Capacity { triangles: 1 << bits, cells: 1 << (bits + 2), pairs: 1 << (bits + 2), leaf_cells: 0 };
        match tracer.build_sizes(&capacity) {
            Ok(sizes) => {
                let next = (sizes.grid.size, sizes.scratch.size);
                assert!(next.0 >= last.0 && next.1 >= last.1, "{capacity:?}");
                assert!(next.0 >= (48 + 32 + 16) << bits && next.1 >= (4 + 48) << bits, "{capacity:?}: {sizes:?}");
                last = next;
            }
            Err(Error::DeviceLimit { needed, limit, .. }) => assert!(needed > limit && needed >= last.0.min(last.1), "{capacity:?}"),
            Err(error) => panic!("{capacity:?}: {error}"),
        }
    }
}

#[test]
fn builds_that_are_refused() {
    let gpu = Gpu::shared();
    let mesh = soup(100, 0.1, 51);
    let built = gpu.prepare(&mesh, mesh.capacity(), BuildOptions::default());
    let shrunk = |region: Region| Region { size: region.size - 64, ..region };
    let moved = |region: Region| Region { address: region.address + 4, ..region };
    let options = |density| BuildOptions { density, ..BuildOptions::default() };
    let info = built.info;
    let geometry = built.geometry();
    let cases: Vec<(&str, BuildInfo)> = vec![
        ("density", BuildInfo { options: options(0.0), ..info }),
        ("density", BuildInfo { options: options(-1.0), ..info }),
        ("density", BuildInfo { options: options(f32::NAN), ..info }),
        ("density", BuildInfo { options: options(f32::INFINITY), ..info }),
        ("resolution", BuildInfo { options: BuildOptions { resolution: Some([4, 0, 4]), ..options(1.0) }, ..info }),
        ("triangles", BuildInfo { capacity: Capacity { triangles: 99, ..info.capacity }, ..info }),
        ("grid", BuildInfo { grid: shrunk(info.grid), ..info }),
        ("scratch", BuildInfo { scratch: shrunk(info.scratch), ..info }),
        ("report", BuildInfo { report: shrunk(info.report), ..info }),
        ("grid", BuildInfo { grid: moved(info.grid), ..info }),
        ("scratch", BuildInfo { scratch: Region::NONE, ..info }),
        ("positions", BuildInfo { input: Geometry { vertex_count: 301, ..geometry }.into(), ..info }),
        ("vertices", BuildInfo { input: Geometry { vertex_count: gridwalk::MAX_VERTICES + 1, ..geometry }.into(), ..info }),
        ("scratch", BuildInfo { scratch: Region { buffer: Default::default(), ..info.scratch }, ..info }),
        ("indices", BuildInfo { input: Geometry { indices: shrunk(geometry.indices), ..geometry }.into(), ..info }),
    ];
    for (name, info) in cases {
        let message = gpu.refused(&info).to_string();
        assert!(message.contains(name), "{name}: {message}");
    }
    for memory in [&built.grid, &built.scratch, &built.report_memory] {
        let words: Vec<u32> = memory.read(0, memory.region().size as usize / 4);
        assert!(words.iter().all(|word| *word == CANARY), "a refused build wrote");
    }
}

#[test]
fn traces_that_are_refused() {
    let gpu = Gpu::shared();
    let region = gpu.guarded("memory", 4096);
    let address = region.region().address;
    let part = |offset, size| region.region().part(offset, size);
    let info = gridwalk::TraceInfo::new(part(0, 32), part(64, 16), gridwalk::RayCount::Direct(1), part(1024, 1024));
    let cases = [
        ("grid", 0, info),
        ("grid", address + 32, info),
        ("rays", address, gridwalk::TraceInfo { rays: Region::NONE, ..info }),
        ("rays", address, gridwalk::TraceInfo { count: gridwalk::RayCount::Direct(2), ..info }),
        ("hits", address, gridwalk::TraceInfo { hits: info.hits.part(4, 16), ..info }),
        ("trace scratch", address, gridwalk::TraceInfo { scratch: info.scratch.part(0, 64), ..info }),
        ("trace scratch", address, gridwalk::TraceInfo { scratch: Region { buffer: Default::default(), ..info.scratch }, ..info }),
        ("ray count", address, gridwalk::TraceInfo { count: gridwalk::RayCount::Indirect { count: Region::NONE, max: 1 }, ..info }),
        ("counters", address, gridwalk::TraceInfo { counters: Some(info.hits.part(0, 8)), ..info }),
    ];
    for (name, grid, info) in cases {
        let message = gpu.refused_trace(grid, &info).to_string();
        assert!(message.contains(name), "{name}: {message}");
    }
    assert!(region.read::<u32>(0, 1024).iter().all(|word| *word == CANARY), "a refused trace wrote");
}
