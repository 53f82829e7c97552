//! `gridwalk diff`.

use std::fmt::Write;

use gridwalk_render::image::{Difference, LayerDifference, ReadLimits, diff, read};
use serde::Serialize;

use crate::args::low::{Diff, Metric};
use crate::exit::{Exit, Failure, Result};
use crate::report::Header;
use crate::{output, suggest};

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    header: Header,
    metric: &'static str,
    threshold: f64,
    equal: bool,
    layers: Vec<Entry<'a>>,
    unmatched: &'a [String],
}

/// JSON knows no infinity: a difference to a value that is no number is `null`.
#[derive(Serialize)]
struct Entry<'a> {
    name: &'a str,
    mean_square: Option<f64>,
    maximum: Option<f64>,
    ssim: Option<f64>,
    pixels: u64,
    at: Option<(u32, u32)>,
}

/// Compares two pictures; the status tells whether they are equal within the threshold.
pub fn run(low: &Diff) -> Result<Exit> {
    let limits = ReadLimits { bytes: low.max_size << 20 };
    let open = |path: &std::path::Path| {
        read(path, limits).map_err(|error| {
            let hint = if path.exists() { String::new() } else { suggest::file_hint(path) };
            Failure::input(format!("{error}{hint}"))
        })
    };
    let mut difference = diff(&open(&low.a)?, &open(&low.b)?)?;
    select(&mut difference, &low.layer)?;

    let beyond = |layer: &LayerDifference| match low.metric {
        Metric::Mse => layer.mean_square > low.threshold,
        Metric::Max => layer.maximum > low.threshold,
        // Integers have no structure: they are equal or not.
        Metric::Ssim => layer.ssim.map_or(layer.maximum > 0.0, |ssim| 1.0 - ssim > low.threshold),
    };
    let equal = difference.unmatched.is_empty() && !difference.layers.iter().any(beyond);
    if low.json {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let entry = |layer: &'_ LayerDifference| (finite(layer.mean_square), finite(layer.maximum));
        let layers = difference
            .layers
            .iter()
            .map(|layer| {
                let (mean_square, maximum) = entry(layer);
                Entry { name: &layer.name, mean_square, maximum, ssim: layer.ssim, pixels: layer.pixels, at: layer.at }
            })
            .collect();
        let metric = match low.metric {
            Metric::Mse => "mse",
            Metric::Max => "max",
            Metric::Ssim => "ssim",
        };
        let header = Header::new("diff");
        let unmatched = &difference.unmatched;
        output::print_json(&Report { header, metric, threshold: low.threshold, equal, layers, unmatched })?;
    } else {
        output::print(&table(&difference))?;
    }
    Ok(if equal { Exit::Ok } else { Exit::Difference })
}

/// Keeps the layers that were asked for.
fn select(difference: &mut Difference, wanted: &[String]) -> Result<()> {
    if wanted.is_empty() {
        return Ok(());
    }
    let all: Vec<String> = difference.layers.iter().map(|layer| layer.name.clone()).chain(difference.unmatched.iter().cloned()).collect();
    for name in wanted {
        if !all.contains(name) {
            let hint = suggest::hint(name, all.iter().map(String::as_str));
            return Err(Failure::input(format!("neither picture has a layer \"{name}\"; {hint}")));
        }
    }
    difference.layers.retain(|layer| wanted.contains(&layer.name));
    difference.unmatched.retain(|name| wanted.contains(name));
    Ok(())
}

fn table(difference: &Difference) -> String {
    let width = difference.layers.iter().map(|layer| layer.name.len()).max().unwrap_or(0).max(5);
    // Writing to a string cannot fail.
    let mut text = String::new();
    let _ = writeln!(text, "{:width$}  {:>12}  {:>12}  {:>9}  {:>10}  worst at", "layer", "mean square", "maximum", "SSIM", "pixels");
    for layer in &difference.layers {
        let ssim = layer.ssim.map_or_else(|| "-".to_owned(), |ssim| format!("{ssim:.6}"));
        let at = layer.at.map_or_else(|| "-".to_owned(), |(x, y)| format!("{x},{y}"));
        let _ = writeln!(
            text,
            "{:width$}  {:>12.6e}  {:>12.6e}  {ssim:>9}  {:>10}  {at}",
            layer.name, layer.mean_square, layer.maximum, layer.pixels
        );
    }
    for name in &difference.unmatched {
        let _ = writeln!(text, "{name:width$}  in one picture only, or with other channels");
    }
    text
}
