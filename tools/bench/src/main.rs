//! `cargo tool bench`: rebuilds and rays of gridwalk, measured on the device, with Embree as rival where it is installed.
#![deny(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that fails panics"))]

mod arguments;
mod compare;
mod dynamic;
mod dynamic_report;
#[allow(unsafe_code, reason = "calls a C library")]
mod embree;
mod growth;
mod measure;
mod moving;
mod plot;
mod rays;
#[allow(unsafe_code, reason = "records commands")]
mod record;
mod report;
mod scenes;
mod surface;
mod vector;

use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

use anyhow::{Context as _, Result};
use clap::Parser;
use gridwalk_render::{Context, ContextDesc, GridBuilder};
use serde::Serialize;

use crate::arguments::{Arguments, Common, Dynamic, Mode};
use crate::embree::Embree;
use crate::report::{Report, Rival};

/// What lavapipe counts its threads by.
const LAVAPIPE_THREADS: &str = "LP_NUM_THREADS";

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match start(&arguments) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("gridwalk-bench: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn start(arguments: &Arguments) -> Result<ExitCode> {
    let common = match &arguments.mode {
        Some(Mode::Dynamic(dynamic)) => &dynamic.common,
        Some(Mode::Growth(growth)) => &growth.common,
        None => &arguments.common,
    };
    // The driver reads its environment when it is loaded, and setting a variable of one's own process is unsafe: so start again with it.
    if let Some(threads) = common.threads.filter(|threads| std::env::var(LAVAPIPE_THREADS) != Ok(threads.to_string())) {
        let mut command = Command::new(std::env::current_exe().context("where is this program?")?);
        let status = command.args(std::env::args_os().skip(1)).env(LAVAPIPE_THREADS, threads.to_string()).status();
        let code = status.context("cannot be started again")?.code().and_then(|code| u8::try_from(code).ok());
        return Ok(code.map_or(ExitCode::FAILURE, ExitCode::from));
    }
    match &arguments.mode {
        Some(Mode::Dynamic(dynamic)) => {
            let report = run_dynamic(dynamic)?;
            write(common, &report, &report.table())?;
        }
        Some(Mode::Growth(growth)) => {
            let report = run(&growth.sizes())?;
            write(common, &report, &(report.table(None) + &growth::slopes(&report)))?;
        }
        None => {
            // Read first: a name that leads nowhere is told before anything is measured.
            let old = arguments.compare.as_deref().map(read_report).transpose()?;
            let report = run(arguments)?;
            let mut table = report.table(arguments.filter_steps.as_deref());
            if let Some(old) = &old {
                table += &compare::changes(old, &report);
            }
            if let Some(path) = &arguments.plot {
                let picture = plot::svg(&report).context("nothing to plot: Embree is not there")?;
                std::fs::write(path, picture).with_context(|| format!("{}: cannot be written", path.display()))?;
            }
            write(common, &report, &table)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn read_report(path: &Path) -> Result<Report> {
    let text = std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    serde_json::from_str(&text).with_context(|| format!("{}: no figures of this benchmark; write them with --json", path.display()))
}

fn write(common: &Common, report: &impl Serialize, table: &str) -> Result<()> {
    let json = || serde_json::to_string_pretty(report).context("JSON");
    match &common.json {
        Some(path) if path.as_os_str() == "-" => {
            eprint!("{table}");
            println!("{}", json()?);
        }
        Some(path) => {
            std::fs::write(path, json()? + "\n").with_context(|| format!("{}: cannot be written", path.display()))?;
            print!("{table}");
        }
        None => print!("{table}"),
    }
    Ok(())
}

fn threads(common: &Common) -> u32 {
    let set = || std::env::var(LAVAPIPE_THREADS).ok()?.parse().ok();
    let machine = || std::thread::available_parallelism().map_or(1, |count| u32::try_from(count.get()).unwrap_or(1));
    common.threads.or_else(set).unwrap_or_else(machine).max(1)
}

/// The rival, where it is installed and wanted, and the device.
fn open(common: &Common) -> Result<(Option<Embree>, Context)> {
    let embree = if common.no_embree { None } else { Embree::load(common.embree.as_deref(), threads(common))? };
    if embree.is_none() && !common.no_embree {
        eprintln!("gridwalk-bench: Embree is not installed (Debian: apt-get install libembree3-3 or libembree4-4): measuring without it");
    }
    let Ok(device) = common.device.parse();
    let context = Context::new(&ContextDesc { device, name: "gridwalk-bench", ..ContextDesc::default() })?;
    Ok((embree, context))
}

fn rival(embree: &Embree, trace_quality: &str) -> Rival {
    Rival {
        version: embree.version(),
        library: embree.path().display().to_string(),
        threads: embree.threads(),
        trace_quality: trace_quality.to_owned(),
    }
}

fn run(arguments: &Arguments) -> Result<Report> {
    let common = &arguments.common;
    let (embree, context) = open(common)?;
    let begin = Instant::now();
    let builder = GridBuilder::new(&context)?;
    let pipelines_ms = begin.elapsed().as_secs_f64() * 1e3;
    let (record_build_us, record_trace_us) = record::measure(&context, builder.tracer()?)?;
    let info = context.device_info();
    let mut report = Report {
        schema: 1,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        device: info.name.clone(),
        driver: format!("{} {}", info.driver_name, info.driver_info),
        device_is_cpu: context.is_cpu(),
        pipelines_ms,
        record_build_us,
        record_trace_us,
        embree: embree.as_ref().map(|embree| rival(embree, &format!("{:?}", arguments.embree_quality).to_lowercase())),
        runs: arguments.runs,
        scenes: Vec::new(),
    };
    let folders = scenes::folders(&common.folder);
    let default = ["bumpy:70000".to_owned()];
    let specs = if arguments.scenes.is_empty() { &default } else { arguments.scenes.as_slice() };
    for spec in specs {
        eprintln!("gridwalk-bench: {spec}");
        let loaded = scenes::load(spec, &folders, common.seed)?;
        report.scenes.push(measure::measure(&builder, embree.as_ref(), arguments, &loaded).with_context(|| spec.clone())?);
    }
    Ok(report)
}

fn run_dynamic(arguments: &Dynamic) -> Result<dynamic_report::Report> {
    let common = &arguments.common;
    let (embree, context) = open(common)?;
    let info = context.device_info();
    let mut report = dynamic_report::Report {
        schema: 1,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        device: info.name.clone(),
        driver: format!("{} {}", info.driver_name, info.driver_info),
        device_is_cpu: context.is_cpu(),
        embree: embree.as_ref().map(|embree| rival(embree, "low")),
        size: common.size.next_multiple_of(8),
        runs: arguments.runs,
        scenes: Vec::new(),
    };
    let folders = scenes::folders(&common.folder);
    let default = ["bumpy:70000".to_owned()];
    let specs = if arguments.scenes.is_empty() { &default } else { arguments.scenes.as_slice() };
    for spec in specs {
        let moving = moving::open(spec, &folders, common.seed).with_context(|| spec.clone())?;
        report.scenes.push(dynamic::measure(&context, embree.as_ref(), arguments, spec, moving).with_context(|| spec.clone())?);
    }
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(words: &[&str]) -> Arguments {
        Arguments::try_parse_from(["gridwalk-bench", "--size", "64", "--runs", "2"].iter().chain(words)).unwrap()
    }

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }

    #[test]
    fn a_small_run_makes_a_table_and_json() {
        for (words, has_rival) in
            [(&["bumpy:500", "soup:300", "--overlap", "exact"][..], None), (&["bumpy:300", "--no-embree"], Some(false))]
        {
            let report = run(&arguments(words)).unwrap();
            let has_rival = has_rival.unwrap_or(report.embree.is_some());
            assert_eq!(report.embree.is_some(), has_rival);
            let table = report.table(None);
            assert!(table.contains("rebuild") && table.contains("sort_scatter"), "{table}");
            assert!(!report.table(Some("sort_")).contains("overlap_count"));
            if let Some(picture) = plot::svg(&report) {
                assert_eq!(picture.matches("<rect x").count(), 6 * report.scenes.len(), "{picture}");
            }
            assert_eq!(plot::svg(&report).is_some(), has_rival);
            let changes = compare::changes(&report, &report);
            assert!(changes.contains("within the noise") && !changes.contains("slower"), "{changes}");
            let again: Report = serde_json::from_str(&serde_json::to_string(&report).unwrap()).unwrap();
            for scene in &again.scenes {
                assert!(scene.pairs > 0 && !scene.steps.is_empty());
                let kinds: Vec<&str> = scene.rays.iter().map(|rays| rays.kind.as_str()).collect();
                assert_eq!(kinds, ["camera", "shadow", "reflection", "diffuse", "any"]);
                for rays in &scene.rays {
                    assert!(rays.rays == 64 * 64 || matches!(rays.kind.as_str(), "shadow" | "reflection"));
                    assert!((1..=64 * 64).contains(&rays.rays));
                    assert!(rays.hits > 0, "{}: no {} ray hits", scene.scene, rays.kind);
                    assert_eq!(rays.difference.is_some(), has_rival);
                    // Two triangles that cross, or an edge seen edge-on, may be told differently.
                    assert!(
                        rays.difference.as_ref().is_none_or(|difference| difference.nearer + difference.farther <= 2),
                        "{}: {rays:?}",
                        scene.scene
                    );
                }
            }
        }
    }

    #[test]
    fn parts_that_are_not_asked_for_are_not_measured() {
        let report = run(&arguments(&["sphere:200", "--no-embree", "--only", "any"])).unwrap();
        assert!(report.scenes[0].rebuild.is_none() && report.scenes[0].rays.len() == 1);
    }
}
