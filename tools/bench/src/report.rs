//! The figures of a run, as JSON has them.

use serde::{Deserialize, Serialize};

/// Version of the schema that is written, and the only one that is read.
pub const SCHEMA: u32 = 2;

/// What was measured on, and against whom.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Setup {
    /// Version of this schema: [`SCHEMA`].
    pub schema: u32,
    /// Version of gridwalk.
    pub version: String,
    /// The Vulkan device.
    pub device: String,
    /// Its driver.
    pub driver: String,
    /// Whether it is a CPU.
    pub device_is_cpu: bool,
    /// Who was measured besides.
    pub rivals: Vec<Rival>,
    /// Width and height of the camera's picture.
    pub size: u32,
    /// Runs after the warm-up.
    pub runs: u32,
}

/// What a whole run of the program found. Times are milliseconds, rates millions of rays a second.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// What was measured on, and against whom.
    #[serde(flatten)]
    pub setup: Setup,
    /// Milliseconds to make the library's pipelines.
    pub pipelines_ms: f64,
    /// Median of the microseconds to record a build into a command buffer.
    pub record_build_us: f64,
    /// Likewise a trace of closest hits.
    pub record_trace_us: f64,
    /// Gigabytes a second that a kernel which only copies reads and writes on the device.
    pub bandwidth_gb_s: f64,
    /// One entry a scene.
    pub scenes: Vec<SceneReport>,
    /// Geometric means of the ratios over scenes.
    pub means: Vec<Mean>,
}

/// A rival and how it was used.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Rival {
    /// As the figures name it.
    pub name: String,
    /// Its version, and where it comes from.
    pub version: String,
    /// Its threads; none where it runs on the device.
    pub threads: Option<u32>,
    /// How it rebuilds, and what the rays of whole frames go through.
    pub rebuild: String,
    /// What all other rays go through.
    pub tree: String,
}

/// The figures of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SceneReport {
    /// As asked for.
    pub scene: String,
    /// Whence it was seen.
    pub view: View,
    /// Triangles.
    pub triangles: u32,
    /// Of them left out for a vertex that is not finite.
    pub dropped: u32,
    /// Density k that was built with.
    pub density: f32,
    /// Overlap test.
    pub overlap: String,
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// All cells.
    pub cells: u32,
    /// Cells that list a triangle.
    pub cells_in_use: u32,
    /// Pairs that are listed.
    pub pairs: u32,
    /// Pairs that the build needed room for: those that are left behind while sorting included.
    pub pair_total: u32,
    /// Triangles in the fullest cell, before it was split.
    pub longest_list: u32,
    /// Cells with so many triangles that they are split.
    pub split_cells: u32,
    /// Leaf cells that they ask for.
    pub leaf_cells: u32,
    /// Pairs of leaf cells, beside `pairs`.
    pub leaf_pairs: u32,
    /// Bytes of the grid with its triangles, as the renderer sizes it: pairs for the first guess of its builder or what a first build asked for.
    pub grid_bytes: u64,
    /// Bytes of the build's scratch, sized likewise.
    pub scratch_bytes: u64,
    /// Bytes of both, if sized for exactly the cells and pairs of this scene.
    pub fitted_bytes: u64,
    /// Bytes of the rivals' trees that are rebuilt, with what building takes, where they are known.
    pub rebuilt_bytes: Vec<RivalBytes>,
    /// Likewise of those that are traced.
    pub traced_bytes: Vec<RivalBytes>,
    /// Rebuilds; none if they were not asked for.
    pub rebuild: Option<Comparison>,
    /// Medians of the rebuild's steps, those of one kernel summed.
    pub steps: Vec<Step>,
    /// Whole frames; none if they were not asked for.
    pub frame: Option<FrameReport>,
    /// Rays, by kind.
    pub rays: Vec<RayReport>,
}

/// Memory of a rival.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RivalBytes {
    /// Who.
    pub rival: String,
    /// How many.
    pub bytes: u64,
}

/// A camera of square pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Where it stands.
    pub eye: [f32; 3],
    /// What is in the middle.
    pub target: [f32; 3],
    /// Angle of view.
    pub fov_degrees: f32,
}

/// A step of the rebuild.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Step {
    /// Kernel.
    pub name: String,
    /// `map` or `cooperative`.
    pub kind: String,
    /// Launches.
    pub count: u32,
    /// Median of the milliseconds of all launches.
    pub ms: f64,
    /// Bytes that all launches have to move, as far as that is reckoned: every array once.
    pub bytes: Option<u64>,
}

impl Step {
    /// A step as it was measured once.
    pub fn of(step: &gridwalk_render::StepTime) -> Step {
        Step { name: step.name.to_owned(), kind: step.kind.to_owned(), count: step.count, ms: step.ms, bytes: None }
    }
}

/// What a ray's walk has done: means over all rays of a set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WalkCounts {
    /// Blocks of cells that were visited.
    pub steps: f64,
    /// Triangles that were tested.
    pub tests: f64,
    /// Cells in use that were visited.
    pub cells: f64,
}

/// Frames: a rebuild from nothing, then rays through what it made, of rivals too.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FrameReport {
    /// The whole.
    pub time: Comparison,
    /// Ours, in parts.
    pub ours: Side,
    /// The rivals', likewise.
    pub rivals: Vec<Side>,
}

/// What a frame took a contender: medians.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// Who.
    pub name: String,
    /// From the triangles to what can be traced.
    pub rebuild_ms: f64,
    /// Each kind of rays.
    pub rays: Vec<KindTime>,
}

/// Time of rays of a kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KindTime {
    /// Which.
    pub kind: String,
    /// Milliseconds.
    pub ms: f64,
}

impl Side {
    /// All rays.
    pub fn trace_ms(&self) -> f64 {
        self.rays.iter().map(|rays| rays.ms).sum()
    }

    /// Rebuild and rays.
    pub fn frame_ms(&self) -> f64 {
        self.rebuild_ms + self.trace_ms()
    }

    /// Rays of one kind.
    pub fn kind_ms(&self, kind: &str) -> f64 {
        self.rays.iter().filter(|rays| rays.kind == kind).map(|rays| rays.ms).sum()
    }
}

/// The figures of one kind of rays.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RayReport {
    /// `camera`, `shadow`, `reflection`, `diffuse`, `any` or `object`.
    pub kind: String,
    /// In which order we traced them: `given` or `sorted`.
    #[serde(default)]
    pub order: String,
    /// Median of the milliseconds that sorting took, which our times include; none where the rays were not sorted.
    #[serde(default)]
    pub sort_ms: Option<f64>,
    /// How many.
    pub rays: u64,
    /// Of them hit something.
    pub hits: u64,
    /// Walks that were given up.
    pub unfinished: u64,
    /// Our median in millions of rays a second.
    pub mrays: f64,
    /// What the walks of closest hits have done; none of any hits, which are not counted.
    pub walk: Option<WalkCounts>,
    /// Times.
    pub time: Comparison,
    /// How the hits differ from those of each rival.
    pub differences: Vec<Difference>,
    /// Of `object`: the same rays, while the object is all that there is.
    pub alone: Option<Against>,
}

/// How two rounds of hits differ. The same triangle is the same hit, since a grazing ray's distance is mostly rounding; of different
/// triangles, distances are the same if they differ by at most 1e-4 of the greater. A miss is infinitely far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// From whose.
    pub rival: String,
    /// Rays that were compared: fewer than all where the rival is far too slow for them.
    pub rays: u64,
    /// Another triangle at the same distance: neighbours share edges.
    pub triangle: u64,
    /// We hit something nearer than the rival.
    pub nearer: u64,
    /// We hit something farther than the rival, or gave up.
    pub farther: u64,
    /// Greatest difference of distance where the triangle is the same, in units of the direction's length.
    pub distance: f32,
    /// The first of those that are nearer or farther.
    pub examples: Vec<Example>,
}

/// A ray that was answered differently.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// Its place among the rays.
    pub ray: u64,
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes.
    pub direction: [f32; 3],
    /// Our distance and triangle; none for a miss.
    pub ours: Option<(f32, u32)>,
    /// The rival's.
    pub theirs: Option<(f32, u32)>,
}

/// Our times beside those of each rival.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Comparison {
    /// Ours, on the device.
    pub ours: Times,
    /// The rivals'.
    pub rivals: Vec<Against>,
}

/// Someone's times, and how often faster we are. Medians, unless a name says otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Against {
    /// Who.
    pub rival: String,
    /// On the device for who runs there, else on the wall.
    pub times: Times,
    /// How often faster we are, by medians; none where we took no time at all.
    pub ratio: Option<f64>,
    /// Likewise by the best runs.
    pub best_ratio: Option<f64>,
    /// Likewise by processor time, where the device is a CPU: what a busy machine disturbs least. None for a rival that has traced a part of
    /// the rays.
    pub processor_ratio: Option<f64>,
    /// The ratios of the turns, each of which has a run of ours and one of the rival's.
    pub turns: Option<Spread>,
    /// Likewise by processor time.
    pub processor_turns: Option<Spread>,
}

/// The ends of what was measured again and again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Least.
    pub least: f64,
    /// Greatest.
    pub greatest: f64,
}

impl Spread {
    /// Of some numbers; none where one is not finite, or not above 0, or there is none.
    pub fn of(numbers: impl Iterator<Item = f64>) -> Option<Spread> {
        let widen = |spread: Option<Spread>, x: f64| {
            let Spread { least, greatest } = spread.unwrap_or(Spread { least: x, greatest: x });
            Some(Spread { least: least.min(x), greatest: greatest.max(x) })
        };
        let mut all = None;
        for number in numbers {
            if !(number > 0.0 && number.is_finite()) {
                return None;
            }
            all = widen(all, number);
        }
        all
    }

    /// How far apart the ends are.
    pub fn factor(&self) -> f64 {
        self.greatest / self.least
    }
}

/// Milliseconds over the runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Median.
    pub median_ms: f64,
    /// Least.
    pub best_ms: f64,
    /// Greatest.
    pub worst_ms: f64,
    /// Median of the processor time that all threads of the program took together, with what the host did besides.
    pub processor_ms: f64,
}

/// What one run took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Milliseconds, by the device's clock for ours and on the wall for the rival.
    pub ms: f64,
    /// Milliseconds of processor time of all threads of the program.
    pub processor_ms: f64,
}

/// The runs of a rival.
pub struct RivalRuns<'a> {
    /// Who.
    pub name: &'a str,
    /// In order.
    pub runs: &'a [Run],
    /// Whether it has traced a part of the rays, so that its processor time is that of the part.
    pub is_sampled: bool,
}

impl Times {
    /// Sums up runs; zeros where there is none.
    pub fn of(runs: &[Run]) -> Times {
        let ms = || runs.iter().map(|run| run.ms);
        Times {
            median_ms: median(ms()),
            best_ms: ms().reduce(f64::min).unwrap_or(0.0),
            worst_ms: ms().reduce(f64::max).unwrap_or(0.0),
            processor_ms: median(runs.iter().map(|run| run.processor_ms)),
        }
    }

    /// Millions of rays a second, of so many rays.
    pub fn mrays(&self, rays: u64) -> f64 {
        if self.median_ms > 0.0 { rays as f64 / self.median_ms * 1e-3 } else { 0.0 }
    }
}

/// The middle number, or the mean of the middle two; 0 of none.
pub fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut ordered: Vec<f64> = numbers.collect();
    ordered.sort_by(f64::total_cmp);
    let at = |index: usize| ordered.get(index).copied().unwrap_or(0.0);
    match ordered.len() {
        0 => 0.0,
        count if count % 2 == 1 => at(count / 2),
        count => (at(count / 2 - 1) + at(count / 2)) * 0.5,
    }
}

impl Against {
    /// Compares our runs to a rival's.
    pub fn of(runs: &[Run], rival: &RivalRuns<'_>, device_is_cpu: bool) -> Against {
        let (ours, times) = (Times::of(runs), Times::of(rival.runs));
        let has_processor = device_is_cpu && !rival.is_sampled;
        let turns = |of: fn(&Run) -> f64| Spread::of(runs.iter().zip(rival.runs).map(|(ours, theirs)| of(theirs) / of(ours)));
        let ratio = |ours: f64, theirs: f64| (ours > 0.0).then_some(theirs / ours);
        Against {
            rival: rival.name.to_owned(),
            times,
            ratio: ratio(ours.median_ms, times.median_ms),
            best_ratio: ratio(ours.best_ms, times.best_ms),
            processor_ratio: ratio(ours.processor_ms, times.processor_ms).filter(|_| has_processor),
            turns: turns(|run| run.ms),
            processor_turns: turns(|run| run.processor_ms).filter(|_| has_processor),
        }
    }
}

impl Comparison {
    /// Compares our runs to those of each rival.
    pub fn of(ours: &[Run], rivals: &[RivalRuns<'_>], device_is_cpu: bool) -> Comparison {
        let rivals = rivals.iter().map(|rival| Against::of(ours, rival, device_is_cpu));
        Comparison { rivals: rivals.collect(), ours: Times::of(ours) }
    }

    /// A rival by its name.
    pub fn against(&self, rival: &str) -> Option<&Against> {
        self.rivals.iter().find(|against| against.rival == rival)
    }

    /// By whom a change is measured: the first rival that both have.
    pub fn common<'a>(&'a self, other: &'a Comparison) -> Option<(&'a Against, &'a Against)> {
        self.rivals.iter().find_map(|ours| Some((ours, other.against(&ours.rival)?)))
    }
}

impl SceneReport {
    /// Every comparison by its name.
    pub fn figures(&self) -> impl Iterator<Item = (&str, &Comparison)> {
        let rebuild = self.rebuild.iter().map(|rebuild| ("rebuild", rebuild));
        let frame = self.frame.iter().map(|frame| ("frame", &frame.time));
        rebuild.chain(frame).chain(self.rays.iter().map(|rays| (rays.kind.as_str(), &rays.time)))
    }
}

/// The geometric mean of the ratios of one figure to one rival.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mean {
    /// `rebuild`, `frame` or a kind of rays.
    pub figure: String,
    /// Against whom.
    pub rival: String,
    /// Over which scenes.
    pub scenes: Vec<String>,
    /// How often faster we are.
    pub ratio: f64,
}

/// The means over those of the `wanted` scenes that were measured, or over all scenes where none of them was.
pub fn means(setup: &Setup, scenes: &[SceneReport], wanted: &[&str]) -> Vec<Mean> {
    let is_wanted = |scene: &&SceneReport| wanted.contains(&scene.scene.as_str());
    let any_wanted = scenes.iter().any(|scene| is_wanted(&scene));
    let chosen: Vec<&SceneReport> = scenes.iter().filter(|scene| !any_wanted || is_wanted(scene)).collect();
    let mut figures: Vec<&str> = Vec::new();
    for (figure, _) in chosen.iter().flat_map(|scene| scene.figures()) {
        if !figures.contains(&figure) {
            figures.push(figure);
        }
    }
    let mean = |figure: &str, rival: &Rival| {
        let ratios = chosen.iter().filter_map(|scene| {
            let (_, comparison) = scene.figures().find(|(name, _)| *name == figure)?;
            let ratio = comparison.against(&rival.name)?.ratio.filter(|ratio| *ratio > 0.0)?;
            Some((scene.scene.clone(), ratio.ln()))
        });
        let (scenes, logarithms): (Vec<String>, Vec<f64>) = ratios.unzip();
        let ratio = (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp();
        (!scenes.is_empty()).then(|| Mean { figure: figure.to_owned(), rival: rival.name.clone(), scenes, ratio })
    };
    figures.iter().flat_map(|figure| setup.rivals.iter().filter_map(|rival| mean(figure, rival))).collect()
}

#[cfg(test)]
pub mod tests {
    use super::*;

    fn runs(ms: &[f64]) -> Vec<Run> {
        ms.iter().map(|&ms| Run { ms, processor_ms: 2.0 * ms }).collect()
    }

    /// A comparison of times to those of a rival of the name.
    pub fn comparison(ours: &[f64], rival: &str, theirs: &[f64]) -> Comparison {
        Comparison::of(&runs(ours), &[RivalRuns { name: rival, runs: &runs(theirs), is_sampled: false }], true)
    }

    #[test]
    fn medians() {
        assert_eq!(Times::of(&runs(&[3.0, 1.0, 2.0])), Times { median_ms: 2.0, best_ms: 1.0, worst_ms: 3.0, processor_ms: 4.0 });
        assert_eq!(Times::of(&runs(&[4.0, 1.0, 2.0, 3.0])).median_ms, 2.5);
        assert_eq!(Times::of(&[]), Times::default());
    }

    #[test]
    fn above_one_is_faster() {
        let against = comparison(&[10.0, 20.0, 12.0], "Embree", &[24.0, 5.0, 30.0]).rivals.remove(0);
        assert_eq!((against.ratio, against.best_ratio, against.processor_ratio), (Some(2.0), Some(0.5), Some(2.0)));
        let spread = Some(Spread { least: 0.25, greatest: 2.5 });
        assert_eq!((against.turns, against.processor_turns), (spread, spread));
        assert_eq!(Spread::of([1.0, f64::NAN].into_iter()), None);
        let of = |device_is_cpu, is_sampled| {
            let rival = RivalRuns { name: "slow", runs: &runs(&[1.0]), is_sampled };
            Against::of(&runs(&[1.0]), &rival, device_is_cpu).processor_ratio
        };
        assert_eq!((of(true, false), of(false, false), of(true, true)), (Some(1.0), None, None));
        assert!(Comparison::of(&runs(&[1.0]), &[], true).rivals.is_empty());
    }

    fn setup() -> Setup {
        let rival = |name: &str| Rival {
            name: name.to_owned(),
            version: String::new(),
            threads: None,
            rebuild: String::new(),
            tree: String::new(),
        };
        Setup {
            schema: SCHEMA,
            version: String::new(),
            device: String::new(),
            driver: String::new(),
            device_is_cpu: true,
            rivals: vec![rival("Embree"), rival("driver")],
            size: 8,
            runs: 1,
        }
    }

    fn scene(name: &str, rebuild: Comparison) -> SceneReport {
        SceneReport {
            scene: name.to_owned(),
            view: View { eye: [0.0; 3], target: [1.0; 3], fov_degrees: 45.0 },
            triangles: 1,
            dropped: 0,
            density: 8.0,
            overlap: "exact".to_owned(),
            resolution: [1; 3],
            cells: 1,
            cells_in_use: 1,
            pairs: 1,
            pair_total: 1,
            longest_list: 1,
            split_cells: 0,
            leaf_cells: 0,
            leaf_pairs: 0,
            grid_bytes: 1,
            scratch_bytes: 1,
            fitted_bytes: 1,
            rebuilt_bytes: Vec::new(),
            traced_bytes: Vec::new(),
            rebuild: Some(rebuild),
            steps: Vec::new(),
            frame: None,
            rays: Vec::new(),
        }
    }

    #[test]
    fn means_are_geometric_and_over_what_was_wanted() {
        let scenes = [
            scene("bunny", comparison(&[1.0], "Embree", &[0.5])),
            scene("dragon", comparison(&[1.0], "Embree", &[8.0])),
            scene("other", comparison(&[1.0], "Embree", &[1000.0])),
        ];
        let found = means(&setup(), &scenes, &["bunny", "dragon", "sponza"]);
        assert_eq!(found.len(), 1, "nothing is known of the driver");
        assert_eq!((found[0].figure.as_str(), found[0].rival.as_str()), ("rebuild", "Embree"));
        assert_eq!(found[0].scenes, ["bunny", "dragon"]);
        assert!((found[0].ratio - 2.0).abs() < 1e-12);
        let all = means(&setup(), &scenes, &["sponza"]);
        assert_eq!(all[0].scenes.len(), 3);
    }
}
