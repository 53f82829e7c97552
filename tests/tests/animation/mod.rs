//! Scenes that move: the kernels that move vertices, and the player that brings one time after another to the device.

mod changes;
mod deformed;
mod errors;
mod frames;
mod kernels;
mod steady;

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;

use gridwalk_render::{
    Aov, BuildSettings, Context, GpuScene, Grid, GridBuilder, Layers, Player, PlayerOptions, RenderSettings, Renderer, SeekStats,
};
use gridwalk_scene::{Animation, AnimationOptions, Camera, LoadOptions, Mesh, Scene, open};
use gridwalk_tests::gpu::Gpu;

fn context() -> &'static Context {
    &Gpu::shared().context
}

fn renderer() -> &'static Renderer {
    static RENDERER: OnceLock<Renderer> = OnceLock::new();
    RENDERER.get_or_init(|| Renderer::new(context()).unwrap())
}

fn builder() -> &'static GridBuilder {
    static BUILDER: OnceLock<GridBuilder> = OnceLock::new();
    BUILDER.get_or_init(|| GridBuilder::new(context()).unwrap())
}

fn animation(path: &Path) -> Animation {
    open(path, &LoadOptions::default(), &AnimationOptions::default()).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn player(animation: Animation) -> Player {
    Player::new(context(), animation, &PlayerOptions::default()).unwrap()
}

/// A player of a folder's scene, or of a pattern's files.
fn play(path: &Path) -> Player {
    player(animation(path))
}

fn seek(player: &mut Player, time: f64, upcoming: &[f64]) -> SeekStats {
    let stats = player.seek(time, upcoming).unwrap_or_else(|error| panic!("at {time}: {error}"));
    Gpu::shared().check_validation();
    stats
}

/// Looks at the origin from afar.
fn camera() -> Camera {
    Camera { eye: [1.0, 2.0, 6.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], vertical_fov_degrees: 40.0, orthographic_height: None }
}

fn small() -> RenderSettings {
    RenderSettings { width: 48, height: 36, depth: 1, aovs: Aov::ALL.to_vec(), ..RenderSettings::default() }
}

fn shoot(scene: &GpuScene, grid: &Grid) -> Layers {
    let frame = renderer().render(scene, grid, &camera(), &small(), &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(frame.stats.rays.unfinished, 0);
    Gpu::shared().check_validation();
    frame.layers
}

fn shoot_player(player: &Player) -> Layers {
    shoot(player.scene(), player.grid())
}

/// A picture of a scene that stands still.
fn shoot_still(scene: &Scene) -> Layers {
    let gpu = GpuScene::upload(context(), scene).unwrap();
    let grid = builder().build(&gpu, &BuildSettings::default()).unwrap();
    shoot(&gpu, &grid)
}

/// Every layer but those that count the walk's work, as bits.
fn bits(layers: &Layers) -> Vec<(String, Vec<u32>)> {
    let words = |layer: &gridwalk_render::Layer| match (layer.floats(), layer.uints()) {
        (Some(values), _) => values.iter().map(|value| value.to_bits()).collect(),
        (_, values) => values.unwrap().to_vec(),
    };
    layers.iter().map(|layer| (layer.name.clone(), words(layer))).collect()
}

#[track_caller]
fn assert_same_picture(what: &str, a: &Layers, b: &Layers) {
    for ((name, a), (_, b)) in bits(a).iter().zip(&bits(b)) {
        let count = a.iter().zip(b).filter(|(a, b)| a != b).count();
        assert!(a.len() == b.len() && count == 0, "{what}: {count} of {} words of layer {name} differ", a.len());
    }
}

fn differ(a: &Layers, b: &Layers) -> bool {
    bits(a) != bits(b)
}

/// An OBJ file of a mesh, with its normals and texture coordinates.
fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for [x, y, z] in &mesh.positions {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for [x, y, z] in &mesh.normals {
        writeln!(text, "vn {x} {y} {z}").unwrap();
    }
    for [u, v] in &mesh.uvs {
        writeln!(text, "vt {u} {v}").unwrap();
    }
    for corners in &mesh.indices {
        text.push('f');
        for corner in corners {
            write!(text, " {0}/{0}/{0}", corner + 1).unwrap();
        }
        text.push('\n');
    }
    text
}

fn moved(mut mesh: Mesh, by: [f32; 3]) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = [p[0] + by[0], p[1] + by[1], p[2] + by[2]]);
    mesh
}

/// A folder with these files.
fn folder<T: AsRef<[u8]>>(files: &[(String, T)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

/// Key-frames as files `key.0000.obj` and so on, and a `scene.toml`.
fn sequence(keys: &[Mesh], text: &str) -> tempfile::TempDir {
    let mut files: Vec<(String, String)> = keys.iter().enumerate().map(|(key, mesh)| (format!("key.{key:04}.obj"), obj(mesh))).collect();
    files.push(("scene.toml".to_owned(), text.to_owned()));
    folder(&files)
}
