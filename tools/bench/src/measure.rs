//! One scene, measured: ours and the rivals in turns.

use std::sync::Arc;

use anyhow::{Context as _, Result};
use gridwalk::{Capacity, Hit, Ray, UNFINISHED};
use gridwalk_render::{BuildSettings, GpuScene, Grid, GridBuilder, StepTime};
use gridwalk_scene::{Camera, Mesh};

use crate::arguments::{Arguments, Common, Overlap, Part, RayOrder};
use crate::contender::{Answers, Contender, Query, Set, Tree, Turn, times, turns};
use crate::counters::walks;
use crate::ours::Ours;
use crate::rays::{camera_rays, diffuse_rays};
use crate::report::{
    Against, Comparison, Difference, Example, FrameReport, KindTime, RayReport, RivalBytes, RivalRuns, Run, SceneReport, Side, Step, View,
    median,
};
use crate::rivals::Rivals;
use crate::scenes::Loaded;
use crate::surface::{Surface, Traced};
use crate::traffic::Size;

/// How a build is to be made.
pub fn settings(arguments: &Common) -> BuildSettings {
    let mut settings = BuildSettings::default();
    if let Some(density) = arguments.density {
        settings.density = density;
    }
    if let Some(overlap) = arguments.overlap {
        settings.overlap = match overlap {
            Overlap::Box => gridwalk::Overlap::Box,
            Overlap::Exact => gridwalk::Overlap::Exact,
        };
    }
    if let Some(levels) = arguments.levels {
        settings.split = levels > 1;
    }
    settings
}

/// Ours and the rivals, in the order of the report.
pub struct Field<'a> {
    pub ours: Ours<'a>,
    pub rivals: Vec<Box<dyn Contender>>,
}

impl Field<'_> {
    /// Prepares, loads or otherwise readies each.
    ///
    /// # Errors
    /// What a contender reports.
    pub fn each(&mut self, ready: impl FnMut(&mut dyn Contender) -> Result<()>) -> Result<()> {
        self.all().into_iter().try_for_each(ready)
    }

    /// Makes one kind of tree; returns the bytes of each rival's.
    fn prepare(&mut self, tree: Tree) -> Result<Vec<RivalBytes>> {
        self.each(|contender| contender.prepare(tree))?;
        let bytes = |rival: &dyn Contender| Some(RivalBytes { rival: rival.name().to_owned(), bytes: rival.bytes()? });
        Ok(self.rivals.iter().filter_map(|rival| bytes(&**rival)).collect())
    }

    /// All of them, ours first.
    pub fn all(&mut self) -> Vec<&mut dyn Contender> {
        let rivals = self.rivals.iter_mut().map(|rival| &mut **rival as &mut dyn Contender);
        std::iter::once(&mut self.ours as &mut dyn Contender).chain(rivals).collect()
    }

    /// Our runs, which come first, compared to the others.
    fn compare(&self, runs: &[Vec<Run>], traces: bool) -> Comparison {
        let rivals: Vec<RivalRuns<'_>> = self
            .rivals
            .iter()
            .zip(runs.get(1..).unwrap_or_default())
            .map(|(rival, runs)| RivalRuns { name: rival.name(), runs, is_sampled: traces && rival.is_sampled() })
            .collect();
        Comparison::of(runs.first().map_or(&[], Vec::as_slice), &rivals, self.ours.grid().context().is_cpu())
    }
}

/// Measures what the arguments ask for.
///
/// # Errors
/// What the device or a rival reports.
pub fn measure(builder: &GridBuilder, rivals: &Rivals, arguments: &Arguments, loaded: &Loaded) -> Result<SceneReport> {
    let mesh = loaded.scene.meshes.first().context("a scene without a mesh")?;
    let gpu = GpuScene::upload(builder.context(), &loaded.scene)?;
    let settings = settings(&arguments.common);
    let grid = builder.build(&gpu, &settings)?;
    let mut field = Field { ours: Ours::still(grid, &gpu), rivals: rivals.contenders(gpu.geometry(), &mesh.positions, &mesh.indices)? };

    let runs = arguments.runs;
    let mut sets = Sets::new(arguments, loaded, mesh);
    let (mut rebuild, mut steps, mut frame) = (None, Vec::new(), None);
    let (mut rebuilt_bytes, mut traced_bytes) = (Vec::new(), Vec::new());
    if arguments.measures(Part::Rebuild) || arguments.measures(Part::Frame) {
        rebuilt_bytes = field.prepare(Tree::Fast)?;
        if arguments.measures(Part::Rebuild) {
            let turns = turns(runs, &mut field.all(), |contender| contender.rebuild())?;
            rebuild = Some(field.compare(&times(&turns), false));
            steps = median_steps(&field.ours.steps(runs)?);
        }
        if arguments.measures(Part::Frame) {
            let sets = [sets.camera(), sets.shadow(field.ours.grid())?];
            frame = Some(frames(&mut field, runs, &sets)?);
        }
    }
    let mut rays = Vec::new();
    for set in sets.wanted(field.ours.grid())? {
        if rays.is_empty() {
            traced_bytes = field.prepare(Tree::Best)?;
        }
        rays.push(trace(&mut field, runs, &set, None)?);
    }
    if let Some((object, camera)) = loaded.object.as_ref().filter(|_| arguments.measures(Part::Object)) {
        if rays.is_empty() {
            traced_bytes = field.prepare(Tree::Best)?;
        }
        let gpu = GpuScene::upload(builder.context(), object)?;
        let alone = Ours::still(builder.build(&gpu, &settings)?, &gpu);
        let set = looking(camera, &arguments.common, alone.grid())?;
        rays.push(trace(&mut field, runs, &set, Some(alone))?);
    }

    let stats = field.ours.grid().stats();
    let report = &stats.report;
    let pairs = report.pair_total.max(report.pairs + report.leaf_pairs);
    let leaf_cells = if report.leaf_pairs > 0 { report.leaf_cells.min(field.ours.grid().capacity().leaf_cells) } else { 0 };
    let fitted = Capacity { triangles: report.triangles, cells: report.cells, pairs, leaf_cells };
    let fitted = field.ours.grid().tracer()?.build_sizes(&fitted).map_err(gridwalk_render::Error::from)?;
    // On a CPU the second level's pairs pass through the sort only where `leaf_sort` leaves them to it, which no report tells.
    let alone = field.ours.grid().tracer()?.shape().leaf_run > 0;
    let sorted = |count: u32| if alone { 0 } else { count.into() };
    let size = Size {
        triangles: report.triangles.into(),
        cells: report.cells.into(),
        cells_in_use: report.cells_in_use.into(),
        written: report.pair_total.into(),
        pairs: report.pairs.into(),
        passes: report.key_bits.div_ceil(field.ours.grid().tracer()?.shape().sort_bits),
        leaf_cells: sorted(report.leaf_cells),
        leaf_pairs: sorted(report.leaf_pairs),
    };
    for step in &mut steps {
        step.bytes = size.step(&step.name, step.count);
    }
    let camera = &loaded.camera;
    Ok(SceneReport {
        scene: loaded.name.clone(),
        view: View { eye: camera.eye, target: camera.target, fov_degrees: camera.vertical_fov_degrees },
        triangles: report.triangles,
        dropped: report.dropped,
        density: report.density,
        overlap: format!("{:?}", field.ours.grid().settings().overlap).to_lowercase(),
        resolution: report.resolution,
        cells: report.cells,
        cells_in_use: report.cells_in_use,
        pairs: report.pairs,
        pair_total: report.pair_total,
        longest_list: report.longest_list,
        split_cells: report.split_cells,
        leaf_cells: report.leaf_cells,
        leaf_pairs: report.leaf_pairs,
        grid_bytes: stats.grid_bytes,
        scratch_bytes: stats.scratch_bytes,
        fitted_bytes: fitted.grid.size + fitted.scratch.size,
        rebuilt_bytes,
        traced_bytes,
        rebuild,
        steps,
        frame,
        rays,
    })
}

/// The rays of a scene, each set made when it is first asked for.
struct Sets<'a> {
    arguments: &'a Arguments,
    loaded: &'a Loaded,
    mesh: &'a Mesh,
    camera: Option<Arc<Set>>,
    /// What the camera rays have hit.
    seen: Option<(Surface, Traced)>,
    shadow: Option<Arc<Set>>,
}

impl<'a> Sets<'a> {
    fn new(arguments: &'a Arguments, loaded: &'a Loaded, mesh: &'a Mesh) -> Sets<'a> {
        Sets { arguments, loaded, mesh, camera: None, seen: None, shadow: None }
    }

    fn camera(&mut self) -> Arc<Set> {
        let Common { size, ray_order, .. } = self.arguments.common;
        let rays = || camera_rays(&self.loaded.camera, size);
        Arc::clone(self.camera.get_or_insert_with(|| closest("camera", rays(), ray_order)))
    }

    fn seen(&mut self, grid: &Grid) -> Result<&(Surface, Traced)> {
        if self.seen.is_none() {
            let camera = self.camera();
            self.seen = Some((Surface::new(self.mesh), Traced::new(grid, camera.rays.clone())?));
        }
        self.seen.as_ref().context("nothing was traced")
    }

    fn shadow(&mut self, grid: &Grid) -> Result<Arc<Set>> {
        if let Some(set) = &self.shadow {
            return Ok(Arc::clone(set));
        }
        let light = self.loaded.scene.lights.first().copied();
        let order = self.arguments.common.ray_order;
        let (surface, seen) = self.seen(grid)?;
        let set = any_hit("shadow", surface.shadows(seen, light), order);
        self.shadow = Some(Arc::clone(&set));
        Ok(set)
    }

    /// Those that are asked for, but `object`.
    fn wanted(&mut self, grid: &Grid) -> Result<Vec<Arc<Set>>> {
        let measures = |part| self.arguments.measures(part);
        let order = self.arguments.common.ray_order;
        let [camera, shadow, reflection, diffuse, any] =
            [Part::Camera, Part::Shadow, Part::Reflection, Part::Diffuse, Part::Any].map(measures);
        let mut sets = Vec::new();
        if camera {
            sets.push(self.camera());
        }
        if shadow {
            sets.push(self.shadow(grid)?);
        }
        if reflection {
            let (surface, seen) = self.seen(grid)?;
            sets.push(closest("reflection", surface.reflections(seen), order));
        }
        if diffuse || any {
            let Common { size, seed, .. } = self.arguments.common;
            let size = size.next_multiple_of(8);
            let rays = diffuse_rays(self.mesh, size * size, seed);
            if diffuse {
                sets.push(closest("diffuse", rays.clone(), order));
            }
            if any {
                sets.push(any_hit("any", rays, order));
            }
        }
        Ok(sets)
    }
}

/// Camera rays that hit an object while it is all that there is.
fn looking(camera: &Camera, common: &Common, alone: &Grid) -> Result<Arc<Set>> {
    let traced = Traced::new(alone, camera_rays(camera, common.size))?;
    let hits = traced.rays.iter().zip(&traced.hits).filter(|(_, hit)| hit.is_hit());
    Ok(closest("object", hits.map(|(ray, _)| *ray).collect(), common.ray_order))
}

/// Rays whose closest hits are wanted.
pub fn closest(kind: &'static str, rays: Vec<Ray>, order: RayOrder) -> Arc<Set> {
    Arc::new(Set { kind, query: Query::Closest, rays, sorts: order.sorts(kind) })
}

/// Rays of which it is asked whether they hit anything.
pub fn any_hit(kind: &'static str, rays: Vec<Ray>, order: RayOrder) -> Arc<Set> {
    Arc::new(Set { kind, query: Query::Any, rays, sorts: order.sorts(kind) })
}

/// Median over the runs of each step that the last has: the second level comes and goes.
pub fn median_steps(runs: &[Vec<StepTime>]) -> Vec<Step> {
    let Some(last) = runs.last() else { return Vec::new() };
    let steps = last.iter().map(|step| {
        let ms = median(runs.iter().filter_map(|run| run.iter().find(|other| other.name == step.name)).map(|step| step.ms));
        Step { ms, ..Step::of(step) }
    });
    steps.collect()
}

/// What one frame took.
pub struct Frame {
    rebuild_ms: f64,
    /// Of each set.
    rays_ms: Vec<f64>,
}

impl Frame {
    /// Rebuilds, and traces this many sets, each scaled by its factor.
    ///
    /// # Errors
    /// What the contender reports.
    pub fn run(contender: &mut dyn Contender, scales: &[f64]) -> Result<Frame> {
        let rebuild_ms = contender.rebuild()?;
        let rays_ms = scales.iter().enumerate().map(|(set, scale)| Ok(contender.trace(set)? * scale)).collect::<Result<_>>()?;
        Ok(Frame { rebuild_ms, rays_ms })
    }

    /// Medians of all parts.
    pub fn side(name: &str, sets: &[Arc<Set>], frames: &[Turn<Frame>]) -> Side {
        let rays = sets.iter().enumerate().map(|(index, set)| {
            let ms = median(frames.iter().filter_map(|frame| frame.value.rays_ms.get(index).copied()));
            KindTime { kind: set.kind.to_owned(), ms }
        });
        Side { name: name.to_owned(), rebuild_ms: median(frames.iter().map(|frame| frame.value.rebuild_ms)), rays: rays.collect() }
    }
}

/// Rays of each kind that a frame is reckoned with, whatever the size of the picture and however many of its rays hit something.
const FRAME_RAYS: f64 = (1 << 20) as f64;

fn frames(field: &mut Field<'_>, runs: u32, sets: &[Arc<Set>]) -> Result<FrameReport> {
    field.each(|contender| contender.load(sets))?;
    let scales: Vec<f64> = sets.iter().map(|set| FRAME_RAYS / set.rays.len().max(1) as f64).collect();
    let turns = turns(runs, &mut field.all(), |contender| Frame::run(contender, &scales))?;
    let run =
        |turn: &Turn<Frame>| Run { ms: turn.value.rebuild_ms + turn.value.rays_ms.iter().sum::<f64>(), processor_ms: turn.processor_ms };
    let runs: Vec<Vec<Run>> = turns.iter().map(|turns| turns.iter().map(run).collect()).collect();
    let time = field.compare(&runs, true);
    let names: Vec<&str> = field.all().iter().map(|contender| contender.name()).collect();
    let mut sides = names.into_iter().zip(&turns).map(|(name, turns)| Frame::side(name, sets, turns));
    Ok(FrameReport { time, ours: sides.next().unwrap_or_default(), rivals: sides.collect() })
}

/// Traces one set; `alone` too, which is no rival.
fn trace(field: &mut Field<'_>, runs: u32, set: &Arc<Set>, mut alone: Option<Ours<'_>>) -> Result<RayReport> {
    let sets = std::slice::from_ref(set);
    field.each(|contender| contender.load(sets))?;
    alone.iter_mut().try_for_each(|alone| alone.load(sets))?;
    let mut all = field.all();
    all.extend(alone.iter_mut().map(|alone| alone as &mut dyn Contender));
    let turns = turns(runs, &mut all, |contender| contender.trace(0))?;
    let mut runs = times(&turns);
    let alone = alone.and_then(|_| runs.pop());
    let ours = runs.first().cloned().unwrap_or_default();
    let time = field.compare(&runs, true);
    let sort_ms = set.sorts.then(|| median(field.ours.take_sorts()));
    let hits = field.ours.answers(0)?.hits;
    let differences = field.rivals.iter_mut().map(|rival| Ok(difference(rival.name(), &set.rays, &hits, &rival.answers(0)?)));
    let differences = differences.collect::<Result<Vec<Difference>>>()?;
    let count = |wanted: fn(&Hit) -> bool| hits.iter().filter(|hit| wanted(hit)).count() as u64;
    let rays = set.rays.len() as u64;
    let is_cpu = field.ours.grid().context().is_cpu();
    Ok(RayReport {
        kind: set.kind.to_owned(),
        order: if set.sorts { "sorted" } else { "given" }.to_owned(),
        sort_ms,
        rays,
        hits: count(Hit::is_hit),
        unfinished: count(|hit| hit.triangle == UNFINISHED),
        mrays: time.ours.mrays(rays),
        walk: (set.query == Query::Closest).then(|| walks(field.ours.grid(), set)).transpose()?,
        alone: alone.map(|runs| Against::of(&ours, &RivalRuns { name: "the object alone", runs: &runs, is_sampled: false }, is_cpu)),
        time,
        differences,
    })
}

/// Rays that are listed as examples of a difference.
const EXAMPLES: usize = 16;

/// Counts how hits differ from a rival's.
pub fn difference(rival: &str, rays: &[Ray], ours: &[Hit], theirs: &Answers) -> Difference {
    let mut difference = Difference { rival: rival.to_owned(), ..Difference::default() };
    let pairs = theirs.hits.iter().enumerate().map(|(answer, hit)| (theirs.ray(answer), hit));
    for (index, theirs) in pairs {
        let Some((ray, ours)) = rays.get(index).zip(ours.get(index)) else { continue };
        difference.rays += 1;
        if ours.triangle == theirs.triangle {
            difference.distance = difference.distance.max(if ours.is_hit() { (ours.t - theirs.t).abs() } else { 0.0 });
            continue;
        }
        let are_hits = ours.is_hit() && theirs.is_hit();
        if are_hits && (ours.t - theirs.t).abs() <= 1e-4 * ours.t.abs().max(theirs.t.abs()) {
            difference.triangle += 1;
            continue;
        }
        let is_nearer = ours.t < theirs.t && ours.triangle != UNFINISHED;
        *(if is_nearer { &mut difference.nearer } else { &mut difference.farther }) += 1;
        if difference.examples.len() < EXAMPLES {
            let answer = |hit: &Hit| hit.is_hit().then_some((hit.t, hit.triangle));
            difference.examples.push(Example {
                ray: index as u64,
                origin: ray.origin,
                direction: ray.direction,
                ours: answer(ours),
                theirs: answer(theirs),
            });
        }
    }
    difference
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_seen() {
        let hit = |t: f32, triangle: u32| Hit { t, u: 0.0, v: 0.0, triangle };
        let rays = [Ray { origin: [0.0; 3], t_min: 0.0, direction: [1.0; 3], t_max: 9.0 }; 7];
        let lost = Hit { triangle: UNFINISHED, ..Hit::MISS };
        let ours = [hit(1.25, 1), hit(1.0, 1), hit(1.0, 1), Hit::MISS, Hit::MISS, lost, hit(2.0, 3)];
        let theirs = vec![hit(1.0, 1), hit(1.000_01, 2), hit(1.01, 4), Hit::MISS, hit(3.0, 0), Hit::MISS, Hit::MISS];
        let found = difference("them", &rays, &ours, &Answers { hits: theirs.clone(), step: 1 });
        assert_eq!((found.rays, found.triangle, found.nearer, found.farther, found.distance), (7, 1, 2, 2, 0.25));
        assert_eq!(found.examples.iter().map(|example| example.ray).collect::<Vec<_>>(), [2, 4, 5, 6]);
        assert_eq!(found.examples[1].theirs, Some((3.0, 0)));
        let same = difference("us", &rays, &ours[..5], &Answers { hits: ours[..5].to_vec(), step: 1 });
        assert_eq!(same, Difference { rival: "us".to_owned(), rays: 5, ..Difference::default() });
        // Every third run of rays alone.
        let (rays, ours) = ([rays[0]; 200], [ours[6]; 200]);
        let some = difference("them", &rays, &ours, &Answers { hits: [[theirs[3]; 64].as_slice(), &[ours[0]; 8]].concat(), step: 3 });
        assert_eq!((some.rays, some.nearer, some.farther), (72, 64, 0));
        assert_eq!(some.examples[15].ray, 15);
        let last = difference("them", &rays, &ours, &Answers { hits: [[ours[0]; 64].as_slice(), &[theirs[3]; 8]].concat(), step: 3 });
        assert_eq!((last.nearer, last.examples[0].ray), (8, 192));
    }
}
