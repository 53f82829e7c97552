//! Where the rays of a picture begin.

use crate::{Crop, Error, RenderSettings, Result, layout::CameraFrame};
use gridwalk_scene::Camera;

/// Where in the pixel a sample goes through: a Hammersley set, so that every row, every column and every power-of-two block of strata
/// holds its share of the samples. A single sample goes through the middle.
pub(crate) fn sample_offset(sample: u32, count: u32) -> [f32; 2] {
    let half = 0.5 / count as f32;
    let reversed = sample.reverse_bits() as f32 / 4_294_967_296.0;
    let below_one = 1.0 - f32::EPSILON;
    [(sample as f32 / count as f32 + half).min(below_one), (reversed + half).min(below_one)]
}

pub(crate) fn camera_frame(camera: &Camera, settings: &RenderSettings, crop: Crop) -> Result<CameraFrame> {
    let bad = |value: String, expected| Error::Setting { setting: "camera", value, expected };
    let wide = |v: [f32; 3]| v.map(f64::from);
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let unit = |v: [f64; 3]| {
        let largest = v.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let v = v.map(|value| value / largest);
        let length = v.iter().map(|value| value * value).sum::<f64>().sqrt();
        (length.is_finite() && length > 0.0).then(|| v.map(|value| value / length))
    };
    let direction = sub(wide(camera.target), wide(camera.eye));
    let Some(forward) = unit(direction) else {
        return Err(bad(format!("eye {:?}, target {:?}", camera.eye, camera.target), "an eye and a target that differ, of finite numbers"));
    };
    // Looking straight up or down leaves the roll open: any will do.
    let sideways = |up: [f64; 3]| {
        unit(up).and_then(|up| {
            unit(cross(forward, up)).filter(|_| {
                let along: f64 = (0..3).map(|i| forward[i] * up[i]).sum();
                along.abs() < 1.0 - 1e-12
            })
        })
    };
    let Some(right) = sideways(wide(camera.up)).or_else(|| sideways([0.0, 0.0, 1.0])).or_else(|| sideways([0.0, 1.0, 0.0])) else {
        return Err(bad(format!("up {:?}", camera.up), "finite numbers"));
    };
    let up = cross(right, forward);
    let half_height = match camera.orthographic_height {
        Some(height) if height > 0.0 && height.is_finite() => f64::from(height) * 0.5,
        Some(height) => return Err(bad(format!("orthographic height {height}"), "a number above 0")),
        None if camera.vertical_fov_degrees > 0.0 && camera.vertical_fov_degrees < 180.0 => {
            (f64::from(camera.vertical_fov_degrees).to_radians() * 0.5).tan()
        }
        None => return Err(bad(format!("field of view {}", camera.vertical_fov_degrees), "degrees above 0 and below 180")),
    };
    let half_width = half_height * f64::from(settings.width) / f64::from(settings.height);
    let narrow = |v: [f64; 3], factor: f64| v.map(|value| (value * factor) as f32);
    Ok(CameraFrame {
        eye: camera.eye,
        is_orthographic: u32::from(camera.orthographic_height.is_some()),
        forward: narrow(forward, 1.0),
        right: narrow(right, half_width),
        up: narrow(up, half_height),
        size: [settings.width, settings.height],
        crop_origin: [crop.x, crop.y],
        crop_size: [crop.width, crop.height],
        ..CameraFrame::default()
    })
}

#[cfg(test)]
mod tests {
    use super::sample_offset;

    #[test]
    fn samples_are_stratified() {
        assert_eq!(sample_offset(0, 1), [0.5, 0.5]);
        for count in [2_u32, 4, 8, 16, 64] {
            let samples: Vec<[f32; 2]> = (0..count).map(|sample| sample_offset(sample, count)).collect();
            for axis in 0..2 {
                let mut strata: Vec<u32> = samples.iter().map(|sample| (sample[axis] * count as f32) as u32).collect();
                strata.sort_unstable();
                assert!(strata.into_iter().eq(0..count), "{count} samples along axis {axis}");
            }
        }
        for count in 1..300 {
            for sample in 0..count {
                assert!(sample_offset(sample, count).iter().all(|value| (0.0..1.0).contains(value)), "{sample} of {count}");
            }
        }
    }
}
