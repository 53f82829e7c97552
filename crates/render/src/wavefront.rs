//! The frame as a wavefront: queues of rays of one kind, one bounce a dispatch (thesis section 3.4).
//!
//! A batch of pixels goes through these steps, sample by sample: camera rays; closest hit; shade; then for each light: flag what it may
//! reach, compact, any hit, add; then compact what reflects into the next bounce's queue. Every step but the compaction is a map.
//!
//! Where surfaces are seen through, a hit may send a ray on both ways. The next queue then holds the reflected ray of each pixel, or else
//! the last of its rays that wait to go straight on, so that a pixel is still in a queue once at most: a bounce is any of these. How many
//! there will be nobody knows beforehand: the host looks at the next queue's length after each submission, and ends with an empty one.

use crate::{
    Buffer, Context, Error, Frame, FrameStats, GpuScene, Grid, Progress, RenderSettings, Result,
    camera::{camera_frame, sample_offset},
    compact::{Compaction, CompactionInfo},
    kernels,
    layout::{CameraFrame, Film, FirstHitRecord, QueueHeader, WaitingRay, Ways},
    picture::Picture,
    pipeline::{Pipeline, Recorder, Timer, map_groups, queue_groups},
    push,
    queues::{QueueShape, Queues},
    scene::update_buffer,
};
use ash::vk;
use gridwalk::{RayCount, TraceInfo};
use gridwalk_scene::Camera;
use std::{
    ops::ControlFlow,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

/// Renders pictures on one device.
pub struct Renderer {
    context: Context,
    camera_rays: Pipeline,
    first_hit: Pipeline,
    shade: Pipeline,
    light_count: Pipeline,
    light_emit: Pipeline,
    light_add: Pipeline,
    reflect_emit: Pipeline,
    compaction: Compaction,
    masked_closest: Masked,
    masked_any: Masked,
    /// Made by the first picture that needs them.
    blending: Mutex<Option<Arc<Blending>>>,
    /// Of the last picture: the next one is often like it.
    kept: Mutex<Kept>,
}

/// What one picture leaves for the next.
#[derive(Default)]
struct Kept {
    queues: Option<Queues>,
    timer: Option<Timer>,
}

/// What takes the place of other kernels where surfaces are seen through.
struct Blending {
    shade: Pipeline,
    light_pass: Masked,
    light_add: Pipeline,
    ways_emit: Pipeline,
}

impl Blending {
    fn new(context: &Context) -> Result<Blending> {
        Ok(Blending {
            shade: Pipeline::new(context, &kernels::SHADE, &[("BLEND", 1)])?,
            light_pass: Masked::new(context, &kernels::LIGHT_PASS)?,
            light_add: Pipeline::new(context, &kernels::LIGHT_ADD, &[("BLEND", 1)])?,
            ways_emit: Pipeline::new(context, &kernels::WAYS_EMIT, &[])?,
        })
    }
}

/// A walk with masks: its first dispatch, one that goes on, and the last, which reports what is still not done.
struct Masked {
    first: Pipeline,
    again: Pipeline,
    last: Pipeline,
}

const CONTINUATIONS: usize = gridwalk::plan::CONTINUATIONS as usize;

impl Masked {
    fn new(context: &Context, kernel: &'static gridwalk::kernel::Kernel) -> Result<Masked> {
        let variant = |go_on, last| Pipeline::new(context, kernel, &[("CONTINUE", go_on), ("LAST", last)]);
        Ok(Masked { first: variant(0, 0)?, again: variant(1, 0)?, last: variant(1, 1)? })
    }

    /// A walk is continued as often as the library's own.
    fn variants(&self) -> [&Pipeline; CONTINUATIONS + 1] {
        std::array::from_fn(|turn| match turn {
            0 => &self.first,
            CONTINUATIONS => &self.last,
            _ => &self.again,
        })
    }
}

impl std::fmt::Debug for Renderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Renderer").field("context", &self.context).finish_non_exhaustive()
    }
}

/// Traces in one submission, each of at most a batch of rays: what keeps a submission short enough for a watchdog.
const TRACES_PER_SUBMISSION: u32 = 8;

/// [`push::Shade::flags`].
const SHADE_CAMERA: u32 = 1;
const SHADE_TRANSPARENT: u32 = 2;
const SHADE_LAST: u32 = 4;

/// One step of a sample, in order; each that traces ends in a trace.
#[derive(Clone, Copy)]
enum Step {
    Camera,
    FirstHit,
    Shade { bounce: u32 },
    Light { bounce: u32, light: u32 },
    Reflect { bounce: u32 },
}

/// Most queues of a sample where surfaces are seen through: rays that a pixel sends on one after another, by reflection or straight on. What
/// is left then is given up, and counted as unfinished.
const MOST_WAYS: u32 = 256;

/// Most bytes of the rays that wait; a batch has fewer pixels where many reflections would need more.
const WAITING_BYTES: u64 = 128 << 20;

/// One picture as it is made, a batch of pixels at a time.
struct Batch<'a> {
    renderer: &'a Renderer,
    scene: &'a GpuScene,
    grid: &'a Grid,
    queues: Queues,
    camera: CameraFrame,
    /// Reflections that are followed.
    depth: u32,
    /// Queues of a sample, the camera's included.
    bounces: u32,
    shade_flags: u32,
    /// Where surfaces are seen through.
    blending: Option<Arc<Blending>>,
}

/// The pixels that a submission is about.
#[derive(Clone, Copy)]
struct Span {
    first: u32,
    count: u32,
    offset: [f32; 2],
}

impl Renderer {
    /// Makes the pipelines.
    ///
    /// # Errors
    /// [`Error::Vulkan`].
    pub fn new(context: &Context) -> Result<Renderer> {
        let pipeline = |kernel| Pipeline::new(context, kernel, &[]);
        Ok(Renderer {
            context: context.clone(),
            camera_rays: pipeline(&kernels::CAMERA_RAYS)?,
            first_hit: pipeline(&kernels::FIRST_HIT)?,
            shade: pipeline(&kernels::SHADE)?,
            light_count: pipeline(&kernels::LIGHT_COUNT)?,
            light_emit: pipeline(&kernels::LIGHT_EMIT)?,
            light_add: pipeline(&kernels::LIGHT_ADD)?,
            reflect_emit: pipeline(&kernels::REFLECT_EMIT)?,
            compaction: Compaction::new(context)?,
            masked_closest: Masked::new(context, &kernels::MASKED_CLOSEST_HIT)?,
            masked_any: Masked::new(context, &kernels::MASKED_ANY_HIT)?,
            blending: Mutex::default(),
            kept: Mutex::default(),
        })
    }

    /// Gives back the memory that it keeps between pictures.
    pub fn free_queues(&self) {
        *self.kept() = Kept::default();
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn blending(&self) -> Result<Arc<Blending>> {
        let mut made = self.blending.lock().unwrap_or_else(PoisonError::into_inner);
        match &*made {
            Some(blending) => Ok(Arc::clone(blending)),
            None => Ok(Arc::clone(made.insert(Arc::new(Blending::new(&self.context)?)))),
        }
    }

    /// The queues of the last picture if they are of this shape, else new ones.
    fn queues(&self, shape: QueueShape) -> Result<Queues> {
        // The old ones go first: the new ones may not fit beside them.
        let kept = self.kept().queues.take().filter(|queues| queues.shape == shape);
        kept.map_or_else(|| Queues::new(&self.context, shape), Ok)
    }

    /// Renders a scene through its grid. `progress` is called after every submission; when it breaks, the picture is given up. The memory
    /// of the queues is kept for the next picture, which takes it over when its settings are the same: see [`Renderer::free_queues`].
    ///
    /// The same scene, grid, camera and settings give the same picture, bit for bit, on the same device.
    ///
    /// # Errors
    /// [`Error::Setting`] for settings without a meaning, [`Error::OutOfDeviceMemory`], [`Error::Interrupted`], those of
    /// [`Context::submit`].
    pub fn render(
        &self,
        scene: &GpuScene,
        grid: &Grid,
        camera: &Camera,
        settings: &RenderSettings,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Frame> {
        let crop = settings.check()?;
        let begin = Instant::now();
        let pixels = crop.width * crop.height;
        let mut capacity = pixels.min(settings.batch).min(self.context.rays_per_submission());
        if scene.has_blends() {
            let pixel_bytes = size_of::<WaitingRay>() as u64 * (u64::from(followed(scene, settings)) + 1);
            // At least one pixel: 1,024 reflections are the most.
            capacity = capacity.min(u32::try_from(WAITING_BYTES / pixel_bytes).unwrap_or(u32::MAX));
        }
        let batch = Batch::new(self, scene, grid, settings, capacity, camera_frame(camera, settings, crop)?)?;
        let kept = self.kept().timer.take();
        let mut timer = kept.map_or_else(|| Timer::new(&self.context), Ok)?;
        // A picture that was given up has left its times.
        timer.take();

        let mut stats = FrameStats { queue_bytes: batch.queues.bytes, ..FrameStats::default() };
        let mut picture = Picture::new(crop, settings);
        let plan = batch.plan();
        // The middle of each pixel is traced for the layers, and is a sample of the beauty only where there is no other.
        let layers_apart = batch.queues.records.is_some() && settings.spp > 1;
        let submissions_each = plan.len() as u64 * u64::from(settings.spp) + u64::from(layers_apart);
        let total = submissions_each * u64::from(pixels.div_ceil(capacity));
        let mut done = 0;
        let mut report = |stats: &mut FrameStats, done: &mut u64, rays: u64| {
            *done += 1;
            stats.submissions += 1;
            let share = *done as f64 / total as f64;
            match progress(Progress { done: share, camera_rays: rays }) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => Err(Error::Interrupted),
            }
        };
        let mut first = 0;
        while first < pixels {
            let count = (pixels - first).min(capacity);
            let mut clear = true;
            if layers_apart {
                let span = Span { first, count, offset: [0.5, 0.5] };
                batch.submit(&mut timer, span, true, &[Step::Camera, Step::FirstHit])?;
                clear = false;
                stats.rays.camera += u64::from(count);
                report(&mut stats, &mut done, u64::from(first))?;
            }
            for sample in 0..settings.spp {
                let span = Span { first, count, offset: sample_offset(sample, settings.spp) };
                let mut used = if batch.blending.is_some() { 1 } else { batch.bounces };
                for (index, steps) in plan.iter().enumerate() {
                    let with_layers = steps.iter().filter(|step| !(layers_apart && matches!(step, Step::FirstHit)));
                    let steps: Vec<Step> = with_layers.copied().collect();
                    batch.submit(&mut timer, span, clear, &steps)?;
                    clear = false;
                    let is_over = batch.blending.is_some() && batch.is_over(&steps, &mut used)?;
                    if is_over {
                        done += (plan.len() - index - 1) as u64;
                    }
                    report(&mut stats, &mut done, u64::from(first))?;
                    if is_over {
                        break;
                    }
                }
                batch.count_rays(&mut stats, used)?;
            }
            let read = Instant::now();
            batch.read(&mut picture, first, count, &mut stats)?;
            stats.readback_ms += read.elapsed().as_secs_f64() * 1e3;
            first += count;
        }
        stats.steps = timer.take();
        *self.kept() = Kept { queues: Some(batch.queues), timer: Some(timer) };
        let traces = ["closest_hit", "any_hit", "masked_closest_hit", "masked_any_hit", "light_pass"];
        stats.trace_ms = stats.steps.iter().filter(|step| traces.contains(&step.name)).fold(0.0, |sum, step| sum + step.ms);
        let read = Instant::now();
        let layers = picture.finish()?;
        stats.readback_ms += read.elapsed().as_secs_f64() * 1e3;
        stats.frame_ms = begin.elapsed().as_secs_f64() * 1e3;
        Ok(Frame { layers, stats, build: grid.stats().clone() })
    }
}

/// Reflections that can have a ray: none without a mirror.
fn followed(scene: &GpuScene, settings: &RenderSettings) -> u32 {
    if scene.has_mirrors() { settings.depth } else { 0 }
}

/// Most queue headers.
const MOST_HEADERS: u32 = 1 << 20;

impl<'a> Batch<'a> {
    fn new(
        renderer: &'a Renderer,
        scene: &'a GpuScene,
        grid: &'a Grid,
        settings: &RenderSettings,
        capacity: u32,
        camera: CameraFrame,
    ) -> Result<Batch<'a>> {
        let depth = followed(scene, settings);
        let each = scene.light_count() + 1;
        let least = depth + 1;
        let bounces = if scene.has_blends() { least.max(MOST_WAYS.min(MOST_HEADERS / each)) } else { least };
        let headers = bounces.checked_mul(each).filter(|&headers| headers <= MOST_HEADERS).ok_or_else(|| Error::Setting {
            setting: "depth",
            value: settings.depth.to_string(),
            expected: "fewer reflections for so many lights",
        })?;
        let queues = renderer.queues(QueueShape {
            capacity,
            headers,
            has_layers: !settings.aovs.is_empty(),
            has_counts: settings.aovs.iter().any(|aov| aov.is_count()),
            scratch: grid.tracer()?.trace_scratch_size(capacity)?.size,
            waiting: if scene.has_blends() { depth + 1 } else { 0 },
        })?;
        let shade_flags = if settings.transparent { SHADE_TRANSPARENT } else { 0 };
        let blending = if scene.has_blends() { Some(renderer.blending()?) } else { None };
        Ok(Batch { renderer, scene, grid, queues, camera, depth, bounces, shade_flags, blending })
    }

    /// The steps of a sample, cut into submissions.
    fn plan(&self) -> Vec<Vec<Step>> {
        let mut steps = vec![Step::Camera];
        if self.queues.records.is_some() {
            steps.push(Step::FirstHit);
        }
        for bounce in 0..self.bounces {
            steps.push(Step::Shade { bounce });
            steps.extend((0..self.scene.light_count()).map(|light| Step::Light { bounce, light }));
            if bounce + 1 < self.bounces {
                steps.push(Step::Reflect { bounce });
            }
        }
        // A CPU takes long for a trace and nothing for a submission.
        let most = if self.renderer.context.is_cpu() { 1 } else { TRACES_PER_SUBMISSION };
        let mut submissions = vec![Vec::new()];
        let mut traces = 0;
        for step in steps {
            let is_trace = matches!(step, Step::Camera | Step::Light { .. } | Step::Reflect { .. });
            if is_trace && traces == most {
                submissions.push(Vec::new());
                traces = 0;
            }
            traces += u32::from(is_trace);
            if let Some(last) = submissions.last_mut() {
                last.push(step);
            }
        }
        submissions
    }

    fn header_offset(&self, bounce: u32, light: Option<u32>) -> u64 {
        let queue = u64::from(bounce) * (u64::from(self.scene.light_count()) + 1) + light.map_or(0, |light| u64::from(light) + 1);
        queue * size_of::<QueueHeader>() as u64
    }

    fn header(&self, bounce: u32, light: Option<u32>) -> u64 {
        self.queues.headers.address() + self.header_offset(bounce, light)
    }

    fn submit(&self, timer: &mut Timer, span: Span, clear: bool, steps: &[Step]) -> Result<()> {
        let context = &self.renderer.context;
        context.submit("a batch of pixels", |cmd| {
            let mut recorder = Recorder::new(context, cmd, timer);
            if clear {
                recorder.step("clear", "copy", |cmd| {
                    let ways = self.queues.ways.as_ref().map(|set| &set.ways);
                    for buffer in [&self.queues.film, &self.queues.unfinished].into_iter().chain(ways) {
                        // SAFETY: the command buffer is recording; the buffer lives and its size is a multiple of 4.
                        unsafe { context.device().cmd_fill_buffer(cmd, buffer.raw(), 0, vk::WHOLE_SIZE, 0) };
                    }
                });
            }
            for step in steps {
                self.record(&mut recorder, span, *step)?;
            }
            Ok(())
        })?;
        timer.collect()
    }

    fn record(&self, recorder: &mut Recorder<'_>, span: Span, step: Step) -> Result<()> {
        let renderer = self.renderer;
        let scene = self.scene.table();
        // A queue's buffers alternate between bounces.
        let here = |bounce: u32| (bounce % 2) as usize;
        match step {
            Step::Camera => {
                let [groups_x, groups_y, groups_z] = queue_groups(&renderer.context, span.count);
                let header = QueueHeader { count: span.count, groups_x, groups_y, groups_z };
                recorder.step("start", "copy", |cmd| {
                    let device = renderer.context.device();
                    update_buffer(device, cmd, &self.queues.headers, 0, bytemuck::bytes_of(&header));
                    update_buffer(device, cmd, &self.queues.camera, 0, bytemuck::bytes_of(&self.camera));
                });
                let push = push::CameraRays {
                    camera: self.queues.camera.address(),
                    rays: self.queues.rays[0].address(),
                    paths: self.queues.paths[0].address(),
                    first_pixel: span.first,
                    pixel_count: span.count,
                    sample_offset: span.offset,
                };
                recorder.dispatch(&renderer.camera_rays, &push, map_groups(span.count));
                self.closest_hit(recorder, 0, self.queues.counters.as_ref())?;
            }
            Step::FirstHit => {
                if let Some(records) = &self.queues.records {
                    let push = push::FirstHit {
                        scene,
                        queue: self.header(0, None),
                        rays: self.queues.rays[0].address(),
                        hits: self.queues.hits.address(),
                        records: records.address(),
                    };
                    recorder.dispatch(&renderer.first_hit, &push, map_groups(span.count));
                }
            }
            Step::Shade { bounce } => {
                // With ways, the kernel itself knows which rays are still the camera's.
                let mut flags = if bounce == 0 || self.blending.is_some() { self.shade_flags } else { 0 };
                if bounce == 0 {
                    flags |= SHADE_CAMERA;
                }
                if bounce + 1 == self.bounces {
                    flags |= SHADE_LAST;
                }
                let ways = self.queues.ways.as_ref();
                let push = push::Shade {
                    scene,
                    queue: self.header(bounce, None),
                    rays: self.queues.rays[here(bounce)].address(),
                    hits: self.queues.hits.address(),
                    paths: self.queues.paths[here(bounce)].address(),
                    film: self.queues.film.address(),
                    surfaces: self.queues.surfaces.address(),
                    reflects: self.queues.reflects.address(),
                    unfinished: self.queues.unfinished.address(),
                    ways: ways.map_or(0, |set| set.ways.address()),
                    waiting: ways.map_or(0, |set| set.waiting.address()),
                    flags,
                    depth: self.depth,
                    capacity: self.queues.shape.capacity,
                    padding: 0,
                };
                let pipeline = self.blending.as_ref().map_or(&renderer.shade, |blending| &blending.shade);
                self.map(recorder, pipeline, &push, self.header_offset(bounce, None));
            }
            Step::Light { bounce, light } => {
                let queue = self.header(bounce, None);
                let walk = self.header_offset(bounce, None);
                let shadow_queue = self.header(bounce, Some(light));
                let rays = self.queues.rays[here(bounce)].address();
                let surfaces = self.queues.surfaces.address();
                let push = push::LightCount { scene, queue, rays, surfaces, shadows: self.queues.shadows.address(), light, padding: 0 };
                self.map(recorder, &renderer.light_count, &push, walk);
                self.compact(recorder, queue, &self.queues.shadows, shadow_queue);
                let push = push::LightEmit {
                    scene,
                    queue,
                    rays,
                    surfaces,
                    paths: self.queues.paths[here(bounce)].address(),
                    shadows: self.queues.shadows.address(),
                    offsets: self.queues.offsets.address(),
                    shadow_rays: self.queues.shadow_rays.address(),
                    shadow_paths: self.queues.shadow_paths.address(),
                    light,
                    padding: 0,
                };
                self.map(recorder, &renderer.light_emit, &push, walk);
                self.any_hit(recorder, bounce, light)?;
                let push = push::LightAdd {
                    queue: shadow_queue,
                    paths: self.queues.shadow_paths.address(),
                    occluded: self.queues.occluded.address(),
                    film: self.queues.film.address(),
                    unfinished: self.queues.unfinished.address(),
                };
                let pipeline = self.blending.as_ref().map_or(&renderer.light_add, |blending| &blending.light_add);
                self.map(recorder, pipeline, &push, self.header_offset(bounce, Some(light)));
            }
            Step::Reflect { bounce } => {
                let queue = self.header(bounce, None);
                self.compact(recorder, queue, &self.queues.reflects, self.header(bounce + 1, None));
                let rays = self.queues.rays[here(bounce)].address();
                let surfaces = self.queues.surfaces.address();
                let paths = self.queues.paths[here(bounce)].address();
                let reflects = self.queues.reflects.address();
                let offsets = self.queues.offsets.address();
                let next_rays = self.queues.rays[here(bounce + 1)].address();
                let next_paths = self.queues.paths[here(bounce + 1)].address();
                let header = self.header_offset(bounce, None);
                if let (Some(blending), Some(set)) = (&self.blending, &self.queues.ways) {
                    let push = push::WaysEmit {
                        queue,
                        rays,
                        surfaces,
                        paths,
                        flags: reflects,
                        offsets,
                        ways: set.ways.address(),
                        waiting: set.waiting.address(),
                        next_rays,
                        next_paths,
                        capacity: self.queues.shape.capacity,
                        padding: 0,
                    };
                    self.map(recorder, &blending.ways_emit, &push, header);
                } else {
                    let push = push::ReflectEmit { queue, rays, surfaces, paths, reflects, offsets, next_rays, next_paths };
                    self.map(recorder, &renderer.reflect_emit, &push, header);
                }
                self.closest_hit(recorder, bounce + 1, None)?;
            }
        }
        Ok(())
    }

    /// Launches a map kernel over a queue whose length the device knows.
    fn map<P: bytemuck::Pod>(&self, recorder: &mut Recorder<'_>, pipeline: &Pipeline, push: &P, header: u64) {
        let arguments = header + std::mem::offset_of!(QueueHeader, groups_x) as u64;
        recorder.dispatch_indirect(pipeline, push, self.queues.headers.raw(), arguments);
    }

    /// Places of the set flags, and the header of the queue that they make.
    fn compact(&self, recorder: &mut Recorder<'_>, queue: u64, flags: &Buffer, next: u64) {
        let info = CompactionInfo {
            capacity: self.queues.shape.capacity,
            queue,
            flags: flags.address(),
            sums: self.queues.sums.address(),
            offsets: self.queues.offsets.address(),
            next,
        };
        self.renderer.compaction.record(recorder, &info);
    }

    fn trace_info(&self, rays: &Buffer, hits: &Buffer, header: u64) -> TraceInfo {
        let queues = &self.queues;
        let count = RayCount::Indirect { count: queues.headers.region().part(header, 4), max: queues.shape.capacity };
        TraceInfo::new(rays.region(), hits.region(), count, queues.scratch.region())
    }

    fn closest_hit(&self, recorder: &mut Recorder<'_>, bounce: u32, counters: Option<&Buffer>) -> Result<()> {
        let rays = &self.queues.rays[(bounce % 2) as usize];
        let header = self.header_offset(bounce, None);
        let looks_closer = self.scene.has_masks() || self.scene.has_blends();
        // Only the library's walk counts: with masks it runs for its counts alone.
        if counters.is_some() || !looks_closer {
            let tracer = self.grid.tracer()?;
            let info = TraceInfo { counters: counters.map(Buffer::region), ..self.trace_info(rays, &self.queues.hits, header) };
            recorder.step("closest_hit", "map", |cmd| {
                // SAFETY: the command buffer is recording on the tracer's device; all regions are whole living buffers of that device with
                // room for `capacity` rays; barriers stand before and behind every step; the grid's build was waited for.
                unsafe { tracer.cmd_closest_hit(cmd, self.grid.address(), &info) }
            })?;
        }
        if looks_closer {
            let push = push::MaskedClosestHit {
                grid: self.grid.address(),
                scene: self.scene.table(),
                queue: self.queues.headers.address() + header,
                rays: rays.address(),
                hits: self.queues.hits.address(),
                walks: self.queues.scratch.address(),
            };
            for pipeline in self.renderer.masked_closest.variants() {
                self.map(recorder, pipeline, &push, header);
            }
        }
        Ok(())
    }

    fn any_hit(&self, recorder: &mut Recorder<'_>, bounce: u32, light: u32) -> Result<()> {
        let header = self.header_offset(bounce, Some(light));
        if let Some(blending) = &self.blending {
            let push = push::LightPass {
                grid: self.grid.address(),
                scene: self.scene.table(),
                queue: self.queues.headers.address() + header,
                rays: self.queues.shadow_rays.address(),
                passed: self.queues.occluded.address(),
                walks: self.queues.scratch.address(),
            };
            for pipeline in blending.light_pass.variants() {
                self.map(recorder, pipeline, &push, header);
            }
            return Ok(());
        }
        if self.scene.has_masks() {
            let push = push::MaskedAnyHit {
                grid: self.grid.address(),
                scene: self.scene.table(),
                queue: self.queues.headers.address() + header,
                rays: self.queues.shadow_rays.address(),
                occluded: self.queues.occluded.address(),
                walks: self.queues.scratch.address(),
            };
            for pipeline in self.renderer.masked_any.variants() {
                self.map(recorder, pipeline, &push, header);
            }
            return Ok(());
        }
        let tracer = self.grid.tracer()?;
        let info = self.trace_info(&self.queues.shadow_rays, &self.queues.occluded, header);
        recorder.step("any_hit", "map", |cmd| {
            // SAFETY: as in `closest_hit`.
            unsafe { tracer.cmd_any_hit(cmd, self.grid.address(), &info) }
        })?;
        Ok(())
    }

    /// After a submission: whether no pixel has a ray left. `used` becomes the number of queues that have been walked over.
    fn is_over(&self, steps: &[Step], used: &mut u32) -> Result<bool> {
        let last = steps.iter().rev().find_map(|step| match step {
            Step::Reflect { bounce } => Some(bounce + 1),
            _ => None,
        });
        let Some(next) = last else { return Ok(false) };
        let at = self.header_offset(next, None);
        let header = self.queues.headers.read_by::<QueueHeader>(self.queues.readback.as_ref(), at, 1)?;
        let is_over = header.first().is_none_or(|header| header.count == 0);
        // Of an empty queue the lights were not all walked over.
        *used = if is_over { next } else { next + 1 };
        Ok(is_over)
    }

    /// Adds the lengths of a sample's queues, of which so many were used.
    fn count_rays(&self, stats: &mut FrameStats, used: u32) -> Result<()> {
        let lights = self.scene.light_count() as usize;
        let headers = self.queues.fetch::<QueueHeader>(&self.queues.headers, used as usize * (lights + 1))?;
        for (bounce, queues) in headers.chunks_exact(lights + 1).enumerate() {
            let count = u64::from(queues[0].count);
            if bounce == 0 {
                stats.rays.camera += count;
            } else {
                stats.rays.reflection += count;
            }
            stats.rays.shadow += queues[1..].iter().map(|queue| u64::from(queue.count)).sum::<u64>();
        }
        Ok(())
    }

    fn read(&self, picture: &mut Picture, first: u32, count: u32, stats: &mut FrameStats) -> Result<()> {
        let film = self.queues.fetch::<Film>(&self.queues.film, count as usize)?;
        let unfinished = self.queues.fetch::<u32>(&self.queues.unfinished, count as usize)?;
        stats.rays.unfinished += unfinished.iter().map(|&rays| u64::from(rays)).sum::<u64>();
        if let Some(set) = &self.queues.ways {
            let ways = self.queues.fetch::<Ways>(&set.ways, count as usize)?;
            let passed = ways.iter().map(|way| u64::from(way.passed)).sum::<u64>();
            // They were counted as all that comes after the camera's.
            stats.rays.passed += passed;
            stats.rays.reflection = stats.rays.reflection.saturating_sub(passed);
        }
        picture.add_film(first, &film);
        if let Some(records) = &self.queues.records {
            let records = self.queues.fetch::<FirstHitRecord>(records, count as usize)?;
            let counters = match &self.queues.counters {
                Some(counters) => self.queues.fetch::<[u32; 4]>(counters, count as usize)?,
                None => Vec::new(),
            };
            picture.add_records(first, &records, &counters);
        }
        Ok(())
    }
}
