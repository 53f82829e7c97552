//! What recording costs: time of the calling thread, nothing being submitted.

use std::time::Instant;

use anyhow::{Context as _, Result};
use gridwalk::ash::vk;
use gridwalk::{BuildInfo, Capacity, Geometry, RayCount, RegionSize, TraceInfo, Tracer};
use gridwalk_render::{Buffer, BufferDesc, BufferKind, Context};

use crate::report::median;

/// Recordings after the warm-up.
const TIMES: usize = 500;

/// Medians of the microseconds to record a build, and a trace of closest hits. The number of steps, and so the time, depends on the capacity
/// of cells alone, by a digit of the sort each 4 to 8 bits.
///
/// # Errors
/// What the device reports.
pub fn measure(context: &Context, tracer: &Tracer) -> Result<(f64, f64)> {
    const RAYS: u32 = 1 << 16;
    let capacity = Capacity { triangles: 1 << 16, cells: 1 << 20, pairs: 1 << 20, leaf_cells: 1 << 16 };
    let sizes = tracer.build_sizes(&capacity).map_err(gridwalk_render::Error::from)?;
    let scratch = tracer.trace_scratch_size(RAYS).map_err(gridwalk_render::Error::from)?;
    let buffer = |name, size| context.buffer(&BufferDesc { name, size, kind: BufferKind::Device, dedicated: false });
    let sized = |name, size: RegionSize| buffer(name, size.size);
    let triangle_bytes = 36 * u64::from(capacity.triangles);
    let build = [buffer("positions", triangle_bytes)?, buffer("indices", triangle_bytes)?];
    let build = [build, [sized("grid", sizes.grid)?, sized("scratch", sizes.scratch)?]];
    let [[positions, indices], [grid, build_scratch]] = &build;
    let report = sized("report", sizes.report)?;
    let trace = [buffer("rays", 32 * u64::from(RAYS))?, buffer("hits", 16 * u64::from(RAYS))?, sized("trace scratch", scratch)?];
    let [rays, hits, trace_scratch] = trace.each_ref().map(Buffer::region);
    let geometry = Geometry {
        positions: positions.region(),
        vertex_count: 3 * capacity.triangles,
        indices: indices.region(),
        triangle_count: capacity.triangles,
    };
    let build = BuildInfo::new(geometry, grid.region(), build_scratch.region(), report.region(), capacity);
    let trace = TraceInfo::new(rays, hits, RayCount::Direct(RAYS), trace_scratch);

    let device = context.device();
    // SAFETY: instance and physical device are of each other.
    let families = unsafe { context.instance().get_physical_device_queue_family_properties(context.physical_device()) };
    let computes = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
    let family = families.iter().position(|family| computes(family) && family.timestamp_valid_bits > 0);
    // The family that the context has made a queue of.
    let family = family.or_else(|| families.iter().position(computes)).context("no queue for compute")? as u32;
    let (mut builds, mut traces) = (Vec::with_capacity(TIMES), Vec::with_capacity(TIMES));
    // SAFETY: the pool is used here alone, and nothing recorded in it is submitted; the regions live until it is destroyed.
    let recorded = unsafe {
        let pool = device.create_command_pool(&vk::CommandPoolCreateInfo::default().queue_family_index(family), None)?;
        let mut record = || -> Result<()> {
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let cmd = device.allocate_command_buffers(&info)?.first().copied().context("no command buffer")?;
            for time in 0..TIMES + TIMES / 10 {
                device.reset_command_pool(pool, vk::CommandPoolResetFlags::empty())?;
                device.begin_command_buffer(cmd, &vk::CommandBufferBeginInfo::default())?;
                let begin = Instant::now();
                tracer.cmd_build(cmd, &build).map_err(gridwalk_render::Error::from)?;
                let middle = Instant::now();
                tracer.cmd_closest_hit(cmd, build.grid.address, &trace).map_err(gridwalk_render::Error::from)?;
                let end = Instant::now();
                device.end_command_buffer(cmd)?;
                if time >= TIMES / 10 {
                    builds.push((middle - begin).as_secs_f64() * 1e6);
                    traces.push((end - middle).as_secs_f64() * 1e6);
                }
            }
            Ok(())
        };
        let recorded = record();
        device.destroy_command_pool(pool, None);
        recorded
    };
    recorded?;
    Ok((median(builds.into_iter()), median(traces.into_iter())))
}
