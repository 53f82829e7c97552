//! One scene, measured: ours and the rival in turns.

use anyhow::{Context as _, Result};
use gridwalk::{Capacity, Hit, Ray, UNFINISHED};
use gridwalk_render::{BuildSettings, GpuScene, Grid, GridBuilder, RayBatch, StepTime};

use crate::arguments::{Arguments, Common, Overlap, Part};
use crate::embree::{self, Embree};
use crate::rays::{camera_rays, diffuse_rays};
use crate::report::{Comparison, Difference, Example, RayReport, Run, SceneReport, Step, Times, median};
use crate::scenes::Loaded;
use crate::surface::{Surface, Traced};

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
    settings
}

/// Measures what the arguments ask for.
///
/// # Errors
/// What the device or the rival reports.
pub fn measure(builder: &GridBuilder, embree: Option<&Embree>, arguments: &Arguments, loaded: &Loaded) -> Result<SceneReport> {
    let mesh = loaded.scene.meshes.first().context("a scene without a mesh")?;
    let gpu = GpuScene::upload(builder.context(), &loaded.scene)?;
    let mut grid = builder.build(&gpu, &settings(&arguments.common))?;
    let rival = match embree {
        Some(embree) => {
            let mesh = embree::Mesh::new(&mesh.positions, &mesh.indices).context("an index that leads nowhere")?;
            Some((embree, mesh))
        }
        None => None,
    };

    let mut steps: Vec<Vec<StepTime>> = Vec::new();
    let mut rebuild = None;
    if arguments.measures(Part::Rebuild) {
        let mut theirs = match &rival {
            Some((embree, mesh)) => Some(embree.rebuildable(mesh)?),
            None => None,
        };
        let ours = || {
            grid.rebuild(&gpu)?;
            steps.push(grid.stats().steps.clone());
            Ok(grid.stats().ms)
        };
        let times = turns(arguments.runs, ours, || theirs.as_mut().map(embree::Scene::rebuild).transpose())?;
        steps.remove(0);
        rebuild = Some(times.compare(grid.context().is_cpu()));
    }

    let mut rays = Vec::new();
    let parts = [Part::Camera, Part::Shadow, Part::Reflection, Part::Diffuse, Part::Any].map(|part| arguments.measures(part));
    if parts.contains(&true) {
        let theirs = match &rival {
            Some((embree, mesh)) => Some(embree.traceable(mesh, arguments.embree_quality)?),
            None => None,
        };
        let [camera, shadow, reflection, diffuse, any] = parts;
        if camera || shadow || reflection {
            let set = camera_rays(&loaded.camera, arguments.common.size);
            if camera {
                rays.push(closest("camera", &grid, theirs.as_ref(), &set, arguments.runs)?);
            }
            let surface = Surface::new(mesh);
            let seen = Traced::new(&grid, set)?;
            if shadow {
                let set = surface.shadows(&seen, loaded.scene.lights.first().copied());
                rays.push(any_hit("shadow", &grid, theirs.as_ref(), &set, arguments.runs)?);
            }
            if reflection {
                rays.push(closest("reflection", &grid, theirs.as_ref(), &surface.reflections(&seen), arguments.runs)?);
            }
        }
        if diffuse || any {
            let size = arguments.common.size.next_multiple_of(8);
            let set = diffuse_rays(mesh, size * size, arguments.common.seed);
            if diffuse {
                rays.push(closest("diffuse", &grid, theirs.as_ref(), &set, arguments.runs)?);
            }
            if any {
                rays.push(any_hit("any", &grid, theirs.as_ref(), &set, arguments.runs)?);
            }
        }
    }

    let stats = grid.stats();
    let report = &stats.report;
    let fitted = Capacity { triangles: report.triangles, cells: report.cells, pairs: report.pair_total };
    let fitted = grid.tracer()?.build_sizes(&fitted).map_err(gridwalk_render::Error::from)?;
    Ok(SceneReport {
        scene: loaded.name.clone(),
        triangles: report.triangles,
        dropped: report.dropped,
        density: report.density,
        overlap: format!("{:?}", grid.settings().overlap).to_lowercase(),
        resolution: report.resolution,
        cells: report.cells,
        cells_in_use: report.cells_in_use,
        pairs: report.pairs,
        pair_total: report.pair_total,
        longest_list: report.longest_list,
        grid_bytes: stats.grid_bytes,
        scratch_bytes: stats.scratch_bytes,
        fitted_bytes: fitted.grid.size + fitted.scratch.size,
        rebuild,
        steps: median_steps(&steps),
        rays,
    })
}

/// Median of each step over the runs, all of which have the same steps in the same order.
pub fn median_steps(runs: &[Vec<StepTime>]) -> Vec<Step> {
    let Some(first) = runs.first() else { return Vec::new() };
    let steps = first.iter().enumerate().map(|(index, step)| {
        let ms = median(runs.iter().filter_map(|run| run.get(index)).map(|step| step.ms));
        Step { name: step.name.to_owned(), kind: step.kind.to_owned(), count: step.count, ms }
    });
    steps.collect()
}

fn closest(kind: &str, grid: &Grid, theirs: Option<&embree::Scene>, rays: &[Ray], runs: u32) -> Result<RayReport> {
    let mut batch = RayBatch::new(grid.context(), rays)?;
    let mut their_hits = vec![Hit::MISS; rays.len()];
    let times = turns(runs, || Ok(batch.closest_hit(grid)?), || Ok(theirs.map(|scene| scene.closest_hit(rays, &mut their_hits))))?;
    let hits = batch.read_hits()?;
    let difference = theirs.map(|_| difference(rays, &hits, &their_hits));
    let count = |wanted: fn(&Hit) -> bool| hits.iter().filter(|hit| wanted(hit)).count() as u64;
    Ok(ray_report(
        kind,
        rays.len(),
        count(Hit::is_hit),
        count(|hit| hit.triangle == UNFINISHED),
        times.compare(grid.context().is_cpu()),
        difference,
    ))
}

fn any_hit(kind: &str, grid: &Grid, theirs: Option<&embree::Scene>, rays: &[Ray], runs: u32) -> Result<RayReport> {
    let mut batch = RayBatch::new(grid.context(), rays)?;
    let mut their_answers = vec![0; rays.len()];
    let times = turns(runs, || Ok(batch.any_hit(grid)?), || Ok(theirs.map(|scene| scene.any_hit(rays, &mut their_answers))))?;
    let answers = batch.read_occluded()?;
    // A hit is nearer than none.
    let as_hits = |answers: &[u32]| -> Vec<Hit> {
        let hit = |&answer: &u32| match answer {
            0 => Hit::MISS,
            UNFINISHED => Hit { triangle: UNFINISHED, ..Hit::MISS },
            _ => Hit { t: 0.0, u: 0.0, v: 0.0, triangle: 0 },
        };
        answers.iter().map(hit).collect()
    };
    let difference = theirs.map(|_| difference(rays, &as_hits(&answers), &as_hits(&their_answers)));
    let count = |wanted: u32| answers.iter().filter(|&&answer| answer == wanted).count() as u64;
    Ok(ray_report(kind, rays.len(), count(1), count(UNFINISHED), times.compare(grid.context().is_cpu()), difference))
}

/// Milliseconds of ours and theirs, run in turns, the first turn left out.
fn turns(runs: u32, mut ours: impl FnMut() -> Result<f64>, mut theirs: impl FnMut() -> Result<Option<f64>>) -> Result<Turns> {
    let mut turns = Turns { ours: Vec::new(), theirs: Vec::new() };
    for run in 0..=runs {
        let begin = processor_ms();
        let ours = Run { ms: ours()?, processor_ms: processor_ms() - begin };
        let begin = processor_ms();
        let theirs = theirs()?.map(|ms| Run { ms, processor_ms: processor_ms() - begin });
        if run > 0 {
            turns.ours.push(ours);
            turns.theirs.extend(theirs);
        }
    }
    Ok(turns)
}

/// Processor time of all threads of this program so far, those that have ended included; not a number on systems without such a clock.
#[cfg(not(unix))]
fn processor_ms() -> f64 {
    f64::NAN
}

/// Processor time of all threads of this program so far, those that have ended included.
#[cfg(unix)]
fn processor_ms() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}

/// What the runs took.
struct Turns {
    ours: Vec<Run>,
    theirs: Vec<Run>,
}

impl Turns {
    fn compare(&self, device_is_cpu: bool) -> Comparison {
        Comparison::of(&self.ours, &self.theirs, device_is_cpu)
    }
}

fn ray_report(kind: &str, rays: usize, hits: u64, unfinished: u64, time: Comparison, difference: Option<Difference>) -> RayReport {
    let rate = |times: Times| if times.median_ms > 0.0 { rays as f64 / times.median_ms * 1e-3 } else { 0.0 };
    RayReport {
        kind: kind.to_owned(),
        rays: rays as u64,
        hits,
        unfinished,
        mrays: rate(time.ours),
        embree_mrays: time.embree.map(rate),
        time,
        difference,
    }
}

/// Rays that are listed as examples of a difference.
const EXAMPLES: usize = 16;

/// Counts how hits differ.
pub fn difference(rays: &[Ray], ours: &[Hit], theirs: &[Hit]) -> Difference {
    let mut difference = Difference::default();
    for (index, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
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
        if let Some(ray) = rays.get(index).filter(|_| difference.examples.len() < EXAMPLES) {
            let answer = |hit: &Hit| hit.is_hit().then_some((hit.t, hit.triangle));
            difference.examples.push(Example {
                ray: index as u64,
                origin: ray.origin,
                direction: ray.direction,
                ours: answer(ours),
                embree: answer(theirs),
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
        let theirs = [hit(1.0, 1), hit(1.000_01, 2), hit(1.01, 4), Hit::MISS, hit(3.0, 0), Hit::MISS, Hit::MISS];
        let found = difference(&rays, &ours, &theirs);
        assert_eq!((found.triangle, found.nearer, found.farther, found.distance), (1, 2, 2, 0.25));
        assert_eq!(found.examples.iter().map(|example| example.ray).collect::<Vec<_>>(), [2, 4, 5, 6]);
        assert_eq!(found.examples[1].embree, Some((3.0, 0)));
        assert_eq!(difference(&rays, &ours[..5], &ours[..5]), Difference::default());
    }

    #[test]
    fn the_first_turn_is_left_out() {
        let mut times = [5.0, 1.0, 2.0].into_iter();
        let turns = turns(2, || times.next().context("one turn too many"), || Ok(None)).unwrap();
        assert_eq!(turns.ours.iter().map(|run| run.ms).collect::<Vec<_>>(), [1.0, 2.0]);
        assert!(turns.theirs.is_empty() && turns.ours.iter().all(|run| run.processor_ms >= 0.0));
    }
}
