//! `cargo tool shaders`: runs the shader tool, which has its own target folder.

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use anyhow::{Result, bail};

use crate::process::{self, Root};
use crate::slang;

/// Where the shader tool is built: shaderc takes minutes, so that its build outlives `cargo clean` of nothing else and is cached alone.
pub fn target(root: &Root) -> PathBuf {
    std::env::var_os("GRIDWALK_SHADERS_TARGET").map_or_else(|| root.join("target/shaders"), PathBuf::from)
}

/// A cargo command on the shader tool. Debug information of shaderc would be gigabytes.
pub fn cargo(root: &Root, subcommand: &str) -> Command {
    let mut command = Command::new("cargo");
    command.arg(subcommand).args(["--release", "--package", "gridwalk-shaders", "--features", "compile"]);
    command.args(["--config", "profile.release.debug=false", "--target-dir"]).arg(target(root)).current_dir(&**root);
    command
}

/// The command that runs the shader tool with the given options.
pub fn command(root: &Root, options: &[String]) -> Result<Command> {
    if !target(root).join("release/gridwalk-shaders").exists() {
        let missing: Vec<&str> = ["cmake", "python3", "c++"].into_iter().filter(|program| !process::installed(program)).collect();
        if !missing.is_empty() {
            bail!("building the GLSL compiler needs {}: apt-get install cmake python3 g++", missing.join(", "));
        }
        eprintln!("building the GLSL compiler (shaderc) into {}: some minutes, once", target(root).display());
    }
    let mut command = cargo(root, "run");
    command.args(["--quiet", "--", "--root"]).arg(&**root).args(options);
    Ok(command)
}

/// Runs the shader tool; and where the include was written, and a Slang compiler is here, compiles what includes it in Slang.
pub fn run(root: &Root, options: &[String]) -> Result<ExitCode> {
    let code = process::pass(&mut command(root, options)?)?;
    if code == ExitCode::SUCCESS && options.is_empty() && slang::is_here() {
        slang::write(root)?;
    }
    Ok(code)
}
