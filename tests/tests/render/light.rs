//! Light and shadow against what can be reckoned by hand.

use std::f32::consts::PI;

use gridwalk_scene::{Camera, Light, Material, Mesh, generate};

use super::*;

fn floor(size: f32) -> Mesh {
    generate::plane([size, size], 1)
}

fn scaled(mut mesh: Mesh, scale: f32, offset: [f32; 3]) -> Mesh {
    for position in &mut mesh.positions {
        *position = std::array::from_fn(|axis| position[axis] * scale + offset[axis]);
    }
    mesh
}

#[test]
fn a_point_light_obeys_the_square_law_and_the_cosine() {
    let mut scene = scene(vec![(floor(4.0), matt(0.6))]);
    scene.lights.push(Light::Point { position: [0.5, 1.5, -0.25], intensity: [3.0; 3] });
    let frame = render(&scene, &from_above(3.0), &with_all_layers(30, 30));
    for (x, y) in [(0, 0), (15, 15), (29, 3), (7, 22)] {
        let at = pixel(&frame.layers, "P", x, y);
        let way = [0.5 - at[0], 1.5, -0.25 - at[2]];
        let square: f32 = way.iter().map(|value| value * value).sum();
        let expected = 0.6 / PI * 3.0 / square * (1.5 / square.sqrt());
        assert_close("radiance", pixel(&frame.layers, "beauty", x, y)[0], expected, 1e-4);
    }
    assert_eq!(frame.stats.rays.shadow, 900);
}

#[test]
fn highlights_are_those_of_blinn_and_phong() {
    let material = Material { diffuse: [0.2; 3], specular: [0.5; 3], shininess: 20.0, ..Material::default() };
    let mut scene = scene(vec![(floor(4.0), material)]);
    scene.lights.push(sun([-0.5, -1.0, 0.2], 2.0));
    let frame = render(&scene, &from_above(3.0), &size(9, 9));
    let light = [0.5_f32, 1.0, -0.2].map(|value| value / 1.29_f32.sqrt());
    let halfway = [light[0], light[1] + 1.0, light[2]];
    let length = halfway.iter().map(|value| value * value).sum::<f32>().sqrt();
    let expected = (0.2 + 0.5 * (halfway[1] / length).powf(20.0)) / PI * 2.0 * light[1];
    assert_close("radiance", pixel(&frame.layers, "beauty", 4, 4)[0], expected, 1e-3);
}

#[test]
fn a_spot_is_dark_beyond_its_cone_and_full_inside() {
    let mut scene = scene(vec![(floor(8.0), matt(0.5))]);
    let (inner_degrees, outer_degrees) = (20.0, 30.0);
    scene.lights.push(Light::Spot {
        position: [0.0, 2.0, 0.0],
        direction: [0.0, -1.0, 0.0],
        intensity: [4.0; 3],
        inner_degrees,
        outer_degrees,
    });
    let frame = render(&scene, &from_above(4.0), &with_all_layers(101, 101));
    for x in 0..101 {
        let at = pixel(&frame.layers, "P", x, 50);
        let angle = (at[0].hypot(at[2]) / 2.0).atan();
        let square = at[0] * at[0] + at[2] * at[2] + 4.0;
        let edge = |degrees: f32| degrees.to_radians().cos();
        let inside = ((angle.cos() - edge(outer_degrees)) / (edge(inner_degrees) - edge(outer_degrees))).clamp(0.0, 1.0);
        let expected = 0.5 / PI * 4.0 / square * angle.cos() * inside * inside * (3.0 - 2.0 * inside);
        let found = pixel(&frame.layers, "beauty", x, 50)[0];
        assert!((found - expected).abs() < 1e-4, "pixel {x}: {found}, expected {expected}");
        assert!(angle.to_degrees() < 30.1 || found == 0.0);
    }
}

#[test]
fn emission_ambient_light_and_background_need_no_ray() {
    let mut scene = scene(vec![(floor(2.0), Material { diffuse: [0.5; 3], emission: [0.25, 0.0, 0.0], ..Material::default() })]);
    scene.ambient = [0.2, 0.4, 0.6];
    scene.background = Background::Colour([0.1, 0.2, 0.3]);
    let frame = render(&scene, &from_above(4.0), &size(8, 8));
    assert_eq!(pixel(&frame.layers, "beauty", 4, 4), [0.25 + 0.1, 0.2, 0.3, 1.0]);
    assert_eq!(pixel(&frame.layers, "beauty", 0, 0), [0.1, 0.2, 0.3, 1.0]);
    assert_eq!(frame.stats.rays.total(), 64);
    let settings = RenderSettings { transparent: true, spp: 4, ..size(8, 8) };
    let frame = render(&scene, &from_above(4.0), &settings);
    assert_eq!(pixel(&frame.layers, "beauty", 4, 4)[3], 1.0);
    assert_eq!(pixel(&frame.layers, "beauty", 0, 0), [0.0; 4]);
}

#[test]
fn both_sides_are_lit_alike_and_none_shines_through() {
    let mut scene = scene(vec![(floor(4.0), matt(0.5))]);
    scene.lights.push(sun([0.0, -1.0, 0.0], 1.0));
    let below = Camera { eye: [0.0, -5.0, 0.0], ..from_above(2.0) };
    let frame = render(&scene, &from_above(2.0), &size(4, 4));
    assert_close("lit side", pixel(&frame.layers, "beauty", 1, 1)[0], 0.5 / PI, 1e-5);
    let frame = render(&scene, &below, &size(4, 4));
    assert_eq!(pixel(&frame.layers, "beauty", 1, 1)[0], 0.0, "seen from below, lit from above");
    scene.lights = vec![sun([0.0, 1.0, 0.0], 1.0)];
    let frame = render(&scene, &below, &size(4, 4));
    assert_close("lit and seen from below", pixel(&frame.layers, "beauty", 1, 1)[0], 0.5 / PI, 1e-5);
}

/// A screen above the floor up to x = 0.5, a lamp above it: the shadow ends where the line over the screen's edge meets the floor.
#[test]
fn a_shadow_ends_where_it_must() {
    let screen = generate::quad([[-3.0, 1.0, 3.0], [0.5, 1.0, 3.0], [0.5, 1.0, -3.0], [-3.0, 1.0, -3.0]]);
    let mut scene = scene(vec![(floor(6.0), matt(0.5)), (screen, matt(0.5))]);
    scene.lights.push(Light::Point { position: [-0.5, 3.0, 0.0], intensity: [5.0; 3] });
    let edge = -0.5 + (0.5 + 0.5) * 3.0 / 2.0;
    let width = 71;
    // From below the screen, so that it hides nothing.
    let camera = Camera { eye: [0.0, 0.9, 0.0], ..from_above(4.0) };
    let frame = render(&scene, &camera, &RenderSettings { width, height: 51, ..RenderSettings::default() });
    let scale = 4.0 / 51.0;
    for y in [0, 20, 50] {
        let row: Vec<f32> = (0..width).map(|x| pixel(&frame.layers, "beauty", x, y)[0]).collect();
        let first_lit = row.iter().position(|&value| value > 0.0).unwrap();
        let found = (first_lit as f32 - width as f32 / 2.0) * scale;
        assert!((found - edge).abs() <= scale, "row {y}: shadow ends at {found}, expected {edge}");
        assert!(row[..first_lit].iter().all(|&value| value == 0.0) && row[first_lit..].iter().all(|&value| value > 0.0), "row {y}");
    }
}

/// What lies behind the lamp casts no shadow.
#[test]
fn light_ends_at_the_lamp() {
    let roof = scaled(floor(6.0), 1.0, [0.0, 2.0, 0.0]);
    let mut scene = scene(vec![(floor(6.0), matt(0.5)), (roof, matt(0.5))]);
    scene.lights.push(Light::Point { position: [0.0, 1.9999, 0.0], intensity: [1.0; 3] });
    let camera = Camera { eye: [0.0, 1.0, 0.0], ..from_above(2.0) };
    let frame = render(&scene, &camera, &size(16, 16));
    assert!(reds(&frame.layers).iter().all(|&value| value > 0.0));
}

/// Pixels of a lit plane that shadow themselves, at a scale, a place and a height of the light.
fn acne_of_plane(scale: f32, offset: [f32; 3], degrees: f32) -> usize {
    let mut mesh = generate::plane([4.0, 4.0], 7);
    // Tilted, so that no coordinate is constant.
    for position in &mut mesh.positions {
        position[1] = 0.3 * position[0] - 0.17 * position[2];
    }
    for normal in &mut mesh.normals {
        let length = (1.0_f32 + 0.09 + 0.0289).sqrt();
        *normal = [-0.3 / length, 1.0 / length, 0.17 / length];
    }
    let mut scene = scene(vec![(scaled(mesh, scale, offset), matt(0.5))]);
    let (sine, cosine) = degrees.to_radians().sin_cos();
    // Along x the plane rises: the light's height above it is measured in the plane's own frame.
    let along = [1.0_f32, 0.3, 0.0].map(|value| value / 1.09_f32.sqrt());
    let normal = [-0.3_f32, 1.0, 0.17].map(|value| value / (1.0_f32 + 0.09 + 0.0289).sqrt());
    scene.lights.push(sun(std::array::from_fn(|axis| -cosine * along[axis] - sine * normal[axis]), 1.0));
    let eye = [offset[0], offset[1] + 5.0 * scale, offset[2]];
    let camera = Camera { eye, target: offset, orthographic_height: Some(2.0 * scale), ..from_above(1.0) };
    let frame = render(&scene, &camera, &size(100, 100));
    reds(&frame.layers).iter().filter(|&&value| value <= 0.0).count()
}

#[test]
fn a_plane_casts_no_shadow_on_itself() {
    for scale in [1e-3, 1.0, 1e3, 1e6] {
        for degrees in [90.0, 30.0, 2.0] {
            assert_eq!(acne_of_plane(scale, [0.0; 3], degrees), 0, "scale {scale}, light {degrees} degrees above the plane");
        }
    }
    for degrees in [90.0, 30.0] {
        assert_eq!(acne_of_plane(100.0, [148_376.0, 1234.0, -223_423.0], degrees), 0, "far away, light at {degrees} degrees");
    }
}

#[test]
fn a_sphere_casts_no_shadow_on_its_lit_side() {
    for scale in [1e-3_f32, 1.0, 1e3, 1e6] {
        let mut scene = scene(vec![(generate::sphere([0.0; 3], scale, 64), matt(0.5))]);
        scene.lights.push(sun([-1.0, -0.4, -0.3], 1.0));
        let camera =
            Camera { eye: [0.0, 0.0, 5.0 * scale], up: [0.0, 1.0, 0.0], orthographic_height: Some(2.2 * scale), ..from_above(1.0) };
        let frame = render(&scene, &camera, &with_all_layers(120, 120));
        let normals = frame.layers.get("N").unwrap().floats().unwrap();
        let (mut lit, mut wrong) = (0, 0);
        for (normal, value) in normals.chunks_exact(3).zip(reds(&frame.layers)) {
            let cosine = (normal[0] + 0.4 * normal[1] + 0.3 * normal[2]) / 1.25_f32.sqrt();
            // Up to the last degree, although triangles face away from the light where the smooth normal still faces it.
            if cosine > 0.02 {
                lit += 1;
                wrong += usize::from(value <= 0.0);
            } else if cosine < -1e-5 {
                assert_eq!(value, 0.0);
            }
        }
        assert!(lit > 3000 && wrong == 0, "scale {scale}: {wrong} of {lit} pixels in their own shadow");
    }
}
