//! What rendering and casting have in common: a device, a scene on it, a grid over it, and what is told in the end.

use std::time::Instant;

use gridwalk_render::gridwalk::Overlap;
use gridwalk_render::gridwalk_scene::{RenderDefaults, Scene};
use gridwalk_render::{BuildSettings, Context, ContextDesc, GpuScene, Grid, GridBuilder, StepTime};

use crate::args::{high, low};
use crate::exit::{Exit, Result};
use crate::output;
use crate::report::{self, Buffer, Header, Run, Step};

/// A scene on a device, under a grid.
pub struct Session {
    pub context: Context,
    pub scene: GpuScene,
    pub grid: Grid,
    device: high::Device,
    /// Device milliseconds of the build, and of its steps: medians.
    build_ms: Option<f64>,
    build_steps: Vec<Step>,
    started: Instant,
}

impl Session {
    /// Opens the device, brings the scene to it and builds the grid; `repeat` times more to measure it.
    pub fn open(device: &high::Device, grid: &high::Grid, scene: &Scene, repeat: Option<u32>, started: Instant) -> Result<Session> {
        let context = Context::new(&ContextDesc {
            device: device.selector.clone(),
            validation: device.validate,
            name: "gridwalk",
            memory_limit: None,
        })?;
        let info = context.device_info();
        report::warn_of_cpu(info);
        tracing::info!("device {} ({}), driver {}", info.name, info.kind.name(), report::driver(info));

        let gpu_scene = GpuScene::upload(&context, scene)?;
        tracing::debug!("{} triangles on the device", gpu_scene.triangle_count());
        let settings = build_settings(grid, &scene.defaults);
        let mut grid = GridBuilder::new(&context)?.build(&gpu_scene, &settings)?;
        // The first build warms the device up; with repetitions it does not count.
        let mut builds = vec![(grid.stats().ms, grid.stats().steps.clone())];
        if let Some(repeat) = repeat {
            builds.clear();
            for _ in 0..repeat {
                grid.rebuild(&gpu_scene)?;
                builds.push((grid.stats().ms, grid.stats().steps.clone()));
            }
        }
        let report = grid.stats().report;
        tracing::info!("grid of {} cells, {} pairs", report.resolution.map(|n| n.to_string()).join(" x "), report.pairs);
        if report.dropped > 0 {
            tracing::warn!("{} of {} triangles have a vertex that is not finite and are left out", report.dropped, report.triangles);
        }
        if settings.resolution.is_none() && report.density < settings.density {
            tracing::warn!("the grid was made coarser to fit: density {} instead of {}", report.density, settings.density);
        }
        if let Some(wanted) = settings.resolution.filter(|wanted| *wanted != report.resolution) {
            tracing::warn!("the resolution is {:?} instead of {wanted:?}: cells would be smaller than rounding allows", report.resolution);
        }
        let (build_ms, build_steps) = if context.has_timestamps() { medians(builds) } else { (None, Vec::new()) };
        Ok(Session { context, scene: gpu_scene, grid, device: device.clone(), build_ms, build_steps, started })
    }

    /// What is known of the run so far.
    pub fn report(&self, command: &str, source: &high::Source, repeat: Option<u32>) -> Run {
        let info = self.context.device_info();
        let stats = self.grid.stats();
        let parts = self.grid.tracer().map(|tracer| tracer.memory_parts(self.grid.capacity()).to_vec()).unwrap_or_default();
        Run {
            header: Header::new(command),
            scene: source.name(),
            device: info.name.clone(),
            device_kind: info.kind.name(),
            device_uuid: info.uuid_text(),
            driver: report::driver(info),
            triangles: stats.report.triangles.into(),
            dropped: stats.report.dropped.into(),
            resolution: stats.report.resolution,
            density: stats.report.density,
            cells: stats.report.cells.into(),
            cells_in_use: stats.report.cells_in_use.into(),
            pairs: stats.report.pairs.into(),
            longest_list: stats.report.longest_list.into(),
            grid_bytes: stats.grid_bytes,
            scratch_bytes: stats.scratch_bytes,
            buffers: parts.into_iter().map(|(name, bytes)| Buffer { name, bytes }).collect(),
            build_ms: self.build_ms,
            build_steps: self.build_steps.clone(),
            rays: 0,
            unfinished: 0,
            trace_ms: None,
            frame_ms: None,
            repeat: repeat.unwrap_or(1),
            size: None,
            spp: None,
            outputs: Vec::new(),
            heatmap: None,
            wall_s: 0.0,
        }
    }

    /// Tells what there is to tell, and how the program is to end.
    pub fn finish(self, mut run: Run, reports: &high::Reports) -> Result<Exit> {
        let mut exit = Exit::Ok;
        if run.unfinished > 0 {
            tracing::warn!("{} rays were given up: too many triangles lie along them; try another --density", run.unfinished);
            exit = Exit::Difference;
        }
        if self.device.validate {
            let messages = self.context.take_validation_messages();
            for message in &messages {
                tracing::error!("validation: {message}");
            }
            if !messages.is_empty() {
                exit = Exit::Difference;
            }
        }
        run.wall_s = self.started.elapsed().as_secs_f64();
        if reports.stats {
            eprint!("{}", run.table());
        }
        if reports.json {
            output::print_json(&run)?;
        }
        Ok(exit)
    }
}

/// The command line before the scene before the library.
pub fn build_settings(grid: &high::Grid, defaults: &RenderDefaults) -> BuildSettings {
    let library = BuildSettings::default();
    BuildSettings {
        density: grid.density.or(defaults.density).unwrap_or(library.density),
        resolution: grid.resolution,
        overlap: match grid.overlap {
            Some(low::Overlap::Box) => Overlap::Box,
            Some(low::Overlap::Exact) => Overlap::Exact,
            None => library.overlap,
        },
    }
}

/// Medians of the whole and of each step.
fn medians(builds: Vec<(f64, Vec<StepTime>)>) -> (Option<f64>, Vec<Step>) {
    let mut all: Vec<f64> = builds.iter().map(|(ms, _)| *ms).collect();
    let names = builds.last().map(|(_, steps)| steps.as_slice()).unwrap_or_default();
    let steps = names
        .iter()
        .map(|step| {
            let same = |steps: &[StepTime]| steps.iter().find(|other| other.name == step.name).map(|other| other.ms);
            let mut times: Vec<f64> = builds.iter().filter_map(|(_, steps)| same(steps)).collect();
            Step { name: step.name.to_owned(), kind: step.kind, ms: report::median(&mut times).unwrap_or(0.0) }
        })
        .collect();
    (report::median(&mut all), steps)
}
