//! Results on their way out.

use std::io::{self, Write};
use std::path::Path;

use gridwalk_render::image::{Overwrite, write_file};

use crate::args::high::Target;
use crate::exit::{Exit, Failure, Result};

/// Writes bytes whole or not at all.
pub fn write(target: &Target, overwrite: Overwrite, bytes: &[u8]) -> Result<()> {
    match target {
        Target::Stdout => {
            let mut stdout = io::stdout().lock();
            stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(|error| stdout_failure(&error))
        }
        Target::Path(path) => Ok(write_file(path, overwrite, |writer| {
            writer.write_all(bytes).map_err(|source| gridwalk_render::image::Error::write(path, source))
        })?),
    }
}

/// Prints text that is the command's result. A reader that has had enough (`| head`) is no error.
pub fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(stdout_failure(&error)),
        _ => Ok(()),
    }
}

/// Prints a JSON object on a line of its own.
pub fn print_json(value: &impl serde::Serialize) -> Result<()> {
    let mut text = serde_json::to_string(value).map_err(|error| Failure { exit: Exit::Output, error: error.into() })?;
    text.push('\n');
    print(&text)
}

fn stdout_failure(error: &io::Error) -> Failure {
    Failure::new(Exit::Output, format!("cannot write to standard output: {error}"))
}

/// Looks at the folder of a result before hours of work, not after.
pub fn check(target: &Target, overwrite: Overwrite) -> Result<()> {
    let Target::Path(path) = target else { return Ok(()) };
    let failed = |kind: io::ErrorKind| Err(gridwalk_render::image::Error::write(path, kind.into()).into());
    if overwrite == Overwrite::Refuse && path.exists() {
        return Err(gridwalk_render::image::Error::Exists { path: path.clone() }.into());
    }
    if path.is_dir() {
        return failed(io::ErrorKind::IsADirectory);
    }
    match path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")) {
        folder if folder.is_dir() => Ok(()),
        folder if folder.exists() => failed(io::ErrorKind::NotADirectory),
        _ => failed(io::ErrorKind::NotFound),
    }
}
