//! `gridwalk info`.

use gridwalk_render::estimate_grid;
use gridwalk_render::gridwalk_scene::{Animation, Motion};
use serde::Serialize;
use std::fmt::Write;

use crate::args::high::{self, Source, load_options};
use crate::args::low::Info;
use crate::exit::{Exit, Result};
use crate::report::Header;
use crate::{output, scene, session};

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    scene: String,
    meshes: Vec<Mesh>,
    triangles: u64,
    vertices: u64,
    dropped: u64,
    degenerate: u64,
    bounds: Option<[[f32; 3]; 2]>,
    materials: Vec<String>,
    textures: usize,
    texture_bytes: u64,
    lights: usize,
    cameras: Vec<String>,
    animation: Option<Course>,
    grid: Option<Grid>,
    warnings: Vec<String>,
}

/// Reckoned on the CPU.
#[derive(Serialize)]
struct Grid {
    resolution: [u32; 3],
    density: f32,
    cells: u32,
    pairs: u64,
    box_pairs: u64,
    grid_bytes: u64,
    scratch_bytes: u64,
}

/// The course of time, of a scene that has one.
#[derive(Serialize)]
struct Course {
    duration: f64,
    fps: f64,
    frames: u64,
    cyclic: bool,
    clips: Vec<Clip>,
}

#[derive(Serialize)]
struct Clip {
    name: String,
    duration: f64,
}

#[derive(Serialize)]
struct Mesh {
    name: String,
    triangles: u64,
    vertices: u64,
    /// `still`, `key-frames` or `deformed`.
    motion: &'static str,
    key_frames: u32,
    morph_targets: usize,
    /// Of joints or nodes that move its vertices.
    matrices: u32,
}

impl Mesh {
    fn new(animation: &Animation, index: usize) -> Option<Mesh> {
        let mesh = animation.scene.meshes.get(index)?;
        let (motion, morph_targets, matrices) = match animation.motions.get(index) {
            Some(Motion::Keys) => ("key-frames", 0, 0),
            Some(Motion::Deformed(deformed)) => ("deformed", deformed.targets.len(), deformed.matrix_count),
            _ => ("still", 0, 0),
        };
        let key_frames = if motion == "key-frames" { animation.key_count(index) } else { 0 };
        let (triangles, vertices) = (mesh.indices.len() as u64, mesh.positions.len() as u64);
        Some(Mesh { name: mesh.name.clone(), triangles, vertices, motion, key_frames, morph_targets, matrices })
    }

    /// How it moves, in words.
    fn movement(&self) -> String {
        let count = |number: usize, one: &str, many: &str| match number {
            0 => None,
            1 => Some(format!("1 {one}")),
            number => Some(format!("{number} {many}")),
        };
        let parts = [
            count(self.key_frames as usize, "key-frame", "key-frames"),
            count(self.morph_targets, "morph target", "morph targets"),
            count(self.matrices as usize, "matrix", "matrices"),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { String::new() } else { format!("; moves by {}", parts.join(", ")) }
    }
}

/// Tells what a scene holds.
pub fn run(low: &Info) -> Result<Exit> {
    let source = Source::new(&low.scene);
    let animation = scene::open(&source, &load_options(&low.limits), None)?;
    let scene = &animation.scene;
    let mut report = report(&source, &animation);
    if report.triangles > report.dropped {
        let grid = estimate_grid(scene, &session::build_settings(&high::grid(&low.grid), &scene.defaults))?;
        report.grid = Some(Grid {
            resolution: grid.resolution,
            density: grid.density,
            cells: grid.cells,
            pairs: grid.pairs,
            box_pairs: grid.box_pairs,
            grid_bytes: grid.grid_bytes,
            scratch_bytes: grid.scratch_bytes,
        });
    }
    if low.json {
        output::print_json(&report)?
    } else {
        output::print(&text(&report))?
    }
    Ok(Exit::Ok)
}

fn report(source: &Source, animation: &Animation) -> Report {
    let scene = &animation.scene;
    let (mut dropped, mut degenerate) = (0, 0);
    for mesh in &scene.meshes {
        for triangle in &mesh.indices {
            let corners = triangle.map(|index| mesh.positions.get(index as usize).copied().unwrap_or([f32::NAN; 3]));
            if !corners.as_flattened().iter().all(|value| value.is_finite()) {
                dropped += 1;
            } else if area(corners) == 0.0 {
                degenerate += 1;
            }
        }
    }
    Report {
        header: Header::new("info"),
        scene: source.name(),
        meshes: (0..scene.meshes.len()).filter_map(|index| Mesh::new(animation, index)).collect(),
        triangles: scene.triangle_count(),
        vertices: scene.meshes.iter().map(|mesh| mesh.positions.len() as u64).sum(),
        dropped,
        degenerate,
        bounds: scene.bounds().map(|bounds| [bounds.min, bounds.max]),
        materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
        textures: scene.textures.len(),
        texture_bytes: scene.textures.iter().map(|texture| u64::from(texture.width) * u64::from(texture.height) * 4).sum(),
        lights: scene.lights.len(),
        cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
        animation: course(animation),
        grid: None,
        warnings: scene.warnings.clone(),
    }
}

fn course(animation: &Animation) -> Option<Course> {
    let &Animation { duration, fps, cyclic, .. } = animation;
    (duration > 0.0 || !animation.clips.is_empty()).then(|| Course {
        duration,
        fps,
        frames: animation.frame_count(fps),
        cyclic,
        clips: animation.clips.iter().map(|clip| Clip { name: clip.name.clone(), duration: clip.duration }).collect(),
    })
}

fn area(corners: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let (u, v): ([f64; 3], [f64; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    cross.iter().map(|value| value * value).sum::<f64>().sqrt() / 2.0
}

fn text(report: &Report) -> String {
    // Writing to a string cannot fail.
    let mut text = String::new();
    let _ = writeln!(text, "{}", report.scene);
    let _ = writeln!(text, "triangles   {} ({} not finite, {} without area)", report.triangles, report.dropped, report.degenerate);
    let _ = writeln!(text, "vertices    {}", report.vertices);
    match report.bounds {
        Some([min, max]) => {
            let _ = writeln!(text, "box         {} to {}", numbers(min), numbers(max));
        }
        None => {
            let _ = writeln!(text, "box         none");
        }
    }
    for mesh in &report.meshes {
        let moves = mesh.movement();
        let _ = writeln!(text, "mesh        {} ({} triangles, {} vertices{moves})", mesh.name, mesh.triangles, mesh.vertices);
    }
    let _ = writeln!(text, "materials   {}: {}", report.materials.len(), report.materials.join(", "));
    let _ = writeln!(text, "textures    {} ({} MiB)", report.textures, report.texture_bytes >> 20);
    let _ = writeln!(text, "lights      {}", report.lights);
    let cameras = if report.cameras.is_empty() { "none; the automatic one".to_owned() } else { report.cameras.join(", ") };
    let _ = writeln!(text, "cameras     {cameras}");
    if let Some(Course { duration, fps, frames, cyclic, clips }) = &report.animation {
        let again = if *cyclic { ", and again from the first" } else { "" };
        let _ = writeln!(text, "animation   {duration:.3} s, {frames} frames at {fps} a second{again}");
        for clip in clips {
            let _ = writeln!(text, "clip        {} ({:.3} s)", clip.name, clip.duration);
        }
    }
    if let Some(grid) = &report.grid {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        let resolution = grid.resolution.map(|n| n.to_string()).join(" x ");
        let _ = writeln!(text, "grid        {resolution}: {} cells, {} pairs at density {}", grid.cells, grid.pairs, grid.density);
        let each = (grid.grid_bytes + grid.scratch_bytes) / report.triangles.max(1);
        let (kept, scratch) = (mib(grid.grid_bytes), mib(grid.scratch_bytes));
        let _ = writeln!(text, "memory      {kept:.1} MiB, and {scratch:.1} MiB while it is built: {each} bytes a triangle");
    }
    text
}

fn numbers(values: [f32; 3]) -> String {
    values.map(|value| value.to_string()).join(" ")
}
