//! Rays of the caller's own.

use crate::{
    Buffer, BufferDesc, BufferKind, Context, Grid, Result,
    pipeline::{Recorder, Timer},
};
use gridwalk::{Hit, Ray, RayCount, TraceInfo};
use std::time::Instant;

/// Rays of one submission at most, so that it is short enough for a watchdog.
pub const RAYS_PER_SUBMISSION: u32 = 262_144;

/// The same for a CPU, whose slowest driver traces ten thousand rays a second through a hard scene.
const CPU_RAYS_PER_SUBMISSION: u32 = 65_536;

impl Context {
    /// Rays that one submission traces at most on this device.
    pub fn rays_per_submission(&self) -> u32 {
        if self.is_cpu() { CPU_RAYS_PER_SUBMISSION } else { RAYS_PER_SUBMISSION }
    }
}

/// Rays that [`cast`] and [`occluded`] bring to the device at once.
const RAYS_PER_BATCH: usize = 1 << 22;

/// Rays in device memory, with room for their answers.
#[derive(Debug)]
pub struct RayBatch {
    context: Context,
    rays: Buffer,
    answers: Buffer,
    scratch: Option<Buffer>,
    count: u32,
}

#[derive(Clone, Copy)]
enum Query {
    Closest,
    Any,
}

impl RayBatch {
    /// Brings rays to the device, at most 2^28.
    ///
    /// # Errors
    /// [`crate::Error::OutOfDeviceMemory`]; those of [`Context::submit`].
    pub fn new(context: &Context, rays: &[Ray]) -> Result<RayBatch> {
        let count = u32::try_from(rays.len()).unwrap_or(u32::MAX);
        if count > gridwalk::MAX_RAYS {
            return Err(gridwalk::Error::Capacity { what: "rays", given: rays.len() as u64, limit: gridwalk::MAX_RAYS.into() }.into());
        }
        let answers = context.buffer(&BufferDesc {
            name: "hits",
            size: u64::from(count) * size_of::<Hit>() as u64,
            kind: BufferKind::Device,
            dedicated: false,
        })?;
        Ok(RayBatch { context: context.clone(), rays: context.upload("rays", rays)?, answers, scratch: None, count })
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Finds the closest hit of every ray, in submissions of at most [`Context::rays_per_submission`]; returns the milliseconds that it took, by the
    /// device's clock where it has one.
    ///
    /// # Errors
    /// [`crate::Error::OutOfDeviceMemory`]; those of [`Context::submit`].
    pub fn closest_hit(&mut self, grid: &Grid) -> Result<f64> {
        self.trace(grid, Query::Closest)
    }

    /// Finds whether each ray hits anything; otherwise as [`RayBatch::closest_hit`].
    ///
    /// # Errors
    /// As [`RayBatch::closest_hit`].
    pub fn any_hit(&mut self, grid: &Grid) -> Result<f64> {
        self.trace(grid, Query::Any)
    }

    /// The answers of the last [`RayBatch::closest_hit`].
    ///
    /// # Errors
    /// Those of [`Buffer::read`].
    pub fn read_hits(&self) -> Result<Vec<Hit>> {
        self.answers.read(0, self.len())
    }

    /// The answers of the last [`RayBatch::any_hit`]: 1 for a hit, 0 for none, [`gridwalk::UNFINISHED`] for a walk that was given up.
    ///
    /// # Errors
    /// Those of [`Buffer::read`].
    pub fn read_occluded(&self) -> Result<Vec<u32>> {
        self.answers.read(0, self.len())
    }

    fn trace(&mut self, grid: &Grid, query: Query) -> Result<f64> {
        let tracer = grid.tracer()?;
        let most = self.context.rays_per_submission();
        let scratch = match self.scratch.take() {
            Some(scratch) => scratch,
            None => {
                let size = tracer.trace_scratch_size(self.count.min(most))?.size;
                self.context.buffer(&BufferDesc { name: "trace scratch", size, kind: BufferKind::Device, dedicated: false })?
            }
        };
        let mut timer = Timer::new(&self.context)?;
        let begin = Instant::now();
        let mut first = 0;
        let answer_size = match query {
            Query::Closest => size_of::<Hit>() as u64,
            Query::Any => 4,
        };
        while first < self.count {
            let count = (self.count - first).min(most);
            let rays = self.rays.region().part(u64::from(first) * size_of::<Ray>() as u64, u64::from(count) * size_of::<Ray>() as u64);
            let hits = self.answers.region().part(u64::from(first) * answer_size, u64::from(count) * answer_size);
            let info = TraceInfo::new(rays, hits, RayCount::Direct(count), scratch.region());
            self.context.submit("trace", |cmd| {
                let mut recorder = Recorder::new(&self.context, cmd, &mut timer);
                // SAFETY: the command buffer is recording on the tracer's device; the regions are parts of living buffers of that device
                // that hold `count` rays and answers; the grid was built by a submission that was waited for.
                recorder.step("trace", "map", |cmd| unsafe {
                    match query {
                        Query::Closest => tracer.cmd_closest_hit(cmd, grid.address(), &info),
                        Query::Any => tracer.cmd_any_hit(cmd, grid.address(), &info),
                    }
                })?;
                Ok(())
            })?;
            timer.collect()?;
            first += count;
        }
        let wall = begin.elapsed().as_secs_f64() * 1e3;
        self.scratch = Some(scratch);
        Ok(if self.context.has_timestamps() { timer.take().iter().map(|step| step.ms).sum() } else { wall })
    }
}

/// The closest hit of every ray.
///
/// # Errors
/// [`crate::Error::OutOfDeviceMemory`]; those of [`Context::submit`].
pub fn cast(grid: &Grid, rays: &[Ray]) -> Result<Vec<Hit>> {
    let mut hits = Vec::with_capacity(rays.len());
    for batch in rays.chunks(RAYS_PER_BATCH) {
        let mut batch = RayBatch::new(grid.context(), batch)?;
        batch.closest_hit(grid)?;
        hits.extend(batch.read_hits()?);
    }
    Ok(hits)
}

/// Whether each ray hits anything: 1, 0, or [`gridwalk::UNFINISHED`].
///
/// # Errors
/// As [`cast`].
pub fn occluded(grid: &Grid, rays: &[Ray]) -> Result<Vec<u32>> {
    let mut answers = Vec::with_capacity(rays.len());
    for batch in rays.chunks(RAYS_PER_BATCH) {
        let mut batch = RayBatch::new(grid.context(), batch)?;
        batch.any_hit(grid)?;
        answers.extend(batch.read_occluded()?);
    }
    Ok(answers)
}
