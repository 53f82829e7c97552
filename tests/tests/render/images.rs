//! Blessed pictures of the committed scenes: `tests/blessed/NAME.png`, made by `cargo tool bless` and looked at before they were committed.

use std::fs;
use std::path::{Path, PathBuf};

use gridwalk_render::image::{Metadata, PngOptions, Rgb8, Tonemap, encode_png, tonemapped};
use gridwalk_scene::{Camera, LoadOptions, load};

use super::{RenderSettings, render, size, with_all_layers};

fn tests() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn picture(name: &str, settings: &RenderSettings) -> Rgb8 {
    let scene = load(&tests().join("../scenes").join(name), &LoadOptions::default()).unwrap();
    let frame = render(&scene, &scene.camera(None).unwrap(), settings);
    let exposure = scene.defaults.exposure.unwrap_or(0.0);
    let rgb = tonemapped(&frame.layers, &PngOptions { exposure, tonemap: Tonemap::None, alpha: false }).unwrap();
    assert_eq!(rgb.not_finite, 0, "{name} holds values that are not finite");
    rgb
}

fn write(path: &Path, picture: &Rgb8) {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, picture, &Metadata::new()).unwrap();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

fn read(path: &Path) -> Option<Rgb8> {
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).ok()?));
    let mut reader = decoder.read_info().unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut data).unwrap();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    Some(Rgb8 { width: info.width, height: info.height, channels: 3, data, not_finite: 0 })
}

/// Share of the values that differ by more than 2 of 255, and the mean difference. Within a driver both are 0; between drivers rays at edges
/// may fall to either side, and roundings of pow, sine and square root show in the last bit.
fn difference(a: &Rgb8, b: &Rgb8) -> (f64, f64) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let distances = || a.data.iter().zip(&b.data).map(|(a, b)| a.abs_diff(*b));
    let count = a.data.len() as f64;
    (distances().filter(|&distance| distance > 2).count() as f64 / count, distances().map(f64::from).sum::<f64>() / count)
}

const MOST_DIFFERENT: f64 = 0.004;
const MEAN_DIFFERENCE: f64 = 0.15;

fn agrees(a: &Rgb8, b: &Rgb8) -> bool {
    let (share, mean) = difference(a, b);
    share <= MOST_DIFFERENT && mean <= MEAN_DIFFERENCE
}

fn check(name: &str) {
    let found = picture(name, &size(160, 120));
    let blessed = tests().join("blessed").join(format!("{name}.png"));
    if std::env::var("GRIDWALK_BLESS").is_ok_and(|value| value == "1") {
        write(&blessed, &found);
        return;
    }
    let evidence = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    let Some(expected) = read(&blessed) else {
        write(&evidence, &found);
        panic!("no blessed picture {}; look at {}, then: cargo tool bless images::{name}", blessed.display(), evidence.display());
    };
    if !agrees(&found, &expected) {
        write(&evidence, &found);
        let (share, mean) = difference(&found, &expected);
        panic!(
            "{name}: {:.2} % of the values differ by more than 2, mean difference {mean:.3}: compare {} with {}; if the new one is right: \
             cargo tool bless images::{name}",
            share * 100.0,
            evidence.display(),
            blessed.display()
        );
    }
}

#[test]
fn teapot() {
    check("teapot");
}

#[test]
fn furniture() {
    check("furniture");
}

#[test]
fn mirrors() {
    check("mirrors");
}

#[test]
fn cornell() {
    check("cornell");
}

#[test]
fn masks() {
    check("masks");
}

#[test]
fn flat() {
    check("flat");
}

/// Sponza from inside, where `GRIDWALK_SPONZA` names `sponza.obj`: nearly every ray meets something, masks and bump maps included.
#[test]
fn sponza_from_inside() {
    let Some(path) = std::env::var_os("GRIDWALK_SPONZA") else {
        eprintln!("skipped: GRIDWALK_SPONZA does not name sponza.obj");
        return;
    };
    let scene = load(Path::new(&path), &LoadOptions::default()).unwrap();
    let camera = Camera {
        eye: [-800.0, 180.0, 0.0],
        target: [800.0, 350.0, 0.0],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 65.0,
        orthographic_height: None,
    };
    let frame = render(&scene, &camera, &with_all_layers(160, 100));
    let rgb = tonemapped(&frame.layers, &PngOptions { exposure: 1.0, tonemap: Tonemap::None, alpha: false }).unwrap();
    let evidence = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("sponza_from_inside.png");
    write(&evidence, &rgb);
    assert_eq!(rgb.not_finite, 0);
    let materials = frame.layers.get("id").unwrap().uints().unwrap();
    let seen = materials.chunks_exact(3).filter(|ids| ids[0] != u32::MAX).count();
    let kinds: std::collections::BTreeSet<u32> = materials.chunks_exact(3).map(|ids| ids[2]).collect();
    assert!(seen > 15_000 && kinds.len() > 10, "{seen} of 16000 pixels, {} materials: look at {}", kinds.len(), evidence.display());
}

/// Negative controls: what a comparison must not let pass.
#[test]
fn a_comparison_sees_small_changes() {
    let found = picture("cornell", &size(160, 120));
    assert!(agrees(&found, &found));
    let mut shifted = found.clone();
    shifted.data.rotate_right(3);
    assert!(!agrees(&found, &shifted), "a shift by one pixel");
    let mut brighter = found.clone();
    brighter.data.iter_mut().for_each(|value| *value = value.saturating_add(1));
    assert!(!agrees(&found, &brighter), "one code brighter everywhere");
    let mut spoilt = found.clone();
    spoilt.data.chunks_exact_mut(3).take(120).for_each(|pixel| pixel.fill(200));
    assert!(!agrees(&found, &spoilt), "part of a row of other pixels");
    assert!(!agrees(&found, &picture("cornell", &RenderSettings { depth: 0, ..size(160, 120) })), "no reflections");
}
