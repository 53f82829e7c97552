//! The figures of animations: JSON, and the table made of them.

use serde::{Deserialize, Serialize};

use crate::report::{Difference, Setup, Side, Step, median};
use crate::table::{columns, head, number};

/// What a run of `dynamic` found. Times are milliseconds, medians over the runs of a frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// What was measured on, and against whom.
    #[serde(flatten)]
    pub setup: Setup,
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
    /// Each rival's.
    pub rivals: Vec<Rate>,
    /// In order.
    pub frames: Vec<FrameReport>,
}

/// A rival's frames a second.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// Who.
    pub rival: String,
    /// Of the sum of all frames.
    pub fps: f64,
    /// How often faster we are.
    pub ratio: f64,
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
    /// Rays of the frame, by kind: camera rays, a reflection ray from each hit of those, and rays to the light from the hits of both that
    /// face it.
    pub rays: Vec<RayCount>,
    /// Our times.
    pub ours: Side,
    /// The rivals'.
    pub rivals: Vec<Side>,
    /// How the hits of camera and reflection rays differ from each rival's; without distances and examples.
    pub differences: Vec<Difference>,
}

/// Rays of a kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RayCount {
    /// Which.
    pub kind: String,
    /// How many.
    pub rays: u64,
}

impl SceneReport {
    /// Sums up frames.
    pub fn new(scene: &str, frames: Vec<FrameReport>) -> SceneReport {
        let rate = |sum: f64| if sum > 0.0 { frames.len() as f64 * 1e3 / sum } else { 0.0 };
        let fps = rate(frames.iter().map(|frame| frame.ours.frame_ms()).sum());
        let names = frames.first().map_or(&[][..], |frame| &frame.rivals).iter().map(|side| side.name.clone());
        let rivals = names.enumerate().filter_map(|(index, rival)| {
            let theirs = rate(frames.iter().map(|frame| frame.rivals.get(index).map(Side::frame_ms)).sum::<Option<f64>>()?);
            (theirs > 0.0).then(|| Rate { rival, fps: theirs, ratio: fps / theirs })
        });
        SceneReport { scene: scene.to_owned(), fps, rivals: rivals.collect(), frames }
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
        let mut text = self.setup.text();
        text += &format!(
            "{0} x {0} camera rays, medians of {1} runs, milliseconds; rivals' rays through what their rebuild makes; a ratio above 1 is faster \
             than the rival\n",
            self.setup.size, self.setup.runs
        );
        for scene in &self.scenes {
            let mut first = head(&[&scene.scene, "triangles", "read", "upload", "hidden", "deform", "rebuild", "map", "cooperative"]);
            first.extend(head(&["camera", "reflection", "shadow", "Mrays", "frames/s"]));
            for rival in &scene.rivals {
                first.push(format!("{} rebuild", rival.rival));
                first.extend(head(&["rays", "frames/s", "ratio"]));
            }
            let mut rows = vec![first];
            rows.extend(scene.frames.iter().enumerate().map(|(place, frame)| frame.row(place)));
            text += &format!("\n{}", columns(&rows));
            text += &format!("{}: {} frames a second", scene.scene, number(Some(scene.fps)));
            for Rate { rival, fps, ratio } in &scene.rivals {
                text += &format!("; {rival} {}, ratio {}", number(Some(*fps)), number(Some(*ratio)));
            }
            text += &format!("\n{}", scene.steps());
        }
        text
    }
}

impl FrameReport {
    fn row(&self, place: usize) -> Vec<String> {
        let ms = |value: f64| number(Some(value));
        let rate = |side: &Side| 1e3 / side.frame_ms().max(f64::MIN_POSITIVE);
        let mut row = vec![place.to_string(), self.triangles.to_string()];
        row.extend([self.read_ms, self.upload_ms, self.hidden_ms, self.deform_ms, self.ours.rebuild_ms].map(ms));
        row.extend(["map", "cooperative"].map(|kind| ms(self.kind_ms(kind))));
        row.extend(["camera", "reflection", "shadow"].map(|kind| ms(self.ours.kind_ms(kind))));
        row.push(format!("{:.2}", self.rays.iter().map(|rays| rays.rays).sum::<u64>() as f64 * 1e-6));
        row.push(ms(rate(&self.ours)));
        for side in &self.rivals {
            let ratio = side.frame_ms() / self.ours.frame_ms().max(f64::MIN_POSITIVE);
            row.extend([side.rebuild_ms, side.trace_ms(), rate(side), ratio].map(ms));
        }
        row
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
    use crate::report::KindTime;

    #[test]
    fn rates_are_of_the_sum_of_all_frames() {
        let kind = |kind: &str, ms| KindTime { kind: kind.to_owned(), ms };
        let side = |ms: f64| Side {
            name: "Embree".to_owned(),
            rebuild_ms: ms,
            rays: vec![kind("camera", 1.0), kind("reflection", 2.0), kind("shadow", 1.0)],
        };
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
            rays: Vec::new(),
            ours: side(ms),
            rivals: theirs.into_iter().map(side).collect(),
            differences: Vec::new(),
        };
        let scene = SceneReport::new("two", vec![frame(6.0, Some(1.0)), frame(26.0, Some(11.0))]);
        assert_eq!(scene.fps, 50.0);
        assert_eq!(scene.rivals, [Rate { rival: "Embree".to_owned(), fps: 100.0, ratio: 0.5 }]);
        assert!(SceneReport::new("alone", vec![frame(6.0, None)]).rivals.is_empty());
    }
}
