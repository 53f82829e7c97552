//! A grid with its memory: sized, built, grown when it turns out too small.

use crate::{
    Buffer, BufferDesc, BufferKind, Context, Error, GpuScene, Result,
    pipeline::{StepTime, add_step},
    queries::Queries,
};
use ash::vk;
use gridwalk::{BuildInfo, BuildOptions, Capacity, DeviceDesc, Geometry, MAX_CELLS, MAX_PAIRS, Overlap, Report, Tracer};
use std::sync::Arc;

/// How a grid is to be built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildSettings {
    /// Density k of Equation 3-1 of the thesis: cells a triangle. Lowered where the grid would not fit; the report says to what.
    pub density: f32,
    /// Cells along each axis, instead of the density.
    pub resolution: Option<[u32; 3]>,
    /// Which cells list a triangle.
    pub overlap: Overlap,
    /// Whether cells with many triangles are split into leaf cells: the second level. Without it the grid is the thesis's.
    pub split: bool,
    /// Whether each step is timed, not the whole alone. On a CPU driver that takes 0.02 ms a step, a tenth of the build of a small scene.
    pub time_steps: bool,
}

impl Default for BuildSettings {
    fn default() -> Self {
        let BuildOptions { density, resolution, overlap } = BuildOptions::default();
        BuildSettings { density, resolution, overlap, split: true, time_steps: false }
    }
}

/// What a build took and made.
#[derive(Clone, Debug)]
pub struct BuildStats {
    /// What the device reported.
    pub report: Report,
    /// Device milliseconds of the build; 0 without timestamps.
    pub ms: f64,
    /// Device milliseconds of its steps, those of one kernel summed; none unless [`BuildSettings::time_steps`] asks for them.
    pub steps: Vec<StepTime>,
    /// Bytes of the grid, with its copy of the triangles.
    pub grid_bytes: u64,
    /// Bytes of the build's scratch.
    pub scratch_bytes: u64,
    /// How often it was built until it fit: 1 unless the memory had to grow.
    pub attempts: u32,
}

/// Makes grids on a device.
#[derive(Clone)]
pub struct GridBuilder {
    engine: Arc<Engine>,
}

/// The library's pipelines, and the device that they must not outlive.
struct Engine {
    /// `None` only while dropping.
    tracer: Option<Tracer>,
    context: Context,
}

impl Drop for Engine {
    fn drop(&mut self) {
        let mut tracer = self.tracer.take();
        self.context.destroy(|_| drop(tracer.take()));
        // Still there under a device that never came back: given up, as all else.
        std::mem::forget(tracer);
    }
}

/// A grid in device memory, ready for rays.
pub struct Grid {
    engine: Arc<Engine>,
    /// What was asked for, and what it is built with.
    wanted: BuildSettings,
    settings: BuildSettings,
    /// Triangles that there were when the density was lowered.
    lowered_for: Option<u32>,
    /// Whether more room for leaf cells is to be taken where they overflow: not once that has failed.
    may_grow: bool,
    /// Whether the last build found cells to split: if not, the next one is recorded without the second level.
    second_level: bool,
    capacity: Capacity,
    grid: Buffer,
    scratch: Option<Buffer>,
    report: Buffer,
    queries: Queries,
    stats: BuildStats,
}

/// How many pairs a triangle are reckoned with before the first count is known.
const FIRST_PAIRS_EACH: u64 = 4;

/// Below it the triangles themselves are what does not fit.
const LEAST_DENSITY: f32 = 0.1;

/// Builds that are tried at ever lower densities when a grid does not fit: enough to halve the greatest density down to the least, and some for
/// what a build counts.
const MAX_ATTEMPTS: u32 = 40;

impl std::fmt::Debug for GridBuilder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GridBuilder").field("context", &self.engine.context).finish()
    }
}

impl std::fmt::Debug for Grid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Grid").field("capacity", &self.capacity).field("stats", &self.stats).finish_non_exhaustive()
    }
}

impl GridBuilder {
    /// Makes the library's pipelines.
    ///
    /// # Errors
    /// [`Error::Gridwalk`].
    pub fn new(context: &Context) -> Result<GridBuilder> {
        let desc = DeviceDesc {
            instance: context.instance(),
            physical_device: context.physical_device(),
            device: context.device(),
            pipeline_cache: context.pipeline_cache(),
            shape: None,
            debug_utils: context.debug_utils(),
        };
        // SAFETY: the handles belong to one living context, which has the required features enabled; the engine keeps it alive beyond the
        // tracer; every submission is waited for before anything is dropped.
        let tracer = unsafe { Tracer::new(&desc) }?;
        Ok(GridBuilder { engine: Arc::new(Engine { tracer: Some(tracer), context: context.clone() }) })
    }

    /// The library's recorder, for builds and traces of the caller's own.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] while the device is being given up.
    pub fn tracer(&self) -> Result<&Tracer> {
        self.engine.tracer()
    }

    /// The context of the builder.
    pub fn context(&self) -> &Context {
        &self.engine.context
    }

    /// Builds a grid over a scene.
    ///
    /// # Errors
    /// [`Error::TooDense`] when not even a low density fits, or when a fixed resolution does not; [`Error::OutOfDeviceMemory`];
    /// [`Error::Gridwalk`] for settings without a meaning; those of [`Context::submit`].
    pub fn build(&self, scene: &GpuScene, settings: &BuildSettings) -> Result<Grid> {
        self.build_beyond(scene, settings, None)
    }

    /// As [`GridBuilder::build`]; instead of memory of a capacity that was too small, with more than just enough, so that a scene that changes
    /// soon finds room.
    fn build_beyond(&self, scene: &GpuScene, settings: &BuildSettings, outgrown: Option<Outgrown>) -> Result<Grid> {
        let geometry = scene.geometry();
        let wanted = *settings;
        let mut settings = wanted;
        let first_pairs = u64::from(geometry.triangle_count) * FIRST_PAIRS_EACH + 1024;
        let mut pairs = outgrown.as_ref().and_then(|outgrown| outgrown.pairs).map_or(first_pairs, u64::from);
        let mut needed = u32::MAX;
        let mut leaves = Leaves { leaf_cells: outgrown.as_ref().map_or(0, |outgrown| outgrown.leaf_cells), pairs: 0 };
        // With which some cells were split, while more is tried.
        let mut sufficient: Option<Leaves> = None;
        let mut may_grow = true;
        let mut outgrown = outgrown;
        for attempts in 1..=MAX_ATTEMPTS {
            let roomy = |needed: u64, most: u32, of: fn(&Capacity) -> u32| {
                let room = outgrown.as_ref().map_or(needed, |outgrown| with_room(needed, of(&outgrown.capacity).into()));
                u32::try_from(room).unwrap_or(u32::MAX).min(most)
            };
            let triangles = roomy(geometry.triangle_count.into(), gridwalk::MAX_TRIANGLES, |capacity| capacity.triangles);
            let capacity = Capacity {
                triangles,
                cells: cell_capacity(triangles, &settings)?,
                pairs: roomy(if settings.split { pairs.max(leaves.pairs.into()) } else { pairs }, MAX_PAIRS, |capacity| capacity.pairs),
                leaf_cells: match settings.split {
                    true => roomy(leaves.leaf_cells.into(), most_leaf_cells(triangles), |capacity| capacity.leaf_cells)
                        .max(first_leaf_cells(triangles)),
                    false => 0,
                },
            };
            let mut grid = match self.allocate(capacity, settings) {
                Ok(grid) => grid,
                // First without the room that nobody has asked for.
                Err(Error::OutOfDeviceMemory { .. }) if outgrown.is_some() => {
                    outgrown = None;
                    continue;
                }
                // Then without what only leaf cells ask for.
                Err(Error::OutOfDeviceMemory { .. }) if settings.split => {
                    may_grow = false;
                    match sufficient.take() {
                        Some(room) => leaves = room,
                        None => settings.split = false,
                    }
                    continue;
                }
                // Fewer cells need fewer pairs: a coarser grid is better than none.
                Err(Error::OutOfDeviceMemory { .. }) if settings.resolution.is_none() && settings.density > LEAST_DENSITY => {
                    // A density may ask for more cells than any grid has.
                    settings.density = settings.density.min(capacity.cells as f32 / triangles.max(1) as f32) / 2.0;
                    pairs = first_pairs;
                    continue;
                }
                Err(error) => return Err(error),
            };
            grid.run(&geometry)?;
            grid.stats.attempts = attempts;
            let report = &grid.stats.report;
            if !report.pairs_overflowed() {
                let is_split = report.leaf_pairs > 0;
                grid.may_grow = may_grow;
                if attempts < MAX_ATTEMPTS {
                    if let Some(more) = grid.more_leaves() {
                        sufficient = is_split.then_some(leaves);
                        leaves = more;
                        continue;
                    }
                    // A second level that comes to nothing would cost each rebuild its time.
                    if settings.split && report.leaves_overflowed() && !is_split {
                        may_grow = false;
                        match sufficient.take() {
                            Some(room) => leaves = room,
                            None => settings.split = false,
                        }
                        continue;
                    }
                }
                grid.wanted = wanted;
                grid.lowered_for = (settings.density < wanted.density).then_some(geometry.triangle_count);
                return Ok(grid);
            }
            needed = report.pair_total;
            match report.needed_pairs().filter(|&pairs| pairs <= MAX_PAIRS) {
                Some(needed) => pairs = u64::from(needed),
                None if settings.resolution.is_some() => break,
                None => {
                    settings.density = report.density / 8.0;
                    pairs = first_pairs;
                    leaves.pairs = 0;
                }
            }
        }
        Err(Error::TooDense { pairs: needed })
    }

    fn allocate(&self, capacity: Capacity, settings: BuildSettings) -> Result<Grid> {
        let context = &self.engine.context;
        let sizes = self.engine.tracer()?.build_sizes(&capacity).map_err(|error| match error {
            // Of one kind with what the memory itself refuses.
            gridwalk::Error::DeviceLimit { region, needed, limit } => {
                Error::OutOfDeviceMemory { name: region.to_owned(), needed, available: limit }
            }
            error => Error::Gridwalk(error),
        })?;
        let buffer = |name, size, kind, dedicated| context.buffer(&BufferDesc { name, size, kind, dedicated });
        let grid = buffer("grid", sizes.grid.size, BufferKind::Device, true)?;
        let scratch = buffer("build scratch", sizes.scratch.size, BufferKind::Device, true)?;
        Ok(Grid {
            stats: BuildStats {
                report: bytemuck::Zeroable::zeroed(),
                ms: 0.0,
                steps: Vec::new(),
                grid_bytes: grid.size(),
                scratch_bytes: scratch.size(),
                attempts: 1,
            },
            report: buffer("build report", sizes.report.size, BufferKind::Readback, false)?,
            queries: Queries::new(context, sizes.timestamp_count)?,
            engine: Arc::clone(&self.engine),
            wanted: settings,
            settings,
            lowered_for: None,
            may_grow: true,
            second_level: true,
            capacity,
            grid,
            scratch: Some(scratch),
        })
    }
}

/// A capacity that was too small.
struct Outgrown {
    capacity: Capacity,
    /// Pairs that a build has counted, where it was for them.
    pairs: Option<u32>,
    /// Leaf cells that there is to be room for.
    leaf_cells: u32,
}

/// Room for the second level.
#[derive(Clone, Copy)]
struct Leaves {
    leaf_cells: u32,
    pairs: u32,
}

/// Leaf cells before the first count is known.
pub(crate) fn first_leaf_cells(triangles: u32) -> u32 {
    (triangles / 2).clamp(4096, MAX_CELLS)
}

/// More pairs of both levels than that are too much memory for what leaf cells gain.
fn most_pairs(triangles: u32) -> u32 {
    triangles.saturating_mul(12).clamp(1 << 16, MAX_PAIRS)
}

/// More leaf cells than that are too much memory for what they gain.
fn most_leaf_cells(triangles: u32) -> u32 {
    triangles.saturating_mul(4).clamp(1 << 17, MAX_CELLS)
}

/// Where a capacity has turned out too small: a quarter more than is needed, and never less than there was.
fn with_room(needed: u64, was: u64) -> u64 {
    if needed <= was { was } else { needed.saturating_add(needed / 4) }
}

impl Engine {
    fn tracer(&self) -> Result<&Tracer> {
        self.tracer.as_ref().ok_or(Error::DeviceLost)
    }
}

impl Grid {
    /// What the last build took and made.
    pub fn stats(&self) -> &BuildStats {
        &self.stats
    }

    /// The settings that it was built with; the density may have been lowered until the grid fitted, and is tried again where a rebuild has
    /// fewer triangles.
    pub fn settings(&self) -> &BuildSettings {
        &self.settings
    }

    /// Whether the next builds time each step: see [`BuildSettings::time_steps`].
    pub fn time_steps(&mut self, time_steps: bool) {
        self.wanted.time_steps = time_steps;
        self.settings.time_steps = time_steps;
    }

    /// What the memory has room for.
    pub fn capacity(&self) -> &Capacity {
        &self.capacity
    }

    /// The address that stands for the whole grid.
    pub fn address(&self) -> vk::DeviceAddress {
        self.grid.address()
    }

    /// The grid's memory, for checks of what a build has made.
    pub fn buffer(&self) -> &Buffer {
        &self.grid
    }

    /// The context of the grid.
    pub fn context(&self) -> &Context {
        &self.engine.context
    }

    /// The library's recorder, for traces of the caller's own.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] while the device is being given up.
    pub fn tracer(&self) -> Result<&Tracer> {
        self.engine.tracer()
    }

    /// Whether the last build found too little room for leaf cells or their pairs, and more is possible.
    fn more_leaves(&self) -> Option<Leaves> {
        let Grid { capacity, stats: BuildStats { report, .. }, .. } = self;
        let leaf_cells = report.leaf_cells.min(most_leaf_cells(capacity.triangles)).max(capacity.leaf_cells);
        let pairs = report.needed_pairs()?;
        // Where large triangles meet all leaf cells of theirs, lists that are shorter elsewhere are not worth the memory.
        let grows = match pairs > capacity.pairs {
            true => pairs <= most_pairs(capacity.triangles),
            false => leaf_cells > capacity.leaf_cells,
        };
        let wanted = self.may_grow && capacity.leaf_cells > 0 && report.leaves_overflowed();
        (wanted && grows).then_some(Leaves { leaf_cells, pairs: pairs.max(capacity.pairs) })
    }

    /// Frees the memory of the build. The next [`Grid::rebuild`] takes it anew.
    pub fn free_scratch(&mut self) {
        self.scratch = None;
    }

    /// Builds again from nothing, in the same memory where it suffices, else in memory with room to spare: after the scene's geometry
    /// changed, or to measure.
    ///
    /// # Errors
    /// As [`GridBuilder::build`].
    pub fn rebuild(&mut self, scene: &GpuScene) -> Result<()> {
        let geometry = scene.geometry();
        let builder = GridBuilder { engine: Arc::clone(&self.engine) };
        // Tried again when there is an eighth less, so that a scene that shrinks a little each frame does not make its grid anew each time.
        let may_be_finer = self.lowered_for.is_some_and(|triangles| geometry.triangle_count <= triangles - triangles.div_ceil(8));
        if geometry.triangle_count <= self.capacity.triangles && !may_be_finer {
            if self.scratch.is_none() {
                let size = self.engine.tracer()?.build_sizes(&self.capacity)?.scratch.size;
                let desc = BufferDesc { name: "build scratch", size, kind: BufferKind::Device, dedicated: true };
                self.scratch = Some(self.engine.context.buffer(&desc)?);
            }
            self.run(&geometry)?;
            self.stats.attempts = 1;
            if !self.stats.report.pairs_overflowed() && self.more_leaves().is_none() {
                return Ok(());
            }
        }
        let overflowed = geometry.triangle_count <= self.capacity.triangles && !may_be_finer;
        let pairs = self.stats.report.needed_pairs().filter(|&pairs| overflowed && pairs <= MAX_PAIRS);
        let leaf_cells = self.more_leaves().filter(|_| overflowed).map_or(0, |more| more.leaf_cells);
        let outgrown = Outgrown { capacity: self.capacity, pairs, leaf_cells: leaf_cells.max(self.capacity.leaf_cells) };
        // The old memory goes first: the new one may not fit beside it.
        self.scratch = None;
        let wanted = self.wanted;
        *self = builder.build_beyond(scene, &wanted, Some(outgrown))?;
        Ok(())
    }

    fn run(&mut self, geometry: &Geometry) -> Result<()> {
        self.stats.steps.clear();
        self.stats.ms = 0.0;
        let was_left_out = self.settings.split && !self.second_level;
        self.run_once(geometry)?;
        // At once, so that no grid depends on those that were built before it.
        match was_left_out && self.second_level {
            true => self.run_once(geometry),
            false => Ok(()),
        }
    }

    fn run_once(&mut self, geometry: &Geometry) -> Result<()> {
        let Some(scratch) = &self.scratch else { return Ok(()) };
        let BuildSettings { density, resolution, overlap, split: _, time_steps } = self.settings;
        let info = BuildInfo {
            input: (*geometry).into(),
            grid: self.grid.region(),
            scratch: scratch.region(),
            report: self.report.region(),
            capacity: self.capacity,
            options: BuildOptions { density, resolution, overlap },
            second_level: self.second_level,
            timestamps: self.queries.timestamps().filter(|_| time_steps),
        };
        let tracer = self.engine.tracer()?;
        self.engine.context.submit("build", |cmd| {
            // SAFETY: the command buffer is recording on the tracer's device and queue; the regions are whole buffers of that device with
            // all usages, and live until the submission was waited for; the pool holds as many queries as the sizes ask for. Whatever wrote
            // the geometry was submitted and waited for before.
            let record = || unsafe { tracer.cmd_build(cmd, &info) };
            Ok(if time_steps { record() } else { self.queries.around(cmd, record) }?)
        })?;
        if let Some(report) = self.report.read::<Report>(0, 1)?.first() {
            self.stats.report = *report;
        }
        let leaf_cells = if self.second_level { self.capacity.leaf_cells } else { 0 };
        self.second_level = self.stats.report.split_cells > 0;
        if !time_steps {
            if let [begin, end] = self.queries.read(2)?[..] {
                self.stats.ms += self.queries.milliseconds(begin, end);
            }
            return Ok(());
        }
        let steps = tracer.build_steps(&Capacity { leaf_cells, ..self.capacity });
        let stamps = self.queries.read(steps.len() as u32 + 1)?;
        for (kernel, pair) in steps.iter().zip(stamps.windows(2)) {
            let ms = self.queries.milliseconds(pair[0], pair[1]);
            self.stats.ms += ms;
            add_step(&mut self.stats.steps, StepTime { name: kernel.name, kind: kernel.kind.name(), ms, count: 1 });
        }
        Ok(())
    }
}

/// Cells that Equation 3-1 asks for; the build rounds down along each axis.
pub(crate) fn cell_capacity(triangles: u32, settings: &BuildSettings) -> Result<u32> {
    let cells = match settings.resolution {
        Some(resolution) => {
            let cells = resolution.iter().map(|&cells| u64::from(cells)).fold(1_u64, u64::saturating_mul);
            if cells > u64::from(MAX_CELLS) {
                return Err(Error::Setting {
                    setting: "resolution",
                    value: resolution.map(|cells| cells.to_string()).join(" x "),
                    expected: "at most 268,435,456 cells in all",
                });
            }
            cells
        }
        None => {
            if !(settings.density > 0.0 && settings.density.is_finite()) {
                return Err(Error::Setting { setting: "density", value: settings.density.to_string(), expected: "a number above 0" });
            }
            ((f64::from(triangles) * f64::from(settings.density)).ceil() as u64).saturating_add(1)
        }
    };
    Ok(u32::try_from(cells).unwrap_or(u32::MAX).min(MAX_CELLS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_any_density() {
        let cells = |triangles, density| cell_capacity(triangles, &BuildSettings { density, ..BuildSettings::default() });
        assert!(matches!(cells(100, 2.5), Ok(251)));
        assert!(matches!(cells(0, f32::MAX), Ok(1)));
        for density in [1e10, 1e19, 1e30, f32::MAX] {
            assert!(matches!(cells(1 << 26, density), Ok(MAX_CELLS)), "{density}");
        }
        for density in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(matches!(cells(1, density), Err(Error::Setting { .. })), "{density}");
        }
    }
}
