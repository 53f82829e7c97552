//! How times and memory grow with the number of triangles.

use clap::Parser as _;

use crate::arguments::{Arguments, Growth, Part};
use crate::report::{Report, SceneReport};
use crate::table::{columns, head};

/// Sizes a tenfold.
const STEPS_EACH_DECADE: f64 = 2.0;

impl Growth {
    /// The measurement of all sizes, evenly spaced on a logarithmic scale.
    pub fn sizes(&self) -> Arguments {
        let (least, most) = (f64::from(self.least), f64::from(self.most.max(self.least)));
        let steps = ((most / least).log10() * STEPS_EACH_DECADE).round();
        let size = |step: f64| if steps > 0.0 { least * (most / least).powf(step / steps) } else { least };
        let scenes = (0..=steps as u32).map(|step| format!("{}:{:.0}", self.shape, size(step.into()))).collect();
        let only = match self.only.is_empty() {
            true => vec![Part::Rebuild, Part::Camera, Part::Diffuse],
            false => self.only.clone(),
        };
        Arguments { scenes, common: self.common.clone(), runs: self.runs, only, ..Arguments::parse_from(["growth"]) }
    }
}

/// Exponent of the power law that fits best: the slope of the line of least squares through the logarithms.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logarithms: Vec<(f64, f64)> = points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logarithms.len() as f64;
    let mean = |part: fn(&(f64, f64)) -> f64| logarithms.iter().map(part).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let (mut both, mut square) = (0.0, 0.0);
    for point in &logarithms {
        both += (point.0 - x) * (point.1 - y);
        square += (point.0 - x).powi(2);
    }
    (logarithms.len() > 1 && square > 0.0).then(|| both / square)
}

/// A figure over the numbers of triangles.
pub struct Series {
    /// What it is, with its unit.
    pub name: String,
    /// Who, ours first, and number of triangles and value at each size.
    pub lines: Vec<(String, Vec<(f64, f64)>)>,
}

/// What grows: rebuilds and frames, rays of each kind (one of them, as there are more or fewer with the shape), memory while building.
pub fn series(report: &Report) -> Vec<Series> {
    let figures = report.scenes.first().map_or(Vec::new(), |scene| scene.figures().map(|(name, _)| name).collect());
    let mut all: Vec<Series> = figures.iter().map(|figure| times(report, figure)).collect();
    all.push(line_up(report, "memory while building, bytes".to_owned(), &|scene, rival| match rival {
        None => Some((scene.grid_bytes + scene.scratch_bytes) as f64),
        Some(rival) => Some(scene.rebuilt_bytes.iter().find(|bytes| bytes.rival == rival)?.bytes as f64),
    }));
    all
}

fn times(report: &Report, figure: &str) -> Series {
    let rays = |scene: &SceneReport| scene.rays.iter().find(|rays| rays.kind == figure).map(|rays| rays.rays as f64);
    let of_rays = report.scenes.iter().any(|scene| rays(scene).is_some());
    let name = if of_rays { format!("{figure} ray, ns") } else { format!("{figure}, ms") };
    line_up(report, name, &|scene, rival| {
        let (_, comparison) = scene.figures().find(|(name, _)| *name == figure)?;
        let ms = match rival {
            None => comparison.ours.median_ms,
            Some(rival) => comparison.against(rival)?.times.median_ms,
        };
        Some(rays(scene).map_or(ms, |rays| ms * 1e6 / rays))
    })
}

fn line_up(report: &Report, name: String, value: &dyn Fn(&SceneReport, Option<&str>) -> Option<f64>) -> Series {
    let line = |rival: Option<&str>| {
        let point = |scene: &SceneReport| Some((f64::from(scene.triangles), value(scene, rival)?));
        report.scenes.iter().filter_map(point).collect::<Vec<_>>()
    };
    let rivals = report.setup.rivals.iter().map(|rival| (rival.name.clone(), line(Some(&rival.name))));
    Series { name, lines: std::iter::once(("gridwalk".to_owned(), line(None))).chain(rivals).collect() }
}

/// A row for each figure: the exponents of ours and of the rivals'.
pub fn slopes(report: &Report) -> String {
    let mut first = head(&["grows as triangles to the power of", "ours"]);
    first.extend(report.setup.rivals.iter().map(|rival| rival.name.clone()));
    let mut rows = vec![first];
    rows.extend(series(report).into_iter().map(|series| {
        let exponents = series.lines.iter().map(|(_, points)| slope(points).map_or_else(|| "-".to_owned(), |slope| format!("{slope:.2}")));
        std::iter::once(series.name.clone()).chain(exponents).collect()
    }));
    format!("\n{}", columns(&rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::Mode;

    #[test]
    fn slopes_of_power_laws() {
        let law = |exponent: f64| [1e4, 1e5, 1e6].map(|x: f64| (x, 3.0 * x.powf(exponent)));
        for exponent in [-0.5, 0.0, 1.0, 1.33] {
            assert!((slope(&law(exponent)).unwrap() - exponent).abs() < 1e-9, "{exponent}");
        }
        assert_eq!(slope(&law(1.0)[..1]), None);
    }

    #[test]
    fn sizes_are_evenly_spaced() {
        let arguments = Arguments::parse_from(["bench", "growth", "soup", "--least", "1000", "--most", "100000", "--runs", "2"]);
        let Some(Mode::Growth(growth)) = arguments.mode else { panic!("not growth") };
        let sizes = growth.sizes();
        assert_eq!(sizes.scenes, ["soup:1000", "soup:3162", "soup:10000", "soup:31623", "soup:100000"]);
        assert_eq!(sizes.runs, 2);
    }
}
