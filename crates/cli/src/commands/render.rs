//! `gridwalk render`.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use gridwalk_render::gridwalk_scene::Camera;
use gridwalk_render::image::{Format, Metadata, Overwrite, encode_exr, encode_png, write_file};
use gridwalk_render::{Frame, RenderSettings, Renderer};

use crate::args::{high, low};
use crate::exit::{Exit, Failure, Result};
use crate::interrupt::Interrupt;
use crate::picture::{self, Shown};
use crate::session::Session;
use crate::{messages, output, progress, report, scene};

/// Renders a picture of a scene, or lists what the options can be.
pub fn run(low: low::Render, quiet: bool, interrupt: &Interrupt) -> Result<Exit> {
    let started = Instant::now();
    if low.list_aovs {
        return super::list::aovs();
    }
    if low.list_tonemaps {
        return super::list::tonemaps();
    }
    if low.list_formats {
        return super::list::formats();
    }
    if low.list_cameras {
        let path = low.scene.as_deref().unwrap_or(Path::new("-"));
        return super::list::cameras(&high::Source::new(path), &low.limits);
    }

    let render = high::Render::new(low, quiet)?;
    for output in &render.outputs {
        output::check(&output.target, render.overwrite)?;
    }
    let animation = scene::open(&render.source, &render.load, render.clip.as_deref())?;
    let time = render.moment.time(&animation);
    let settings = picture::settings(&render.picture, &animation.scene.defaults);
    let shown = Shown::new(&render.picture, &animation.scene.defaults);
    let camera = high::camera(&render.picture.view, &animation, time, [settings.width, settings.height], None)?;
    tracing::info!("camera at {:?}, towards {:?}, {} degrees high", camera.eye, camera.target, camera.vertical_fov_degrees);

    let mut session = Session::open(&render.device, &render.grid, &render.reports, animation, started)?;
    session.seek(time, &[])?;
    session.tell_grid();
    session.measure_build(render.repeat)?;
    let frames = frames(&session, &camera, &settings, &render)?;
    let Some(frame) = frames.last() else { return Ok(Exit::Ok) };

    let mut run = session.report("render", &render.source, render.repeat);
    run.rays = frame.stats.rays.total();
    run.unfinished = frame.stats.rays.unfinished;
    if session.context.has_timestamps() {
        run.trace_ms = report::median(&mut frames.iter().map(|frame| frame.stats.trace_ms).collect::<Vec<_>>());
    }
    run.frame_ms = report::median(&mut frames.iter().map(|frame| frame.stats.frame_ms).collect::<Vec<_>>());
    run.size = Some([settings.width, settings.height]);
    run.spp = Some(settings.spp);
    run.time = Some(time);
    run.outputs = render.outputs.iter().map(|output| output.target.name()).collect();

    let common = picture::metadata(&render.source, session.context.device_info(), &settings);
    let metadata = picture::metadata_of_one(common, &frame.build.report, &camera, &settings);
    let mut picture = None;
    if render.outputs.iter().any(|output| output.format == Format::Png) {
        let (shown, heatmap) = shown.of(&frame.layers)?;
        run.heatmap = heatmap;
        picture = Some(shown);
    }
    interrupt.uninterrupted(|| {
        for output in &render.outputs {
            match (output.format, &picture) {
                (Format::Png, Some(picture)) => {
                    let mut bytes = Vec::new();
                    encode_png(&mut bytes, picture, &metadata)?;
                    output::write(&output.target, render.overwrite, &bytes)?;
                }
                (_, _) => exr(&output.target, render.overwrite, frame, &metadata)?,
            }
            if render.named {
                tracing::info!("wrote {}", output.target.name());
            } else {
                tracing::info!(target: messages::RESULT, "wrote {}", output.target.name());
            }
        }
        Ok(())
    })?;
    session.finish(run, &render.reports)
}

/// The picture, as often as it is asked for; with repetitions the first one does not count.
fn frames(session: &Session, camera: &Camera, settings: &RenderSettings, render: &high::Render) -> Result<Vec<Frame>> {
    const PARTS: u64 = progress::PARTS;
    let renderer = Renderer::new(&session.context)?;
    let count = render.repeat.map_or(1, |repeat| u64::from(repeat) + 1);
    let bar = progress::bar(render.reports.progress, count * PARTS, "rendering");
    let mut frames = Vec::new();
    for index in 0..count {
        let frame = renderer.render(session.player.scene(), session.player.grid(), camera, settings, &mut |progress| {
            bar.set_position(index * PARTS + (progress.done * PARTS as f64) as u64);
            ControlFlow::Continue(())
        })?;
        // Only the last picture is written; the others are kept for their times alone.
        if let Some(last) = frames.last_mut() {
            let last: &mut Frame = last;
            last.layers = gridwalk_render::Layers::new(0, 0);
        }
        frames.push(frame);
    }
    if render.repeat.is_some() {
        frames.remove(0);
    }
    bar.finish_and_clear();
    Ok(frames)
}

fn exr(target: &high::Target, overwrite: Overwrite, frame: &Frame, metadata: &Metadata) -> Result<()> {
    match target {
        high::Target::Path(path) => Ok(write_file(path, overwrite, |writer| encode_exr(writer, &frame.layers, metadata))?),
        high::Target::Stdout => Err(Failure::usage("standard output takes PNG alone; write the EXR to a file")),
    }
}
