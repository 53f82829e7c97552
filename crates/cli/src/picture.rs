//! What `render` and `animate` have in common: how a picture is rendered, shown in eight bits, and described.

use gridwalk_render::gridwalk::Report;
use gridwalk_render::gridwalk_scene::{Camera, RenderDefaults};
use gridwalk_render::image::{Metadata, MetadataValue, PngOptions, Rgb8, Tonemap, heatmap, tonemapped};
use gridwalk_render::{DeviceInfo, Layers, RenderSettings};

use crate::args::high;
use crate::exit::Result;
use crate::report;

/// The command line before the scene before the library.
pub fn settings(picture: &high::Picture, defaults: &RenderDefaults) -> RenderSettings {
    let library = RenderSettings::default();
    let [width, height] = picture.size.or(defaults.size).unwrap_or([library.width, library.height]);
    RenderSettings {
        width,
        height,
        crop: picture.crop,
        spp: picture.spp.or(defaults.spp).unwrap_or(library.spp),
        depth: picture.depth.or(defaults.depth).unwrap_or(library.depth),
        aovs: picture.aovs.clone(),
        transparent: picture.transparent,
        batch: library.batch,
    }
}

/// How layers are shown in eight bits: as the beauty, or as a heat map.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    heatmap: Option<&'static str>,
    options: PngOptions,
}

impl Shown {
    /// The command line before the scene before the library.
    pub fn new(picture: &high::Picture, defaults: &RenderDefaults) -> Shown {
        let tonemap = picture.tonemap.or_else(|| defaults.tonemap.as_deref().and_then(Tonemap::from_name)).unwrap_or_default();
        let exposure = picture.exposure.or(defaults.exposure).unwrap_or(0.0);
        Shown { heatmap: picture.heatmap.map(|count| count.name()), options: PngOptions { exposure, tonemap, alpha: picture.transparent } }
    }

    /// The picture, and the numbers behind the colours of a heat map.
    pub fn of(&self, layers: &Layers) -> Result<(Rgb8, Option<report::Heatmap>)> {
        if let Some(count) = self.heatmap {
            let map = heatmap(layers, count)?;
            tracing::info!("{count}: {} to {}, {:.2} on average", map.min, map.max, map.mean);
            return Ok((map.picture, Some(report::Heatmap { count, min: map.min, max: map.max, mean: map.mean })));
        }
        let picture = tonemapped(layers, &self.options)?;
        if picture.not_finite > 0 {
            tracing::warn!("{} pixels hold no finite number; the EXR shows which", picture.not_finite);
        }
        Ok((picture, None))
    }
}

/// What all pictures of a run say of themselves. No times: the same input gives the same bytes.
pub fn metadata(source: &high::Source, device: &DeviceInfo, settings: &RenderSettings) -> Metadata {
    Metadata::new()
        .with("software", MetadataValue::Text(format!("gridwalk {}", env!("CARGO_PKG_VERSION"))))
        .with("scene", MetadataValue::Text(source.name()))
        .with("device", MetadataValue::Text(device.name.clone()))
        .with("driver", MetadataValue::Text(report::driver(device)))
        .with("spp", MetadataValue::Int(i32::try_from(settings.spp).unwrap_or(i32::MAX)))
        .with("depth", MetadataValue::Int(i32::try_from(settings.depth).unwrap_or(i32::MAX)))
}

/// What one of them says beside that: its grid and its camera.
pub fn metadata_of_one(common: Metadata, grid: &Report, camera: &Camera, settings: &RenderSettings) -> Metadata {
    let (to_camera, to_ndc) = matrices(camera, f64::from(settings.width) / f64::from(settings.height));
    common
        .with("density", MetadataValue::Float(grid.density))
        .with("resolution", MetadataValue::Text(grid.resolution.map(|n| n.to_string()).join(" x ")))
        .with("worldToCamera", MetadataValue::Matrix(to_camera))
        .with("worldToNDC", MetadataValue::Matrix(to_ndc))
}

/// World to camera (x right, y up, looking along -z), and on to the picture (-1 to 1, y up), for row vectors as OpenEXR has them.
fn matrices(camera: &Camera, aspect: f64) -> ([f32; 16], [f32; 16]) {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let unit = |a: [f64; 3]| a.map(|value| value / dot(a, a).sqrt());
    let eye = camera.eye.map(f64::from);
    let backwards: [f64; 3] = std::array::from_fn(|i| eye[i] - f64::from(camera.target[i]));
    let distance = dot(backwards, backwards).sqrt();
    let back = unit(backwards);
    let right = unit(cross(camera.up.map(f64::from), back));
    let up = cross(back, right);
    let view = [
        [right[0], up[0], back[0], 0.0],
        [right[1], up[1], back[1], 0.0],
        [right[2], up[2], back[2], 0.0],
        [-dot(right, eye), -dot(up, eye), -dot(back, eye), 1.0],
    ];
    // Depth from one thousandth of the target's distance to infinity; rays have no such bounds.
    let near = distance * 1e-3;
    let projection = match camera.orthographic_height {
        None => {
            let scale = 1.0 / (f64::from(camera.vertical_fov_degrees).to_radians() / 2.0).tan();
            [[scale / aspect, 0.0, 0.0, 0.0], [0.0, scale, 0.0, 0.0], [0.0, 0.0, -1.0, -1.0], [0.0, 0.0, -2.0 * near, 0.0]]
        }
        Some(height) => {
            let scale = 2.0 / f64::from(height);
            [[scale / aspect, 0.0, 0.0, 0.0], [0.0, scale, 0.0, 0.0], [0.0, 0.0, -1.0 / distance, 0.0], [0.0, 0.0, 0.0, 1.0]]
        }
    };
    let product: [[f64; 4]; 4] =
        std::array::from_fn(|row| std::array::from_fn(|column| (0..4).map(|k| view[row][k] * projection[k][column]).sum()));
    let flat = |matrix: [[f64; 4]; 4]| std::array::from_fn(|i| matrix[i / 4][i % 4] as f32);
    (flat(view), flat(product))
}

#[cfg(test)]
mod tests {
    use super::matrices;
    use gridwalk_render::gridwalk_scene::Camera;

    fn apply(matrix: [f32; 16], point: [f32; 3]) -> [f32; 3] {
        let row = [point[0], point[1], point[2], 1.0];
        let out: [f32; 4] = std::array::from_fn(|column| (0..4).map(|k| row[k] * matrix[k * 4 + column]).sum());
        [out[0] / out[3], out[1] / out[3], out[2] / out[3]]
    }

    #[test]
    fn points_end_where_they_are_seen() {
        let mut camera = Camera {
            eye: [1.0, 2.0, 7.0],
            target: [1.0, 2.0, 2.0],
            up: [0.0, 3.0, 0.0],
            vertical_fov_degrees: 90.0,
            orthographic_height: None,
        };
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        let (view, ndc) = matrices(&camera, 2.0);
        assert!(near(apply(view, [2.0, 2.5, 2.0]), [1.0, 0.5, -5.0]));
        let seen = apply(ndc, [11.0, 7.0, 2.0]);
        assert!((seen[0] - 1.0).abs() < 1e-5 && (seen[1] - 1.0).abs() < 1e-5, "the upper right corner: {seen:?}");
        camera.orthographic_height = Some(4.0);
        let seen = apply(matrices(&camera, 2.0).1, [5.0, 4.0, -100.0]);
        assert!((seen[0] - 1.0).abs() < 1e-5 && (seen[1] - 1.0).abs() < 1e-5, "{seen:?}");
    }
}
