//! Counts as colours.

use super::font;
use super::png::Rgb8;
use super::tonemap::srgb_encode_u8;
use super::{Error, Result};
use crate::{Layer, LayerData, Layers};

/// A heat map, and the numbers its colours stand for.
#[derive(Clone, Debug, PartialEq)]
pub struct Heatmap {
    /// The picture, with the legend below it.
    pub picture: Rgb8,
    /// The smallest count of a pixel: the darkest colour.
    pub min: f64,
    /// The largest count of a pixel: the brightest colour.
    pub max: f64,
    /// The mean over all pixels.
    pub mean: f64,
}

/// Colours the channel `name` (`steps`, `tests` or `cells`) of the layer `debug`, from the smallest to the largest finite count. Below
/// the picture comes a legend with the ramp and both numbers.
///
/// # Errors
/// [`Error::Layer`] when the layer or the channel is not there.
pub fn heatmap(layers: &Layers, name: &str) -> Result<Heatmap> {
    let missing = |reason: String| Error::Layer { name: format!("debug.{name}"), reason };
    let (layer, channel) = find(layers, name).ok_or_else(|| missing("it was not rendered".to_owned()))?;
    let stride = layer.channels.len();
    let values: Vec<f64> = match &layer.data {
        LayerData::Float(values) => values.iter().skip(channel).step_by(stride).map(|value| f64::from(*value)).collect(),
        LayerData::Uint(values) => values.iter().skip(channel).step_by(stride).map(|value| f64::from(*value)).collect(),
    };
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let count = finite().count();
    if count == 0 {
        return Err(missing("it holds no number".to_owned()));
    }
    let (min, max) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| (min.min(value), max.max(value)));
    let mean = finite().sum::<f64>() / count as f64;

    let ramp = ramp();
    let color = |value: f64| {
        let position = if max > min { (value - min) / (max - min) } else { 0.0 };
        // Saturates; a value that is no number takes the darkest colour.
        ramp[((position * 255.0 + 0.5) as usize).min(255)]
    };
    let picture = with_legend(layers.width() as usize, layers.height() as usize, &values, color, &ramp, name, min, max);
    Ok(Heatmap { picture, min, max, mean })
}

/// The counts are channels of the layer `debug`, or layers of one channel with the prefix `debug`.
fn find<'a>(layers: &'a Layers, name: &str) -> Option<(&'a Layer, usize)> {
    let full = format!("debug.{name}");
    layers.iter().find_map(|layer| layer.channel_names().position(|channel| channel == full).map(|index| (layer, index)))
}

/// 256 colours from dark violet by red and orange to pale yellow. Their lightness rises by equal steps in Oklab (Ottosson 2020) while hue
/// turns, so that equal steps look equal, in grey and to colour-blind eyes too.
pub fn ramp() -> [[u8; 3]; 256] {
    let mut colors = [[0; 3]; 256];
    for (i, color) in colors.iter_mut().enumerate() {
        let position = i as f32 / 255.0;
        let lightness = 0.16 + 0.80 * position;
        let hue = (-75.0 + 180.0 * position).to_radians();
        let wanted = 0.05 + 0.15 * (std::f32::consts::PI * position).sin();
        *color = oklch_in_gamut(lightness, wanted, hue).map(srgb_encode_u8);
    }
    colors
}

/// The colour of this lightness and hue with the chroma wanted, or as much of it as sRGB can show.
fn oklch_in_gamut(lightness: f32, chroma: f32, hue: f32) -> [f32; 3] {
    let shown = |chroma: f32| oklab_to_linear([lightness, chroma * hue.cos(), chroma * hue.sin()]);
    let inside = |color: [f32; 3]| color.iter().all(|value| (0.0..=1.0).contains(value));
    if inside(shown(chroma)) {
        return shown(chroma);
    }
    let (mut low, mut high) = (0.0, chroma);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if inside(shown(middle)) { low = middle } else { high = middle }
    }
    shown(low)
}

fn oklab_to_linear([l, a, b]: [f32; 3]) -> [f32; 3] {
    let long = (l + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let medium = (l - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let short = (l - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * long - 3.307_711_6 * medium + 0.230_969_94 * short,
        -1.268_438 * long + 2.609_757_4 * medium - 0.341_319_38 * short,
        -0.004_196_086_3 * long - 0.703_418_6 * medium + 1.707_614_7 * short,
    ]
}

#[expect(clippy::too_many_arguments, reason = "one call, of values that have no other home")]
fn with_legend(
    width: usize,
    height: usize,
    values: &[f64],
    color: impl Fn(f64) -> [u8; 3],
    ramp: &[[u8; 3]; 256],
    name: &str,
    min: f64,
    max: f64,
) -> Rgb8 {
    let scale = (width / 400).max(1);
    let labels = [number(min), name.to_owned(), number(max)];
    let text_width = labels.iter().map(|label| font::width(label)).sum::<usize>() + 4 * font::ADVANCE;
    let full_width = width.max(text_width * scale);
    let margin = 2 * scale;
    let bar = 6 * scale;
    let legend = margin + bar + margin + font::HEIGHT * scale + margin;

    let mut data = vec![0; full_width * (height + legend) * 3];
    let mut set = |x: usize, y: usize, color: [u8; 3]| {
        let at = (y * full_width + x) * 3;
        if x < full_width
            && let Some(pixel) = data.get_mut(at..at + 3)
        {
            pixel.copy_from_slice(&color);
        }
    };
    for (i, value) in values.iter().enumerate() {
        set(i % width, i / width, color(*value));
    }
    for y in height + margin..height + margin + bar {
        for x in 0..full_width {
            set(x, y, ramp[x * 255 / (full_width - 1)]);
        }
    }
    let baseline = height + margin + bar + margin;
    let space = font::ADVANCE * scale / 2;
    let mut write = |label: &str, x: usize| {
        for (dx, dy) in font::pixels(label) {
            for sub in 0..scale * scale {
                set(x + dx * scale + sub % scale, baseline + dy * scale + sub / scale, [255; 3]);
            }
        }
    };
    write(&labels[0], space);
    write(&labels[1], (full_width - font::width(&labels[1]) * scale) / 2);
    write(&labels[2], full_width - font::width(&labels[2]) * scale - space);
    Rgb8 { width: full_width as u32, height: (height + legend) as u32, channels: 3, data, not_finite: 0 }
}

/// Counts without a fraction, means with two places.
fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { format!("{value:.0}") } else { format!("{value:.2}") }
}
