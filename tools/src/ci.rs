//! `cargo tool ci`: what CI does, in its order.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use clap::Args;

use crate::api;
use crate::drivers::{self, Environment};
use crate::process::{self, Root};
use crate::shaders;
use crate::slang;

/// What `cargo tool ci` may be told.
#[derive(Args)]
pub struct Arguments {
    /// Only this step; may be given again
    #[arg(long, value_name = "STEP")]
    only: Vec<String>,
    /// Leave this step out; may be given again
    #[arg(long, value_name = "STEP")]
    skip: Vec<String>,
    /// Print the steps and do nothing
    #[arg(long)]
    list: bool,
}

struct Step {
    name: &'static str,
    about: &'static str,
    run: fn(&Root) -> Result<Outcome>,
}

enum Outcome {
    Passed,
    /// Could not be done here, and why; counts as passed, but is said.
    Skipped(String),
}

/// The full test suite comes last, so that its closing line is the last thing before the summary.
const STEPS: [Step; 15] = [
    Step { name: "format", about: "rustfmt has nothing to change", run: format },
    Step { name: "clippy", about: "no warning in any crate, test or tool", run: clippy },
    Step { name: "doc", about: "documentation builds without a warning", run: doc },
    Step { name: "shaders", about: "what is made from GLSL is as committed, compiled anew", run: check_shaders },
    Step { name: "clippy-shaders", about: "no warning in the shader tool", run: clippy_shaders },
    Step { name: "spirv-val", about: "every committed SPIR-V module is valid", run: spirv_val },
    Step { name: "slang", about: "the include in Slang compiles, to what is committed", run: check_slang },
    Step { name: "api", about: "the library's public interface is as kept in docs/api", run: check_api },
    Step { name: "package", about: "each crate packs", run: package },
    Step { name: "msrv", about: "the published crates compile with the oldest Rust that they promise", run: msrv },
    Step { name: "cross", about: "the program and the libraries compile for Windows and macOS", run: cross },
    Step { name: "matrix", about: "lavapipe's vector widths and thread counts: the tests pass on each", run: matrix },
    Step { name: "pictures", about: "the same: four pictures are equal bit for bit", run: pictures },
    Step { name: "swiftshader", about: "the same tests and pictures pass on SwiftShader, under a current layer", run: swiftshader },
    Step { name: "test", about: "the whole suite, under the validation layers", run: test },
];

/// What the matrix and the second driver run: everything that computes on the device, but not the whole suite.
/// The comparisons with CPU oracles over millions of rays run once, in the whole suite: most of their time is the oracle's.
const DEVICE_TESTS: [&str; 7] = ["kernels::", "rebuild::", "traverse::", "--skip", "traverse::real", "--skip", "traverse::watertight"];

/// Runs the steps; the first failure ends it.
pub fn run(root: &Root, arguments: &Arguments) -> Result<ExitCode> {
    if let Some(name) = arguments.only.iter().chain(&arguments.skip).find(|name| STEPS.iter().all(|step| step.name != **name)) {
        bail!("{name}: no such step; there are: {}", STEPS.map(|step| step.name).join(", "));
    }
    if arguments.list {
        for step in &STEPS {
            println!("{:<15} {}", step.name, step.about);
        }
        return Ok(ExitCode::SUCCESS);
    }
    let mut summary = String::new();
    let mut failed = false;
    for step in &STEPS {
        if (!arguments.only.is_empty() && !arguments.only.iter().any(|name| name == step.name))
            || arguments.skip.iter().any(|name| name == step.name)
        {
            continue;
        }
        eprintln!("==> {}: {}", step.name, step.about);
        let start = Instant::now();
        let result = (step.run)(root);
        let verdict = match &result {
            Ok(Outcome::Passed) => "passed".to_owned(),
            Ok(Outcome::Skipped(why)) => format!("SKIPPED: {why}"),
            Err(error) => format!("FAILED: {error:#}"),
        };
        summary += &format!("{:<15} {:>7}  {verdict}\n", step.name, seconds(start.elapsed()));
        if result.is_err() {
            failed = true;
            summary += &format!("again: cargo tool ci --only {}\n", step.name);
            break;
        }
    }
    eprint!("\n{summary}");
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

fn seconds(duration: Duration) -> String {
    format!("{:.1} s", duration.as_secs_f32())
}

fn cargo(root: &Root, arguments: &[&str]) -> Command {
    let mut command = Command::new("cargo");
    command.args(arguments).current_dir(&**root);
    command
}

fn passed(command: &mut Command) -> Result<Outcome> {
    process::run(command).map(|()| Outcome::Passed)
}

fn format(root: &Root) -> Result<Outcome> {
    passed(&mut cargo(root, &["fmt", "--all", "--check"]))
}

fn clippy(root: &Root) -> Result<Outcome> {
    passed(&mut cargo(root, &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))
}

fn doc(root: &Root) -> Result<Outcome> {
    passed(cargo(root, &["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}

fn check_shaders(root: &Root) -> Result<Outcome> {
    passed(&mut shaders::command(root, &["--check".to_owned()])?)
}

fn clippy_shaders(root: &Root) -> Result<Outcome> {
    passed(shaders::cargo(root, "clippy").args(["--all-targets", "--", "-D", "warnings"]))
}

fn spirv_val(root: &Root) -> Result<Outcome> {
    if !process::installed("spirv-val") {
        return Ok(Outcome::Skipped("spirv-val is not installed: apt-get install spirv-tools".to_owned()));
    }
    let mut count = 0;
    let mut owners = vec![root.join("examples"), root.join("tests"), root.join("tools/bench")];
    for owner in fs::read_dir(root.join("crates")).context("crates/: cannot be listed")? {
        owners.push(owner?.path());
    }
    for owner in owners {
        for module in fs::read_dir(owner.join("spirv")).into_iter().flatten() {
            let module = module?.path();
            if module.extension() == Some(OsStr::new("spv")) {
                process::run(Command::new("spirv-val").args(["--target-env", "vulkan1.2"]).arg(&module))?;
                count += 1;
            }
        }
    }
    if count == 0 {
        bail!("no SPIR-V found");
    }
    eprintln!("{count} modules are valid");
    Ok(Outcome::Passed)
}

fn check_slang(root: &Root) -> Result<Outcome> {
    match slang::compiler() {
        Ok(_) => slang::check(root).map(|()| Outcome::Passed),
        Err(error) => Ok(Outcome::Skipped(format!("a Slang compiler cannot be had here: {error:#}"))),
    }
}

fn check_api(root: &Root) -> Result<Outcome> {
    if !api::installed() {
        return Ok(Outcome::Skipped("cargo-public-api is not installed: cargo install --locked cargo-public-api".to_owned()));
    }
    api::check(root).map(|()| Outcome::Passed)
}

fn package(root: &Root) -> Result<Outcome> {
    // That the library builds from its packages is a test of the suite; building every crate so would take longer than all else here.
    let mut command = cargo(root, &["package", "--offline", "--allow-dirty", "--no-verify"]);
    // All in crates/ are published, and nothing else: a test sees to it.
    for folder in fs::read_dir(root.join("crates")).context("crates/: cannot be listed")? {
        command.arg("--package").arg(package_name(&folder?.path().join("Cargo.toml"))?);
    }
    passed(&mut command)
}

fn msrv(root: &Root) -> Result<Outcome> {
    let text = fs::read_to_string(root.join("Cargo.toml")).context("Cargo.toml: cannot be read")?;
    let version = text.lines().find_map(|line| line.strip_prefix("rust-version = \"")?.strip_suffix('"'));
    let toolchain = format!("+{}.0", version.context("Cargo.toml: no rust-version")?);
    if process::output(Command::new("cargo").args([&toolchain, "--version"])).is_err() {
        let why = format!("Rust {0} is not installed: rustup toolchain install {0} --profile minimal", &toolchain[1..]);
        return Ok(Outcome::Skipped(why));
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from).join("msrv");
    let mut command = cargo(root, &[&toolchain, "check", "--locked"]);
    for folder in fs::read_dir(root.join("crates")).context("crates/: cannot be listed")? {
        command.arg("--package").arg(package_name(&folder?.path().join("Cargo.toml"))?);
    }
    passed(command.arg("--target-dir").arg(target))
}

/// The name in a manifest.
fn package_name(manifest: &Path) -> Result<String> {
    let text = fs::read_to_string(manifest).with_context(|| format!("{}: cannot be read", manifest.display()))?;
    let name = text.lines().find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'));
    Ok(name.with_context(|| format!("{}: no name", manifest.display()))?.to_owned())
}

/// Systems that nothing here can run on: that all compiles is all that is known of them.
const TARGETS: [&str; 2] = ["x86_64-pc-windows-msvc", "aarch64-apple-darwin"];

/// What is meant to run there: all else follows from it, or is a tool of this repository.
const CROSS: [&str; 2] = ["gridwalk-cli", "gridwalk-capi"];

fn cross(root: &Root) -> Result<Outcome> {
    let sysroot = process::output(Command::new("rustc").args(["--print", "sysroot"]))?;
    let libraries = Path::new(String::from_utf8_lossy(&sysroot).trim()).join("lib/rustlib");
    let (here, missing): (Vec<&str>, Vec<&str>) = TARGETS.into_iter().partition(|target| libraries.join(target).join("lib").is_dir());
    for target in here {
        process::run(cargo(root, &["check", "--target", target]).args(CROSS.iter().flat_map(|name| ["--package", name])))?;
    }
    Ok(match missing[..] {
        [] => Outcome::Passed,
        _ => Outcome::Skipped(format!("no standard library of {0}: rustup target add {0}", missing.join(" "))),
    })
}

fn test(root: &Root) -> Result<Outcome> {
    // The suite's own output is what CI is read by: it goes where it would without this tool.
    let status = Command::new(root.join("tools/test")).current_dir(&**root).stdin(Stdio::null()).status();
    if !status.context("tools/test cannot be started")?.success() {
        bail!("tools/test failed");
    }
    Ok(Outcome::Passed)
}

/// The settings of lavapipe that change how kernels are run: subgroups of 4, 8 and 16, and one worker or two.
fn settings() -> impl Iterator<Item = Environment> {
    ["128", "256", "512"].into_iter().flat_map(|width| {
        ["1", "2"].map(|threads| vec![("LP_NATIVE_VECTOR_WIDTH", width.to_owned()), ("LP_NUM_THREADS", threads.to_owned())])
    })
}

fn describe(environment: &Environment) -> String {
    environment.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(" ")
}

/// Runs tests in an environment. Their output is shown only if they fail; that none ran is a failure.
fn device_tests(root: &Root, environment: &Environment, tests: &[&str]) -> Result<()> {
    let start = Instant::now();
    let mut command = cargo(root, &["test", "--quiet", "--workspace", "--test", "tests", "--"]);
    command.args(tests).envs(environment.iter().map(|(name, value)| (name, value))).stdin(Stdio::null());
    let output = command.output().context("cargo cannot be started")?;
    let text = String::from_utf8_lossy(&output.stdout);
    let closing = text.lines().find(|line| line.starts_with("test result:")).unwrap_or("no test result");
    if !output.status.success() || closing.contains(" 0 passed") || !closing.contains(" passed") {
        eprint!("{text}{}", String::from_utf8_lossy(&output.stderr));
        bail!("{} {}: {closing}", describe(environment), process::line(&command));
    }
    let counts = closing.trim_start_matches("test result: ok. ").split("; finished").next().unwrap_or_default();
    eprintln!("{}: {counts}, {}", describe(environment), seconds(start.elapsed()));
    Ok(())
}

fn matrix(root: &Root) -> Result<Outcome> {
    for mut environment in settings() {
        // The layers see the same calls whatever the setting: they are on in the whole suite and on the second driver.
        environment.push(("GRIDWALK_VALIDATE", "0".to_owned()));
        device_tests(root, &environment, &DEVICE_TESTS)?;
    }
    Ok(Outcome::Passed)
}

fn swiftshader(root: &Root) -> Result<Outcome> {
    let fetched = drivers::environment("swiftshader").and_then(|mut all| {
        all.extend(drivers::environment("validation")?);
        Ok(all)
    });
    match fetched {
        Ok(environment) => device_tests(root, &environment, &[&DEVICE_TESTS[..], &["render::images::"]].concat()).map(|()| Outcome::Passed),
        Err(error) => Ok(Outcome::Skipped(format!("SwiftShader cannot be had here: {error:#}"))),
    }
}

/// Renders four scenes with every setting and compares every layer with that of the first.
fn pictures(root: &Root) -> Result<Outcome> {
    process::run(&mut cargo(root, &["build", "--workspace", "--bin", "gridwalk"]))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let folder = target.join("ci-pictures");
    fs::create_dir_all(&folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
    let mut scenes: Vec<PathBuf> =
        fs::read_dir(root.join("scenes")).context("scenes/: cannot be listed")?.flatten().map(|e| e.path()).collect();
    scenes.retain(|scene| scene.join("scene.toml").is_file());
    scenes.sort();
    scenes.truncate(4);
    if scenes.is_empty() {
        bail!("scenes/: no scene");
    }
    let gridwalk = target.join("debug/gridwalk");
    let mut first: Vec<PathBuf> = Vec::new();
    for environment in settings() {
        for (index, scene) in scenes.iter().enumerate() {
            let picture = render(&gridwalk, scene, &folder, &environment)?;
            let Some(first) = first.get(index) else {
                first.push(picture);
                continue;
            };
            let mut diff = Command::new(&gridwalk);
            diff.args(["diff", "--quiet", "--metric", "max"]).arg(first).arg(&picture);
            process::run(&mut diff).with_context(|| format!("with {} the picture is another one", describe(&environment)))?;
        }
    }
    eprintln!("{} scenes, equal in all settings", scenes.len());
    Ok(Outcome::Passed)
}

/// Renders all layers of a scene, as the numbers that the device computed.
fn render(gridwalk: &Path, scene: &Path, folder: &Path, environment: &Environment) -> Result<PathBuf> {
    let settings: Vec<&str> = environment.iter().map(|(_, value)| value.as_str()).collect();
    let name = scene.file_name().unwrap_or_default().to_string_lossy();
    let picture = folder.join(format!("{name}-{}.exr", settings.join("-")));
    let mut command = Command::new(gridwalk);
    command.arg("render").arg(scene).args(["--quiet", "--size", "160x120", "--spp", "1", "--aov", "all", "-o"]).arg(&picture);
    process::run(command.envs(environment.iter().map(|(name, value)| (name, value))))?;
    Ok(picture)
}
