//! What is told about the frames of an animation: a JSON line each and one in the end (docs/json.md), a table.

use std::fmt::Write;

use gridwalk_render::image::Rate;
use gridwalk_render::{Frame, RenderSettings, SeekStats};
use serde::Serialize;

use crate::args::high;
use crate::report::{self, Header, Heatmap, Step};
use crate::session::Session;

/// Milliseconds. Those of the device are not known without timestamps.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Times {
    pub disk_ms: f64,
    pub parse_ms: f64,
    pub upload_ms: f64,
    pub hidden_ms: f64,
    pub wait_ms: f64,
    pub deform_ms: Option<f64>,
    pub rebuild_ms: Option<f64>,
    pub trace_ms: Option<f64>,
    pub shade_ms: Option<f64>,
    pub readback_ms: f64,
    pub encode_ms: f64,
    pub frame_ms: f64,
}

impl Times {
    fn add(&mut self, other: &Times) {
        let sum = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a + b);
        *self = Times {
            disk_ms: self.disk_ms + other.disk_ms,
            parse_ms: self.parse_ms + other.parse_ms,
            upload_ms: self.upload_ms + other.upload_ms,
            hidden_ms: self.hidden_ms + other.hidden_ms,
            wait_ms: self.wait_ms + other.wait_ms,
            deform_ms: sum(self.deform_ms, other.deform_ms),
            rebuild_ms: sum(self.rebuild_ms, other.rebuild_ms),
            trace_ms: sum(self.trace_ms, other.trace_ms),
            shade_ms: sum(self.shade_ms, other.shade_ms),
            readback_ms: self.readback_ms + other.readback_ms,
            encode_ms: self.encode_ms + other.encode_ms,
            frame_ms: self.frame_ms + other.frame_ms,
        };
    }

    /// In the order of the table's columns, which is that of a frame's way.
    fn columns(&self) -> [(&'static str, Option<f64>); 11] {
        [
            ("disk", Some(self.disk_ms)),
            ("parse", Some(self.parse_ms)),
            ("upload", Some(self.upload_ms)),
            ("hidden", Some(self.hidden_ms)),
            ("deform", self.deform_ms),
            ("rebuild", self.rebuild_ms),
            ("trace", self.trace_ms),
            ("shade", self.shade_ms),
            ("read-back", Some(self.readback_ms)),
            ("encode", Some(self.encode_ms)),
            ("frame", Some(self.frame_ms)),
        ]
    }
}

/// One frame.
#[derive(Clone, Debug, Serialize)]
pub struct FrameLine {
    #[serde(flatten)]
    header: Header,
    pub frame: u64,
    time: f64,
    pub outputs: Vec<String>,
    triangles: u64,
    dropped: u64,
    rebuilt: bool,
    resolution: [u32; 3],
    density: f32,
    pairs: u64,
    key_frames: u32,
    grown: u32,
    rays: u64,
    unfinished: u64,
    #[serde(flatten)]
    pub times: Times,
    build_steps: Vec<Step>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heatmap: Option<Heatmap>,
}

impl FrameLine {
    /// What is known of a frame before it is written. `timestamps` tells whether the device has any.
    pub fn new(frame: u64, time: f64, sought: &SeekStats, picture: &Frame, timestamps: bool) -> FrameLine {
        let (stats, grid) = (&picture.stats, &sought.build.report);
        let of_device = |ms: f64| timestamps.then_some(ms);
        let steps: f64 = stats.steps.iter().map(|step| step.ms).sum();
        // The one by which the player was made is no frame's.
        let build = sought.rebuilt.then_some(&sought.build);
        let build_steps = build.filter(|_| timestamps).map_or_else(Vec::new, |build| {
            build.steps.iter().map(|step| Step { name: step.name.to_owned(), kind: step.kind, ms: step.ms }).collect()
        });
        FrameLine {
            header: Header::new("animate.frame"),
            frame,
            time,
            outputs: Vec::new(),
            triangles: grid.triangles.into(),
            dropped: grid.dropped.into(),
            rebuilt: sought.rebuilt,
            resolution: grid.resolution,
            density: grid.density,
            pairs: grid.pairs.into(),
            key_frames: sought.key_frames,
            grown: sought.grown,
            rays: stats.rays.total(),
            unfinished: stats.rays.unfinished,
            times: Times {
                disk_ms: sought.read_ms,
                parse_ms: sought.parse_ms,
                upload_ms: sought.stage_ms + sought.upload_ms,
                hidden_ms: sought.hidden_ms,
                wait_ms: sought.wait_ms,
                deform_ms: of_device(sought.deform_ms),
                rebuild_ms: of_device(build.map_or(0.0, |build| build.ms)),
                trace_ms: of_device(stats.trace_ms),
                shade_ms: of_device(steps - stats.trace_ms),
                readback_ms: stats.readback_ms,
                encode_ms: 0.0,
                frame_ms: 0.0,
            },
            build_steps,
            heatmap: None,
        }
    }
}

/// Milliseconds before the first frame.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Before {
    pub open_ms: f64,
    pub setup_ms: f64,
    pub first_build_ms: Option<f64>,
}

/// A frame's row in the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    frame: u64,
    triangles: u64,
    times: Times,
}

/// What is known of the frames so far; a run may have millions of them.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub frames: usize,
    rebuilt: usize,
    key_frames: u64,
    grown: u64,
    last_grown: Option<u64>,
    rays: u64,
    unfinished: u64,
    times: Times,
    /// With `--stats` alone.
    pub rows: Vec<Row>,
}

impl Tally {
    /// Adds a frame; `in_table` keeps its row.
    pub fn add(&mut self, line: &FrameLine, in_table: bool) {
        if self.frames == 0 {
            self.times = line.times;
        } else {
            self.times.add(&line.times);
        }
        self.frames += 1;
        self.rebuilt += usize::from(line.rebuilt);
        self.key_frames += u64::from(line.key_frames);
        self.grown += u64::from(line.grown);
        self.last_grown = if line.grown > 0 { Some(line.frame) } else { self.last_grown };
        self.rays += line.rays;
        self.unfinished += line.unfinished;
        if in_table {
            self.rows.push(Row { frame: line.frame, triangles: line.triangles, times: line.times });
        }
    }
}

/// All frames of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    #[serde(flatten)]
    header: Header,
    scene: String,
    device: String,
    device_kind: &'static str,
    device_uuid: String,
    driver: String,
    size: [u32; 2],
    spp: u32,
    fps: f64,
    frames: usize,
    pub skipped: usize,
    pub interrupted: bool,
    pub error: Option<String>,
    pub outputs: Vec<String>,
    rebuilt: usize,
    key_frames: u64,
    grown: u64,
    last_grown: Option<u64>,
    rays: u64,
    pub unfinished: u64,
    grid_bytes: u64,
    scratch_bytes: u64,
    #[serde(flatten)]
    pub before: Before,
    #[serde(flatten)]
    times: Times,
    frames_per_second: Option<f64>,
    wall_s: f64,
}

impl Summary {
    /// Sums up; how it ended is still to be filled in.
    pub fn new(session: &Session, animate: &high::Animate, settings: &RenderSettings, rate: Rate, tally: &Tally) -> Summary {
        let (device, grid) = (session.context.device_info(), session.player.grid().stats());
        let Tally { frames, rebuilt, key_frames, grown, last_grown, rays, unfinished, times, .. } = *tally;
        Summary {
            header: Header::new("animate"),
            scene: animate.source.name(),
            device: device.name.clone(),
            device_kind: device.kind.name(),
            device_uuid: device.uuid_text(),
            driver: report::driver(device),
            size: [settings.width, settings.height],
            spp: settings.spp,
            fps: rate.per_second(),
            frames,
            skipped: 0,
            interrupted: false,
            error: None,
            outputs: Vec::new(),
            rebuilt,
            key_frames,
            grown,
            last_grown,
            rays,
            unfinished,
            grid_bytes: grid.grid_bytes,
            scratch_bytes: grid.scratch_bytes,
            before: Before::default(),
            times,
            frames_per_second: None,
            wall_s: 0.0,
        }
    }

    /// Seconds of the frames alone, and of everything.
    pub fn seconds(&mut self, frames: f64, all: f64) {
        self.frames_per_second = Some(self.frames as f64 / frames).filter(|rate| rate.is_finite() && *rate > 0.0);
        self.wall_s = all;
    }
}

/// The table of `--stats`: a row a frame, then sums.
pub fn table(summary: &Summary, rows: &[Row]) -> String {
    let row = |name: &str, triangles: &str, times: &Times| {
        let cell = |(name, ms): (&str, Option<f64>)| {
            let width = name.len().max(9);
            ms.map_or_else(|| format!("{:>width$}", "-"), |ms| format!("{ms:>width$.2}"))
        };
        format!("{name:>8} {triangles:>10} {}\n", times.columns().map(cell).join(" "))
    };
    let head: Vec<String> = Times::default().columns().iter().map(|(name, _)| format!("{name:>9}")).collect();
    // Writing to a string cannot fail.
    let mut text = format!("{:>8} {:>10} {}\n", "frame", "triangles", head.join(" "));
    for line in rows {
        text.push_str(&row(&line.frame.to_string(), &line.triangles.to_string(), &line.times));
    }
    text.push_str(&row("all (ms)", "", &summary.times));
    let Before { open_ms, setup_ms, first_build_ms } = summary.before;
    let build = first_build_ms.map_or_else(String::new, |ms| format!(", {ms:.1} ms of it the build of a grid at time 0"));
    let _ =
        writeln!(text, "before   the first frame: {open_ms:.1} ms to read the scene, {setup_ms:.1} ms to bring it to the device{build}");
    let Times { disk_ms, parse_ms, upload_ms, hidden_ms, wait_ms, .. } = summary.times;
    let streamed = disk_ms + parse_ms + upload_ms;
    if streamed > 0.0 {
        let share = 100.0 * (hidden_ms / streamed).min(1.0);
        let _ = writeln!(
            text,
            "hidden   {share:.0} % of {streamed:.1} ms of disk, parse and upload ran beside earlier frames; frames waited {wait_ms:.1} ms"
        );
    }
    let _ = writeln!(text, "grid     rebuilt for {} of {} frames; buffers grown {} times", summary.rebuilt, summary.frames, summary.grown);
    if summary.skipped > 0 {
        let _ = writeln!(text, "skipped  {} frames", summary.skipped);
    }
    let rate = summary.frames_per_second.map_or_else(|| "-".to_owned(), |rate| format!("{rate:.2}"));
    let _ = writeln!(text, "rate     {rate} frames a second; wall clock {:.2} s", summary.wall_s);
    text
}
