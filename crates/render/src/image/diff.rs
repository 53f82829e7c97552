//! How far two pictures are apart.

use super::tonemap::LUMINANCE;
use super::{Error, Result};
use crate::{Layer, LayerData, Layers};

/// How far one layer of two pictures is apart.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerDifference {
    /// Name of the layer.
    pub name: String,
    /// Mean of the squared differences over all channels. Infinite when a value is finite, or a number, in one picture only.
    pub mean_square: f64,
    /// Largest difference of a channel's value, by the same rule.
    pub maximum: f64,
    /// Mean structural similarity of the luminance (Wang et al. 2004: Gaussian window of 11 x 11, sigma 1.5): 1 for equal pictures, and for
    /// layers of integers absent. A picture smaller than the window has one window.
    pub ssim: Option<f64>,
    /// Number of pixels in which at least one channel differs.
    pub pixels: u64,
    /// Where the largest difference is: column and row.
    pub at: Option<(u32, u32)>,
}

/// How far two pictures are apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Every layer that both have, with the same channels.
    pub layers: Vec<LayerDifference>,
    /// Layers that only one of the two has, or with other channels.
    pub unmatched: Vec<String>,
}

impl Difference {
    /// The largest mean square of a layer.
    pub fn mean_square(&self) -> f64 {
        self.layers.iter().map(|layer| layer.mean_square).fold(0.0, f64::max)
    }

    /// The largest difference of a value.
    pub fn maximum(&self) -> f64 {
        self.layers.iter().map(|layer| layer.maximum).fold(0.0, f64::max)
    }

    /// The smallest similarity of a layer; 1 when no layer has one.
    pub fn ssim(&self) -> f64 {
        self.layers.iter().filter_map(|layer| layer.ssim).fold(1.0, f64::min)
    }
}

/// Compares two pictures layer by layer. Two not-a-numbers count as equal, and so do two infinities of one sign.
///
/// # Errors
/// [`Error::SizeMismatch`]; [`Error::NoCommonLayer`] when there is nothing to compare.
pub fn diff(a: &Layers, b: &Layers) -> Result<Difference> {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return Err(Error::SizeMismatch { a: (a.width(), a.height()), b: (b.width(), b.height()) });
    }
    let mut difference = Difference { layers: Vec::new(), unmatched: Vec::new() };
    for layer in a.iter() {
        match b.get(&layer.name) {
            Some(other) if layer.channels == other.channels => match (&layer.data, &other.data) {
                (LayerData::Float(x), LayerData::Float(y)) => {
                    let mut entry = compare(layer, x, y, a.width(), float_distance);
                    entry.ssim = Some(ssim(&gray(layer, x), &gray(layer, y), a.width() as usize, a.height() as usize));
                    difference.layers.push(entry);
                }
                (LayerData::Uint(x), LayerData::Uint(y)) => {
                    difference.layers.push(compare(layer, x, y, a.width(), |x, y| f64::from(x.abs_diff(y))));
                }
                _ => difference.unmatched.push(layer.name.clone()),
            },
            _ => difference.unmatched.push(layer.name.clone()),
        }
    }
    for layer in b.iter() {
        if a.get(&layer.name).is_none() {
            difference.unmatched.push(layer.name.clone());
        }
    }
    if difference.layers.is_empty() {
        let names = |layers: &Layers| {
            layers.iter().map(|layer| format!("{} ({})", layer.name, layer.channels.join(" "))).collect::<Vec<_>>().join(", ")
        };
        return Err(Error::NoCommonLayer { a: names(a), b: names(b) });
    }
    Ok(difference)
}

fn float_distance(x: f32, y: f32) -> f64 {
    if x == y || (x.is_nan() && y.is_nan()) {
        0.0
    } else if x.is_finite() && y.is_finite() {
        (f64::from(x) - f64::from(y)).abs()
    } else {
        f64::INFINITY
    }
}

fn compare<T: Copy>(layer: &Layer, x: &[T], y: &[T], width: u32, distance: impl Fn(T, T) -> f64) -> LayerDifference {
    let channels = layer.channels.len();
    let mut entry = LayerDifference { name: layer.name.clone(), mean_square: 0.0, maximum: 0.0, ssim: None, pixels: 0, at: None };
    let mut sum = 0.0;
    for (index, (x, y)) in x.chunks_exact(channels).zip(y.chunks_exact(channels)).enumerate() {
        let mut differs = false;
        for (x, y) in x.iter().zip(y) {
            let distance = distance(*x, *y);
            sum += distance * distance;
            differs |= distance > 0.0;
            if distance > entry.maximum {
                entry.maximum = distance;
                entry.at = Some(((index % width as usize) as u32, (index / width as usize) as u32));
            }
        }
        entry.pixels += u64::from(differs);
    }
    if !x.is_empty() {
        entry.mean_square = sum / x.len() as f64;
    }
    entry
}

/// One value a pixel: luminance where there are colours, the mean of the channels elsewhere. Values that are not finite become 0.
fn gray(layer: &Layer, values: &[f32]) -> Vec<f64> {
    let color: Option<Vec<usize>> = ["R", "G", "B"].iter().map(|name| layer.channels.iter().position(|channel| channel == name)).collect();
    values
        .chunks_exact(layer.channels.len())
        .map(|pixel| {
            let value = match &color {
                Some(indices) => indices.iter().zip(LUMINANCE).map(|(index, weight)| f64::from(pixel[*index]) * f64::from(weight)).sum(),
                None => pixel.iter().map(|value| f64::from(*value)).sum::<f64>() / pixel.len() as f64,
            };
            if value.is_finite() { value } else { 0.0 }
        })
        .collect()
}

/// Mean structural similarity over all places where the window fits. The range of values is that of both pictures together, at least 1.
fn ssim(x: &[f64], y: &[f64], width: usize, height: usize) -> f64 {
    if x.is_empty() {
        return 1.0;
    }
    let (least, largest) = x.iter().chain(y).fold((0.0_f64, 1.0_f64), |(least, largest), value| (least.min(*value), largest.max(*value)));
    let range = largest - least;
    let (c1, c2) = ((0.01 * range).powi(2), (0.03 * range).powi(2));

    let horizontal = window(width);
    let vertical = window(height);
    let blurred = |value: &dyn Fn(usize) -> f64| blur(value, width, height, &horizontal, &vertical);
    let mean_x = blurred(&|i| x[i]);
    let mean_y = blurred(&|i| y[i]);
    let square_x = blurred(&|i| x[i] * x[i]);
    let square_y = blurred(&|i| y[i] * y[i]);
    let product = blurred(&|i| x[i] * y[i]);

    let mut sum = 0.0;
    for i in 0..mean_x.len() {
        let (mx, my) = (mean_x[i], mean_y[i]);
        let (vx, vy, cov) = (square_x[i] - mx * mx, square_y[i] - my * my, product[i] - mx * my);
        sum += (2.0 * mx * my + c1) * (2.0 * cov + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2));
    }
    sum / mean_x.len() as f64
}

/// Gaussian weights, sigma 1.5, that add up to 1.
fn window(extent: usize) -> Vec<f64> {
    let size = extent.min(11);
    let middle = (size as f64 - 1.0) / 2.0;
    let weights: Vec<f64> = (0..size).map(|i| (-(i as f64 - middle).powi(2) / (2.0 * 1.5 * 1.5)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// Separable filter, at the places where the whole window lies in the picture.
fn blur(value: &dyn Fn(usize) -> f64, width: usize, height: usize, horizontal: &[f64], vertical: &[f64]) -> Vec<f64> {
    let columns = width + 1 - horizontal.len();
    let rows = height + 1 - vertical.len();
    let mut across = Vec::with_capacity(columns * height);
    for row in 0..height {
        for column in 0..columns {
            across.push(horizontal.iter().enumerate().map(|(i, weight)| weight * value(row * width + column + i)).sum::<f64>());
        }
    }
    let mut out = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            out.push(vertical.iter().enumerate().map(|(i, weight)| weight * across[(row + i) * columns + column]).sum());
        }
    }
    out
}
