//! What was not timed but counted: the steps of walks, and what the device's memory can move.

use anyhow::Result;
use gridwalk::{Hit, RayCount, TraceInfo};
use gridwalk_render::{BufferDesc, BufferKind, Context, Grid};

use crate::contender::Set;
use crate::kernels::COPY;
use crate::pipeline::Pipeline;
use crate::push::Copy;
use crate::report::WalkCounts;
use crate::stopwatch::Stopwatch;

/// Means over the rays of a set, traced once more for their closest hits by a kernel that counts.
///
/// # Errors
/// What the device reports.
pub fn walks(grid: &Grid, set: &Set) -> Result<WalkCounts> {
    let context = grid.context();
    let tracer = grid.tracer()?;
    let most = context.rays_per_submission();
    let buffer = |name, size: usize| {
        let size = u64::from(most) * size as u64;
        context.buffer(&BufferDesc { name, size, kind: BufferKind::Device, dedicated: false })
    };
    let (hits, counters) = (buffer("hits", size_of::<Hit>())?, buffer("counters", 16)?);
    let size = tracer.trace_scratch_size(most).map_err(gridwalk_render::Error::from)?.size;
    let scratch = context.buffer(&BufferDesc { name: "trace scratch", size, kind: BufferKind::Device, dedicated: false })?;
    let mut sums = [0_u64; 3];
    for chunk in set.rays.chunks(most as usize) {
        let rays = context.upload("rays", chunk)?;
        let mut info = TraceInfo::new(rays.region(), hits.region(), RayCount::Direct(chunk.len() as u32), scratch.region());
        info.counters = Some(counters.region());
        context.submit("count", |cmd| {
            // SAFETY: the command buffer is recording on the tracer's device; the buffers hold `chunk` and have room for as many answers and
            // counters, and live until the submission was waited for, as does the grid, whose build was waited for.
            Ok(unsafe { tracer.cmd_closest_hit(cmd, grid.address(), &info) }?)
        })?;
        for counts in counters.read::<[u32; 4]>(0, chunk.len())? {
            sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += u64::from(count));
        }
    }
    let [steps, tests, cells] = sums.map(|sum| sum as f64 / set.rays.len().max(1) as f64);
    Ok(WalkCounts { steps, tests, cells })
}

/// Bytes that are copied to tell the bandwidth: beyond what caches hold, but in tests, which run on slow drivers.
const COPIED: u64 = if cfg!(test) { 1 << 20 } else { 256 << 20 };

/// Copies after the first.
const COPIES: usize = 5;

/// Gigabytes a second that a kernel reads and writes when it does nothing else: the best of some copies.
///
/// # Errors
/// What the device reports.
pub fn bandwidth(context: &Context) -> Result<f64> {
    // Room for two, and not all that there is.
    let size = COPIED.min(context.available_bytes() / 8).min(context.device_info().limits.max_buffer_bytes) / 16 * 16;
    let buffer = |name| context.buffer(&BufferDesc { name, size, kind: BufferKind::Device, dedicated: true });
    let (from, to) = (buffer("copied from")?, buffer("copied to")?);
    let pipeline = Pipeline::new(context, &COPY, &[])?;
    let stopwatch = Stopwatch::new(context)?;
    // Below 2^28, as the size is below 2^32.
    let count = (size / 16) as u32;
    let push = Copy { from: from.address(), to: to.address(), count, reserved: 0 };
    let mut best = f64::INFINITY;
    for _ in 0..=COPIES {
        // SAFETY: the command buffer is recording on the pipeline's device, and both buffers hold as many elements of 16 bytes.
        let ms = stopwatch.time("copy", |cmd| unsafe { pipeline.record(cmd, &push, count) })?;
        best = best.min(ms);
    }
    Ok(if best > 0.0 { 2.0 * size as f64 / best * 1e-6 } else { 0.0 })
}
