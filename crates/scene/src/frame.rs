//! The automatic camera: no options needed for a picture that shows everything.

use crate::vector::{Vector, add, cross, dot, normalised, scale, sub};
use crate::{Bounds, Camera};

/// How to look at a box. The default is a view from the front, a little from the right and above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// Degrees around `up` away from the default view; positive moves the camera to the right.
    pub azimuth: f32,
    /// Degrees upwards away from the default view; the sum stays within 89 degrees of the horizon.
    pub elevation: f32,
    /// 2 shows everything twice as large as 1, which just fits.
    pub zoom: f32,
    /// Up; its length does not matter. Values that are no direction count as +Y.
    pub up: [f32; 3],
    /// Vertical angle of view.
    pub vertical_fov_degrees: f32,
    /// Width by height of the picture.
    pub aspect: f32,
}

impl Default for Framing {
    fn default() -> Self {
        Self { azimuth: 0.0, elevation: 0.0, zoom: 1.0, up: [0.0, 1.0, 0.0], vertical_fov_degrees: 35.0, aspect: 4.0 / 3.0 }
    }
}

const DEFAULT_AZIMUTH: f64 = 30.0;
const DEFAULT_ELEVATION: f64 = 20.0;
/// Share of the picture that stays free around the box.
const MARGIN: f64 = 1.06;

/// The horizontal directions towards the viewer and to the viewer's right. Front is +Z where Y is up, and -Y where Z is up, as modelling
/// programs have it.
pub(crate) fn front_and_side(up: [f32; 3]) -> (Vector, Vector) {
    let up = normalised(up.map(f64::from)).unwrap_or([0.0, 1.0, 0.0]);
    let axis = if up[2].abs() > 0.9 { [0.0, -up[2].signum(), 0.0] } else { [0.0, 0.0, 1.0] };
    let front = normalised(sub(axis, scale(up, dot(axis, up)))).unwrap_or([1.0, 0.0, 0.0]);
    (front, cross(up, front))
}

/// A camera from which the whole box is seen, as large as the picture allows, looking at the box's middle. Values of `framing` that make
/// no sense (not finite, zoom of zero) count as their defaults, so that there is always a camera.
pub fn frame_camera(bounds: &Bounds, framing: &Framing) -> Camera {
    let sane = |value: f32, default: f32, low: f64, high: f64| {
        f64::from(if value.is_finite() && value > 0.0 { value } else { default }).clamp(low, high)
    };
    let defaults = Framing::default();
    let angle = |value: f32| if value.is_finite() { f64::from(value) } else { 0.0 };
    let fov = sane(framing.vertical_fov_degrees, defaults.vertical_fov_degrees, 0.1, 170.0);
    let zoom = sane(framing.zoom, 1.0, 1e-6, 1e6);
    let aspect = sane(framing.aspect, defaults.aspect, 1e-3, 1e3);
    let up = normalised(framing.up.map(f64::from)).unwrap_or([0.0, 1.0, 0.0]);

    let (front, side) = front_and_side(framing.up);

    let azimuth = (DEFAULT_AZIMUTH + angle(framing.azimuth)).to_radians();
    let elevation = (DEFAULT_ELEVATION + angle(framing.elevation)).clamp(-89.0, 89.0).to_radians();
    let around = add(scale(front, azimuth.cos()), scale(side, azimuth.sin()));
    let backwards = add(scale(around, elevation.cos()), scale(up, elevation.sin()));
    let right = normalised(cross(up, backwards)).unwrap_or(side);
    let above = cross(backwards, right);

    let (min, max) = (bounds.min.map(f64::from), bounds.max.map(f64::from));
    let centre = scale(add(min, max), 0.5);
    let half = scale(sub(max, min), 0.5);
    let radius = dot(half, half).sqrt();
    // A box without extent still needs an eye that differs from the target after rounding to single precision.
    let least = centre.iter().fold(1e-18_f64, |least, value| least.max(value.abs() * 1e-4));

    let tan_y = (fov.to_radians() * 0.5).tan();
    let tan_x = tan_y * aspect;
    let mut distance = 0.0_f64;
    for corner in 0..8_u32 {
        let offset: [f64; 3] = std::array::from_fn(|axis| if corner >> axis & 1 == 1 { half[axis] } else { -half[axis] });
        let depth = dot(offset, backwards);
        let (x, y) = (dot(offset, right).abs() * MARGIN, dot(offset, above).abs() * MARGIN);
        distance = distance.max(depth + (x / tan_x).max(y / tan_y));
    }
    // Zooming in by moving would put the eye inside the box, so it narrows the angle; zooming out moves away.
    let (distance, fov) = if zoom >= 1.0 { (distance, 2.0 * (tan_y / zoom).atan().to_degrees()) } else { (distance / zoom, fov) };
    let distance = distance.max(radius * 1.01).max(least);
    let eye = add(centre, scale(backwards, distance));
    let limit = f64::from(f32::MAX);
    Camera {
        eye: eye.map(|value| value.clamp(-limit, limit) as f32),
        target: centre.map(|value| value as f32),
        up: up.map(|value| value as f32),
        vertical_fov_degrees: fov as f32,
        orthographic_height: None,
    }
}
