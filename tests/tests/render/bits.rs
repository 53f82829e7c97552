//! Grids and pictures are the same, bit for bit, whatever the subgroup size and the number of threads: lavapipe takes both from its
//! environment, so each setting is a process of its own, this one started again.

use std::path::Path;
use std::process::Command;

use gridwalk::{BuildOptions, Overlap};
use gridwalk_scene::{LoadOptions, load};
use gridwalk_tests::gpu::{Gpu, Mesh};

use super::*;

const SCENES: [&str; 4] = ["teapot", "mirrors", "masks", "cornell"];
const NAME: &str = "render::bits::no_vector_width_changes_a_bit";
/// Set in the processes that print their bits.
const CHILD: &str = "GRIDWALK_TEST_BITS";

/// FNV-1a.
fn hash(words: impl IntoIterator<Item = u32>) -> u64 {
    words
        .into_iter()
        .flat_map(u32::to_le_bytes)
        .fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

fn grid_bits(scene: &Scene, overlap: Overlap) -> u64 {
    let mut mesh = Mesh::default();
    for part in &scene.meshes {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(&part.positions);
        mesh.indices.extend(part.indices.iter().map(|corners| corners.map(|corner| corner + first)));
    }
    let built = Gpu::shared().build(&mesh, mesh.capacity(), BuildOptions { overlap, ..BuildOptions::default() });
    hash(built.cells().into_iter().flatten().chain(built.references()))
}

fn picture_bits(scene: &Scene, settings: &RenderSettings) -> u64 {
    let frame = render(scene, &scene.camera(None).unwrap(), settings);
    let words = |layer: &gridwalk_render::Layer| match (layer.floats(), layer.uints()) {
        (Some(values), _) => values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>(),
        (_, values) => values.unwrap().to_vec(),
    };
    hash(frame.layers.iter().flat_map(words))
}

fn all_bits() -> String {
    let mut line = String::from("bits");
    for name in SCENES {
        let scene = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name), &LoadOptions::default()).unwrap();
        let settings = RenderSettings { spp: 2, ..with_all_layers(80, 60) };
        let grids = [Overlap::Box, Overlap::Exact].map(|overlap| grid_bits(&scene, overlap));
        line += &format!(" {:x} {:x} {:x}", grids[0], grids[1], picture_bits(&scene, &settings));
    }
    line
}

#[test]
fn no_vector_width_changes_a_bit() {
    if std::env::var_os(CHILD).is_some() {
        println!("{}", all_bits());
        return;
    }
    if !context().device_info().name.contains("llvmpipe") {
        eprintln!("skipped: {} has one subgroup size", context().device_info().name);
        return;
    }
    let bits = |width: &str, threads: &str| {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", NAME, "--nocapture"]).env(CHILD, "1");
        let output = command.env("LP_NATIVE_VECTOR_WIDTH", width).env("LP_NUM_THREADS", threads).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{width} bits, {threads} threads: {text}{}", String::from_utf8_lossy(&output.stderr));
        text.lines().find_map(|line| line.find("bits ").map(|at| line[at..].to_owned())).expect("a line of bits")
    };
    let reference = bits("128", "1");
    assert_eq!(reference.split_whitespace().count(), 1 + 3 * SCENES.len());
    for (width, threads) in [("128", "2"), ("256", "1"), ("256", "2"), ("512", "1"), ("512", "2")] {
        assert_eq!(bits(width, threads), reference, "LP_NATIVE_VECTOR_WIDTH={width} LP_NUM_THREADS={threads}");
    }
}

/// The negative control: the bits are those of what was built and rendered.
#[test]
fn bits_tell_pictures_and_grids_apart() {
    let cornell = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/cornell"), &LoadOptions::default()).unwrap();
    let settings = RenderSettings { depth: 1, ..size(40, 30) };
    let bits = picture_bits(&cornell, &settings);
    assert_eq!(bits, picture_bits(&cornell, &settings));
    assert_ne!(bits, picture_bits(&cornell, &RenderSettings { depth: 0, ..settings }));
    assert_ne!(grid_bits(&cornell, Overlap::Box), grid_bits(&cornell, Overlap::Exact));
}
