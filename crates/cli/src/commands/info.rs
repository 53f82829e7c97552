//! `gridwalk info`.

use gridwalk_render::estimate_grid;
use gridwalk_render::gridwalk_scene::Scene;
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

#[derive(Serialize)]
struct Mesh {
    name: String,
    triangles: u64,
    vertices: u64,
}

/// Tells what a scene holds.
pub fn run(low: &Info) -> Result<Exit> {
    let source = Source::new(&low.scene);
    let scene = scene::read(&source, &load_options(&low.limits))?;
    let mut report = report(&source, &scene);
    if report.triangles > report.dropped {
        let grid = estimate_grid(&scene, &session::build_settings(&high::grid(&low.grid), &scene.defaults))?;
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

fn report(source: &Source, scene: &Scene) -> Report {
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
        meshes: scene
            .meshes
            .iter()
            .map(|mesh| Mesh { name: mesh.name.clone(), triangles: mesh.indices.len() as u64, vertices: mesh.positions.len() as u64 })
            .collect(),
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
        grid: None,
        warnings: scene.warnings.clone(),
    }
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
        let _ = writeln!(text, "mesh        {} ({} triangles, {} vertices)", mesh.name, mesh.triangles, mesh.vertices);
    }
    let _ = writeln!(text, "materials   {}: {}", report.materials.len(), report.materials.join(", "));
    let _ = writeln!(text, "textures    {} ({} MiB)", report.textures, report.texture_bytes >> 20);
    let _ = writeln!(text, "lights      {}", report.lights);
    let cameras = if report.cameras.is_empty() { "none; the automatic one".to_owned() } else { report.cameras.join(", ") };
    let _ = writeln!(text, "cameras     {cameras}");
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
