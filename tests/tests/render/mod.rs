//! Pictures: the device behind them, what the shading promises, and the blessed ones.

mod bits;
mod blend;
mod context;
mod grids;
mod images;
mod light;
mod masks;
mod mirrors;
mod pictures;

use std::ops::ControlFlow;
use std::sync::OnceLock;

use gridwalk_render::{Aov, BuildSettings, Context, Frame, GpuScene, Grid, GridBuilder, Layers, RenderSettings, Renderer};
use gridwalk_scene::{Background, Camera, Light, Material, Mesh, Scene};
use gridwalk_tests::gpu::Gpu;

/// The renderer that all tests of a process share, on their common device.
struct Studio {
    builder: GridBuilder,
    renderer: Renderer,
}

fn context() -> &'static Context {
    &Gpu::shared().context
}

fn studio() -> &'static Studio {
    static STUDIO: OnceLock<Studio> = OnceLock::new();
    STUDIO.get_or_init(|| Studio { builder: GridBuilder::new(context()).unwrap(), renderer: Renderer::new(context()).unwrap() })
}

impl Studio {
    fn load(&self, scene: &Scene) -> (GpuScene, Grid) {
        let gpu = GpuScene::upload(context(), scene).unwrap();
        let grid = self.builder.build(&gpu, &BuildSettings::default()).unwrap();
        (gpu, grid)
    }

    fn shoot(&self, scene: &GpuScene, grid: &Grid, camera: &Camera, settings: &RenderSettings) -> Frame {
        let frame = self.renderer.render(scene, grid, camera, settings, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(frame.stats.rays.unfinished, 0);
        Gpu::shared().check_validation();
        frame
    }
}

/// Loads, builds and renders.
fn render(scene: &Scene, camera: &Camera, settings: &RenderSettings) -> Frame {
    let (gpu, grid) = studio().load(scene);
    studio().shoot(&gpu, &grid, camera, settings)
}

fn size(width: u32, height: u32) -> RenderSettings {
    RenderSettings { width, height, ..RenderSettings::default() }
}

fn with_all_layers(width: u32, height: u32) -> RenderSettings {
    RenderSettings { aovs: Aov::ALL.to_vec(), ..size(width, height) }
}

/// A scene of meshes, each with the material of its place in the list; black background, no lights, no ambient light.
fn scene(parts: Vec<(Mesh, Material)>) -> Scene {
    let mut scene = Scene { up: [0.0, 1.0, 0.0], ..Scene::default() };
    for (index, (mut mesh, material)) in parts.into_iter().enumerate() {
        mesh.materials = vec![index as u32; mesh.indices.len()];
        scene.meshes.push(mesh);
        scene.materials.push(material);
    }
    scene
}

fn matt(diffuse: f32) -> Material {
    Material { diffuse: [diffuse; 3], ..Material::default() }
}

fn mirror() -> Material {
    Material { diffuse: [0.0; 3], specular: [1.0; 3], illumination: 3, ..Material::default() }
}

fn lamp(radiance: [f32; 3]) -> Material {
    Material { diffuse: [0.0; 3], emission: radiance, ..Material::default() }
}

/// Looks down from above; x to the right, -z upwards in the picture.
fn from_above(height: f32) -> Camera {
    Camera { eye: [0.0, 5.0, 0.0], target: [0.0; 3], up: [0.0, 0.0, -1.0], vertical_fov_degrees: 40.0, orthographic_height: Some(height) }
}

fn pixel(layers: &Layers, layer: &str, x: u32, y: u32) -> Vec<f32> {
    let layer = layers.get(layer).unwrap();
    let channels = layer.channels.len();
    let at = (y * layers.width() + x) as usize * channels;
    layer.floats().unwrap()[at..at + channels].to_vec()
}

fn ids(layers: &Layers, layer: &str, x: u32, y: u32) -> Vec<u32> {
    let layer = layers.get(layer).unwrap();
    let channels = layer.channels.len();
    let at = (y * layers.width() + x) as usize * channels;
    layer.uints().unwrap()[at..at + channels].to_vec()
}

/// Red of every pixel.
fn reds(layers: &Layers) -> Vec<f32> {
    layers.get("beauty").unwrap().floats().unwrap().chunks_exact(4).map(|pixel| pixel[0]).collect()
}

fn sun(direction: [f32; 3], irradiance: f32) -> Light {
    let length = direction.iter().map(|value| value * value).sum::<f32>().sqrt();
    Light::Directional { direction: direction.map(|value| value / length), irradiance: [irradiance; 3] }
}

fn colour(value: f32) -> Background {
    Background::Colour([value; 3])
}

/// Within a share of the expected value, or of 1e-6 for an expected zero.
fn assert_close(what: &str, found: f32, expected: f32, share: f32) {
    let bound = (expected.abs() * share).max(1e-6);
    assert!((found - expected).abs() <= bound, "{what}: {found}, expected {expected}");
}
