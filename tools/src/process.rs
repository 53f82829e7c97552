//! Running other programs, and writing folders that are either complete or absent.

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use anyhow::{Context, Result, bail};

/// The root of the repository.
#[derive(Debug)]
pub struct Root(PathBuf);

impl Root {
    /// The nearest folder at or above the working folder that holds `glsl/` and `crates/`.
    pub fn find() -> Result<Root> {
        let start = std::env::current_dir().context("the working folder is gone")?;
        let root = start.ancestors().find(|folder| folder.join("glsl").is_dir() && folder.join("crates").is_dir());
        Ok(Root(root.with_context(|| format!("{}: not inside the repository", start.display()))?.to_owned()))
    }
}

impl Deref for Root {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

/// Where fetched things are kept: `GRIDWALK_CACHE`, or `gridwalk` below `XDG_CACHE_HOME` or `~/.cache`.
pub fn cache() -> Result<PathBuf> {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = match (set("GRIDWALK_CACHE"), set("XDG_CACHE_HOME"), set("HOME")) {
        (Some(cache), _, _) => cache,
        (None, Some(base), _) => base.join("gridwalk"),
        (None, None, Some(home)) => home.join(".cache/gridwalk"),
        (None, None, None) => bail!("no cache folder: set GRIDWALK_CACHE"),
    };
    std::path::absolute(&cache).with_context(|| format!("{}: no usable folder", cache.display()))
}

/// Runs a program whose output is for people: all of it goes to stderr. Fails if the program does.
pub fn run(command: &mut Command) -> Result<()> {
    let status = command.stdin(Stdio::null()).stdout(std::io::stderr()).status().with_context(|| cannot_start(command))?;
    if !status.success() {
        bail!("{} failed: {status}", line(command));
    }
    Ok(())
}

/// Runs a program in place of this one, as far as output and exit code go.
pub fn pass(command: &mut Command) -> Result<ExitCode> {
    let status = command.status().with_context(|| cannot_start(command))?;
    Ok(match status.code() {
        Some(0) => ExitCode::SUCCESS,
        Some(code) => ExitCode::from(u8::try_from(code).unwrap_or(1)),
        None => ExitCode::FAILURE,
    })
}

/// Runs a program and gives its standard output.
pub fn output(command: &mut Command) -> Result<Vec<u8>> {
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output().with_context(|| cannot_start(command))?;
    if !output.status.success() {
        bail!("{} failed: {}", line(command), output.status);
    }
    Ok(output.stdout)
}

/// Whether a program can be found.
pub fn installed(program: &str) -> bool {
    std::env::var_os("PATH").is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join(program).is_file()))
}

fn cannot_start(command: &Command) -> String {
    format!("{} cannot be started; is it installed?", command.get_program().to_string_lossy())
}

/// A command as one would type it.
pub fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

/// Makes a folder by `fill`, which gets a temporary folder beside it: whoever sees the folder sees all of it. Does nothing if it is there.
pub fn complete(folder: &Path, fill: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    if folder.exists() {
        return Ok(());
    }
    let name = folder.file_name().context("a folder without a name")?.to_string_lossy();
    let partial = folder.with_file_name(format!(".{name}.{}", std::process::id()));
    fs::create_dir_all(&partial).with_context(|| format!("{}: cannot be made", partial.display()))?;
    let result = fill(&partial).and_then(|()| match fs::rename(&partial, folder) {
        Err(error) if !folder.exists() => Err(error).with_context(|| format!("{}: cannot be made", folder.display())),
        // Somebody else was quicker, with the same content.
        _ => Ok(()),
    });
    if partial.exists() {
        fs::remove_dir_all(&partial).with_context(|| format!("{}: cannot be removed", partial.display()))?;
    }
    result
}
