//! Bakes ambient occlusion into the vertices of a model, with gridwalk's own device: no engine, no Vulkan, two functions.
//!
//! [`occluded`] tells for every vertex which of its rays reach the sky, [`cast`] what each pixel of a picture sees. Writes `bake.ply`, the model
//! with a grey a vertex, and `bake.png`, a picture of it, to the folder named, or to the working folder.
//!
//! ```sh
//! cargo run --release --example bake -- scenes/teapot/teapot.obj pictures
//! ```

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::{env, iter};

use anyhow::{Context as _, Result, ensure};
use glam::{Vec3, vec3};
use gridwalk_render::gridwalk::{Ray, UNFINISHED};
use gridwalk_render::{BuildSettings, Context, ContextDesc, GpuScene, GridBuilder, cast, occluded};
use gridwalk_scene::{Camera, LoadOptions, Mesh, generate::Random, load};

const RAYS_EACH: usize = 32;
const WIDTH: usize = 320;
const HEIGHT: usize = 240;

/// The fraction of a vertex's hemisphere, weighted by the cosine, from which light of the sky comes.
type Openness = Vec<f32>;

/// Rays into the hemispheres of all vertices, [`RAYS_EACH`] a vertex, up to a distance.
fn hemispheres(mesh: &Mesh, reach: f32) -> Vec<Ray> {
    let mut random = Random::new(1);
    let mut rays = Vec::with_capacity(mesh.positions.len() * RAYS_EACH);
    for (&position, &normal) in iter::zip(&mesh.positions, &mesh.normals) {
        let normal = Vec3::from(normal);
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        for i in 0..RAYS_EACH {
            // Strata of the radius: a random height in each would cluster.
            let radius2 = (i as f32 + random.unit()) / RAYS_EACH as f32;
            let (sine, cosine) = (std::f32::consts::TAU * random.unit()).sin_cos();
            let direction = radius2.sqrt() * (cosine * tangent + sine * bitangent) + (1.0 - radius2).sqrt() * normal;
            // Off the surface, so that the triangles around the vertex are not hit by rays that start on them.
            let origin = Vec3::from(position) + 1e-3 * reach * normal;
            rays.push(Ray { origin: origin.into(), t_min: 0.0, direction: direction.into(), t_max: reach });
        }
    }
    rays
}

/// One ray a pixel, row by row from the top.
fn camera_rays(camera: &Camera) -> Vec<Ray> {
    let eye = Vec3::from(camera.eye);
    let forward = (Vec3::from(camera.target) - eye).normalize();
    let right = forward.cross(Vec3::from(camera.up)).normalize();
    let up = right.cross(forward);
    let scale = (camera.vertical_fov_degrees.to_radians() / 2.0).tan() * 2.0 / HEIGHT as f32;
    let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x as f32, y as f32)));
    pixels
        .map(|(x, y)| {
            let across = (x + 0.5 - WIDTH as f32 / 2.0) * scale;
            let above = (HEIGHT as f32 / 2.0 - y - 0.5) * scale;
            let direction = forward + across * right + above * up;
            Ray { origin: camera.eye, t_min: 0.0, direction: direction.into(), t_max: f32::INFINITY }
        })
        .collect()
}

/// PLY as most programs read it: binary, a colour a vertex.
fn write_ply(path: &Path, mesh: &Mesh, open: &Openness) -> Result<()> {
    let mut file = BufWriter::new(File::create(path).with_context(|| path.display().to_string())?);
    writeln!(file, "ply\nformat binary_little_endian 1.0\nelement vertex {}", mesh.positions.len())?;
    writeln!(file, "property float x\nproperty float y\nproperty float z")?;
    writeln!(file, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
    writeln!(file, "element face {}\nproperty list uchar uint vertex_indices\nend_header", mesh.indices.len())?;
    for (position, &open) in iter::zip(&mesh.positions, open) {
        file.write_all(bytemuck::bytes_of(position))?;
        file.write_all(&[encoded(open); 3])?;
    }
    for corners in &mesh.indices {
        file.write_all(&[3])?;
        file.write_all(bytemuck::bytes_of(corners))?;
    }
    Ok(file.flush()?)
}

fn write_png(path: &Path, grey: &[u8]) -> Result<()> {
    let file = File::create(path).with_context(|| path.display().to_string())?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), WIDTH as u32, HEIGHT as u32);
    encoder.set_color(png::ColorType::Grayscale);
    Ok(encoder.write_header()?.write_image_data(grey)?)
}

/// A linear value as a byte of a picture.
fn encoded(linear: f32) -> u8 {
    (linear.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0 + 0.5) as u8
}

fn main() -> Result<()> {
    let mut arguments = env::args_os().skip(1).map(PathBuf::from);
    let path = arguments.next().unwrap_or_else(|| PathBuf::from("scenes/teapot/teapot.obj"));
    let folder = arguments.next().unwrap_or_default();

    // The model: a scene has any number of meshes, one after another on the device. `Hit::triangle` counts over all of them.
    let scene = load(&path, &LoadOptions::default())?;
    let extent = scene.meshes.iter().flat_map(|mesh| &mesh.positions).map(|&p| Vec3::from(p)).filter(|p| p.is_finite());
    let (low, high) = extent.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    ensure!(low.cmple(high).all(), "{}: no vertex", path.display());

    // A device, the scene in its memory, and a grid over it.
    let context = Context::new(&ContextDesc::default())?;
    let on_device = GpuScene::upload(&context, &scene)?;
    let grid = GridBuilder::new(&context)?.build(&on_device, &BuildSettings::default())?;

    let mut openness: Vec<Openness> = Vec::new();
    for mesh in &scene.meshes {
        // `occluded` takes as many rays as there are, and brings them to the device in batches.
        let answers = occluded(&grid, &hemispheres(mesh, 0.5 * (high - low).length()))?;
        ensure!(!answers.contains(&UNFINISHED), "a ray took too long");
        openness.push(answers.chunks(RAYS_EACH).map(|rays| 1.0 - rays.iter().sum::<u32>() as f32 / RAYS_EACH as f32).collect());
    }
    // A PLY file holds one mesh.
    let mut whole = Mesh::default();
    for mesh in &scene.meshes {
        let first = whole.positions.len() as u32;
        whole.indices.extend(mesh.indices.iter().map(|corners| corners.map(|corner| corner + first)));
        whole.positions.extend(&mesh.positions);
    }
    let open: Openness = openness.concat();
    write_ply(&folder.join("bake.ply"), &whole, &open)?;

    // What the bake looks like: the hit says where between which three vertices a pixel lies.
    let hits = cast(&grid, &camera_rays(&scene.camera(None).context("no camera")?))?;
    let shade = |hit: &gridwalk_render::gridwalk::Hit| {
        if !hit.is_hit() {
            return encoded(0.2);
        }
        let corners = whole.indices[hit.triangle as usize].map(|vertex| open[vertex as usize]);
        encoded(Vec3::from(corners).dot(vec3(1.0 - hit.u - hit.v, hit.u, hit.v)))
    };
    let picture: Vec<u8> = hits.iter().map(shade).collect();
    write_png(&folder.join("bake.png"), &picture)?;
    let mean = open.iter().sum::<f32>() / open.len() as f32;
    eprintln!("{} vertices, {} rays, {:.0} % open", open.len(), open.len() * RAYS_EACH, 100.0 * mean);
    Ok(())
}
