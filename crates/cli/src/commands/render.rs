//! `gridwalk render`.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use gridwalk_render::gridwalk_scene::{Camera, RenderDefaults};
use gridwalk_render::image::{
    Format, Metadata, MetadataValue, Overwrite, PngOptions, Rgb8, Tonemap, encode_exr, encode_png, heatmap, tonemapped, write_file,
};
use gridwalk_render::{Frame, RenderSettings, Renderer};

use crate::args::{high, low};
use crate::exit::{Exit, Failure, Result};
use crate::interrupt::Interrupt;
use crate::report::{self, Run};
use crate::session::Session;
use crate::{messages, output, progress, scene};

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
    let scene = scene::read(&render.source, &render.load)?;
    let settings = settings(&render, &scene.defaults);
    let camera = high::camera(&render.view, &scene, [settings.width, settings.height])?;
    tracing::info!("camera at {:?}, towards {:?}, {} degrees high", camera.eye, camera.target, camera.vertical_fov_degrees);

    let session = Session::open(&render.device, &render.grid, &scene, render.repeat, started)?;
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
    run.outputs = render.outputs.iter().map(|output| output.target.name()).collect();

    let metadata = metadata(&run, &camera, &settings);
    let mut picture = None;
    if render.outputs.iter().any(|output| output.format == Format::Png) {
        picture = Some(png(frame, &render, &scene.defaults, &mut run)?);
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

/// The command line before the scene before the library.
fn settings(render: &high::Render, defaults: &RenderDefaults) -> RenderSettings {
    let library = RenderSettings::default();
    let [width, height] = render.size.or(defaults.size).unwrap_or([library.width, library.height]);
    RenderSettings {
        width,
        height,
        crop: render.crop,
        spp: render.spp.or(defaults.spp).unwrap_or(library.spp),
        depth: render.depth.or(defaults.depth).unwrap_or(library.depth),
        aovs: render.aovs.clone(),
        transparent: render.transparent,
        batch: library.batch,
    }
}

/// The picture, as often as it is asked for; with repetitions the first one does not count.
fn frames(session: &Session, camera: &Camera, settings: &RenderSettings, render: &high::Render) -> Result<Vec<Frame>> {
    const PARTS: u64 = 1000;
    let renderer = Renderer::new(&session.context)?;
    let count = render.repeat.map_or(1, |repeat| u64::from(repeat) + 1);
    let bar = progress::bar(render.reports.progress, count * PARTS, "rendering");
    let mut frames = Vec::new();
    for index in 0..count {
        let frame = renderer.render(&session.scene, &session.grid, camera, settings, &mut |progress| {
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

/// What a PNG shows: the beauty, or a heat map.
fn png(frame: &Frame, render: &high::Render, defaults: &RenderDefaults, run: &mut Run) -> Result<Rgb8> {
    if let Some(count) = render.heatmap {
        let map = heatmap(&frame.layers, count.name())?;
        tracing::info!("{}: {} to {}, {:.2} on average", count.name(), map.min, map.max, map.mean);
        run.heatmap = Some(report::Heatmap { count: count.name(), min: map.min, max: map.max, mean: map.mean });
        return Ok(map.picture);
    }
    let tonemap = render.tonemap.or_else(|| defaults.tonemap.as_deref().and_then(Tonemap::from_name)).unwrap_or_default();
    let exposure = render.exposure.or(defaults.exposure).unwrap_or(0.0);
    let picture = tonemapped(&frame.layers, &PngOptions { exposure, tonemap, alpha: render.transparent })?;
    if picture.not_finite > 0 {
        tracing::warn!("{} pixels hold no finite number; the EXR shows which", picture.not_finite);
    }
    Ok(picture)
}

fn exr(target: &high::Target, overwrite: Overwrite, frame: &Frame, metadata: &Metadata) -> Result<()> {
    match target {
        high::Target::Path(path) => Ok(write_file(path, overwrite, |writer| encode_exr(writer, &frame.layers, metadata))?),
        high::Target::Stdout => Err(Failure::usage("standard output takes PNG alone; write the EXR to a file")),
    }
}

/// What the files say of themselves. No times: the same input gives the same bytes.
fn metadata(run: &Run, camera: &Camera, settings: &RenderSettings) -> Metadata {
    let text = |text: &str| MetadataValue::Text(text.to_owned());
    let (to_camera, to_ndc) = matrices(camera, f64::from(settings.width) / f64::from(settings.height));
    Metadata::new()
        .with("software", MetadataValue::Text(format!("gridwalk {}", env!("CARGO_PKG_VERSION"))))
        .with("scene", text(&run.scene))
        .with("device", text(&run.device))
        .with("driver", text(&run.driver))
        .with("spp", MetadataValue::Int(i32::try_from(settings.spp).unwrap_or(i32::MAX)))
        .with("depth", MetadataValue::Int(i32::try_from(settings.depth).unwrap_or(i32::MAX)))
        .with("density", MetadataValue::Float(run.density))
        .with("resolution", MetadataValue::Text(run.resolution.map(|n| n.to_string()).join(" x ")))
        .with("worldToCamera", MetadataValue::Matrix(to_camera))
        .with("worldToNDC", MetadataValue::Matrix(to_ndc))
}

/// World to camera (x right, y up, looking along -z), and on to the picture (-1 to 1, y up), for row vectors as OpenEXR has them.
fn matrices(camera: &Camera, aspect: f64) -> ([f32; 16], [f32; 16]) {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let unit = |a: [f64; 3]| a.map(|value| value / dot(a, a).sqrt());
    let eye = camera.eye.map(f64::from);
    let backwards: [f64; 3] = std::array::from_fn(|i| eye[i] - f64::from(camera.target[i]));
    let distance = dot(backwards, backwards).sqrt();
    let back = unit(backwards);
    let right = unit(cross(camera.up.map(f64::from), back));
    let up = cross(back, right);
    let view = [
        [right[0], up[0], back[0], 0.0],
        [right[1], up[1], back[1], 0.0],
        [right[2], up[2], back[2], 0.0],
        [-dot(right, eye), -dot(up, eye), -dot(back, eye), 1.0],
    ];
    // Depth from one thousandth of the target's distance to infinity; rays have no such bounds.
    let near = distance * 1e-3;
    let projection = match camera.orthographic_height {
        None => {
            let scale = 1.0 / (f64::from(camera.vertical_fov_degrees).to_radians() / 2.0).tan();
            [[scale / aspect, 0.0, 0.0, 0.0], [0.0, scale, 0.0, 0.0], [0.0, 0.0, -1.0, -1.0], [0.0, 0.0, -2.0 * near, 0.0]]
        }
        Some(height) => {
            let scale = 2.0 / f64::from(height);
            [[scale / aspect, 0.0, 0.0, 0.0], [0.0, scale, 0.0, 0.0], [0.0, 0.0, -1.0 / distance, 0.0], [0.0, 0.0, 0.0, 1.0]]
        }
    };
    let product: [[f64; 4]; 4] =
        std::array::from_fn(|row| std::array::from_fn(|column| (0..4).map(|k| view[row][k] * projection[k][column]).sum()));
    let flat = |matrix: [[f64; 4]; 4]| std::array::from_fn(|i| matrix[i / 4][i % 4] as f32);
    (flat(view), flat(product))
}

#[cfg(test)]
mod tests {
    use super::matrices;
    use gridwalk_render::gridwalk_scene::Camera;

    fn apply(matrix: [f32; 16], point: [f32; 3]) -> [f32; 3] {
        let row = [point[0], point[1], point[2], 1.0];
        let out: [f32; 4] = std::array::from_fn(|column| (0..4).map(|k| row[k] * matrix[k * 4 + column]).sum());
        [out[0] / out[3], out[1] / out[3], out[2] / out[3]]
    }

    #[test]
    fn points_end_where_they_are_seen() {
        let mut camera = Camera {
            eye: [1.0, 2.0, 7.0],
            target: [1.0, 2.0, 2.0],
            up: [0.0, 3.0, 0.0],
            vertical_fov_degrees: 90.0,
            orthographic_height: None,
        };
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        let (view, ndc) = matrices(&camera, 2.0);
        assert!(near(apply(view, [2.0, 2.5, 2.0]), [1.0, 0.5, -5.0]));
        let seen = apply(ndc, [11.0, 7.0, 2.0]);
        assert!((seen[0] - 1.0).abs() < 1e-5 && (seen[1] - 1.0).abs() < 1e-5, "the upper right corner: {seen:?}");
        camera.orthographic_height = Some(4.0);
        let seen = apply(matrices(&camera, 2.0).1, [5.0, 4.0, -100.0]);
        assert!((seen[0] - 1.0).abs() < 1e-5 && (seen[1] - 1.0).abs() < 1e-5, "{seen:?}");
    }
}
