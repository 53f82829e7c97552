//! What rendering and casting have in common: a device, a scene on it, a grid over it, and what is told in the end.

use std::time::Instant;

use gridwalk_render::gridwalk::Overlap;
use gridwalk_render::gridwalk_scene::{Animation, RenderDefaults};
use gridwalk_render::{BuildSettings, Context, ContextDesc, Player, PlayerOptions, SeekStats, StepTime};

use crate::args::{high, low};
use crate::exit::{Exit, Result};
use crate::output;
use crate::report::{self, Buffer, Header, Run, Step};

/// A scene on a device, under a grid.
pub struct Session {
    pub context: Context,
    pub player: Player,
    device: high::Device,
    settings: BuildSettings,
    /// Device milliseconds of the build, and of its steps: medians.
    build_ms: Option<f64>,
    build_steps: Vec<Step>,
    started: Instant,
}

impl Session {
    /// Opens the device, brings the scene to it as it is at time 0 and builds the grid.
    pub fn open(
        device: &high::Device,
        grid: &high::Grid,
        reports: &high::Reports,
        animation: Animation,
        started: Instant,
    ) -> Result<Session> {
        let context = Context::new(&ContextDesc {
            device: device.selector.clone(),
            validation: device.validate,
            name: "gridwalk",
            ..ContextDesc::default()
        })?;
        let info = context.device_info();
        report::warn_of_cpu(info);
        tracing::info!("device {} ({}), driver {}", info.name, info.kind.name(), report::driver(info));

        let time_steps = reports.stats || reports.json;
        let settings = BuildSettings { time_steps, ..build_settings(grid, &animation.scene.defaults) };
        let mut options = PlayerOptions::default();
        options.build = settings;
        let player = Player::new(&context, animation, &options)?;
        tracing::debug!("{} triangles on the device", player.scene().triangle_count());
        Ok(Session { context, player, device: device.clone(), settings, build_ms: None, build_steps: Vec::new(), started })
    }

    /// Brings scene and grid to a time; `upcoming` are those that come next.
    pub fn seek(&mut self, time: f64, upcoming: &[f64]) -> Result<SeekStats> {
        let stats = self.player.seek(time, upcoming)?;
        for warning in &stats.warnings {
            tracing::warn!("{warning}");
        }
        Ok(stats)
    }

    /// Notes how long the build took, of `repeat` more where there are to be any.
    pub fn measure_build(&mut self, repeat: Option<u32>) -> Result<()> {
        let last = |player: &Player| (player.grid().stats().ms, player.grid().stats().steps.clone());
        // The first build warms the device up; with repetitions it does not count.
        let mut builds = vec![last(&self.player)];
        if let Some(repeat) = repeat {
            builds.clear();
            for _ in 0..repeat {
                self.player.rebuild()?;
                builds.push(last(&self.player));
            }
        }
        if self.context.has_timestamps() {
            (self.build_ms, self.build_steps) = medians(builds);
        }
        Ok(())
    }

    /// Tells how the grid is, and in what it is not as it was wanted.
    pub fn tell_grid(&self) {
        let (report, settings) = (self.player.grid().stats().report, &self.settings);
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
    }

    /// What is known of the run so far.
    pub fn report(&self, command: &str, source: &high::Source, repeat: Option<u32>) -> Run {
        let info = self.context.device_info();
        let grid = self.player.grid();
        let stats = grid.stats();
        let parts = grid.tracer().map(|tracer| tracer.memory_parts(grid.capacity())).unwrap_or_default();
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
            split_cells: if stats.report.leaf_pairs > 0 { stats.report.split_cells.into() } else { 0 },
            leaf_cells: if stats.report.leaf_pairs > 0 { stats.report.leaf_cells.into() } else { 0 },
            leaf_pairs: stats.report.leaf_pairs.into(),
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
            time: None,
            outputs: Vec::new(),
            heatmap: None,
            wall_s: 0.0,
        }
    }

    /// Tells what there is to tell, and how the program is to end.
    pub fn finish(self, mut run: Run, reports: &high::Reports) -> Result<Exit> {
        let exit = self.verdict(run.unfinished);
        run.wall_s = self.seconds();
        if reports.stats {
            eprint!("{}", run.table());
        }
        if reports.json {
            output::print_json(&run)?;
        }
        Ok(exit)
    }

    /// How the program is to end when all is written, with a word on why.
    pub fn verdict(&self, unfinished: u64) -> Exit {
        let mut exit = Exit::Ok;
        if unfinished > 0 {
            tracing::warn!("{unfinished} rays were given up: too many triangles lie along them; try another --density");
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
        exit
    }

    /// Seconds since the program began.
    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
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
        split: grid.levels.map_or(library.split, |levels| levels > 1),
        ..library
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
