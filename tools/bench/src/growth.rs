//! How times and memory grow with the number of triangles.

use clap::Parser as _;

use crate::arguments::{Arguments, Growth};
use crate::report::{Comparison, Report, SceneReport};
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
        Arguments { scenes, common: self.common.clone(), runs: self.runs, ..Arguments::parse_from(["growth"]) }
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

/// A row for each figure: the exponents of ours and of the rivals'.
pub fn slopes(report: &Report) -> String {
    let fit = |value: &dyn Fn(&SceneReport) -> Option<f64>| {
        let points: Vec<(f64, f64)> = report.scenes.iter().filter_map(|scene| Some((f64::from(scene.triangles), value(scene)?))).collect();
        slope(&points).map_or_else(|| "-".to_owned(), |slope| format!("{slope:.2}"))
    };
    let rivals = || report.setup.rivals.iter().map(|rival| rival.name.as_str());
    let mut first = head(&["grows as triangles to the power of", "ours"]);
    first.extend(rivals().map(str::to_owned));
    let mut rows = vec![first];
    let figures = report.scenes.first().map_or(Vec::new(), |scene| scene.figures().map(|(name, _)| name).collect());
    for name in figures {
        // Of a ray: shadow and reflection rays are more or fewer with the shape.
        let time = |scene: &SceneReport, of: &dyn Fn(&Comparison) -> Option<f64>| {
            let rays = scene.rays.iter().find(|rays| rays.kind == name).map_or(1.0, |rays| rays.rays as f64);
            let (_, comparison) = scene.figures().find(|(other, _)| *other == name)?;
            Some(of(comparison)? / rays)
        };
        let is_rays = report.scenes.iter().any(|scene| scene.rays.iter().any(|rays| rays.kind == name));
        let mut row = vec![if is_rays { format!("{name} ray") } else { name.to_owned() }];
        row.push(fit(&|scene| time(scene, &|comparison| Some(comparison.ours.median_ms))));
        row.extend(rivals().map(|rival| fit(&|scene| time(scene, &|comparison| Some(comparison.against(rival)?.times.median_ms)))));
        rows.push(row);
    }
    rows.push(vec!["memory".to_owned(), fit(&|scene| Some((scene.grid_bytes + scene.scratch_bytes) as f64))]);
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
