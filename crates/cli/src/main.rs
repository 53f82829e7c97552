//! The program `gridwalk`.
#![forbid(unsafe_code)]

mod args;
mod commands;
mod exit;
mod interrupt;
mod messages;
mod npy;
mod output;
mod picture;
mod progress;
mod report;
mod scene;
mod session;
mod suggest;

use std::process::ExitCode;

use clap::Parser;

use args::low::{Cli, Command};
use exit::{Exit, Result};
use interrupt::Interrupt;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are results and go to standard output; if nobody reads them, nobody misses them.
            let _ = error.print();
            return if error.use_stderr() { Exit::Usage } else { Exit::Ok }.code().into();
        }
    };
    let exit = match messages::install(&cli.global).and_then(|()| run(cli)) {
        Ok(exit) => exit,
        Err(failure) => {
            tracing::error!("{}", sentence(&failure.error));
            failure.exit
        }
    };
    exit.code().into()
}

/// An error and its causes in one line. A cause that the sentence before already tells is not told again.
fn sentence(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .reduce(|said, cause| if said.contains(&cause) { said } else { format!("{said}: {cause}") })
        .unwrap_or_default()
}

fn run(cli: Cli) -> Result<Exit> {
    let interrupt = Interrupt::install();
    let quiet = cli.global.quiet;
    match cli.command {
        Command::Render(low) => commands::render::run(*low, quiet, &interrupt),
        Command::Animate(low) => commands::animate::run(*low, quiet, &interrupt),
        Command::Info(low) => commands::info::run(&low),
        Command::Devices(low) => commands::devices::run(low.json),
        Command::Cast(low) => commands::cast::run(*low, quiet, &interrupt),
        Command::Diff(low) => commands::diff::run(&low),
        Command::List(low) => commands::list::run(&low),
        Command::Completions(low) => commands::manual::completions(low.shell),
        Command::Man(low) => commands::manual::man(low.folder.as_deref()),
    }
}
