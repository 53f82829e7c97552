//! Animations, everything rebuilt each frame, ours and the rival in turns.

use anyhow::{Context as _, Result};
use gridwalk::Hit;
use gridwalk_render::{Context, Player, PlayerOptions, RayBatch, SeekStats};
use gridwalk_scene::{Animation, Camera, Framing, Light};

use crate::arguments::Dynamic;
use crate::dynamic_report::{FrameReport, RayCounts, SceneReport, Side};
use crate::embree::{self, Embree};
use crate::measure::{difference, median_steps, settings};
use crate::moving::Moving;
use crate::rays::camera_rays;
use crate::report::{Difference, Step, median};
use crate::surface::{Surface, Traced};

/// Frames of a scene where none are asked for.
const MOST_FRAMES: u64 = 24;

/// Measures one scene, frame by frame.
///
/// # Errors
/// What the scene's files, the device or the rival report.
pub fn measure(context: &Context, embree: Option<&Embree>, arguments: &Dynamic, name: &str, moving: Moving) -> Result<SceneReport> {
    // The folder of a made scene is removed with the last frame.
    let Moving { animation, folder: _folder } = moving;
    let times = times(&animation, arguments.frames);
    let mut options = PlayerOptions::default();
    options.build = settings(&arguments.common);
    let camera_of = camera(&animation);
    let mut player = Player::new(context, animation, &options)?;
    let mut frames = Vec::with_capacity(times.len());
    for (number, &time) in times.iter().enumerate() {
        eprint!("\r{name}: frame {} of {}", number + 1, times.len());
        let seek = player.seek(time, times.get(number + 1..).unwrap_or_default())?;
        let animation = player.animation();
        let camera =
            camera_of.unwrap_or_else(|| animation.camera(None, time).unwrap_or_else(|| animation.scene.frame(&Framing::default())));
        let light = animation.lights(time).first().copied();
        frames.push(frame(&mut player, embree, arguments, (time, &seek), &camera, light)?);
    }
    eprintln!();
    Ok(SceneReport::new(name, frames))
}

/// A scene without a camera of its own is framed once, as for a square picture.
fn camera(animation: &Animation) -> Option<Camera> {
    let scene = &animation.scene;
    scene.cameras.is_empty().then(|| scene.frame(&Framing { aspect: 1.0, up: scene.up, ..Framing::default() }))
}

fn times(animation: &Animation, frames: Option<u32>) -> Vec<f64> {
    let own = animation.frame_count(animation.fps);
    let count = frames.map_or(own.min(MOST_FRAMES), u64::from);
    // As many as the scene has of its own are its own.
    let step = if count == own { 1.0 / animation.fps } else { animation.duration / count as f64 };
    (0..count).map(|number| number as f64 * step).collect()
}

fn frame(
    player: &mut Player,
    embree: Option<&Embree>,
    arguments: &Dynamic,
    (time, seek): (f64, &SeekStats),
    camera: &Camera,
    light: Option<Light>,
) -> Result<FrameReport> {
    let report = seek.build.report;
    let extent = (0..3).map(|axis| report.box_max[axis] - report.box_min[axis]).fold(0.0, f32::max);
    let scene = player.scene();
    let surface = Surface { positions: scene.read_positions()?, indices: scene.read_indices()?, offset: extent * 1e-4 };

    let camera_rays = camera_rays(camera, arguments.common.size);
    let camera = Traced::new(player.grid(), camera_rays)?;
    let reflections = Traced::new(player.grid(), surface.reflections(&camera))?;
    let mut shadow_rays = surface.shadows(&camera, light);
    shadow_rays.extend(surface.shadows(&reflections, light));

    let context = player.grid().context().clone();
    let mut camera_batch = RayBatch::new(&context, &camera.rays)?;
    let mut reflection_batch = RayBatch::new(&context, &reflections.rays)?;
    let mut shadow_batch = RayBatch::new(&context, &shadow_rays)?;
    let mut theirs = match embree {
        Some(embree) => {
            let mesh = embree::Mesh::new(&surface.positions, &surface.indices).context("an index that leads nowhere")?;
            let mut scene = embree.rebuildable(&mesh)?;
            // The first build allocates.
            scene.rebuild()?;
            Some(scene)
        }
        None => None,
    };

    let (mut ours, mut rival) = (Vec::new(), Vec::new());
    let mut steps = Vec::new();
    let mut their_hits = [vec![Hit::MISS; camera.rays.len()], vec![Hit::MISS; reflections.rays.len()]];
    let mut their_answers = vec![0; shadow_rays.len()];
    for _ in 0..arguments.runs {
        player.rebuild()?;
        let grid = player.grid();
        let rebuild_ms = grid.stats().ms;
        steps.push(grid.stats().steps.clone());
        ours.push([rebuild_ms, camera_batch.closest_hit(grid)?, reflection_batch.closest_hit(grid)?, shadow_batch.any_hit(grid)?]);
        if let Some(scene) = &mut theirs {
            let rebuild_ms = scene.rebuild()?;
            rival.push([
                rebuild_ms,
                scene.closest_hit(&camera.rays, &mut their_hits[0]),
                scene.closest_hit(&reflections.rays, &mut their_hits[1]),
                scene.any_hit(&shadow_rays, &mut their_answers),
            ]);
        }
    }
    let difference = theirs.is_some().then(|| {
        let mut sum = Difference::default();
        for (traced, theirs) in [&camera, &reflections].into_iter().zip(&their_hits) {
            let Difference { triangle, nearer, farther, .. } = difference(&traced.rays, &traced.hits, theirs);
            sum.triangle += triangle;
            sum.nearer += nearer;
            sum.farther += farther;
        }
        sum
    });
    let deform = seek.deform_steps.iter();
    Ok(FrameReport {
        time,
        triangles: report.triangles,
        pairs: report.pairs,
        longest_list: report.longest_list,
        read_ms: seek.read_ms + seek.parse_ms,
        upload_ms: seek.stage_ms + seek.upload_ms,
        hidden_ms: seek.hidden_ms,
        wait_ms: seek.wait_ms,
        deform_ms: seek.deform_ms,
        deform_steps: deform
            .map(|step| Step { name: step.name.to_owned(), kind: step.kind.to_owned(), count: step.count, ms: step.ms })
            .collect(),
        steps: median_steps(&steps),
        rays: RayCounts { camera: camera.rays.len() as u64, reflection: reflections.rays.len() as u64, shadow: shadow_rays.len() as u64 },
        ours: side(&ours),
        embree: theirs.is_some().then(|| side(&rival)),
        difference,
    })
}

fn side(runs: &[[f64; 4]]) -> Side {
    let part = |index: usize| median(runs.iter().map(|run| run[index]));
    Side { rebuild_ms: part(0), camera_ms: part(1), reflection_ms: part(2), shadow_ms: part(3) }
}
