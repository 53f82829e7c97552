//! The figures: JSON, and the table made of them.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

/// What a whole run of the program found. Times are milliseconds, rates millions of rays a second.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// Version of this schema.
    pub schema: u32,
    /// Version of gridwalk.
    pub version: String,
    /// The Vulkan device.
    pub device: String,
    /// Its driver.
    pub driver: String,
    /// Whether it is a CPU.
    pub device_is_cpu: bool,
    /// Milliseconds to make the library's pipelines.
    pub pipelines_ms: f64,
    /// Median of the microseconds to record a build into a command buffer.
    #[serde(default)]
    pub record_build_us: f64,
    /// Likewise a trace of closest hits.
    #[serde(default)]
    pub record_trace_us: f64,
    /// The rival; none where it is not installed.
    pub embree: Option<Rival>,
    /// Runs after the warm-up.
    pub runs: u32,
    /// One entry a scene.
    pub scenes: Vec<SceneReport>,
}

/// The rival and how it was used.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Rival {
    /// Its version.
    pub version: String,
    /// The library.
    pub library: String,
    /// Its threads.
    pub threads: u32,
    /// Build quality of the tree that rays were traced through.
    pub trace_quality: String,
}

/// The figures of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SceneReport {
    /// As asked for.
    pub scene: String,
    /// Triangles.
    pub triangles: u32,
    /// Of them left out for a vertex that is not finite.
    pub dropped: u32,
    /// Density k that was built with.
    pub density: f32,
    /// Overlap test.
    pub overlap: String,
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// All cells.
    pub cells: u32,
    /// Cells that list a triangle.
    pub cells_in_use: u32,
    /// Pairs that are listed.
    pub pairs: u32,
    /// Cells in the boxes of all triangles.
    pub pair_total: u32,
    /// Triangles in the fullest cell.
    pub longest_list: u32,
    /// Bytes of the grid with its triangles, as the renderer sizes it: pairs for the first guess of its builder or what a first build asked for.
    pub grid_bytes: u64,
    /// Bytes of the build's scratch, sized likewise.
    pub scratch_bytes: u64,
    /// Bytes of both, if sized for exactly the cells and pairs of this scene.
    pub fitted_bytes: u64,
    /// Rebuilds; none if they were not asked for.
    pub rebuild: Option<Comparison>,
    /// Medians of the rebuild's steps, those of one kernel summed.
    pub steps: Vec<Step>,
    /// Rays, by kind.
    pub rays: Vec<RayReport>,
}

/// A step of the rebuild.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Step {
    /// Kernel.
    pub name: String,
    /// `map` or `cooperative`.
    pub kind: String,
    /// Launches.
    pub count: u32,
    /// Median of the milliseconds of all launches.
    pub ms: f64,
}

/// The figures of one kind of rays.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RayReport {
    /// `camera`, `diffuse` or `any`.
    pub kind: String,
    /// How many.
    pub rays: u64,
    /// Of them hit something.
    pub hits: u64,
    /// Walks that were given up.
    pub unfinished: u64,
    /// Our median in millions of rays a second.
    pub mrays: f64,
    /// The rival's.
    pub embree_mrays: Option<f64>,
    /// Times.
    pub time: Comparison,
    /// How the hits differ from the rival's.
    pub difference: Option<Difference>,
}

/// How two rounds of hits differ. The same triangle is the same hit, since a grazing ray's distance is mostly rounding; of different
/// triangles, distances are the same if they differ by at most 1e-4 of the greater. A miss is infinitely far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Another triangle at the same distance: neighbours share edges.
    pub triangle: u64,
    /// We hit something nearer than the rival.
    pub nearer: u64,
    /// We hit something farther than the rival, or gave up.
    pub farther: u64,
    /// Greatest difference of distance where the triangle is the same, in units of the direction's length.
    pub distance: f32,
    /// The first of those that are nearer or farther.
    pub examples: Vec<Example>,
}

/// A ray that was answered differently.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// Its place among the rays.
    pub ray: u64,
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes.
    pub direction: [f32; 3],
    /// Our distance and triangle; none for a miss.
    pub ours: Option<(f32, u32)>,
    /// The rival's.
    pub embree: Option<(f32, u32)>,
}

/// Times of both. Medians, unless a name says otherwise.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Comparison {
    /// Ours, on the device.
    pub ours: Times,
    /// The rival's, on the wall.
    pub embree: Option<Times>,
    /// How often faster than the rival we are, by medians.
    pub ratio: Option<f64>,
    /// Likewise by the best runs.
    pub best_ratio: Option<f64>,
    /// Likewise by processor time, where the device is a CPU: what a busy machine disturbs least.
    pub processor_ratio: Option<f64>,
}

/// Milliseconds over the runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Median.
    pub median_ms: f64,
    /// Least.
    pub best_ms: f64,
    /// Greatest.
    pub worst_ms: f64,
    /// Median of the processor time that all threads of the program took together, with what the host did besides.
    pub processor_ms: f64,
}

/// What one run took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Milliseconds, by the device's clock for ours and on the wall for the rival.
    pub ms: f64,
    /// Milliseconds of processor time of all threads of the program.
    pub processor_ms: f64,
}

impl Times {
    /// Sums up runs; zeros where there is none.
    pub fn of(runs: &[Run]) -> Times {
        let ms = || runs.iter().map(|run| run.ms);
        Times {
            median_ms: median(ms()),
            best_ms: ms().reduce(f64::min).unwrap_or(0.0),
            worst_ms: ms().reduce(f64::max).unwrap_or(0.0),
            processor_ms: median(runs.iter().map(|run| run.processor_ms)),
        }
    }
}

/// The middle number, or the mean of the middle two; 0 of none.
pub fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut ordered: Vec<f64> = numbers.collect();
    ordered.sort_by(f64::total_cmp);
    let at = |index: usize| ordered.get(index).copied().unwrap_or(0.0);
    match ordered.len() {
        0 => 0.0,
        count if count % 2 == 1 => at(count / 2),
        count => (at(count / 2 - 1) + at(count / 2)) * 0.5,
    }
}

impl Comparison {
    /// Compares runs; the rival's may be missing.
    pub fn of(ours: &[Run], embree: &[Run], device_is_cpu: bool) -> Comparison {
        let ours = Times::of(ours);
        let embree = (!embree.is_empty()).then(|| Times::of(embree));
        let ratio = |ours: f64, embree: f64| (ours > 0.0).then_some(embree / ours);
        Comparison {
            ratio: embree.and_then(|embree| ratio(ours.median_ms, embree.median_ms)),
            best_ratio: embree.and_then(|embree| ratio(ours.best_ms, embree.best_ms)),
            processor_ratio: embree.filter(|_| device_is_cpu).and_then(|embree| ratio(ours.processor_ms, embree.processor_ms)),
            ours,
            embree,
        }
    }
}

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

fn bytes_each(bytes: u64, triangles: u32) -> String {
    format!("{:.0}", bytes as f64 / f64::from(triangles.max(1)))
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

impl Report {
    /// The table; of the steps only those whose name holds `filter`.
    pub fn table(&self, filter: Option<&str>) -> String {
        let mut text = format!("{} ({})\n", self.device, self.driver);
        match &self.embree {
            Some(rival) => {
                let Rival { version, threads, trace_quality, .. } = rival;
                text += &format!("against Embree {version}, {threads} threads, Morton rebuild, rays through its {trace_quality} tree; ");
            }
            None => text += "Embree is not there: its columns are empty; ",
        }
        text += &format!(
            "medians of {} runs; ratio above 1: faster than Embree, by medians, by the best runs, and by processor time\n",
            self.runs
        );
        text += &format!(
            "pipelines made in {:.0} ms; recorded in {:.1} us a build, {:.1} us a trace\n\n",
            self.pipelines_ms, self.record_build_us, self.record_trace_us
        );

        let mut rows = vec![head(&["scene", "triangles", "k", "overlap", "resolution", "cells", "in use", "pairs", "of", "longest"])];
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
                scene.pair_total.to_string(),
                scene.longest_list.to_string(),
            ]
        }));
        text += &columns(&rows);

        let mut rows = vec![head(&["scene", "bytes a triangle:", "grid", "scratch", "sum", "sum if fitted"])];
        rows.extend(self.scenes.iter().map(|scene| {
            let each = |bytes| bytes_each(bytes, scene.triangles);
            let (grid, scratch) = (scene.grid_bytes, scene.scratch_bytes);
            vec![scene.scene.clone(), String::new(), each(grid), each(scratch), each(grid + scratch), each(scene.fitted_bytes)]
        }));
        text += &format!("\n{}", columns(&rows));

        let mut rows = vec![head(&[
            "scene",
            "",
            "ms",
            "Embree",
            "Mrays/s",
            "Embree",
            "ratio",
            "best",
            "processor",
            "hits",
            "other triangle",
            "nearer",
            "farther",
        ])];
        for scene in &self.scenes {
            let times = |comparison: &Comparison| [number(Some(comparison.ours.median_ms)), number(comparison.embree.map(|t| t.median_ms))];
            if let Some(rebuild) = &scene.rebuild {
                let mut row = vec![scene.scene.clone(), "rebuild".to_owned()];
                row.extend(times(rebuild));
                row.extend([String::new(), String::new(), number(rebuild.ratio), number(rebuild.best_ratio)]);
                row.extend([number(rebuild.processor_ratio)]);
                rows.push(row);
            }
            for rays in &scene.rays {
                let mut row = vec![scene.scene.clone(), rays.kind.clone()];
                row.extend(times(&rays.time));
                row.extend([number(Some(rays.mrays)), number(rays.embree_mrays), number(rays.time.ratio)]);
                row.extend([number(rays.time.best_ratio), number(rays.time.processor_ratio)]);
                row.push(format!("{:.1} %", rays.hits as f64 / rays.rays.max(1) as f64 * 100.0));
                let difference = |part: fn(&Difference) -> u64| rays.difference.as_ref().map_or("-".to_owned(), |d| part(d).to_string());
                row.extend([difference(|d| d.triangle), difference(|d| d.nearer), difference(|d| d.farther)]);
                if rays.unfinished > 0 {
                    row.push(format!("{} unfinished", rays.unfinished));
                }
                rows.push(row);
            }
        }
        text += &format!("\n{}", columns(&rows));

        for scene in &self.scenes {
            let sum: f64 = scene.steps.iter().map(|step| step.ms).sum();
            let mut rows = vec![head(&[&scene.scene, "kind", "launches", "ms", "share"])];
            let shown = scene.steps.iter().filter(|step| filter.is_none_or(|filter| step.name.contains(filter)));
            rows.extend(shown.map(|step| {
                let share = format!("{:.1} %", step.ms / sum.max(f64::MIN_POSITIVE) * 100.0);
                vec![step.name.clone(), step.kind.clone(), step.count.to_string(), format!("{:.3}", step.ms), share]
            }));
            if rows.len() > 1 {
                text += &format!("\n{}", columns(&rows));
            }
        }
        text
    }
}

pub fn head(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(ms: &[f64]) -> Vec<Run> {
        ms.iter().map(|&ms| Run { ms, processor_ms: 2.0 * ms }).collect()
    }

    #[test]
    fn medians() {
        assert_eq!(Times::of(&runs(&[3.0, 1.0, 2.0])), Times { median_ms: 2.0, best_ms: 1.0, worst_ms: 3.0, processor_ms: 4.0 });
        assert_eq!(Times::of(&runs(&[4.0, 1.0, 2.0, 3.0])).median_ms, 2.5);
        assert_eq!(Times::of(&[]), Times::default());
    }

    #[test]
    fn above_one_is_faster() {
        let comparison = Comparison::of(&runs(&[10.0, 20.0, 12.0]), &runs(&[24.0, 5.0, 30.0]), true);
        assert_eq!((comparison.ratio, comparison.best_ratio, comparison.processor_ratio), (Some(2.0), Some(0.5), Some(2.0)));
        assert_eq!(Comparison::of(&runs(&[1.0]), &runs(&[1.0]), false).processor_ratio, None);
        assert_eq!(Comparison::of(&runs(&[1.0]), &[], true).ratio, None);
    }

    #[test]
    fn numbers_keep_two_digits() {
        assert_eq!([None, Some(0.1234), Some(2.345), Some(123.45)].map(number), ["-", "0.123", "2.35", "123.5"]);
    }
}
