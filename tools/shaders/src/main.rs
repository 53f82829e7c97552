//! Compiles the GLSL kernels to SPIR-V and writes the kernel tables: `cargo tool shaders`.
#![forbid(unsafe_code)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime};

use anyhow::Result;
use clap::Parser;
use gridwalk_shaders::generate::{self, Generated};
use gridwalk_shaders::{manifest, source};

/// Compiles the GLSL kernels to SPIR-V and writes SPIR-V, manifests, kernel tables and the public include into the crates.
#[derive(Parser)]
#[command(name = "cargo tool shaders")]
struct Arguments {
    /// Compile anew, write nothing, and fail if a committed file differs
    #[arg(long, conflicts_with = "watch")]
    check: bool,
    /// Compare hashes only, without compiling; fail if a committed file is stale
    #[arg(long, conflicts_with_all = ["check", "watch"])]
    check_hashes: bool,
    /// Go on, and compile again whenever a source changes
    #[arg(long)]
    watch: bool,
    /// Print a table of the kernels
    #[arg(long)]
    stats: bool,
    /// Only the kernels of this crate (gridwalk, render, bench, examples or tests); may be given again
    #[arg(long = "crate", value_name = "NAME")]
    only: Vec<String>,
    /// Root of the repository [default: found from the working folder]
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<bool> {
    let root = match &arguments.root {
        Some(root) => root.clone(),
        None => source::find_root(Path::new("."))?,
    };
    if arguments.check_hashes {
        let stale = manifest::stale(&root)?;
        return Ok(report_stale(&stale));
    }
    if !arguments.watch {
        return once(&root, arguments);
    }
    let mut seen = BTreeMap::new();
    loop {
        let mut now = times(&root.join("glsl"));
        for (_, folder) in source::OWNERS.iter().flat_map(|owner| owner.sources) {
            now.extend(times(&root.join(folder)));
        }
        if now != seen {
            seen = now;
            if let Err(error) = once(&root, arguments) {
                eprintln!("{error:#}");
            }
        }
        std::thread::sleep(Duration::from_millis(200));
    }
}

/// The files below a folder and when each was last changed.
fn times(folder: &Path) -> BTreeMap<PathBuf, Option<SystemTime>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            match entry.metadata() {
                Ok(metadata) if metadata.is_dir() => open.push(entry.path()),
                Ok(metadata) => {
                    found.insert(entry.path(), metadata.modified().ok());
                }
                Err(_) => {}
            }
        }
    }
    found
}

fn once(root: &Path, arguments: &Arguments) -> Result<bool> {
    let start = Instant::now();
    let all = generate::generate(root, &arguments.only)?;
    if arguments.stats {
        print_stats(&all);
    }
    let below = |path: &PathBuf| path.strip_prefix(root).unwrap_or(path).display().to_string();
    if arguments.check {
        let mut stale = Vec::new();
        for generated in &all {
            stale.extend(generated.stale(root)?.iter().map(below));
        }
        return Ok(report_stale(&stale));
    }
    let mut written = Vec::new();
    for generated in &all {
        written.extend(generated.write(root)?.iter().map(below));
    }
    for path in &written {
        eprintln!("wrote {path}");
    }
    let kernels: usize = all.iter().map(|generated| generated.kernels.len()).sum();
    eprintln!("{kernels} kernels, {} files changed, {:.1} s", written.len(), start.elapsed().as_secs_f32());
    Ok(true)
}

fn report_stale(stale: &[String]) -> bool {
    if stale.is_empty() {
        eprintln!("the generated files are up to date");
        return true;
    }
    for path in stale {
        eprintln!("stale: {path}");
    }
    eprintln!("{} generated files are stale; this mends it: {}", stale.len(), manifest::CURE);
    false
}

fn print_stats(all: &[Generated]) {
    println!("{:<28} {:<12} {:>7} {:>16} {:>5}  accesses (r, w)", "kernel", "kind", "words", "local size", "push");
    for (kernel, reflected) in all.iter().flat_map(|generated| &generated.kernels) {
        let accesses: Vec<String> = reflected
            .accesses
            .iter()
            .map(|(name, reads, writes)| format!("{name}:{}{}", if *reads { "r" } else { "" }, if *writes { "w" } else { "" }))
            .collect();
        println!(
            "{:<28} {:<12} {:>7} {:>16} {:>5}  {}",
            kernel.name,
            kernel.kind,
            reflected.words.len(),
            format!("{:?}", reflected.local_size),
            reflected.push.as_ref().map_or(0, |push| push.end),
            accesses.join(" ")
        );
    }
}
