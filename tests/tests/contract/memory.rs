//! Which memory is needed, for how long, and what may share it.

use gridwalk::ash::vk;
use gridwalk::{BuildInfo, RayCount, RaySortInfo, Region, Timestamps, TraceInfo, Tracer, cmd_barrier};
use gridwalk_tests::foreign::{Foreign, Memory, Placed, Terrain};

/// One buffer for each region, with the usage flags that the sizes name and no other, and those of the caller's data with the one flag that
/// an address takes.
#[test]
fn the_named_usages_suffice() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let terrain = Terrain::new(9, 2);
        let address = vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
        // Sized by a placement that is thrown away.
        let other = Memory::new(&foreign, 8 << 20);
        let model = Placed::new(&other, &tracer, Terrain::new(9, 2));
        let sizes = tracer.build_sizes(&model.build.capacity).unwrap();
        let trace_size = tracer.trace_scratch_size(terrain.rays.len() as u32).unwrap();
        assert_eq!(sizes.grid.alignment, gridwalk::REGION_ALIGNMENT);
        let buffers = [
            ("positions", 1 << 16, address),
            ("indices", 1 << 16, address),
            ("rays", 1 << 16, address),
            ("hits", 1 << 16, address),
            ("grid", sizes.grid.size, sizes.grid.usage),
            ("scratch", sizes.scratch.size, sizes.scratch.usage),
            ("report", sizes.report.size, sizes.report.usage),
            ("trace scratch", trace_size.size, trace_size.usage),
        ]
        .map(|(_, size, usage)| Memory::with_usage(&foreign, size + 256, usage));
        let [positions, indices, rays, hits, grid, scratch, report, trace_scratch] = buffers.each_ref();
        let geometry = gridwalk::Geometry {
            positions: positions.upload(&terrain.positions),
            vertex_count: terrain.positions.len() as u32,
            indices: indices.upload(&terrain.indices),
            triangle_count: terrain.indices.len() as u32,
        };
        let (grid, scratch) = (grid.region(sizes.grid.size), scratch.region(sizes.scratch.size));
        let build = BuildInfo::new(geometry, grid, scratch, report.region(sizes.report.size), model.build.capacity);
        let count = RayCount::Direct(terrain.rays.len() as u32);
        let answers = hits.region(16 * terrain.rays.len() as u64);
        let trace = TraceInfo::new(rays.upload(&terrain.rays), answers, count, trace_scratch.region(trace_size.size));
        let commands = foreign.record(|cmd| {
            // SAFETY: what is recorded is submitted once and waited for below, while all of it lives.
            unsafe {
                tracer.cmd_build(cmd, &build).unwrap();
                cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::TRACE);
                tracer.cmd_closest_hit(cmd, grid.address, &trace).unwrap();
            }
        });
        foreign.submit(&[&commands]);
        assert_eq!(terrain.wrong(&hits.read(&answers, terrain.rays.len())), 0);
        buffers.iter().for_each(Memory::check_gaps);
    }
    assert_eq!(foreign.close(), [""; 0]);
}

/// Two builds with one scratch, then two traces with one scratch, with the barriers of the table between them.
#[test]
fn scratch_is_shared_by_what_barriers_keep_apart() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 16 << 20);
        let mut placed = [Terrain::new(16, 0), Terrain::new(7, 3)].map(|terrain| Placed::new(&memory, &tracer, terrain));
        // The first is the larger one.
        (placed[1].build.scratch, placed[1].trace.scratch) = (placed[0].build.scratch, placed[0].trace.scratch);
        for region in [placed[0].build.scratch, placed[0].trace.scratch] {
            memory.poison(&region);
        }
        let commands = foreign.record(|cmd| {
            // SAFETY: as above.
            unsafe {
                placed[0].cmd_build(&tracer, cmd);
                cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::BUILD);
                placed[1].cmd_build(&tracer, cmd);
                cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::TRACE);
                placed[0].cmd_trace(&tracer, cmd);
                cmd_barrier(&foreign.device, cmd, Tracer::TRACE, Tracer::TRACE);
                placed[1].cmd_trace(&tracer, cmd);
            }
        });
        for _ in 0..2 {
            foreign.submit(&[&commands]);
            placed.iter().for_each(Placed::check);
            memory.check_gaps();
            placed.iter().for_each(|placed| memory.poison(&placed.trace.hits));
        }
    }
    assert_eq!(foreign.close(), [""; 0]);
}

/// A build reads the geometry for the last time, and the scratch means nothing after it; the report is nobody's need.
#[test]
fn only_the_grid_is_needed_after_a_build() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let placed = Placed::new(&memory, &tracer, Terrain::new(12, 1));
        // SAFETY: what is recorded is submitted and waited for below, while all of it lives.
        let build = foreign.record(|cmd| unsafe { placed.cmd_build(&tracer, cmd) });
        foreign.submit(&[&build]);
        assert_eq!(placed.report().overflow, 0);
        let gridwalk::Input::Mesh(geometry) = placed.build.input else { panic!("a mesh") };
        for region in [geometry.positions, geometry.indices, placed.build.scratch] {
            memory.poison(&region);
        }
        // SAFETY: as above.
        let trace = foreign.record(|cmd| unsafe { placed.cmd_trace(&tracer, cmd) });
        foreign.submit(&[&trace]);
        placed.check();
        // A control: the grid is needed.
        memory.write(&placed.build.grid.part(0, 256), &[0u32; 64]);
        memory.poison(&placed.trace.hits);
        foreign.submit(&[&trace]);
        assert!(placed.terrain.wrong(&memory.read(&placed.trace.hits, placed.terrain.rays.len())) > 0, "it is not read");
    }
    assert_eq!(foreign.close(), [""; 0]);
}

/// The same commands with other vertices, other rays and another number of rays.
#[test]
fn a_recording_serves_other_numbers() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let terrains = [Terrain::new(10, 0), Terrain::new(10, 3), Terrain::new(10, 4)];
        let mut placed = Placed::new(&memory, &tracer, Terrain::new(10, 0));
        let rays = placed.terrain.rays.len() as u32;
        let number = memory.upload(&[rays]);
        placed.trace.count = RayCount::Indirect { count: number, max: rays };
        let commands = foreign.record(|cmd| {
            // SAFETY: what is recorded is submitted and waited for below, while all of it lives.
            unsafe {
                placed.cmd_build(&tracer, cmd);
                cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::TRACE);
                placed.cmd_trace(&tracer, cmd);
            }
        });
        let gridwalk::Input::Mesh(geometry) = placed.build.input else { panic!("a mesh") };
        for (terrain, traced) in terrains.iter().zip([rays, rays, rays / 3]) {
            memory.write(&geometry.positions, &terrain.positions);
            memory.write(&placed.trace.rays, &terrain.rays);
            memory.write(&number, &[traced]);
            memory.poison(&placed.trace.hits);
            foreign.submit(&[&commands]);
            let hits: Vec<gridwalk::Hit> = memory.read(&placed.trace.hits, rays as usize);
            let words: Vec<u32> = memory.read(&placed.trace.hits, 4 * rays as usize);
            assert_eq!(terrain.wrong(&hits), (rays - traced) as usize, "of {traced} rays");
            assert!(words[4 * traced as usize..].iter().all(|word| *word == gridwalk_tests::foreign::POISON), "rays beyond are not traced");
            memory.check_gaps();
        }
    }
    assert_eq!(foreign.close(), [""; 0]);
}

/// A build resets and writes the queries that it was given, and no others.
#[test]
fn timestamps_are_written_where_they_were_asked_for() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let mut placed = Placed::new(&memory, &tracer, Terrain::new(10, 0));
        let count = tracer.build_sizes(&placed.build.capacity).unwrap().timestamp_count;
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(count + 2);
        // SAFETY: the device lives; what uses the pool is waited for.
        let pool = unsafe { foreign.device.create_query_pool(&info, None) }.unwrap();
        placed.build.timestamps = Some(Timestamps { pool, first_query: 1 });
        let commands = foreign.record(|cmd| {
            // SAFETY: as above.
            unsafe {
                foreign.device.cmd_reset_query_pool(cmd, pool, 0, count + 2);
                placed.cmd_build(&tracer, cmd);
            }
        });
        foreign.submit(&[&commands]);
        let mut found = vec![[0u64; 2]; count as usize + 2];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WITH_AVAILABILITY;
        // SAFETY: the pool has as many queries, and its last use has ended.
        let _ = unsafe { foreign.device.get_query_pool_results(pool, 0, &mut found, flags) };
        let (written, others) = (&found[1..=count as usize], [found[0], found[count as usize + 1]]);
        assert!(written.iter().all(|[_, available]| *available != 0), "{found:?}");
        assert!(written.windows(2).all(|pair| pair[0][0] <= pair[1][0]), "{found:?}");
        assert!(others.iter().all(|[_, available]| *available == 0), "{found:?}");
        // SAFETY: as above.
        unsafe { foreign.device.destroy_query_pool(pool, None) };
    }
    assert_eq!(foreign.close(), [""; 0]);
}

/// What cannot be is refused, not recorded.
#[test]
fn what_is_too_small_or_badly_aligned_is_refused() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let Placed { build, trace, .. } = Placed::new(&memory, &tracer, Terrain::new(6, 0));
        let shorter = |region: Region| Region { size: region.size - 1, ..region };
        let moved = |region: Region, by: u64| Region { offset: region.offset + by, address: region.address + by, ..region };
        let builds = [
            ("grid", BuildInfo { grid: shorter(build.grid), ..build }),
            ("grid", BuildInfo { grid: moved(build.grid, 32), ..build }),
            ("scratch", BuildInfo { scratch: shorter(build.scratch), ..build }),
            ("scratch", BuildInfo { scratch: Region { buffer: vk::Buffer::null(), ..build.scratch }, ..build }),
            ("report", BuildInfo { report: moved(build.report, 16), ..build }),
            ("grid", BuildInfo { grid: Region { address: u64::MAX - 63, ..build.grid }, ..build }),
            ("scratch", BuildInfo { scratch: Region { offset: u64::MAX - 63, ..build.scratch }, ..build }),
        ];
        let traces = [
            ("rays", TraceInfo { rays: shorter(trace.rays), ..trace }),
            ("rays", TraceInfo { rays: moved(trace.rays, 4), ..trace }),
            ("hits", TraceInfo { hits: shorter(trace.hits), ..trace }),
            ("trace scratch", TraceInfo { scratch: shorter(trace.scratch), ..trace }),
            ("masks", TraceInfo { masks: Some(trace.rays.part(0, 4)), ..trace }),
            ("geometries", TraceInfo { geometries: Some(moved(trace.hits, 4)), ..trace }),
            ("order", TraceInfo { order: Some(trace.rays.part(0, 4)), ..trace }),
            ("counters", TraceInfo { counters: Some(moved(trace.hits, 8)), ..trace }),
            ("ray count", TraceInfo { count: RayCount::Indirect { count: moved(trace.rays.part(0, 4), 2), max: 3 }, ..trace }),
        ];
        // Nothing is recorded, so that they may overlap.
        let sort = RaySortInfo::new(trace.rays, trace.count, trace.rays, build.scratch);
        let sorts = [
            ("rays", RaySortInfo { rays: shorter(trace.rays), ..sort }),
            ("order", RaySortInfo { order: trace.rays.part(0, 4), ..sort }),
            ("ray sort scratch", RaySortInfo { scratch: build.scratch.part(0, 64), ..sort }),
            ("ray sort scratch", RaySortInfo { scratch: Region { buffer: vk::Buffer::null(), ..build.scratch }, ..sort }),
            ("ray count", RaySortInfo { count: RayCount::Indirect { count: Region::NONE, max: 3 }, ..sort }),
        ];
        let commands = foreign.record(|cmd| {
            let refused = |name: &str, result: gridwalk::Result<()>| match result {
                Err(gridwalk::Error::Region { region, .. }) => assert_eq!(region, name),
                other => panic!("{name}: {other:?}"),
            };
            // SAFETY: what is refused records nothing.
            unsafe {
                builds.iter().for_each(|(name, build)| refused(name, tracer.cmd_build(cmd, build)));
                traces.iter().for_each(|(name, trace)| refused(name, tracer.cmd_closest_hit(cmd, build.grid.address, trace)));
                refused("grid", tracer.cmd_closest_hit(cmd, build.grid.address + 32, &trace));
                sorts.iter().for_each(|(name, sort)| refused(name, tracer.cmd_sort_rays(cmd, build.grid.address, sort)));
                refused("grid", tracer.cmd_closest_hit(cmd, 0, &trace));
            }
        });
        memory.poison(&build.grid);
        foreign.submit(&[&commands]);
        assert!(memory.read::<u32>(&build.grid, 64).iter().all(|word| *word == gridwalk_tests::foreign::POISON), "something was recorded");
    }
    assert_eq!(foreign.close(), [""; 0]);
}
