//! What holds of every picture.

use std::path::Path;

use gridwalk_render::{Crop, Error};
use gridwalk_scene::{LoadOptions, generate, load};

use super::*;

fn committed(name: &str) -> Scene {
    load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name), &LoadOptions::default()).unwrap()
}

fn same_bits(a: &Layers, b: &Layers) -> bool {
    let bits = |layers: &Layers| -> Vec<u32> {
        let of = |layer: &gridwalk_render::Layer| match (layer.floats(), layer.uints()) {
            (Some(values), _) => values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>(),
            (_, values) => values.unwrap().to_vec(),
        };
        layers.iter().flat_map(of).collect()
    };
    a.width() == b.width() && bits(a) == bits(b)
}

#[test]
fn the_same_input_gives_the_same_bits_whatever_the_batch() {
    let scene = committed("mirrors");
    let camera = scene.camera(None).unwrap();
    let (gpu, grid) = studio().load(&scene);
    let settings = RenderSettings { spp: 2, ..with_all_layers(70, 45) };
    let first = studio().shoot(&gpu, &grid, &camera, &settings);
    let again = studio().shoot(&gpu, &grid, &camera, &settings);
    assert!(same_bits(&first.layers, &again.layers));
    assert_eq!(first.stats.rays, again.stats.rays);
    for batch in [1000, 333] {
        let other = studio().shoot(&gpu, &grid, &camera, &RenderSettings { batch, ..settings.clone() });
        assert!(same_bits(&first.layers, &other.layers), "batches of {batch}");
        assert_eq!(first.stats.rays, other.stats.rays);
        assert!(other.stats.submissions > first.stats.submissions);
    }
    let (gpu, grid) = studio().load(&scene);
    assert!(same_bits(&first.layers, &studio().shoot(&gpu, &grid, &camera, &settings).layers), "uploaded and built anew");
    let coarser = studio().shoot(&gpu, &grid, &camera, &RenderSettings { spp: 1, ..settings });
    assert!(!same_bits(&first.layers, &coarser.layers), "the comparison sees nothing");
}

#[test]
fn a_part_is_a_part_of_the_whole() {
    let scene = committed("teapot");
    let camera = scene.camera(None).unwrap();
    let (gpu, grid) = studio().load(&scene);
    let settings = with_all_layers(61, 43);
    let whole = studio().shoot(&gpu, &grid, &camera, &settings).layers;
    let crop = Crop { x: 17, y: 9, width: 23, height: 31 };
    let part = studio().shoot(&gpu, &grid, &camera, &RenderSettings { crop: Some(crop), ..settings }).layers;
    assert_eq!((part.width(), part.height()), (23, 31));
    for (x, y) in [(0, 0), (22, 30), (11, 8), (3, 25)] {
        for layer in ["beauty", "Z", "N", "P"] {
            assert_eq!(pixel(&part, layer, x, y), pixel(&whole, layer, x + 17, y + 9), "{layer} at {x}, {y}");
        }
        assert_eq!(ids(&part, "id", x, y), ids(&whole, "id", x + 17, y + 9));
    }
}

#[test]
fn layers_say_what_was_hit() {
    let floor = generate::plane([4.0, 4.0], 1);
    let ball = generate::sphere([0.0, 1.0, 0.0], 0.5, 64);
    let mut scene = scene(vec![(floor, matt(0.3)), (ball, matt(0.7))]);
    scene.background = colour(1.0);
    let frame = render(&scene, &from_above(5.0), &with_all_layers(50, 50));
    let layers = &frame.layers;
    // The ball's top, from 5 above the floor.
    assert!((pixel(layers, "Z", 25, 25)[0] - 3.5).abs() < 0.01);
    assert_eq!(ids(layers, "id", 25, 25)[1..], [1, 1]);
    assert!(ids(layers, "id", 25, 25)[0] < scene.meshes[1].indices.len() as u32, "counted within the mesh");
    assert_eq!(pixel(layers, "albedo", 25, 25), [0.7; 3]);
    assert!(pixel(layers, "N", 25, 25)[1] > 0.98);
    // The floor, a quarter in from its left edge and in the middle of the rows: x = -1, z = 0.
    let at = pixel(layers, "P", 15, 24);
    assert!((at[0] + 0.95).abs() < 1e-5 && at[1].abs() < 1e-6 && (at[2] + 0.05).abs() < 1e-5, "{at:?}");
    assert_close("distance", pixel(layers, "Z", 15, 24)[0], 5.0, 1e-6);
    let uv = pixel(layers, "uv", 15, 24);
    assert!((uv[0] - (at[0] / 4.0 + 0.5)).abs() < 1e-5 && (uv[1] - (0.5 - at[2] / 4.0)).abs() < 1e-5, "{uv:?}");
    assert_eq!(pixel(layers, "Ng", 15, 24), [0.0, 1.0, 0.0]);
    // Beside the floor.
    assert_eq!(ids(layers, "id", 0, 0), [u32::MAX; 3]);
    assert_eq!(pixel(layers, "Z", 0, 0), [f32::INFINITY]);
    assert_eq!(pixel(layers, "N", 0, 0), [0.0; 3]);
    assert!(ids(layers, "debug.steps", 25, 25)[0] > 0 && ids(layers, "debug.tests", 25, 25)[0] > 0);
    assert!(ids(layers, "debug.cells", 25, 25)[0] <= ids(layers, "debug.steps", 25, 25)[0]);
}

#[test]
fn samples_smooth_edges_and_leave_layers_alone() {
    let scene = scene(vec![(generate::plane([2.0, 2.0], 1), lamp([1.0; 3]))]);
    // Pixels half a unit wide: the edges at x = -1 and x = 1 go through the middle of a column.
    let camera = from_above(4.5);
    let one = render(&scene, &camera, &with_all_layers(9, 9));
    let many = render(&scene, &camera, &RenderSettings { spp: 16, ..with_all_layers(9, 9) });
    let edge: Vec<f32> = (0..9).map(|x| pixel(&many.layers, "beauty", x, 4)[0]).collect();
    assert!(edge.iter().any(|&value| (value - 0.5).abs() < 0.07), "half a pixel is covered: {edge:?}");
    assert!((0..9).all(|x| [0.0, 1.0].contains(&pixel(&one.layers, "beauty", x, 4)[0])));
    for layer in ["Z", "P"] {
        assert_eq!(one.layers.get(layer), many.layers.get(layer), "{layer}");
    }
}

#[test]
fn a_scene_of_nothing_is_its_background() {
    let mut nothing = scene(Vec::new());
    nothing.background = Background::Colour([0.5, 0.25, 0.125]);
    let frame = render(&nothing, &from_above(1.0), &with_all_layers(9, 7));
    assert!((0..63).all(|i| pixel(&frame.layers, "beauty", i % 9, i / 9) == [0.5, 0.25, 0.125, 1.0]));
}

#[test]
fn a_panorama_hangs_as_documented() {
    let mut nothing = scene(Vec::new());
    let (width, height) = (64, 32);
    // Red grows with u, green with v.
    let pixels = (0..width * height).map(|i| [(i % width) as f32 / 63.0, 1.0 - (i / width) as f32 / 31.0, 0.0]).collect();
    nothing.background = Background::Equirectangular { width, height, pixels, rotation_degrees: 0.0 };
    let looking = |target: [f32; 3]| Camera {
        eye: [0.0; 3],
        target,
        up: if target[1].abs() > 0.5 { [0.0, 0.0, -1.0] } else { [0.0, 1.0, 0.0] },
        vertical_fov_degrees: 1.0,
        orthographic_height: None,
    };
    for (target, u, v) in [
        ([0.0, 0.0, -1.0], 0.5, 0.5),
        ([1.0, 0.0, 0.0], 0.75, 0.5),
        ([-1.0, 0.0, 0.0], 0.25, 0.5),
        ([1.0, 0.0, -1.0], 0.625, 0.5),
        ([0.0, 1.0, 0.0], -1.0, 1.0),
        ([0.0, -1.0, 0.0], -1.0, 0.0),
    ] {
        let frame = render(&nothing, &looking(target), &size(1, 1));
        let found = pixel(&frame.layers, "beauty", 0, 0);
        assert!((found[1] - v).abs() < 0.03 && (u < 0.0 || (found[0] - u).abs() < 0.03), "towards {target:?}: {found:?}");
    }
}

#[test]
fn settings_without_a_meaning_are_refused() {
    let scene = scene(vec![(generate::plane([1.0, 1.0], 1), matt(0.5))]);
    let (gpu, grid) = studio().load(&scene);
    let camera = from_above(1.0);
    let refuse = |settings: RenderSettings, camera: &Camera, name: &str| {
        let error = studio().renderer.render(&gpu, &grid, camera, &settings, &mut |_| ControlFlow::Continue(())).unwrap_err();
        assert!(matches!(&error, Error::Setting { setting, .. } if *setting == name), "{error}");
    };
    refuse(size(0, 10), &camera, "width");
    refuse(size(10, 70_000), &camera, "height");
    refuse(RenderSettings { spp: 0, ..size(4, 4) }, &camera, "spp");
    refuse(RenderSettings { batch: 0, ..size(4, 4) }, &camera, "batch");
    refuse(RenderSettings { crop: Some(Crop { x: 2, y: 0, width: 3, height: 1 }), ..size(4, 4) }, &camera, "crop");
    refuse(RenderSettings { crop: Some(Crop { x: u32::MAX, y: 0, width: 3, height: 1 }), ..size(4, 4) }, &camera, "crop");
    refuse(size(4, 4), &Camera { target: camera.eye, ..camera }, "camera");
    refuse(size(4, 4), &Camera { eye: [f32::NAN; 3], ..camera }, "camera");
    refuse(size(4, 4), &Camera { orthographic_height: None, vertical_fov_degrees: 180.0, ..camera }, "camera");
    refuse(size(4, 4), &Camera { orthographic_height: Some(-1.0), ..camera }, "camera");
    assert!("normals".parse::<Aov>().unwrap_err().to_string().contains("geometric-normal"));
    assert!(Aov::ALL.into_iter().all(|aov| aov.name().parse::<Aov>().unwrap() == aov && aov.layer().parse::<Aov>().unwrap() == aov));
}

#[test]
fn indices_that_lead_nowhere_are_refused() {
    let good = || scene(vec![(generate::plane([1.0, 1.0], 1), matt(0.5))]);
    let refuse = |what: &str, scene: &Scene| {
        let error = GpuScene::upload(context(), scene).unwrap_err();
        assert!(matches!(error, Error::Scene { .. }) && error.to_string().contains(what), "{error}");
    };
    let mut bad = good();
    bad.meshes[0].indices[1][2] = 4;
    refuse("vertex 4 of 4", &bad);
    bad = good();
    bad.meshes[0].materials[0] = 1;
    refuse("material 1 of 1", &bad);
    bad = good();
    bad.meshes[0].normals.pop();
    refuse("3 normals", &bad);
    bad = good();
    bad.materials[0].diffuse_map = Some(0);
    refuse("texture 0 of 0", &bad);
    GpuScene::upload(context(), &good()).unwrap();
}

#[test]
fn a_picture_can_be_interrupted() {
    let scene = scene(vec![(generate::plane([1.0, 1.0], 1), matt(0.5))]);
    let (gpu, grid) = studio().load(&scene);
    let mut calls = 0;
    let settings = RenderSettings { batch: 16, ..size(32, 32) };
    let mut shares = Vec::new();
    let result = studio().renderer.render(&gpu, &grid, &from_above(1.0), &settings, &mut |progress| {
        calls += 1;
        shares.push(progress.done);
        if calls == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(result, Err(Error::Interrupted)));
    assert_eq!(calls, 5);
    assert!(shares.is_sorted() && shares[4] < 0.5, "{shares:?}");
    let mut last = 0.0;
    studio()
        .renderer
        .render(&gpu, &grid, &from_above(1.0), &settings, &mut |progress| {
            last = progress.done;
            ControlFlow::Continue(())
        })
        .unwrap();
    assert_eq!(last, 1.0);
}

/// The grid grows by itself: fewer pairs are reckoned with than large overlapping triangles make.
#[test]
fn a_grid_that_is_too_small_is_built_again() {
    let mut scene = scene(vec![(generate::soup(3000, 7), matt(0.5))]);
    for position in &mut scene.meshes[0].positions {
        *position = position.map(|value| value * 30.0);
    }
    scene.background = colour(1.0);
    let (gpu, grid) = studio().load(&scene);
    let dense = studio().builder.build(&gpu, &BuildSettings { density: 64.0, ..BuildSettings::default() }).unwrap();
    assert!(dense.stats().attempts > 1, "{:?}", dense.stats());
    assert!(!dense.stats().report.pairs_overflowed());
    let camera = scene.camera(None).unwrap();
    let settings = with_all_layers(60, 40);
    let (a, b) = (studio().shoot(&gpu, &grid, &camera, &settings), studio().shoot(&gpu, &dense, &camera, &settings));
    assert_eq!(a.layers.get("id"), b.layers.get("id"), "what is seen does not depend on the grid");
    assert_ne!(a.layers.get("debug.tests"), b.layers.get("debug.tests"));
}
