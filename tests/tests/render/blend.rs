//! Surfaces that are seen and lit through.

use std::f32::consts::PI;
use std::path::Path;

use gridwalk_scene::{Background, Camera, Light, LoadOptions, Mesh, generate, load};

use super::masks::{facing, square, texture};
use super::*;

/// A lamp of one's own that is seen through.
fn glass(opacity: f32, radiance: [f32; 3]) -> Material {
    Material { opacity, blend: true, ..lamp(radiance) }
}

fn behind(mut scene: Scene, colour: [f32; 3]) -> Scene {
    scene.background = Background::Colour(colour);
    scene
}

fn rgb(frame: &Frame, x: u32, y: u32) -> [f32; 3] {
    let found = pixel(&frame.layers, "beauty", x, y);
    [found[0], found[1], found[2]]
}

#[test]
fn a_pane_shows_its_share_and_the_rest_of_what_lies_behind() {
    let scene = behind(scene(vec![(square(0.0), glass(0.25, [1.0, 0.5, 0.0]))]), [0.5, 0.25, 1.0]);
    let frame = render(&scene, &facing(), &with_all_layers(16, 16));
    for y in 0..16 {
        for x in 0..16 {
            assert_eq!(rgb(&frame, x, y), [0.25 + 0.375, 0.125 + 0.1875, 0.75], "pixel {x}, {y}: the diagonal too");
            assert_eq!(pixel(&frame.layers, "beauty", x, y)[3], 1.0);
            assert_eq!(ids(&frame.layers, "id", x, y)[1], 0, "layers are of what is met first");
        }
    }
    let rays = frame.stats.rays;
    assert_eq!((rays.camera, rays.passed, rays.reflection, rays.total()), (256, 256, 0, 512));
    // Negative controls: what is solid hides, and what is not there is not seen.
    for (opacity, blend, expected) in [(0.25, false, [1.0, 0.5, 0.0]), (1.0, true, [1.0, 0.5, 0.0]), (0.0, true, [0.5, 0.25, 1.0])] {
        let mut other = scene.clone();
        (other.materials[0].opacity, other.materials[0].blend) = (opacity, blend);
        let frame = render(&other, &facing(), &size(4, 4));
        assert_eq!(rgb(&frame, 1, 2), expected, "{opacity} {blend}");
        assert_eq!(frame.stats.rays.passed, 0, "nothing waits behind what is nothing");
    }
}

#[test]
fn panes_behind_one_another() {
    // Halves and quarters: exact in binary.
    let parts: Vec<(Mesh, Material)> = (0..10)
        .map(|pane| {
            let opacity = if pane % 3 == 0 { 0.25 } else { 0.5 };
            (square(-0.1 * pane as f32), glass(opacity, [pane as f32, 0.0, 1.0]))
        })
        .collect();
    let (mut expected, mut left) = ([0.0_f32; 3], 1.0_f32);
    for (_, material) in &parts {
        for (sum, value) in expected.iter_mut().zip(material.emission) {
            *sum += left * (value * material.opacity);
        }
        left *= 1.0 - material.opacity;
    }
    let expected = expected.map(|value| value + left * 8.0);
    let mut scene = behind(scene(parts), [8.0; 3]);
    let frame = render(&scene, &facing(), &size(9, 9));
    assert!((0..81).all(|at| rgb(&frame, at % 9, at / 9) == expected), "{:?}, expected {expected:?}", rgb(&frame, 3, 3));
    assert_eq!(frame.stats.rays.passed, 810);
    // The order in which the file has them does not matter.
    scene.meshes.reverse();
    assert_eq!(rgb(&render(&scene, &facing(), &size(9, 9)), 4, 4), expected);
}

/// What lies behind more panes than are followed is missed, and told.
#[test]
fn panes_have_an_end() {
    let stack = |count: u32| {
        let parts = (0..count).map(|pane| (square(-0.01 * pane as f32), glass(1.0 / 128.0, [0.0; 3])));
        behind(scene(parts.collect()), [1.0; 3])
    };
    let left = |count: u32| (1.0 - 1.0 / 128.0_f32).powi(count as i32);
    let frame = render(&stack(255), &facing(), &size(2, 2));
    assert_close("255 panes", rgb(&frame, 0, 1)[1], left(255), 1e-5);
    let scene = stack(256);
    let (gpu, grid) = studio().load(&scene);
    let frame = studio().renderer.render(&gpu, &grid, &facing(), &size(2, 2), &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!((rgb(&frame, 0, 1)[1], frame.stats.rays.unfinished), (0.0, 4));
}

/// A floor lit through panes above it, seen from below them.
fn lit_through(panes: Vec<(Mesh, Material)>, light: Light) -> Scene {
    let mut scene = scene([vec![(generate::plane([2.0, 2.0], 1), matt(0.5))], panes].concat());
    scene.lights.push(light);
    scene
}

fn raised(mut mesh: Mesh, by: f32) -> Mesh {
    mesh.positions.iter_mut().for_each(|position| position[1] += by);
    mesh
}

/// With 8 by 8 pixels, those in the middle of which the coordinates are multiples of a quarter.
fn below_panes() -> Camera {
    Camera { eye: [0.125, 0.5, 0.125], target: [0.125, 0.0, 0.125], ..from_above(2.0) }
}

#[test]
fn light_is_held_back_by_as_much_as_is_opaque() {
    let pane = |opacity: f32, height: f32, segments: u32| (raised(generate::plane([4.0, 4.0], segments), height), glass(opacity, [0.0; 3]));
    // Edges and corners of the panes lie on a raster of quarters: each shadow ray goes through one or right beside it.
    for (panes, share) in [
        (vec![pane(0.25, 1.0, 16)], 0.75),
        (vec![pane(0.25, 1.0, 1)], 0.75),
        (vec![pane(0.5, 1.0, 16), pane(0.25, 1.5, 8), pane(0.5, 2.0, 1)], 0.1875),
        (vec![pane(0.0, 1.0, 16)], 1.0),
        (vec![pane(1.0, 1.0, 16)], 0.0),
        (vec![pane(0.5, 1.0, 16), (raised(generate::plane([4.0, 4.0], 1), 1.5), matt(0.5))], 0.0),
    ] {
        let sunny = lit_through(panes.clone(), sun([0.0, -1.0, 0.0], 2.0));
        let frame = render(&sunny, &below_panes(), &size(8, 8));
        for (at, found) in reds(&frame.layers).into_iter().enumerate() {
            assert_close(&format!("{} panes, pixel {at}", panes.len()), found, 0.5 / PI * 2.0 * share, 1e-5);
        }
        // From a lamp above all panes the rays fan out.
        let lamp = lit_through(panes, Light::Point { position: [0.0, 3.0, 0.0], intensity: [9.0; 3] });
        let frame = render(&lamp, &below_panes(), &with_all_layers(8, 8));
        for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
            let at = pixel(&frame.layers, "P", x, y);
            let square = at[0] * at[0] + 9.0 + at[2] * at[2];
            let expected = 0.5 / PI * 9.0 / square * (3.0 / square.sqrt()) * share;
            assert_close(&format!("pixel {x}, {y}"), rgb(&frame, x, y)[0], expected, 1e-4);
        }
    }
}

/// The walk through thousands of panes is continued by later dispatches, with the share that it had.
#[test]
fn light_through_very_many_triangles() {
    let count = 3000;
    let mut panes: Vec<Mesh> = (0..count).map(|pane| raised(generate::plane([3.0, 3.0], 1), 1.0 + pane as f32 * 1e-4)).collect();
    // All in a few cells: long lists.
    panes.push(raised(generate::plane([400.0, 400.0], 1), 50.0));
    let mut scene = lit_through(vec![(generate::merge(&panes), glass(1.0 / 1024.0, [0.0; 3]))], sun([0.0, -1.0, 0.0], 2.0));
    scene.meshes[1].materials.fill(1);
    let frame = render(&scene, &below_panes(), &size(6, 6));
    let expected = 0.5 / PI * 2.0 * (1.0 - 1.0 / 1024.0_f64).powi(count + 1) as f32;
    for found in reds(&frame.layers) {
        assert_close("pixel", found, expected, 1e-3);
    }
}

#[test]
fn opacity_comes_from_material_map_and_vertices() {
    let mut scene = behind(scene(vec![(square(0.0), glass(0.5, [0.0; 3]))]), [1.0; 3]);
    scene.materials[0].opacity_map = Some(0);
    // Left half 51 / 255 = 0.2, right half all; a column between two texels' middles mixes them.
    scene.textures.push(texture(2, false, |x, _| if x == 0 { [51; 4] } else { [255; 4] }));
    let frame = render(&scene, &facing(), &size(64, 64));
    for (x, opacity) in [(16, 0.5 * 0.2), (47, 0.5), (15, 0.5 * 0.2)] {
        assert_close("map", rgb(&frame, x, 20)[0], 1.0 - opacity, 0.02);
    }
    // Upwards from 0 to 1.
    scene.materials[0].opacity_map = None;
    scene.meshes[0].opacities = vec![0.0, 0.0, 1.0, 1.0];
    let frame = render(&scene, &facing(), &size(64, 64));
    for y in 0..64 {
        let opacity = 0.5 * (1.0 - (y as f32 + 0.5) / 64.0);
        assert_close("vertices", rgb(&frame, y, y)[0], 1.0 - opacity, 1e-5);
    }
    // A second mesh has none: it is as if they were one.
    let mut lamp = square(-1.0);
    lamp.materials = vec![1; 2];
    scene.meshes.push(lamp);
    scene.materials.push(glass(0.5, [3.0; 3]));
    let frame = render(&scene, &facing(), &size(64, 64));
    assert_close("both", rgb(&frame, 7, 63)[0], 1.0 - 0.5 / 128.0 + (1.0 - 0.5 / 128.0), 1e-5);
    // Without blending they do not count.
    scene.materials.iter_mut().for_each(|material| material.blend = false);
    let frame = render(&scene, &facing(), &size(4, 4));
    assert_eq!(rgb(&frame, 1, 1), [0.0; 3]);
}

/// Two mirrors face each other that are both seen through; a ray that meets one goes both ways, again and again.
#[test]
fn ways_branch_at_mirrors_that_are_seen_through() {
    #[derive(Clone, Copy)]
    struct Pane {
        opacity: f64,
        emission: f64,
        specular: f64,
    }
    let panes = [
        Pane { opacity: 0.5, emission: 1.0, specular: 0.75 },
        Pane { opacity: 0.75, emission: 3.0, specular: 0.5 },
        Pane { opacity: 0.625, emission: 0.5, specular: 1.0 },
    ];
    let (above, below) = (2.0, 7.0);
    let material = |pane: &Pane| Material {
        specular: [pane.specular as f32; 3],
        illumination: 3,
        ..glass(pane.opacity as f32, [pane.emission as f32; 3])
    };
    let mut scene = scene(panes.iter().enumerate().map(|(at, pane)| (square(-(at as f32)), material(pane))).collect());
    scene.up = [0.0, 0.0, 1.0];
    scene.background = Background::Gradient { bottom: [below as f32; 3], top: [above as f32; 3] };
    /// Between panes `gap - 1` and `gap`, up or down: what is seen, by the weight that the way has so far.
    struct Walk<'a> {
        panes: &'a [Pane],
        ends: [f64; 2],
        depth: u32,
        rays: u64,
    }
    impl Walk<'_> {
        fn see(&mut self, gap: usize, up: bool, level: u32, weight: f64) -> f64 {
            self.rays += 1;
            let met = if up { gap.checked_sub(1) } else { Some(gap).filter(|&gap| gap < self.panes.len()) };
            let Some(met) = met else { return self.ends[usize::from(!up)] };
            let pane = self.panes[met];
            let mut sum = pane.opacity * pane.emission;
            let (mirrored, rest) = (pane.opacity * pane.specular, 1.0 - pane.opacity);
            if level < self.depth && weight * mirrored > 1.0 / 4096.0 {
                sum += mirrored * self.see(gap, !up, level + 1, weight * mirrored);
            }
            if weight * rest > 1.0 / 4096.0 {
                sum += rest * self.see(if up { gap - 1 } else { gap + 1 }, up, level, weight * rest);
            }
            sum
        }
    }
    let mut seen = Vec::new();
    for depth in [0, 1, 2, 4] {
        let frame = render(&scene, &facing(), &RenderSettings { depth, ..size(6, 6) });
        let mut walk = Walk { panes: &panes, ends: [above, below], depth, rays: 0 };
        let expected = walk.see(0, false, 0, 1.0) as f32;
        for found in reds(&frame.layers) {
            assert_close(&format!("{depth} reflections"), found, expected, 1e-5);
        }
        assert_eq!(frame.stats.rays.total(), 36 * walk.rays, "{depth} reflections");
        seen.push(expected);
    }
    assert!(seen.windows(2).all(|pair| pair[1] > pair[0] + 0.01), "each depth shows more: {seen:?}");
}

#[test]
fn panes_are_seen_in_mirrors() {
    let mut parts = vec![(square(0.0), mirror())];
    parts.push((square(2.0), glass(0.25, [4.0, 0.0, 0.0])));
    let scene = behind(scene(parts), [0.5; 3]);
    // Between the two, looking at the mirror.
    let camera = Camera { eye: [0.0, 0.0, 1.0], ..facing() };
    let frame = render(&scene, &camera, &RenderSettings { depth: 1, ..size(5, 5) });
    assert_eq!(rgb(&frame, 2, 3), [1.0 + 0.375, 0.375, 0.375], "behind the mirrored pane, without a second reflection");
}

#[test]
fn a_picture_without_background_is_as_clear_as_its_panes() {
    let panes = vec![(square(0.0), glass(0.25, [1.0; 3])), (square(-1.0), glass(0.5, [2.0; 3]))];
    let mut scene = behind(scene(panes), [9.0; 3]);
    let camera = Camera { orthographic_height: Some(4.0), ..facing() };
    let settings = RenderSettings { transparent: true, spp: 4, ..size(16, 16) };
    let frame = render(&scene, &camera, &settings);
    assert_eq!(pixel(&frame.layers, "beauty", 8, 8), [1.0, 1.0, 1.0, 1.0 - 0.375], "premultiplied");
    assert_eq!(pixel(&frame.layers, "beauty", 0, 0), [0.0; 4]);
    scene.materials[1] = lamp([2.0; 3]);
    assert_eq!(pixel(&render(&scene, &camera, &settings).layers, "beauty", 8, 8), [1.75, 1.75, 1.75, 1.0]);
}

/// Where nothing is seen through, the other kernels give the same bits.
#[test]
fn what_is_opaque_stays_as_it_is() {
    for name in ["mirrors", "masks", "cornell"] {
        let mut scene = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name), &LoadOptions::default()).unwrap();
        let camera = scene.camera(None).unwrap();
        let settings = RenderSettings { spp: 2, ..with_all_layers(60, 45) };
        let (plain, grid) = studio().load(&scene);
        let expected = studio().shoot(&plain, &grid, &camera, &settings);
        scene.materials.push(Material { opacity: 0.5, blend: true, ..Material::default() });
        let (gpu, grid) = studio().load(&scene);
        assert!(gpu.has_blends() && !plain.has_blends());
        let found = studio().shoot(&gpu, &grid, &camera, &settings);
        assert_eq!(found.layers, expected.layers, "{name}");
        assert_eq!(found.stats.rays, expected.stats.rays, "{name}");
    }
}

#[test]
fn the_same_bits_whatever_the_batch() {
    let mut scene = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/mirrors"), &LoadOptions::default()).unwrap();
    let solid = render(&scene, &scene.camera(None).unwrap(), &size(40, 30));
    for material in &mut scene.materials {
        (material.opacity, material.blend) = (0.6, true);
    }
    let camera = scene.camera(None).unwrap();
    let (gpu, grid) = studio().load(&scene);
    let settings = RenderSettings { spp: 2, ..with_all_layers(40, 30) };
    let first = studio().shoot(&gpu, &grid, &camera, &settings);
    assert!(first.stats.rays.passed > 2400 && first.stats.rays.reflection > 0, "{:?}", first.stats.rays);
    for batch in [1200, 333] {
        let other = studio().shoot(&gpu, &grid, &camera, &RenderSettings { batch, ..settings.clone() });
        assert_eq!((&other.layers, other.stats.rays), (&first.layers, first.stats.rays), "batches of {batch}");
    }
    assert_ne!(solid.layers, first.layers);
}

/// Many reflections need more memory a pixel: the batch gets smaller by itself.
#[test]
fn rays_that_wait_have_bounded_memory() {
    let mut scene = behind(scene(vec![(square(0.0), glass(0.5, [0.0; 3]))]), [1.0; 3]);
    scene.materials.push(mirror());
    let frame = render(&scene, &facing(), &RenderSettings { depth: 1024, ..size(80, 60) });
    assert_eq!((rgb(&frame, 50, 50), frame.stats.rays.passed), ([0.5; 3], 3600));
    assert!(frame.stats.queue_bytes < 160 << 20, "{} bytes", frame.stats.queue_bytes);
}
