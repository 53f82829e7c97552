//! Masks and textures.

use std::f32::consts::PI;

use gridwalk_scene::{Camera, Light, Texture, generate};

use super::*;

/// A texture of `size` by `size` texels; the function is given column and row from the upper left.
pub(super) fn texture(size: u32, srgb: bool, texel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
    let pixels: Vec<u8> = (0..size * size).flat_map(|i| texel(i % size, i / size)).collect();
    let has_alpha = pixels.chunks_exact(4).any(|texel| texel[3] < 255);
    Texture { name: "made".to_owned(), width: size, height: size, pixels, srgb, has_alpha }
}

pub(super) fn facing() -> Camera {
    Camera { eye: [0.0, 0.0, 4.0], up: [0.0, 1.0, 0.0], orthographic_height: Some(2.0), ..from_above(1.0) }
}

pub(super) fn square(z: f32) -> gridwalk_scene::Mesh {
    generate::quad([[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]])
}

/// A square with holes in a checkerboard of 8 by 8 fields before a lamp.
fn screen(masked: bool) -> Scene {
    let mut scene = scene(vec![(square(0.0), lamp([0.0, 0.0, 1.0])), (square(-1.0), lamp([1.0, 0.0, 0.0]))]);
    let mask = texture(64, false, |x, y| if (x / 8 + y / 8) % 2 == 0 { [255; 4] } else { [0; 4] });
    scene.textures.push(mask);
    scene.materials[0].opacity_map = masked.then_some(0);
    scene
}

#[test]
fn one_sees_through_a_mask() {
    let frame = render(&screen(true), &facing(), &with_all_layers(64, 64));
    for y in 0..64 {
        for x in 0..64 {
            let solid = (x / 8 + y / 8) % 2 == 0;
            let expected = if solid { [0.0, 0.0, 1.0, 1.0] } else { [1.0, 0.0, 0.0, 1.0] };
            assert_eq!(pixel(&frame.layers, "beauty", x, y), expected, "pixel {x}, {y}");
            assert_eq!(ids(&frame.layers, "id", x, y)[1], u32::from(!solid));
        }
    }
    let frame = render(&screen(false), &facing(), &size(64, 64));
    assert!(reds(&frame.layers).iter().all(|&value| value == 0.0), "without its mask the screen hides the lamp");
}

#[test]
fn light_falls_through_a_mask() {
    for masked in [true, false] {
        let mut scene = screen(masked);
        scene.materials[1] = matt(0.5);
        scene.lights.push(Light::Point { position: [0.0, 0.0, 2.0], intensity: [8.0; 3] });
        let camera = Camera { eye: [0.0, 0.0, -0.5], target: [0.0, 0.0, -1.0], ..facing() };
        let frame = render(&scene, &camera, &with_all_layers(60, 60));
        let mut lit = 0;
        for y in 0..60 {
            for x in 0..60 {
                let at = pixel(&frame.layers, "P", x, y);
                // Where the way from the lamp goes through the screen: two thirds of the way.
                let through = [at[0] * 2.0 / 3.0, at[1] * 2.0 / 3.0].map(|value| (value + 1.0) * 4.0);
                let near_edge = through.iter().any(|value| (value - value.round()).abs() < 0.02);
                let hole = masked && (through[0] as u32 + (8.0 - through[1]) as u32) % 2 == 1;
                let found = pixel(&frame.layers, "beauty", x, y)[0] > 0.0;
                assert!(near_edge || found == hole, "pixel {x}, {y}: lit {found}");
                lit += u32::from(found);
            }
        }
        assert_eq!(lit > 1000, masked, "{lit} pixels are lit");
    }
}

#[test]
fn masks_work_in_mirrors() {
    let mut scene = screen(true);
    scene.meshes.push(square(3.0));
    scene.materials.push(mirror());
    let last = scene.meshes.last_mut().unwrap();
    last.materials = vec![2; 2];
    // Between screen and mirror, looking at the mirror: the screen is seen from its front, left and right exchanged.
    let camera = Camera { eye: [0.0, 0.0, 1.0], target: [0.0, 0.0, 3.0], ..facing() };
    let frame = render(&scene, &camera, &size(64, 64));
    let reds = reds(&frame.layers).iter().filter(|&&value| value == 1.0).count();
    assert_eq!(reds, 64 * 64 / 2);
}

#[test]
fn a_mask_without_a_hole_is_none() {
    let mut scene = screen(true);
    scene.textures[0] = texture(8, false, |_, _| [200; 4]);
    let (gpu, _) = studio().load(&scene);
    assert!(!gpu.has_masks());
    scene.materials[0].opacity = 0.5;
    let (gpu, _) = studio().load(&scene);
    assert!(gpu.has_masks());
}

#[test]
fn textures_are_upright_repeated_and_linear() {
    let mut scene = scene(vec![(square(0.0), matt(1.0))]);
    scene.ambient = [1.0; 3];
    // Upper left red, upper right green, lower left blue, lower right a grey of code 128.
    let texels = [[[255, 0, 0, 255], [0, 255, 0, 255]], [[0, 0, 255, 255], [128, 128, 128, 255]]];
    scene.textures.push(texture(2, true, |x, y| texels[y as usize][x as usize]));
    scene.materials[0].diffuse_map = Some(0);
    let frame = render(&scene, &facing(), &size(128, 128));
    let at = |x: u32, y: u32| pixel(&frame.layers, "beauty", x, y);
    let grey = 0.215_860_5;
    // A pixel beside the middle of a texel: 1/128 of the other texels.
    for (x, y, expected) in [(31, 31, [1.0, 0.0, 0.0]), (95, 31, [0.0, 1.0, 0.0]), (31, 95, [0.0, 0.0, 1.0]), (95, 95, [grey; 3])] {
        let near = at(x, y).iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 0.02);
        assert!(near, "{x}, {y}: {:?}", at(x, y));
    }
    // In the middle, and by repetition at each corner, all four mix alike, in linear light.
    for (x, y) in [(63, 63), (0, 0), (127, 127), (0, 127)] {
        assert!((at(x, y)[0] - (1.0 + grey) / 4.0).abs() < 0.02, "{x}, {y}: {:?}", at(x, y));
    }
    scene.meshes[0].uvs.iter_mut().for_each(|uv| *uv = uv.map(|value| value * 3.0 - 7.0));
    let repeated = render(&scene, &facing(), &size(126, 126));
    let third = |x: u32, y: u32| pixel(&repeated.layers, "beauty", x, y);
    for (x, y) in [(10, 10), (5, 30), (41, 1)] {
        for channel in 0..3 {
            assert_close("repeated", third(x + 42, y + 84)[channel], third(x, y)[channel], 1e-3);
        }
    }
    scene.textures[0] = texture(1, false, |_, _| [128; 4]);
    let linear = render(&scene, &facing(), &size(4, 4));
    assert_close("a code of a linear texture", pixel(&linear.layers, "beauty", 1, 1)[0], 128.0 / 255.0, 1e-6);
}

#[test]
fn texture_coordinates_that_are_no_numbers_do_no_harm() {
    for value in [f32::NAN, f32::INFINITY, -1e30, 3e38] {
        let mut scene = scene(vec![(square(0.0), matt(1.0))]);
        scene.ambient = [1.0; 3];
        scene.textures.push(texture(4, true, |_, _| [255; 4]));
        scene.materials[0].diffuse_map = Some(0);
        scene.meshes[0].uvs = vec![[value; 2]; 4];
        let frame = render(&scene, &facing(), &size(8, 8));
        assert!(reds(&frame.layers).iter().all(|&red| red == 1.0), "{value}");
    }
}

#[test]
fn a_normal_map_turns_the_normal() {
    let mut scene = scene(vec![(square(0.0), matt(1.0))]);
    scene.lights.push(sun([0.0, 0.0, -1.0], PI));
    // Towards u by 45 degrees: (218, 128, 218) is about (0.71, 0, 0.71).
    scene.textures.push(texture(1, false, |_, _| [218, 128, 218, 255]));
    scene.materials[0].normal_map = Some(0);
    let frame = render(&scene, &facing(), &with_all_layers(8, 8));
    let normal = pixel(&frame.layers, "N", 4, 4);
    assert!((normal[0] - 0.707).abs() < 0.01 && normal[1].abs() < 0.01 && (normal[2] - 0.707).abs() < 0.01, "{normal:?}");
    assert_close("cosine", pixel(&frame.layers, "beauty", 4, 4)[0], normal[2], 1e-3);
    assert_eq!(pixel(&frame.layers, "Ng", 4, 4), [0.0, 0.0, 1.0]);
    // Heights that rise along v tilt the normal against v.
    scene.textures[0] = texture(16, false, |_, y| [(240 - 16 * y.min(15)) as u8; 4]);
    scene.materials[0].normal_map_is_height = true;
    let frame = render(&scene, &facing(), &with_all_layers(8, 8));
    let normal = pixel(&frame.layers, "N", 4, 4);
    assert!(normal[1] < -0.1 && normal[0].abs() < 1e-3, "{normal:?}");
}
