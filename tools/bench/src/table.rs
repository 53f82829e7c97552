//! The figures as text.

use std::fmt::Write as _;

use crate::report::{Against, Report, Rival, RivalBytes, SceneReport, Setup};

/// Rows of cells as text, with columns as wide as they need be; the first column to the left, the others to the right.
pub fn columns(rows: &[Vec<String>]) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count)
        .map(|column| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0))
        .collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            // Writing to a string cannot fail.
            let _ = if column == 0 { write!(line, "{cell:<width$}") } else { write!(line, "  {cell:>width$}") };
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// The first row.
pub fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

/// Three decimals below 1, so that no ratio loses its second digit.
pub fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(value) if value < 1.0 => format!("{value:.3}"),
        Some(value) if value < 10.0 => format!("{value:.2}"),
        Some(value) => format!("{value:.1}"),
    }
}

fn bytes_each(bytes: u64, triangles: u32) -> String {
    format!("{:.0}", bytes as f64 / f64::from(triangles.max(1)))
}

impl Setup {
    /// The device, and each rival.
    pub fn text(&self) -> String {
        let mut text = format!("{} ({})\n", self.device, self.driver);
        for rival in &self.rivals {
            let threads = rival.threads.map_or(String::new(), |threads| format!(", {threads} threads"));
            text += &format!("against {} {}{threads}: {}; rays: {}\n", rival.name, rival.version, rival.rebuild, rival.tree);
        }
        if self.rivals.is_empty() {
            text += "against nobody\n";
        }
        text
    }
}

/// Appends a block of rows, a line apart, if there is more than the head.
fn block(text: &mut String, rows: &[Vec<String>]) {
    if rows.len() > 1 {
        text.push('\n');
        text.push_str(&columns(rows));
    }
}

impl Report {
    /// The table; of the steps only those whose name holds `filter`.
    pub fn table(&self, filter: Option<&str>) -> String {
        let mut text = self.setup.text();
        text += &format!(
            "{0} x {0} camera rays, as many others; medians of {1} runs; ratio above 1: faster than the rival, by medians, by the best runs, and by processor \
             time; frame: rebuild, and 2^20 camera and 2^20 shadow rays through what it made\n",
            self.setup.size, self.setup.runs
        );
        text += &format!(
            "pipelines made in {:.0} ms; recorded in {:.1} us a build, {:.1} us a trace; a kernel copies at {:.1} GB/s, read and written\n",
            self.pipelines_ms, self.record_build_us, self.record_trace_us, self.bandwidth_gb_s
        );
        block(&mut text, &self.grids());
        block(&mut text, &self.memory());
        block(&mut text, &self.times());
        block(&mut text, &self.frames());
        block(&mut text, &self.walks());
        block(&mut text, &self.hits());
        for scene in &self.scenes {
            block(&mut text, &scene.steps(filter, self.bandwidth_gb_s));
        }
        block(&mut text, &self.mean_rows());
        text
    }

    fn grids(&self) -> Vec<Vec<String>> {
        let mut rows = vec![head(&[
            "scene",
            "triangles",
            "k",
            "overlap",
            "resolution",
            "cells",
            "in use",
            "pairs",
            "a triangle",
            "of",
            "longest",
            "split",
            "leaf cells",
            "pairs",
        ])];
        rows.extend(self.scenes.iter().map(|scene| {
            vec![
                scene.scene.clone(),
                scene.triangles.to_string(),
                format!("{:.1}", scene.density),
                scene.overlap.clone(),
                scene.resolution.map(|cells| cells.to_string()).join("x"),
                scene.cells.to_string(),
                scene.cells_in_use.to_string(),
                scene.pairs.to_string(),
                format!("{:.2}", f64::from(scene.pairs) / f64::from(scene.triangles.max(1))),
                scene.pair_total.to_string(),
                scene.longest_list.to_string(),
                scene.split_cells.to_string(),
                scene.leaf_cells.to_string(),
                scene.leaf_pairs.to_string(),
            ]
        }));
        rows
    }

    fn memory(&self) -> Vec<Vec<String>> {
        let mut first = head(&["scene", "bytes a triangle:", "grid", "scratch", "sum", "sum if fitted"]);
        let known = |rival: &Rival| {
            let of = |bytes: &[RivalBytes]| bytes.iter().any(|bytes| bytes.rival == rival.name);
            self.scenes.iter().any(|scene| of(&scene.rebuilt_bytes) || of(&scene.traced_bytes))
        };
        let rivals: Vec<&Rival> = self.setup.rivals.iter().filter(|rival| known(rival)).collect();
        first.extend(rivals.iter().flat_map(|rival| [format!("{}, rebuilt", rival.name), "traced".to_owned()]));
        let mut rows = vec![first];
        rows.extend(self.scenes.iter().map(|scene| {
            let each = |bytes| bytes_each(bytes, scene.triangles);
            let (grid, scratch) = (scene.grid_bytes, scene.scratch_bytes);
            let mut row =
                vec![scene.scene.clone(), String::new(), each(grid), each(scratch), each(grid + scratch), each(scene.fitted_bytes)];
            row.extend(rivals.iter().flat_map(|rival| {
                [&scene.rebuilt_bytes, &scene.traced_bytes].map(|all| {
                    let bytes = all.iter().find(|bytes| bytes.rival == rival.name);
                    bytes.map_or("-".to_owned(), |bytes| each(bytes.bytes))
                })
            }));
            row
        }));
        rows
    }

    fn times(&self) -> Vec<Vec<String>> {
        let mut first = head(&["scene", "", "ms", "of it sort", "Mrays/s"]);
        for rival in &self.setup.rivals {
            first.extend([format!("{} ms", rival.name)].into_iter().chain(head(&["ratio", "best", "processor"])));
        }
        let mut rows = vec![first];
        for scene in &self.scenes {
            for (name, comparison) in scene.figures() {
                let rays = scene.rays.iter().find(|rays| rays.kind == name);
                let mut row = vec![scene.scene.clone(), name.to_owned(), number(Some(comparison.ours.median_ms))];
                row.extend(rays.map_or([String::new(), String::new()], |rays| {
                    [rays.sort_ms.map_or(String::new(), |ms| number(Some(ms))), number(Some(rays.mrays))]
                }));
                row.extend(self.setup.rivals.iter().flat_map(|rival| against(comparison.against(&rival.name))));
                if let Some(alone) = rays.and_then(|rays| rays.alone.as_ref()?.ratio) {
                    row.push(format!("{} times slower than the object alone", number(Some(alone.recip()))));
                }
                rows.push(row);
            }
        }
        rows
    }

    /// What frames are made of.
    fn frames(&self) -> Vec<Vec<String>> {
        let mut rows = vec![head(&["scene", "frame of", "ms", "rebuild", "camera", "shadow"])];
        for scene in &self.scenes {
            let sides = scene.frame.iter().flat_map(|frame| std::iter::once(&frame.ours).chain(&frame.rivals));
            rows.extend(sides.map(|side| {
                let ms = [side.frame_ms(), side.rebuild_ms, side.kind_ms("camera"), side.kind_ms("shadow")];
                let mut row = vec![scene.scene.clone(), side.name.clone()];
                row.extend(ms.map(|ms| number(Some(ms))));
                row
            }));
        }
        rows
    }

    fn walks(&self) -> Vec<Vec<String>> {
        let mut rows = vec![head(&["scene", "a ray", "steps", "cells in use", "tests", "bytes asked for", "GB/s", "of a copy's"])];
        for (scene, rays) in self.scenes.iter().flat_map(|scene| scene.rays.iter().map(move |rays| (scene, rays))) {
            let Some(walk) = &rays.walk else { continue };
            let rate = walk.bytes() * rays.mrays * 1e-3;
            let mut row = vec![scene.scene.clone(), rays.kind.clone()];
            row.extend([walk.steps, walk.cells, walk.tests].map(|count| number(Some(count))));
            row.extend([format!("{:.0}", walk.bytes()), number(Some(rate)), share(rate, self.bandwidth_gb_s)]);
            rows.push(row);
        }
        rows
    }

    fn hits(&self) -> Vec<Vec<String>> {
        let mut rows =
            vec![head(&["scene", "rays", "", "hits", "unfinished", "against", "compared", "other triangle", "nearer", "farther"])];
        for scene in &self.scenes {
            for rays in &scene.rays {
                let hits = format!("{:.1} %", rays.hits as f64 / rays.rays.max(1) as f64 * 100.0);
                let row = vec![scene.scene.clone(), rays.kind.clone(), rays.rays.to_string(), hits, rays.unfinished.to_string()];
                if rays.differences.is_empty() {
                    rows.push(row);
                    continue;
                }
                rows.extend(rays.differences.iter().map(|difference| {
                    let counts = [difference.rays, difference.triangle, difference.nearer, difference.farther];
                    row.iter().cloned().chain([difference.rival.clone()]).chain(counts.map(|count| count.to_string())).collect()
                }));
            }
        }
        rows
    }

    fn mean_rows(&self) -> Vec<Vec<String>> {
        let mut rows = vec![head(&["geometric mean of", "against", "ratio", "over"])];
        rows.extend(
            self.means.iter().map(|mean| vec![mean.figure.clone(), mean.rival.clone(), number(Some(mean.ratio)), mean.scenes.join(" ")]),
        );
        rows
    }
}

fn against(against: Option<&Against>) -> [String; 4] {
    let of = |value: fn(&Against) -> Option<f64>| number(against.and_then(value));
    [of(|a| Some(a.times.median_ms)), of(|a| a.ratio), of(|a| a.best_ratio), of(|a| a.processor_ratio)]
}

fn share(part: f64, whole: f64) -> String {
    if whole > 0.0 { format!("{:.1} %", part / whole * 100.0) } else { "-".to_owned() }
}

impl SceneReport {
    fn steps(&self, filter: Option<&str>, bandwidth_gb_s: f64) -> Vec<Vec<String>> {
        let sum: f64 = self.steps.iter().map(|step| step.ms).sum();
        let mut rows = vec![head(&[&self.scene, "kind", "launches", "ms", "share", "MB", "GB/s", "of a copy's"])];
        let shown = self.steps.iter().filter(|step| filter.is_none_or(|filter| step.name.contains(filter)));
        rows.extend(shown.map(|step| {
            let mut row =
                vec![step.name.clone(), step.kind.clone(), step.count.to_string(), format!("{:.3}", step.ms), share(step.ms, sum)];
            if let Some(bytes) = step.bytes.filter(|_| step.ms > 0.0) {
                let rate = bytes as f64 / step.ms * 1e-6;
                row.extend([number(Some(bytes as f64 * 1e-6)), number(Some(rate)), share(rate, bandwidth_gb_s)]);
            }
            row
        }));
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_two_digits() {
        assert_eq!([None, Some(0.1234), Some(2.345), Some(123.45)].map(number), ["-", "0.123", "2.35", "123.5"]);
    }
}
