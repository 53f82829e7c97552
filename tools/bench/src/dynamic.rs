//! Animations, everything rebuilt each frame, ours and the rivals in turns.

use anyhow::Result;
use gridwalk_render::{Context, Player, PlayerOptions, SeekStats};
use gridwalk_scene::{Animation, Camera, Framing, Light};

use crate::arguments::Dynamic;
use crate::contender::{Tree, turns};
use crate::dynamic_report::{FrameReport, RayCount, SceneReport};
use crate::measure::{Field, Frame, any_hit, closest, difference, median_steps, settings};
use crate::moving::Moving;
use crate::ours::Ours;
use crate::rays::camera_rays;
use crate::report::{Difference, Step};
use crate::rivals::Rivals;
use crate::surface::{Surface, Traced};

/// Frames of a scene where none are asked for.
const MOST_FRAMES: u64 = 24;

/// Measures one scene, frame by frame.
///
/// # Errors
/// What the scene's files, the device or a rival reports.
pub fn measure(context: &Context, rivals: &Rivals, arguments: &Dynamic, name: &str, moving: Moving) -> Result<SceneReport> {
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
        frames.push(frame(&mut player, rivals, arguments, (time, &seek), &camera, light)?);
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
    rivals: &Rivals,
    arguments: &Dynamic,
    (time, seek): (f64, &SeekStats),
    camera: &Camera,
    light: Option<Light>,
) -> Result<FrameReport> {
    let report = seek.build.report;
    let extent = (0..3).map(|axis| report.box_max[axis] - report.box_min[axis]).fold(0.0, f32::max);
    let scene = player.scene();
    let surface = Surface { positions: scene.read_positions()?, indices: scene.read_indices()?, offset: extent * 1e-4 };
    let contenders = rivals.contenders(scene.geometry(), &surface.positions, &surface.indices)?;

    let camera = Traced::new(player.grid(), camera_rays(camera, arguments.common.size))?;
    let reflection = Traced::new(player.grid(), surface.reflections(&camera))?;
    let mut shadow = surface.shadows(&camera, light);
    shadow.extend(surface.shadows(&reflection, light));
    let order = arguments.common.ray_order;
    let sets = [closest("camera", camera.rays, order), closest("reflection", reflection.rays, order), any_hit("shadow", shadow, order)];

    let mut field = Field { ours: Ours::moving(player), rivals: contenders };
    field.each(|contender| {
        contender.prepare(Tree::Fast)?;
        contender.load(&sets)
    })?;
    let turns = turns(arguments.runs, &mut field.all(), |contender| Frame::run(contender, &[1.0; 3]))?;
    let names: Vec<&str> = field.all().iter().map(|contender| contender.name()).collect();
    let mut sides = names.into_iter().zip(&turns).map(|(name, turns)| Frame::side(name, &sets, turns));
    let (ours, sides) = (sides.next().unwrap_or_default(), sides.collect());
    let mut differences = Vec::new();
    for rival in &mut field.rivals {
        let mut sum = Difference { rival: rival.name().to_owned(), ..Difference::default() };
        for (index, hits) in [&camera.hits, &reflection.hits].into_iter().enumerate() {
            let found = difference(rival.name(), &sets[index].rays, hits, &rival.answers(index)?);
            sum.rays += found.rays;
            sum.triangle += found.triangle;
            sum.nearer += found.nearer;
            sum.farther += found.farther;
        }
        differences.push(sum);
    }
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
        deform_steps: seek.deform_steps.iter().map(Step::of).collect(),
        steps: median_steps(&field.ours.steps(arguments.runs)?),
        rays: sets.iter().map(|set| RayCount { kind: set.kind.to_owned(), rays: set.rays.len() as u64 }).collect(),
        ours,
        rivals: sides,
        differences,
    })
}
