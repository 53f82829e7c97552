//! `cargo tool bench`: rebuilds and rays of gridwalk, measured on the device, beside those of its rivals on this machine.
#![deny(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test that fails panics"))]

mod arguments;
mod bvh;
mod compare;
mod contender;
#[allow(unsafe_code, reason = "records commands")]
mod counters;
#[allow(unsafe_code, reason = "calls Vulkan's own ray tracing")]
mod driver;
mod dynamic;
mod dynamic_report;
#[allow(unsafe_code, reason = "calls a C library")]
mod embree;
mod growth;
mod host;
#[allow(dead_code, reason = "generated: kernels are taken by name")]
mod kernels;
mod measure;
mod moving;
mod ours;
#[allow(unsafe_code, reason = "makes pipelines")]
mod pipeline;
mod plot;
mod push;
mod rays;
#[allow(unsafe_code, reason = "records commands")]
mod record;
mod report;
mod rivals;
mod scenes;
#[allow(unsafe_code, reason = "records commands")]
mod stopwatch;
mod surface;
mod table;
mod traffic;
mod vector;

use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use clap::Parser;
use gridwalk_render::{Context, ContextDesc, GridBuilder};
use serde::{Deserialize, Serialize};

use crate::arguments::{Arguments, Common, Dynamic, Mode, Quality, Who};
use crate::report::{Report, SCHEMA, Setup};
use crate::rivals::Rivals;

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
            let mut report = run(&growth.sizes())?;
            // Of sizes, which are no scenes of a kind.
            report.means.clear();
            draw(growth.plot.as_deref(), || Some(plot::growth(&report.setup, &growth::series(&report))))?;
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
            draw(arguments.plot.as_deref(), || plot::bars(&report))?;
            write(common, &report, &table)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Writes a picture, if one is asked for.
fn draw(path: Option<&Path>, picture: impl FnOnce() -> Option<String>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let picture = picture().context("nothing to plot: no rival is there")?;
    std::fs::write(path, picture).with_context(|| format!("{}: cannot be written", path.display()))
}

fn read_report(path: &Path) -> Result<Report> {
    #[derive(Deserialize)]
    struct Schema {
        schema: u32,
    }
    let text = std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    if let Ok(Schema { schema }) = serde_json::from_str(&text)
        && schema != SCHEMA
    {
        bail!("{}: figures of schema {schema}, which is not {SCHEMA}: measure them anew", path.display());
    }
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

/// The device, the rivals, and what the report says of both.
fn open(common: &Common, quality: Quality, runs: u32) -> Result<(Context, Rivals, Setup)> {
    let Ok(device) = common.device.parse();
    let context =
        Context::new(&ContextDesc { device, name: "gridwalk-bench", ray_query: common.wants(Who::Driver).0, ..ContextDesc::default() })?;
    let rivals = Rivals::open(common, &context, threads(common), quality)?;
    let info = context.device_info();
    let setup = Setup {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        device: info.name.clone(),
        driver: format!("{} {}", info.driver_name, info.driver_info),
        device_is_cpu: context.is_cpu(),
        rivals: rivals.list(),
        size: common.size.next_multiple_of(8),
        runs,
    };
    Ok((context, rivals, setup))
}

fn run(arguments: &Arguments) -> Result<Report> {
    let common = &arguments.common;
    let (context, rivals, setup) = open(common, arguments.embree_quality, arguments.runs)?;
    let begin = Instant::now();
    let builder = GridBuilder::new(&context)?;
    let pipelines_ms = begin.elapsed().as_secs_f64() * 1e3;
    let (record_build_us, record_trace_us) = record::measure(&context, builder.tracer()?)?;
    let bandwidth_gb_s = counters::bandwidth(&context)?;
    let (scenes, means) = (Vec::new(), Vec::new());
    let mut report = Report { setup, pipelines_ms, record_build_us, record_trace_us, bandwidth_gb_s, scenes, means };
    let folders = scenes::folders(&common.folder);
    for spec in scenes::expand(&arguments.scenes) {
        eprintln!("gridwalk-bench: {spec}");
        let loaded = scenes::load(&spec, &folders, common.seed)?;
        report.scenes.push(measure::measure(&builder, &rivals, arguments, &loaded).with_context(|| spec.clone())?);
    }
    report.means = report::means(&report.setup, &report.scenes, &scenes::FIVE);
    Ok(report)
}

fn run_dynamic(arguments: &Dynamic) -> Result<dynamic_report::Report> {
    let common = &arguments.common;
    let (context, rivals, setup) = open(common, Quality::Medium, arguments.runs)?;
    let mut report = dynamic_report::Report { setup, scenes: Vec::new() };
    let folders = scenes::folders(&common.folder);
    let default = ["bumpy:70000".to_owned()];
    let specs = if arguments.scenes.is_empty() { &default } else { arguments.scenes.as_slice() };
    for spec in specs {
        let moving = moving::open(spec, &folders, common.seed).with_context(|| spec.clone())?;
        report.scenes.push(dynamic::measure(&context, &rivals, arguments, spec, moving).with_context(|| spec.clone())?);
    }
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

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
            [(&["bumpy:500", "soup:300", "stadium:400", "--overlap", "exact"][..], None), (&["bumpy:300", "--rivals", "none"], Some(false))]
        {
            let report = run(&arguments(words)).unwrap();
            let rivals = report.setup.rivals.len();
            assert!(has_rival.is_none_or(|has_rival| has_rival == (rivals > 0)));
            let table = report.table(None);
            assert!(table.contains("rebuild") && table.contains("sort_scatter"), "{table}");
            assert!(!report.table(Some("sort_")).contains("overlap_count"));
            assert_eq!(plot::bars(&report).is_some(), rivals > 0);
            if let Some(picture) = plot::bars(&report) {
                let objects = report.scenes.iter().filter(|scene| scene.scene.starts_with("stadium")).count();
                assert_eq!(picture.matches("<rect x").count(), rivals * (7 * report.scenes.len() + objects), "{picture}");
            }
            let changes = compare::changes(&report, &report);
            assert!(changes.contains("within the noise") && !changes.contains("slower"), "{changes}");
            let again: Report = serde_json::from_str(&serde_json::to_string(&report).unwrap()).unwrap();
            assert_eq!(again.means.len(), rivals * report.scenes.iter().map(|scene| scene.rays.len() + 2).max().unwrap());
            for scene in &again.scenes {
                assert!(scene.pairs > 0 && !scene.steps.is_empty());
                let mut wanted = vec!["rebuild", "frame", "camera", "shadow", "reflection", "diffuse", "any"];
                wanted.extend(scene.scene.starts_with("stadium").then_some("object"));
                assert_eq!(scene.figures().map(|(name, _)| name).collect::<Vec<_>>(), wanted);
                assert!(scene.figures().all(|(_, comparison)| comparison.rivals.len() == rivals && comparison.ours.median_ms > 0.0));
                let frame = scene.frame.as_ref().unwrap();
                assert!(frame.rivals.len() == rivals && frame.ours.kind_ms("camera") > 0.0 && frame.ours.kind_ms("shadow") > 0.0);
                for rays in &scene.rays {
                    assert!(rays.rays == 64 * 64 || matches!(rays.kind.as_str(), "shadow" | "reflection" | "object"));
                    assert!((1..=64 * 64).contains(&rays.rays));
                    assert!(rays.hits > 0, "{}: no {} ray hits", scene.scene, rays.kind);
                    assert_eq!((rays.alone.is_some(), rays.differences.len()), (rays.kind == "object", rivals));
                    // Two triangles that cross, or an edge seen edge-on, may be told differently.
                    assert!(
                        rays.differences.iter().all(|difference| difference.rays > 0 && difference.nearer + difference.farther <= 2),
                        "{}: {rays:?}",
                        scene.scene
                    );
                    // Whoever looks at the object sees it, whatever stands around it.
                    assert!(rays.kind != "object" || rays.hits == rays.rays);
                }
            }
        }
    }

    #[test]
    fn growth_has_slopes_and_a_picture() {
        let arguments = Arguments::try_parse_from(
            ["gridwalk-bench", "growth", "sphere", "--least", "100", "--most", "1000", "--size", "16", "--runs", "1"].iter(),
        );
        let Some(Mode::Growth(growth)) = arguments.unwrap().mode else { panic!("not growth") };
        let report = run(&growth.sizes()).unwrap();
        let series = growth::series(&report);
        assert_eq!(series.len(), 4);
        assert!(series.iter().all(|series| series.lines.len() == 1 + report.setup.rivals.len() && series.lines[0].1.len() == 3));
        let slopes = growth::slopes(&report);
        assert!(["rebuild, ms", "camera ray, ns", "diffuse ray, ns", "memory"].iter().all(|name| slopes.contains(name)), "{slopes}");
        let picture = plot::growth(&report.setup, &series);
        assert!(picture.starts_with("<svg") && picture.matches(">gridwalk<").count() == 4, "{picture}");
    }

    /// The names of all fields, at any depth.
    fn fields(value: &serde_json::Value, found: &mut BTreeSet<String>) {
        match value {
            serde_json::Value::Object(object) => object.iter().for_each(|(name, value)| {
                found.insert(name.clone());
                fields(value, found);
            }),
            serde_json::Value::Array(array) => array.iter().for_each(|value| fields(value, found)),
            _ => {}
        }
    }

    #[test]
    fn the_documentation_has_every_field_and_no_other() {
        let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/bench.md")).unwrap();
        let (_, table) = text.split_once("## JSON").unwrap();
        let names = table.lines().filter(|line| line.starts_with("| `")).filter_map(|line| line.split('|').nth(1));
        let documented: BTreeSet<String> =
            names.flat_map(|cell| cell.split(',')).map(|name| name.trim().trim_matches('`').to_owned()).collect();

        let mut found = BTreeSet::new();
        let rival = ["--rivals", "obvhs"];
        let report = run(&arguments(&[&["stadium:300"][..], &rival].concat())).unwrap();
        fields(&serde_json::to_value(&report).unwrap(), &mut found);
        let words = ["gridwalk-bench", "dynamic", "sphere:100", "--size", "16", "--runs", "1", "--frames", "1"];
        let Some(Mode::Dynamic(dynamic)) = Arguments::try_parse_from(words.iter().chain(&rival)).unwrap().mode else {
            panic!("not dynamic")
        };
        fields(&serde_json::to_value(run_dynamic(&dynamic).unwrap()).unwrap(), &mut found);
        // Of memory and differences, which may be none.
        let bytes = report::RivalBytes { rival: String::new(), bytes: 1 };
        fields(&serde_json::to_value(bytes).unwrap(), &mut found);
        let example = report::Example { ray: 0, origin: [0.0; 3], direction: [1.0; 3], ours: None, theirs: None };
        fields(&serde_json::to_value(example).unwrap(), &mut found);
        assert_eq!(documented, found);
    }

    #[test]
    fn a_committed_scene() {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/teapot/scene.toml");
        let report = run(&arguments(&[scene, "--only", "rebuild,frame,camera,shadow"])).unwrap();
        assert!(report.setup.rivals.iter().any(|rival| rival.name == "obvhs"));
        assert_eq!(report.means.len(), 4 * report.setup.rivals.len());
        for rays in &report.scenes[0].rays {
            assert_eq!(rays.differences.len(), report.setup.rivals.len());
            assert!(rays.differences.iter().all(|difference| difference.nearer + difference.farther <= 4), "{rays:?}");
        }
    }

    #[test]
    fn wrong_words_are_refused() {
        for (words, said) in [
            (&["--only", "rebuilds"][..], "rebuild"),
            (&["--rivals", "embre"], "embree"),
            (&["--runs", "0"], "1..=1000"),
            (&["--size", "7"], "8..=8192"),
            (&["--overlap", "sphere"], "exact"),
            (&["growth", "--most", "60000000"], "50000000"),
        ] {
            let error = Arguments::try_parse_from(["gridwalk-bench"].iter().chain(words)).unwrap_err().to_string();
            assert!(error.contains(said), "{words:?}: {error}");
        }
    }

    #[test]
    fn a_rival_that_is_named_must_be_there() {
        let error = run(&arguments(&["sphere:200", "--rivals", "embree", "--embree", "nowhere/libembree4.so"])).err().unwrap();
        assert!(format!("{error:#}").contains("nowhere/libembree4.so"), "{error:#}");
    }

    #[test]
    fn parts_that_are_not_asked_for_are_not_measured() {
        let report = run(&arguments(&["sphere:200", "--rivals", "none", "--only", "any"])).unwrap();
        assert_eq!(report.scenes[0].figures().map(|(name, _)| name).collect::<Vec<_>>(), ["any"]);
    }

    #[test]
    fn figures_of_another_schema_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let told = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            format!("{:#}", read_report(&path).err().unwrap())
        };
        assert!(told("old.json", "{\"schema\": 1, \"scenes\": []}").contains("schema 1"));
        assert!(told("other.json", "{}").contains("no figures of this benchmark"));
        assert!(format!("{:#}", read_report(Path::new("nowhere.json")).err().unwrap()).contains("cannot be read"));
    }
}
