//! What is told about a run: a JSON object on standard output (docs/json.md), a table on standard error.

use std::fmt::Write;

use gridwalk_render::{DeviceInfo, DeviceKind};
use serde::Serialize;

/// What every JSON object begins with.
#[derive(Clone, Debug, Serialize)]
pub struct Header {
    /// Names the kind of object and the version of its fields: fields are added without notice, but none is removed or changed
    /// without a new version.
    schema: String,
    /// The version of the program.
    gridwalk: &'static str,
}

impl Header {
    pub fn new(command: &str) -> Header {
        Header { schema: format!("gridwalk.{command}/1"), gridwalk: env!("CARGO_PKG_VERSION") }
    }
}

/// A step of the rebuild.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    pub name: String,
    /// `map` or `cooperative`.
    pub kind: &'static str,
    pub ms: f64,
}

/// A part of the grid's memory, or of the memory that builds it.
#[derive(Clone, Debug, Serialize)]
pub struct Buffer {
    pub name: &'static str,
    pub bytes: u64,
}

/// One run of `render` or `cast`. Times are those of the device, in milliseconds; medians when the run was repeated. A device without
/// timestamps leaves them out.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    #[serde(flatten)]
    pub header: Header,
    pub scene: String,
    pub device: String,
    pub device_kind: &'static str,
    pub device_uuid: String,
    pub driver: String,
    pub triangles: u64,
    pub dropped: u64,
    pub resolution: [u32; 3],
    pub density: f32,
    pub cells: u64,
    pub cells_in_use: u64,
    pub pairs: u64,
    pub longest_list: u64,
    pub split_cells: u64,
    pub leaf_cells: u64,
    pub leaf_pairs: u64,
    pub grid_bytes: u64,
    pub scratch_bytes: u64,
    pub buffers: Vec<Buffer>,
    pub build_ms: Option<f64>,
    pub build_steps: Vec<Step>,
    pub rays: u64,
    pub unfinished: u64,
    pub trace_ms: Option<f64>,
    pub frame_ms: Option<f64>,
    pub repeat: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[u32; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spp: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    pub outputs: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heatmap: Option<Heatmap>,
    /// Seconds of the wall clock from start to end, all files included.
    pub wall_s: f64,
}

/// The numbers behind the colours of a heat map.
#[derive(Clone, Debug, Serialize)]
pub struct Heatmap {
    pub count: &'static str,
    pub min: f64,
    pub max: f64,
    pub mean: f64,
}

/// A device's driver in one line.
pub fn driver(device: &DeviceInfo) -> String {
    format!("{} {}", device.driver_name, device.driver_info).trim().to_owned()
}

/// Says plainly that no GPU is at work.
pub fn warn_of_cpu(device: &DeviceInfo) {
    if device.kind == DeviceKind::Cpu {
        tracing::warn!("the device is the CPU ({}): everything works, but a GPU is many times faster", device.name);
    }
}

/// The middle one of several times; `None` of none.
pub fn median(times: &mut [f64]) -> Option<f64> {
    times.sort_by(f64::total_cmp);
    let middle = times.len() / 2;
    match times.len() {
        0 => None,
        length if length % 2 == 1 => Some(times[middle]),
        _ => Some((times[middle - 1] + times[middle]) / 2.0),
    }
}

impl Run {
    /// The table of `--stats`.
    pub fn table(&self) -> String {
        let mut rows: Vec<(String, String)> = vec![
            ("device".to_owned(), format!("{} ({})", self.device, self.device_kind)),
            ("driver".to_owned(), self.driver.clone()),
            ("triangles".to_owned(), format!("{} ({} dropped)", self.triangles, self.dropped)),
            ("resolution".to_owned(), self.resolution.map(|n| n.to_string()).join(" x ")),
            ("density".to_owned(), format!("{}", self.density)),
            ("cells".to_owned(), format!("{} ({} in use)", self.cells, self.cells_in_use)),
            ("pairs".to_owned(), format!("{} (longest list {})", self.pairs, self.longest_list)),
            (
                "second level".to_owned(),
                format!("{} cells ask for {} leaf cells; {} pairs", self.split_cells, self.leaf_cells, self.leaf_pairs),
            ),
            ("grid".to_owned(), mib(self.grid_bytes)),
            ("scratch".to_owned(), mib(self.scratch_bytes)),
        ];
        rows.extend(self.buffers.iter().map(|buffer| (format!("  {}", buffer.name), mib(buffer.bytes))));
        rows.push(("build".to_owned(), ms(self.build_ms)));
        for step in &self.build_steps {
            rows.push((format!("  {}", step.name), format!("{}  {}", ms(Some(step.ms)), step.kind)));
        }
        for kind in ["map", "cooperative"] {
            if !self.build_steps.is_empty() {
                let sum = self.build_steps.iter().filter(|step| step.kind == kind).fold(0.0, |sum, step| sum + step.ms);
                rows.push((format!("  all {kind}"), ms(Some(sum))));
            }
        }
        rows.push(("rays".to_owned(), self.rays.to_string()));
        if self.unfinished > 0 {
            rows.push(("unfinished".to_owned(), self.unfinished.to_string()));
        }
        let rate = self.trace_ms.filter(|ms| *ms > 0.0).map(|ms| format!("  ({:.2} million rays a second)", self.rays as f64 / ms / 1e3));
        rows.push(("trace".to_owned(), format!("{}{}", ms(self.trace_ms), rate.unwrap_or_default())));
        rows.push(("frame".to_owned(), ms(self.frame_ms)));
        if self.repeat > 1 {
            rows.push(("repeated".to_owned(), format!("{} times; times are medians", self.repeat)));
        }
        rows.push(("wall clock".to_owned(), format!("{:.2} s", self.wall_s)));

        let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        rows.into_iter().fold(String::new(), |mut text, (name, value)| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name:width$}  {value}");
            text
        })
    }
}

fn mib(bytes: u64) -> String {
    format!("{:.2} MiB", bytes as f64 / f64::from(1 << 20))
}

fn ms(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:>9.3} ms"))
}

#[cfg(test)]
mod tests {
    use super::median;

    #[test]
    fn medians() {
        assert_eq!(median(&mut []), None);
        assert_eq!(median(&mut [3.0]), Some(3.0));
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), Some(2.5));
    }
}
