//! Pictures (SVG). The ratios: a bar for each figure, on a logarithmic scale, and the line at which both are equally fast. How figures grow: a
//! line for each contender, on logarithmic scales.

use std::fmt::Write as _;

use crate::growth::Series;
use crate::report::{Comparison, Report, Rival, Setup};
use crate::table::number;

const BAR: f64 = 14.0;
const GAP: f64 = 12.0;
const LABELS: f64 = 210.0;
const DECADE: f64 = 200.0;
/// Colours that the colour-blind tell apart (Okabe and Ito 2008), one a kind of figure.
const COLOURS: [(&str, &str); 8] = [
    ("rebuild", "#0072B2"),
    ("frame", "#000000"),
    ("camera", "#E69F00"),
    ("shadow", "#56B4E9"),
    ("reflection", "#009E73"),
    ("diffuse", "#D55E00"),
    ("any", "#CC79A7"),
    ("object", "#F0E442"),
];

/// A picture in the making.
struct Picture(String);

impl Picture {
    /// With the device in its first line.
    fn new(setup: &Setup) -> Picture {
        let mut picture = Picture(String::new());
        picture.text(8.0, 18.0, "start", &format!("{} ({})", setup.device, setup.driver));
        picture
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, words: &str) {
        let words = words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>");
    }

    fn bar(&mut self, x: f64, y: f64, width: f64, colour: &str) {
        let height = BAR - 3.0;
        let _ = writeln!(self.0, "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\"/>");
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2], colour: &str) {
        let ([x1, y1], [x2, y2]) = (from, to);
        let _ = writeln!(self.0, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\"/>");
    }

    fn finish(self, width: f64, height: f64) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" font-family=\"sans-serif\" \
             font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
            self.0
        )
    }
}

fn colour(figure: &str) -> &'static str {
    COLOURS.iter().find(|(known, _)| *known == figure).map_or("#000000", |(_, colour)| colour)
}

/// A scene's ratios to a rival, by name.
fn ratios<'a>(report: &'a Report, rival: &'a Rival) -> Vec<(&'a str, Vec<(&'a str, f64)>)> {
    let scenes = report.scenes.iter().map(|scene| {
        let ratio = |comparison: &Comparison| comparison.against(&rival.name)?.ratio.filter(|ratio| *ratio > 0.0);
        let known = scene.figures().filter_map(|(name, comparison)| Some((name, ratio(comparison)?)));
        (scene.scene.as_str(), known.collect::<Vec<_>>())
    });
    scenes.filter(|(_, figures)| !figures.is_empty()).collect()
}

/// The picture: a block of bars a rival; `None` without one.
pub fn bars(report: &Report) -> Option<String> {
    let rivals: Vec<_> = report.setup.rivals.iter().map(|rival| (rival, ratios(report, rival))).collect();
    if rivals.is_empty() {
        return None;
    }
    let all = || rivals.iter().flat_map(|(_, scenes)| scenes).flat_map(|(_, figures)| figures.iter().map(|(_, ratio)| *ratio));
    // Whole decades, with the line of equality in or at the edge of the picture.
    let first = all().fold(1.0, f64::min).log10().floor();
    let last = all().fold(1.0, f64::max).log10().ceil().max(first + 1.0);
    let x = |ratio: f64| LABELS + (ratio.log10() - first) * DECADE;

    let mut picture = Picture::new(&report.setup);
    let mut y = 18.0;
    for (rival, scenes) in &rivals {
        y += 24.0;
        let threads = rival.threads.map_or(String::new(), |threads| format!(" with {threads} threads"));
        let title = format!("times as fast as {} {}{threads}; to the right of 1: faster", rival.name, rival.version);
        picture.text(8.0, y, "start", &title);
        y += 24.0;
        let top = y;
        for (scene, figures) in scenes {
            picture.text(8.0, y + BAR - 3.0, "start", scene);
            for (name, ratio) in figures {
                picture.text(LABELS - 6.0, y + BAR - 3.0, "end", name);
                picture.text(x(*ratio) + 4.0, y + BAR - 3.0, "start", &number(Some(*ratio)));
                picture.bar(LABELS, y + 2.0, x(*ratio) - LABELS, colour(name));
                y += BAR;
            }
            y += GAP;
        }
        for decade in first as i32..=last as i32 {
            let x = x(10_f64.powi(decade));
            picture.text(x, top - 8.0, "middle", &number(Some(10_f64.powi(decade))));
            picture.line([x, top - 4.0], [x, y], if decade == 0 { "black" } else { "#bbbbbb" });
        }
    }
    Some(picture.finish(x(10_f64.powf(last)) + 60.0, y + 24.0))
}

/// Side of a panel's plot, and the space around it.
const PANEL: f64 = 230.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 60.0;
const RIGHT: f64 = 90.0;
/// Panels beside one another.
const ACROSS: usize = 3;

/// Whole decades around numbers: exponents of the first and the last.
fn decades(numbers: impl Iterator<Item = f64>) -> Option<(i32, i32)> {
    let (least, most) = numbers.filter(|number| *number > 0.0).fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), x| (a.min(x), b.max(x)));
    let (first, last) = (least.log10().floor() as i32, most.log10().ceil() as i32);
    (most > 0.0).then(|| (first, last.max(first + 1)))
}

/// A power of ten as people write it.
fn power(exponent: i32) -> String {
    match exponent {
        -3..=3 => 10_f64.powi(exponent).to_string(),
        _ => format!("1e{exponent}"),
    }
}

/// A panel for each figure that grows.
pub fn growth(setup: &Setup, all: &[Series]) -> String {
    let mut picture = Picture::new(setup);
    for (place, series) in all.iter().enumerate() {
        let points = || series.lines.iter().flat_map(|(_, points)| points);
        let (Some(across), Some(upwards)) = (decades(points().map(|point| point.0)), decades(points().map(|point| point.1))) else {
            continue;
        };
        let corner = [LEFT + (place % ACROSS) as f64 * (LEFT + PANEL + RIGHT), TOP + (place / ACROSS) as f64 * (TOP + PANEL)];
        let part = |value: f64, (first, last): (i32, i32)| (value.log10() - f64::from(first)) / f64::from(last - first) * PANEL;
        let at = |point: &(f64, f64)| [corner[0] + part(point.0, across), corner[1] + PANEL - part(point.1, upwards)];
        picture.text(corner[0], corner[1] - 10.0, "start", &series.name);
        for exponent in across.0..=across.1 {
            let x = corner[0] + part(10_f64.powi(exponent), across);
            picture.line([x, corner[1]], [x, corner[1] + PANEL], "#dddddd");
            picture.text(x, corner[1] + PANEL + 14.0, "middle", &power(exponent));
        }
        for exponent in upwards.0..=upwards.1 {
            let y = corner[1] + PANEL - part(10_f64.powi(exponent), upwards);
            picture.line([corner[0], y], [corner[0] + PANEL, y], "#dddddd");
            picture.text(corner[0] - 4.0, y + 4.0, "end", &power(exponent));
        }
        let mut labels: Vec<(f64, f64, &str)> = Vec::new();
        for (line, (who, points)) in series.lines.iter().enumerate() {
            let (_, colour) = COLOURS[line % COLOURS.len()];
            for pair in points.windows(2) {
                picture.line(at(&pair[0]), at(&pair[1]), colour);
            }
            labels.extend(points.last().map(at).map(|[x, y]| (y, x, who.as_str())));
        }
        // One below the other, where lines end close together.
        labels.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut free = f64::NEG_INFINITY;
        for (y, x, who) in labels {
            let y = y.max(free);
            picture.text(x + 4.0, y + 4.0, "start", who);
            free = y + 11.0;
        }
    }
    let rows = all.len().div_ceil(ACROSS);
    picture.finish(ACROSS.min(all.len()) as f64 * (LEFT + PANEL + RIGHT), rows as f64 * (TOP + PANEL) + TOP)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_whole_decades() {
        assert_eq!(decades([20.0, 3000.0, 0.0].into_iter()), Some((1, 4)));
        assert_eq!(decades([1.0, 1.0].into_iter()), Some((0, 1)));
        assert_eq!(decades([0.0].into_iter()), None);
        assert_eq!([-2, 0, 3, 6].map(power), ["0.01", "1", "1000", "1e6"]);
    }
}
