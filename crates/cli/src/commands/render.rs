//! `gridwalk render`.
use crate::args::{high, low};
use crate::exit::{Exit, Result};
use crate::interrupt::Interrupt;

pub fn run(low: low::Render, quiet: bool, _interrupt: &Interrupt) -> Result<Exit> {
    let _render = high::Render::new(low, quiet)?;
    Ok(Exit::Ok)
}
