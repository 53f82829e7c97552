//! The ratios as a picture (SVG): a bar for each figure, on a logarithmic scale, and the line at which both are equally fast.

use std::fmt::Write as _;

use crate::report::{Report, number};

const BAR: f64 = 14.0;
const GAP: f64 = 12.0;
const LABELS: f64 = 210.0;
const DECADE: f64 = 200.0;
const TOP: f64 = 58.0;
/// Colours that the colour-blind tell apart (Okabe and Ito 2008), one a kind of figure.
const COLOURS: [(&str, &str); 6] = [
    ("rebuild", "#0072B2"),
    ("camera", "#E69F00"),
    ("shadow", "#56B4E9"),
    ("reflection", "#009E73"),
    ("diffuse", "#D55E00"),
    ("any", "#CC79A7"),
];

/// A scene's ratios, by name.
fn ratios(report: &Report) -> Vec<(&str, Vec<(&str, f64)>)> {
    let scenes = report.scenes.iter().map(|scene| {
        let rebuild = scene.rebuild.iter().map(|time| ("rebuild", time.ratio));
        let figures = rebuild.chain(scene.rays.iter().map(|rays| (rays.kind.as_str(), rays.time.ratio)));
        let known = figures.filter_map(|(name, ratio)| Some((name, ratio.filter(|ratio| *ratio > 0.0)?)));
        (scene.scene.as_str(), known.collect::<Vec<_>>())
    });
    scenes.filter(|(_, figures)| !figures.is_empty()).collect()
}

/// The picture; `None` without a rival.
pub fn svg(report: &Report) -> Option<String> {
    let rival = report.embree.as_ref()?;
    let scenes = ratios(report);
    let all = || scenes.iter().flat_map(|(_, figures)| figures.iter().map(|(_, ratio)| *ratio));
    // Whole decades, with the line of equality in or at the edge of the picture.
    let first = all().fold(1.0, f64::min).log10().floor();
    let last = all().fold(1.0, f64::max).log10().ceil().max(first + 1.0);
    let x = |ratio: f64| LABELS + (ratio.log10() - first) * DECADE;
    let height = scenes.iter().fold(TOP, |height, (_, figures)| height + figures.len() as f64 * BAR + GAP) + 24.0;
    let width = x(10_f64.powf(last)) + 60.0;

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" font-family=\"sans-serif\" \
         font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut text = |x: f64, y: f64, anchor: &str, words: &str| {
        let words = words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        // Writing to a string cannot fail.
        let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>");
    };
    text(8.0, 18.0, "start", &format!("{} ({})", report.device, report.driver));
    let title = format!("times as fast as Embree {} with {} threads; to the right of 1: faster", rival.version, rival.threads);
    text(8.0, 34.0, "start", &title);
    for decade in first as i32..=last as i32 {
        text(x(10_f64.powi(decade)), TOP - 8.0, "middle", &number(Some(10_f64.powi(decade))));
    }
    let mut y = TOP;
    for (scene, figures) in &scenes {
        text(8.0, y + BAR - 3.0, "start", scene);
        for (name, ratio) in figures {
            text(LABELS - 6.0, y + BAR - 3.0, "end", name);
            text(x(*ratio) + 4.0, y + BAR - 3.0, "start", &number(Some(*ratio)));
            y += BAR;
        }
        y += GAP;
    }
    let mut y = TOP;
    for (_, figures) in &scenes {
        for (name, ratio) in figures {
            let colour = COLOURS.iter().find(|(known, _)| known == name).map_or("#000000", |(_, colour)| colour);
            let _ = writeln!(
                svg,
                "<rect x=\"{LABELS:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{colour}\"/>",
                y + 2.0,
                x(*ratio) - LABELS,
                BAR - 3.0
            );
            y += BAR;
        }
        y += GAP;
    }
    for decade in first as i32..=last as i32 {
        let colour = if decade == 0 { "black" } else { "#bbbbbb" };
        let x = x(10_f64.powi(decade));
        let _ = writeln!(svg, "<line x1=\"{x:.1}\" y1=\"{:.1}\" x2=\"{x:.1}\" y2=\"{y:.1}\" stroke=\"{colour}\"/>", TOP - 4.0);
    }
    svg += "</svg>\n";
    Some(svg)
}
