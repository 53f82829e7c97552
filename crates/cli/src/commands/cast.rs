//! `gridwalk cast`.
use crate::args::{high, low};
use crate::exit::{Exit, Result};
use crate::interrupt::Interrupt;

pub fn run(low: low::Cast, quiet: bool, _interrupt: &Interrupt) -> Result<Exit> {
    let _cast = high::Cast::new(low, quiet)?;
    Ok(Exit::Ok)
}
