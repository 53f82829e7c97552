//! `cargo tool bless`: what the tests make now, pictures or `gridwalk.h`, becomes what they compare with.

use std::process::{Command, ExitCode};

use anyhow::Result;

use crate::process::{self, Root};

/// Runs the image tests, or those of the filter, so that they write what they would compare with, and lists the files that changed.
pub fn run(root: &Root, filter: Option<&str>) -> Result<ExitCode> {
    let mut tests = Command::new("cargo");
    tests.args(["test", "--package", "gridwalk-tests", "--test", "tests", "--", filter.unwrap_or("image")]);
    process::run(tests.env("GRIDWALK_BLESS", "1").current_dir(&**root))?;
    let changed =
        process::output(Command::new("git").args(["status", "--porcelain", "--", "tests", "crates/capi/include"]).current_dir(&**root))?;
    let changed = String::from_utf8_lossy(&changed);
    if changed.is_empty() {
        eprintln!("no blessed file changed");
    } else {
        print!("{changed}");
        eprintln!("look at each before committing");
    }
    Ok(ExitCode::SUCCESS)
}
