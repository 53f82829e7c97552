//! Mirrors against the law of reflection.

use gridwalk_scene::{Camera, generate};

use super::*;

/// A mirror, and a background whose value is the height of a direction.
fn tilted_mirror(tilt: f32) -> Scene {
    let (sine, cosine) = tilt.sin_cos();
    let corner = |x: f32, y: f32| [x, y * cosine, y * sine];
    let quad = generate::quad([corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)]);
    let mut scene = scene(vec![(quad, mirror())]);
    scene.background = Background::Gradient { bottom: [0.0; 3], top: [1.0; 3] };
    scene
}

#[test]
fn a_mirror_shows_what_the_law_says() {
    let camera =
        Camera { eye: [0.3, 0.2, 4.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], vertical_fov_degrees: 30.0, orthographic_height: None };
    for tilt in [0.0_f32, 0.4, -0.7] {
        let frame = render(&tilted_mirror(tilt), &camera, &with_all_layers(40, 30));
        let mut seen = 0;
        for y in 0..30 {
            for x in 0..40 {
                if ids(&frame.layers, "id", x, y)[1] != 0 {
                    continue;
                }
                seen += 1;
                let at = pixel(&frame.layers, "P", x, y);
                let way: Vec<f64> = (0..3).map(|i| f64::from(at[i]) - f64::from(camera.eye[i])).collect();
                let length = way.iter().map(|value| value * value).sum::<f64>().sqrt();
                let normal = [0.0, -f64::from(tilt).sin(), f64::from(tilt).cos()];
                let along: f64 = (0..3).map(|i| way[i] / length * normal[i]).sum();
                let height = way[1] / length - 2.0 * along * normal[1];
                let found = pixel(&frame.layers, "beauty", x, y)[0];
                assert_close("mirrored background", found, ((height + 1.0) * 0.5) as f32, 1e-4);
            }
        }
        assert!(seen > 600, "{seen}");
        assert_eq!(frame.stats.rays.reflection, seen);
    }
}

#[test]
fn what_a_mirror_reflects_is_weighted_by_its_colour() {
    let mut scene = tilted_mirror(0.0);
    scene.materials[0].specular = [0.5, 0.25, 0.0];
    scene.background = colour(1.0);
    let camera = Camera { eye: [0.0, 0.0, 4.0], up: [0.0, 1.0, 0.0], orthographic_height: Some(1.0), ..from_above(1.0) };
    let frame = render(&scene, &camera, &size(4, 4));
    assert_eq!(pixel(&frame.layers, "beauty", 1, 2), [0.5, 0.25, 0.0, 1.0]);
    scene.materials[0].illumination = 2;
    let frame = render(&scene, &camera, &size(4, 4));
    assert_eq!(pixel(&frame.layers, "beauty", 1, 2), [0.0, 0.0, 0.0, 1.0], "illum 2 does not reflect");
    assert_eq!(frame.stats.rays.reflection, 0);
}

/// Between two mirrors that face each other, each of which also glows: every reflection adds one glow.
#[test]
fn reflections_end_at_the_depth() {
    let wall = |z: f32| generate::quad([[-50.0, -50.0, z], [50.0, -50.0, z], [50.0, 50.0, z], [-50.0, 50.0, z]]);
    let mut both = mirror();
    both.emission = [1.0; 3];
    both.specular = [0.5; 3];
    let scene = scene(vec![(wall(-1.0), both.clone()), (wall(1.0), both)]);
    let camera =
        Camera { eye: [0.0; 3], target: [0.1, 0.0, -1.0], up: [0.0, 1.0, 0.0], vertical_fov_degrees: 20.0, orthographic_height: None };
    let mut before = 0.0;
    for depth in 0..6 {
        let frame = render(&scene, &camera, &RenderSettings { depth, ..size(5, 5) });
        let expected: f32 = (0..=depth).map(|bounce| 0.5_f32.powi(bounce as i32)).sum();
        let found = pixel(&frame.layers, "beauty", 2, 2)[0];
        assert_eq!(found, expected, "depth {depth}");
        assert!(found > before);
        assert_eq!(frame.stats.rays.reflection, 25 * u64::from(depth));
        before = found;
    }
}

#[test]
fn a_mirror_does_not_see_itself() {
    for scale in [1e-3_f32, 1.0, 1e3, 1e6] {
        let mut scene = scene(vec![(generate::sphere([0.0; 3], scale, 64), mirror())]);
        scene.background = colour(1.0);
        let camera =
            Camera { eye: [0.0, 0.0, 5.0 * scale], up: [0.0, 1.0, 0.0], orthographic_height: Some(2.2 * scale), ..from_above(1.0) };
        let frame = render(&scene, &camera, &size(120, 120));
        let dark = reds(&frame.layers).iter().filter(|&&value| value < 0.999).count();
        assert_eq!(dark, 0, "scale {scale}: a convex mirror reflects nothing but the background");
    }
}
