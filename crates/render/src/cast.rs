//! Rays of the caller's own.

use crate::{
    Buffer, BufferDesc, BufferKind, Context, Error, Grid, Result,
    pipeline::{Recorder, Timer},
};
use bytemuck::AnyBitPattern;
use gridwalk::{Hit, Ray, RayCount, RaySortInfo, Region, TraceInfo, Tracer};
use std::time::Instant;

/// Rays of one submission at most, so that it is short enough for a watchdog.
pub const RAYS_PER_SUBMISSION: u32 = 262_144;

/// The same for a CPU, whose slowest driver traces ten thousand rays a second through a hard scene.
const CPU_RAYS_PER_SUBMISSION: u32 = 65_536;

/// How many rays the next submission traces: as many as keep it short.
#[derive(Debug)]
struct Pace {
    rays: u32,
    least: u32,
    short_ms: f64,
}

impl Pace {
    const MOST: u32 = 1 << 20;

    /// What is so long that the next submission has half as many rays.
    const LONG_MS: f64 = 1000.0;

    fn new(context: &Context) -> Pace {
        // Where rays take eight times as long, twice as many as took so long stay within a watchdog's two seconds. A CPU has none: there it is how
        // long an interruption waits.
        let short_ms = if context.is_cpu() { 250.0 } else { 125.0 };
        Pace { rays: context.rays_per_submission(), least: context.rays_per_submission(), short_ms }
    }

    /// A submission of `count` rays has taken so long.
    fn took(&mut self, count: u32, ms: f64) {
        if count >= self.rays && ms < self.short_ms {
            self.rays = self.rays.saturating_mul(2).min(Pace::MOST);
        } else if ms > Pace::LONG_MS {
            self.rays = (self.rays / 2).max(self.least);
        }
    }
}

impl Context {
    /// Rays that one submission traces on this device, as long as nothing is known of the time that they take.
    pub fn rays_per_submission(&self) -> u32 {
        if self.is_cpu() { CPU_RAYS_PER_SUBMISSION } else { RAYS_PER_SUBMISSION }
    }
}

/// Rays in device memory, with room for their answers.
#[derive(Debug)]
pub struct RayBatch {
    context: Context,
    rays: Buffer,
    answers: Buffer,
    /// With room for how many rays.
    scratch: Option<(Buffer, u32)>,
    pace: Pace,
    /// Of rays that are sorted: the order of all, and the memory of the sort.
    sorting: Option<(Buffer, Option<Buffer>)>,
    count: u32,
    sort_ms: f64,
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
        Ok(RayBatch {
            context: context.clone(),
            rays: context.upload("rays", rays)?,
            answers,
            scratch: None,
            pace: Pace::new(context),
            sorting: None,
            count,
            sort_ms: 0.0,
        })
    }

    /// As [`RayBatch::new`], and each query sorts the rays before it traces them ([`gridwalk::Tracer::cmd_sort_rays`]): the same answers in
    /// the same places, sooner where neighbours among many rays go different ways.
    ///
    /// # Errors
    /// As [`RayBatch::new`].
    pub fn sorted(context: &Context, rays: &[Ray]) -> Result<RayBatch> {
        let batch = RayBatch::new(context, rays)?;
        let size = u64::from(batch.count) * 4;
        let order = context.buffer(&BufferDesc { name: "ray order", size, kind: BufferKind::Device, dedicated: false })?;
        Ok(RayBatch { sorting: Some((order, None)), ..batch })
    }

    /// Milliseconds of the last query that sorting its rays took.
    pub fn sort_ms(&self) -> f64 {
        self.sort_ms
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Finds the closest hit of every ray; returns the milliseconds that it took, by the device's clock where it has one. The first submission has
    /// [`Context::rays_per_submission`] rays; as long as they are short, the next has twice as many, up to 2^20.
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
        let mut timer = Timer::new(&self.context)?;
        let begin = Instant::now();
        if let Some((order, scratch)) = &mut self.sorting {
            if scratch.is_none() {
                let size = tracer.ray_sort_scratch_size(self.count)?.size;
                let desc = BufferDesc { name: "ray sort scratch", size, kind: BufferKind::Device, dedicated: false };
                *scratch = Some(self.context.buffer(&desc)?);
            }
            let scratch = scratch.as_ref().map_or(Region::NONE, Buffer::region);
            let info = RaySortInfo::new(self.rays.region(), RayCount::Direct(self.count), order.region(), scratch);
            self.context.submit("sort rays", |cmd| {
                let mut recorder = Recorder::new(&self.context, cmd, &mut timer);
                // SAFETY: as below; the order has room for as many indices.
                recorder.step("sort", "cooperative", |cmd| unsafe { tracer.cmd_sort_rays(cmd, grid.address(), &info) })?;
                Ok(())
            })?;
            timer.collect()?;
        }
        let mut first = 0;
        let answer_size = match query {
            Query::Closest => size_of::<Hit>() as u64,
            Query::Any => 4,
        };
        while first < self.count {
            let wanted = (self.count - first).min(self.pace.rays);
            let (scratch, room) = self.scratch_for(tracer, wanted)?;
            let count = wanted.min(room);
            let part = |region: Region, size: u64| region.part(u64::from(first) * size, u64::from(count) * size);
            let (rays, hits, number) = (self.rays.region(), self.answers.region(), RayCount::Direct(count));
            // A part of the order is of rays from everywhere.
            let info = match &self.sorting {
                Some((order, _)) => {
                    TraceInfo { order: Some(part(order.region(), 4)), ..TraceInfo::new(rays, hits, number, scratch.region()) }
                }
                None => TraceInfo::new(part(rays, size_of::<Ray>() as u64), part(hits, answer_size), number, scratch.region()),
            };
            let submitted = Instant::now();
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
            self.scratch = Some((scratch, room));
            self.pace.took(count, submitted.elapsed().as_secs_f64() * 1e3);
            first += count;
        }
        let wall = begin.elapsed().as_secs_f64() * 1e3;
        let steps = timer.take();
        self.sort_ms = steps.iter().filter(|step| step.name == "sort").map(|step| step.ms).sum();
        Ok(if self.context.has_timestamps() { steps.iter().map(|step| step.ms).sum() } else { wall })
    }
}

impl RayBatch {
    /// Scratch for so many rays, or for fewer if there was some and there is no memory for more.
    fn scratch_for(&mut self, tracer: &Tracer, count: u32) -> Result<(Buffer, u32)> {
        let before = match self.scratch.take() {
            Some((scratch, room)) if room >= count => return Ok((scratch, room)),
            before => before,
        };
        let size = tracer.trace_scratch_size(count)?.size;
        let made = self.context.buffer(&BufferDesc { name: "trace scratch", size, kind: BufferKind::Device, dedicated: false });
        match (made, before) {
            (Ok(scratch), _) => Ok((scratch, count)),
            (Err(Error::OutOfDeviceMemory { .. }), Some(before)) => Ok(before),
            (Err(error), _) => Err(error),
        }
    }
}

/// Rays on their way to the device and answers on their way back, in memory that both the host and the device see: each is copied once, and
/// crosses a bus once.
struct Lane {
    rays: Buffer,
    answers: Buffer,
}

impl Lane {
    fn new(context: &Context, count: usize, answer_size: usize) -> Result<Lane> {
        let buffer = |name, size: usize, kind| context.buffer(&BufferDesc { name, size: (count * size) as u64, kind, dedicated: false });
        Ok(Lane {
            rays: buffer("rays", size_of::<Ray>(), BufferKind::Upload)?,
            answers: buffer("hits", answer_size, BufferKind::Readback)?,
        })
    }

    /// To be called while the device has nothing to do with the lane.
    fn put(&self, rays: &[Ray]) -> Result<()> {
        let pointer = seen(&self.rays)?;
        // SAFETY: the buffer has room for as many rays (no batch is longer than the first, which it was made for), aligned to 64 bytes; the
        // device does not use the lane, and of the host's threads one at a time does.
        unsafe { std::ptr::copy_nonoverlapping(rays.as_ptr(), pointer.cast(), rays.len()) };
        Ok(())
    }

    /// As [`Lane::put`]; the answers of as many rays are there.
    fn take<T: AnyBitPattern>(&self, count: usize, answers: &mut Vec<T>) -> Result<()> {
        let pointer = seen(&self.answers)?;
        // SAFETY: as in `put`; every bit pattern is a `T`.
        answers.extend_from_slice(unsafe { std::slice::from_raw_parts(pointer.cast(), count) });
        Ok(())
    }
}

fn seen(buffer: &Buffer) -> Result<*mut u8> {
    let unseen = || Error::Allocator { name: buffer.name().to_owned(), reason: "the host cannot see the memory".to_owned() };
    buffer.pointer().ok_or_else(unseen)
}

/// The answers for all rays, in two lanes: while the device traces the rays of one, the host copies the answers out of the other and the
/// next rays into it.
fn trace_in_lanes<T: AnyBitPattern + Send>(grid: &Grid, rays: &[Ray], query: Query) -> Result<Vec<T>> {
    let context = grid.context();
    let tracer = grid.tracer()?;
    let batches: Vec<&[Ray]> = rays.chunks(context.rays_per_submission() as usize).collect();
    let mut answers = Vec::with_capacity(rays.len());
    let (Some(first), Some(last)) = (batches.first(), batches.last()) else { return Ok(answers) };
    let lanes = batches.iter().take(2).map(|_| Lane::new(context, first.len(), size_of::<T>())).collect::<Result<Vec<_>>>()?;
    // Below 2^32, as the device's rays for a submission are.
    let size = tracer.trace_scratch_size(first.len() as u32)?.size;
    let scratch = context.buffer(&BufferDesc { name: "trace scratch", size, kind: BufferKind::Device, dedicated: false })?;
    let trace = |lane: &Lane, count: usize| {
        let info = TraceInfo::new(lane.rays.region(), lane.answers.region(), RayCount::Direct(count as u32), scratch.region());
        context.submit("trace", |cmd| {
            // SAFETY: the command buffer is recording on the tracer's device; the lane has room for as many rays and answers, and lives until
            // the submission has been waited for; the grid was built by a submission that was waited for.
            context.label(cmd, "trace", || unsafe {
                match query {
                    Query::Closest => tracer.cmd_closest_hit(cmd, grid.address(), &info),
                    Query::Any => tracer.cmd_any_hit(cmd, grid.address(), &info),
                }
            })?;
            Ok(())
        })
    };
    lanes[0].put(first)?;
    for (i, batch) in batches.iter().enumerate() {
        let lane = &lanes[i % 2];
        let Some(other) = lanes.get((i + 1) % 2) else {
            trace(lane, batch.len())?;
            continue;
        };
        let beside = || {
            if let Some(before) = i.checked_sub(1) {
                other.take(batches[before].len(), &mut answers)?;
            }
            batches.get(i + 1).map_or(Ok(()), |next| other.put(next))
        };
        std::thread::scope(|scope| {
            let copying = scope.spawn(beside);
            let traced = trace(lane, batch.len());
            let copied = copying.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            traced.and(copied)
        })?;
    }
    lanes[(batches.len() - 1) % 2].take(last.len(), &mut answers)?;
    Ok(answers)
}

/// The closest hit of every ray, in batches of [`Context::rays_per_submission`], between which the device does not wait for copies.
///
/// # Errors
/// [`crate::Error::OutOfDeviceMemory`]; those of [`Context::submit`].
pub fn cast(grid: &Grid, rays: &[Ray]) -> Result<Vec<Hit>> {
    trace_in_lanes(grid, rays, Query::Closest)
}

/// Whether each ray hits anything: 1, 0, or [`gridwalk::UNFINISHED`]; otherwise as [`cast`].
///
/// # Errors
/// As [`cast`].
pub fn occluded(grid: &Grid, rays: &[Ray]) -> Result<Vec<u32>> {
    trace_in_lanes(grid, rays, Query::Any)
}

#[cfg(test)]
mod tests {
    use super::Pace;

    #[test]
    fn submissions_grow_while_they_are_short() {
        let mut pace = Pace { rays: 100_000, least: 100_000, short_ms: 250.0 };
        pace.took(100_000, 249.0);
        assert_eq!(pace.rays, 200_000);
        // The rest of a batch says little.
        pace.took(1, 0.0);
        assert_eq!(pace.rays, 200_000);
        pace.took(200_000, 250.0);
        assert_eq!(pace.rays, 200_000);
        for _ in 0..4 {
            pace.took(pace.rays, 0.0);
        }
        assert_eq!(pace.rays, Pace::MOST);
        pace.took(1, 1001.0);
        assert_eq!(pace.rays, Pace::MOST / 2);
        for _ in 0..4 {
            pace.took(pace.rays, 5000.0);
        }
        assert_eq!(pace.rays, 100_000);
    }
}
