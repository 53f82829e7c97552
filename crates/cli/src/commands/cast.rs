//! `gridwalk cast`.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::time::Instant;

use gridwalk_render::gridwalk::{Hit, MISS, Ray, UNFINISHED};
use gridwalk_render::gridwalk_scene::{Animation, Scene};
use gridwalk_render::{GpuScene, RayBatch};

use crate::args::{high, low};
use crate::exit::{Exit, Failure, Result};
use crate::interrupt::Interrupt;
use crate::session::Session;
use crate::{npy, output, progress, report, scene, suggest};

/// Rays that are on the device at once.
const BATCH: usize = 1 << 22;

/// Casts the rays of a file, and writes what they hit.
pub fn run(low: low::Cast, quiet: bool, interrupt: &Interrupt) -> Result<Exit> {
    let started = Instant::now();
    let cast = high::Cast::new(low, quiet)?;
    output::check(&cast.target, cast.overwrite)?;
    let rays = read_rays(&cast.rays, cast.max_rays_bytes)?;
    let scene = scene::read(&cast.source, &cast.load)?;
    let mut session = Session::open(&cast.device, &cast.grid, &cast.reports, Animation::still(scene), started)?;
    session.tell_grid();
    session.measure_build(cast.repeat)?;

    let mut answers = Answers::new(cast.occlusion, rays.len());
    // The first pass over a batch warms the device up; with repetitions it does not count.
    let mut times = vec![0.0; cast.repeat.unwrap_or(1) as usize];
    let bar = progress::bar(cast.reports.progress, rays.len() as u64, "casting");
    let (grid, scene) = (session.player.grid(), &session.player.animation().scene);
    let size = scene.bounds().map_or(0.0, |bounds| (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f32::max));
    let make = if go_together(&rays, size) { RayBatch::new } else { RayBatch::sorted };
    for part in rays.chunks(BATCH) {
        let mut batch = make(&session.context, part)?;
        let mut trace = || if cast.occlusion { batch.any_hit(grid) } else { batch.closest_hit(grid) };
        if cast.repeat.is_some() {
            trace()?;
        }
        for time in &mut times {
            *time += trace()?;
        }
        if cast.occlusion {
            answers.push_occluded(&batch.read_occluded()?);
        } else {
            answers.push_hits(&batch.read_hits()?, session.player.scene(), scene);
        }
        bar.inc(part.len() as u64);
    }
    bar.finish_and_clear();

    let bytes = answers.npz()?;
    interrupt.uninterrupted(|| output::write(&cast.target, cast.overwrite, &bytes))?;
    let mut run = session.report("cast", &cast.source, cast.repeat);
    run.rays = rays.len() as u64;
    run.unfinished = answers.unfinished;
    run.trace_ms = report::median(&mut times);
    run.outputs = vec![cast.target.name()];
    session.finish(run, &cast.reports)
}

/// Whether most neighbours in the file walk through the same part of a scene of this size in about the same direction, as those of a picture
/// do. Such rays are traced as they are; sorting others pays.
fn go_together(rays: &[Ray], size: f32) -> bool {
    const SAMPLES: usize = 1024;
    const NEAR: f32 = 1.0 / 32.0;
    const COSINE: f32 = 0.9;
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let pairs = rays.windows(2).step_by((rays.len() / SAMPLES).max(1));
    let together = pairs.clone().filter(|pair| {
        let (a, b) = (pair[0], pair[1]);
        let apart: [f32; 3] = std::array::from_fn(|axis| b.origin[axis] - a.origin[axis]);
        let lengths = (dot(a.direction, a.direction) * dot(b.direction, b.direction)).sqrt();
        dot(apart, apart).sqrt() <= size * NEAR && dot(a.direction, b.direction) >= lengths * COSINE
    });
    2 * together.count() >= pairs.count()
}

/// Rays of an NPY file: origin and direction, and the interval if there are eight columns.
fn read_rays(source: &high::Source, limit: u64) -> Result<Vec<Ray>> {
    let name = source.name();
    let refuse = |reason: String| Failure::input(format!("{name}: {reason}"));
    let array = match source {
        high::Source::Stdin => npy::read_f32(&mut std::io::stdin().lock(), limit),
        high::Source::Path(path) => npy::read_f32(&mut open(path)?, limit),
    };
    let array = array.map_err(refuse)?;
    let columns = match array.shape[..] {
        [_, columns @ (6 | 8)] => columns,
        _ => {
            let reason = format!("its shape is {:?}; rays have (N, 6): origin, direction; or (N, 8): and t_min, t_max", array.shape);
            return Err(refuse(reason));
        }
    };
    let ray = |row: &[f32]| Ray {
        origin: [row[0], row[1], row[2]],
        t_min: row.get(6).copied().unwrap_or(0.0),
        direction: [row[3], row[4], row[5]],
        t_max: row.get(7).copied().unwrap_or(f32::INFINITY),
    };
    Ok(array.values.chunks_exact(columns).map(ray).collect())
}

fn open(path: &Path) -> Result<impl Read> {
    let failed = |reason: String| Failure::input(format!("cannot read {}: {reason}{}", path.display(), hint(path)));
    let file = File::open(path).map_err(|error| failed(error.to_string()))?;
    if file.metadata().is_ok_and(|metadata| metadata.is_dir()) {
        return Err(failed("it is a folder".to_owned()));
    }
    Ok(BufReader::new(file))
}

fn hint(path: &Path) -> String {
    if path.exists() { String::new() } else { suggest::file_hint(path) }
}

/// What is written, by Open3D's names.
#[derive(Default)]
struct Answers {
    occlusion: bool,
    occluded: Vec<bool>,
    t_hit: Vec<f32>,
    geometry_ids: Vec<u32>,
    primitive_ids: Vec<u32>,
    primitive_uvs: Vec<f32>,
    primitive_normals: Vec<f32>,
    unfinished: u64,
}

impl Answers {
    fn new(occlusion: bool, rays: usize) -> Answers {
        let mut answers = Answers { occlusion, ..Answers::default() };
        if occlusion {
            answers.occluded.reserve_exact(rays);
        } else {
            answers.t_hit.reserve_exact(rays);
            answers.geometry_ids.reserve_exact(rays);
            answers.primitive_ids.reserve_exact(rays);
            answers.primitive_uvs.reserve_exact(rays.saturating_mul(2));
            answers.primitive_normals.reserve_exact(rays.saturating_mul(3));
        }
        answers
    }

    fn push_occluded(&mut self, answers: &[u32]) {
        for answer in answers {
            self.unfinished += u64::from(*answer == UNFINISHED);
            self.occluded.push(*answer == 1);
        }
    }

    /// A ray that was given up has `nan` as its distance and 4294967294 as its identifiers: it is neither a hit nor a miss.
    fn push_hits(&mut self, hits: &[Hit], gpu: &GpuScene, scene: &Scene) {
        for hit in hits {
            let place = gpu.locate(hit.triangle);
            let unfinished = hit.triangle == UNFINISHED;
            self.unfinished += u64::from(unfinished);
            let (geometry, primitive) = place.unwrap_or(if unfinished { (UNFINISHED, UNFINISHED) } else { (MISS, MISS) });
            self.t_hit.push(if unfinished { f32::NAN } else { hit.t });
            self.geometry_ids.push(geometry);
            self.primitive_ids.push(primitive);
            self.primitive_uvs.extend(if place.is_some() { [hit.u, hit.v] } else { [0.0; 2] });
            self.primitive_normals.extend(place.and_then(|place| normal(scene, place)).unwrap_or([0.0; 3]));
        }
    }

    fn npz(&self) -> Result<Vec<u8>> {
        let arrays = if self.occlusion {
            vec![("occluded", npy::npy(&self.occluded, None))]
        } else {
            vec![
                ("t_hit", npy::npy(&self.t_hit, None)),
                ("geometry_ids", npy::npy(&self.geometry_ids, None)),
                ("primitive_ids", npy::npy(&self.primitive_ids, None)),
                ("primitive_uvs", npy::npy(&self.primitive_uvs, Some(2))),
                ("primitive_normals", npy::npy(&self.primitive_normals, Some(3))),
            ]
        };
        npy::npz(&arrays).map_err(|reason| Failure::new(Exit::Output, reason))
    }
}

/// The triangle's own normal, of length one, by the winding of its corners.
fn normal(scene: &Scene, (geometry, primitive): (u32, u32)) -> Option<[f32; 3]> {
    let mesh = scene.meshes.get(geometry as usize)?;
    let corners = mesh.indices.get(primitive as usize)?;
    let [a, b, c] = corners.map(|index| mesh.positions.get(index as usize).map(|position| position.map(f64::from)));
    let (a, b, c) = (a?, b?, c?);
    let (u, v): ([f64; 3], [f64; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = cross.iter().map(|value| value * value).sum::<f64>().sqrt();
    (length > 0.0).then(|| cross.map(|value| (value / length) as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        Ray { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
    }

    #[test]
    fn rays_of_a_picture_go_together() {
        let picture: Vec<Ray> = (0..10_000_u32).map(|i| ray([0.0; 3], [(i % 100) as f32 * 0.01, (i / 100) as f32 * 0.01, 2.0])).collect();
        assert!(go_together(&picture, 1.0) && go_together(&picture[..1], 1.0) && go_together(&[], 1.0));
        // A linear congruence: every place, in no order.
        let mixed: Vec<Ray> = (0..10_000).map(|i| picture[i * 7_919 % 10_000]).collect();
        assert!(go_together(&mixed, 1.0), "a narrow picture in any order still goes one way");
        let around = |i: u32| [(i as f32 * 2.4).sin(), (i as f32 * 2.4).cos(), 0.1];
        let sphere: Vec<Ray> = (0..10_000).map(|i| ray([0.0; 3], around(i))).collect();
        assert!(!go_together(&sphere, 1.0));
        let scattered: Vec<Ray> = (0..10_000_u32).map(|i| ray(around(i), [0.0, 0.0, 1.0])).collect();
        assert!(!go_together(&scattered, 1.0) && go_together(&scattered, 100.0));
        let broken = vec![ray([f32::NAN; 3], [0.0; 3]); 100];
        assert!(!go_together(&broken, 1.0));
    }
}
