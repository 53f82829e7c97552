//! The figures of animations: JSON, and the table made of them.

use serde::{Deserialize, Serialize};

use crate::report::{Difference, Rival, Step, columns, head, median, number};

/// What a run of `dynamic` found. Times are milliseconds, medians over the runs of a frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// Version of this schema.
    pub schema: u32,
    /// Version of gridwalk.
    pub version: String,
    /// The Vulkan device.
    pub device: String,
    /// Its driver.
    pub driver: String,
    /// Whether it is a CPU.
    pub device_is_cpu: bool,
    /// The rival; none where it is not installed.
    pub embree: Option<Rival>,
    /// Width and height of the pictures whose rays are traced.
    pub size: u32,
    /// Runs of each frame.
    pub runs: u32,
    /// One entry a scene.
    pub scenes: Vec<SceneReport>,
}

/// The frames of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SceneReport {
    /// As asked for.
    pub scene: String,
    /// Our frames a second, rebuild and rays: of the sum of all frames.
    pub fps: f64,
    /// The rival's.
    pub embree_fps: Option<f64>,
    /// How often faster than the rival we are.
    pub ratio: Option<f64>,
    /// In order.
    pub frames: Vec<FrameReport>,
}

/// The figures of a frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FrameReport {
    /// Seconds from the beginning.
    pub time: f64,
    /// Triangles.
    pub triangles: u32,
    /// Pairs that the grid lists.
    pub pairs: u32,
    /// Triangles in the fullest cell.
    pub longest_list: u32,
    /// Reading and parsing of the key-frames that this frame was the first to need.
    pub read_ms: f64,
    /// Their way to the device.
    pub upload_ms: f64,
    /// How much of both ran beside earlier frames.
    pub hidden_ms: f64,
    /// What the frame had to wait for them.
    pub wait_ms: f64,
    /// Interpolation, morphing, skinning and placing.
    pub deform_ms: f64,
    /// Its kernels.
    pub deform_steps: Vec<Step>,
    /// The rebuild's steps, those of one kernel summed.
    pub steps: Vec<Step>,
    /// Rays of the frame.
    pub rays: RayCounts,
    /// Our times.
    pub ours: Side,
    /// The rival's.
    pub embree: Option<Side>,
    /// How the hits of camera and reflection rays differ; without distances and examples.
    pub difference: Option<Difference>,
}

/// Rays of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RayCounts {
    /// One a pixel.
    pub camera: u64,
    /// One from each hit of those.
    pub reflection: u64,
    /// To the light, from the hits of both that face it.
    pub shadow: u64,
}

/// What a frame took one of the two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// From the triangles to what can be traced.
    pub rebuild_ms: f64,
    /// Closest hits of camera rays.
    pub camera_ms: f64,
    /// Closest hits of reflection rays.
    pub reflection_ms: f64,
    /// Any hits of shadow rays.
    pub shadow_ms: f64,
}

impl Side {
    fn trace_ms(&self) -> f64 {
        self.camera_ms + self.reflection_ms + self.shadow_ms
    }

    fn frame_ms(&self) -> f64 {
        self.rebuild_ms + self.trace_ms()
    }
}

impl SceneReport {
    /// Sums up frames.
    pub fn new(scene: &str, frames: Vec<FrameReport>) -> SceneReport {
        let rate = |sum: f64| if sum > 0.0 { frames.len() as f64 * 1e3 / sum } else { 0.0 };
        let fps = rate(frames.iter().map(|frame| frame.ours.frame_ms()).sum());
        let theirs: Option<f64> = frames.iter().map(|frame| frame.embree.map(|side| side.frame_ms())).sum();
        let embree_fps = theirs.map(rate);
        let ratio = embree_fps.filter(|fps| *fps > 0.0).map(|theirs| fps / theirs);
        SceneReport { scene: scene.to_owned(), fps, embree_fps, ratio, frames }
    }
}

impl FrameReport {
    fn kind_ms(&self, kind: &str) -> f64 {
        self.steps.iter().filter(|step| step.kind == kind).map(|step| step.ms).sum()
    }
}

impl Report {
    /// A line a frame, and one a scene; then the rebuild's steps.
    pub fn table(&self) -> String {
        let mut text = format!("{} ({})\n", self.device, self.driver);
        text += &match &self.embree {
            Some(rival) => {
                format!("against Embree {}, {} threads: Morton rebuild, rays through its tree; ", rival.version, rival.threads)
            }
            None => "Embree is not there: its columns are empty; ".to_owned(),
        };
        text += &format!(
            "{0} x {0} camera rays, medians of {1} runs, milliseconds; a ratio above 1 is faster than Embree\n",
            self.size, self.runs
        );
        for scene in &self.scenes {
            let mut rows = vec![head(&[
                &scene.scene,
                "triangles",
                "read",
                "upload",
                "hidden",
                "deform",
                "rebuild",
                "map",
                "cooperative",
                "camera",
                "reflection",
                "shadow",
                "Mrays",
                "frames/s",
                "Embree rebuild",
                "trace",
                "frames/s",
                "ratio",
            ])];
            for (place, frame) in scene.frames.iter().enumerate() {
                let ms = |value: f64| number(Some(value));
                let rate = |side: &Side| 1e3 / side.frame_ms().max(f64::MIN_POSITIVE);
                let RayCounts { camera, reflection, shadow } = frame.rays;
                let mut row = vec![place.to_string(), frame.triangles.to_string()];
                row.extend([frame.read_ms, frame.upload_ms, frame.hidden_ms, frame.deform_ms, frame.ours.rebuild_ms].map(ms));
                row.extend(["map", "cooperative"].map(|kind| ms(frame.kind_ms(kind))));
                row.extend([frame.ours.camera_ms, frame.ours.reflection_ms, frame.ours.shadow_ms].map(ms));
                row.push(format!("{:.2}", (camera + reflection + shadow) as f64 * 1e-6));
                row.push(ms(rate(&frame.ours)));
                let theirs = frame.embree.as_ref();
                row.push(number(theirs.map(|side| side.rebuild_ms)));
                row.push(number(theirs.map(Side::trace_ms)));
                row.push(number(theirs.map(rate)));
                row.push(number(theirs.map(|side| side.frame_ms() / frame.ours.frame_ms().max(f64::MIN_POSITIVE))));
                rows.push(row);
            }
            text += &format!("\n{}", columns(&rows));
            text += &format!(
                "{}: {} frames a second, Embree {}, ratio {}\n",
                scene.scene,
                number(Some(scene.fps)),
                number(scene.embree_fps),
                number(scene.ratio)
            );
            text += &scene.steps();
        }
        text
    }
}

impl SceneReport {
    /// Medians over the frames of the rebuild's steps and of the kernels before it.
    fn steps(&self) -> String {
        let mut names: Vec<(&str, &str)> = Vec::new();
        for step in self.frames.iter().flat_map(|frame| frame.deform_steps.iter().chain(&frame.steps)) {
            if !names.contains(&(&step.name, &step.kind)) {
                names.push((&step.name, &step.kind));
            }
        }
        let mut rows = vec![head(&["step", "kind", "ms"])];
        rows.extend(names.into_iter().map(|(name, kind)| {
            let all = self.frames.iter().filter_map(|frame| frame.deform_steps.iter().chain(&frame.steps).find(|step| step.name == name));
            vec![name.to_owned(), kind.to_owned(), format!("{:.3}", median(all.map(|step| step.ms)))]
        }));
        columns(&rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_of_the_sum_of_all_frames() {
        let side = |ms: f64| Side { rebuild_ms: ms, camera_ms: 1.0, reflection_ms: 2.0, shadow_ms: 1.0 };
        let frame = |ms: f64, theirs: Option<f64>| FrameReport {
            time: 0.0,
            triangles: 1,
            pairs: 1,
            longest_list: 1,
            read_ms: 0.0,
            upload_ms: 0.0,
            hidden_ms: 0.0,
            wait_ms: 0.0,
            deform_ms: 0.0,
            deform_steps: Vec::new(),
            steps: Vec::new(),
            rays: RayCounts::default(),
            ours: side(ms),
            embree: theirs.map(side),
            difference: None,
        };
        let scene = SceneReport::new("two", vec![frame(6.0, Some(1.0)), frame(26.0, Some(11.0))]);
        assert_eq!((scene.fps, scene.embree_fps, scene.ratio), (50.0, Some(100.0), Some(0.5)));
        assert_eq!(SceneReport::new("alone", vec![frame(6.0, None)]).ratio, None);
    }
}
