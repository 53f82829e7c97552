//! Completions and manual pages, made from the same definitions as the options themselves.

use std::io::Cursor;
use std::path::Path;

use clap::CommandFactory;
use gridwalk_render::image::Overwrite;

use crate::args::high::Target;
use crate::args::low::Cli;
use crate::exit::{Exit, Failure, Result};
use crate::output;

/// Prints the completions of a shell.
pub fn completions(shell: clap_complete::Shell) -> Result<Exit> {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "gridwalk", &mut bytes);
    output::print(&String::from_utf8_lossy(&bytes))?;
    Ok(Exit::Ok)
}

/// Prints the manual page, or writes one a command.
pub fn man(folder: Option<&Path>) -> Result<Exit> {
    let mut command = Cli::command();
    command.build();
    let Some(folder) = folder else {
        output::print(&page(&command)?)?;
        return Ok(Exit::Ok);
    };
    std::fs::create_dir_all(folder).map_err(|source| gridwalk_render::image::Error::write(folder, source))?;
    for command in std::iter::once(&command).chain(command.get_subcommands()) {
        // Built commands are called `gridwalk-render`, as their pages are.
        let name = command.get_display_name().unwrap_or(command.get_name());
        output::write(&Target::Path(folder.join(format!("{name}.1"))), Overwrite::Replace, page(command)?.as_bytes())?;
    }
    Ok(Exit::Ok)
}

fn page(command: &clap::Command) -> Result<String> {
    let mut bytes = Cursor::new(Vec::new());
    clap_mangen::Man::new(command.clone())
        .render(&mut bytes)
        .map_err(|error| Failure::new(Exit::Output, format!("cannot make the manual page: {error}")))?;
    Ok(String::from_utf8_lossy(bytes.get_ref()).into_owned())
}
