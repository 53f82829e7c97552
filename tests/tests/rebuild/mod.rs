//! Grids that the device built: what must hold of every one of them.

mod again;
mod errors;
mod hostile;
pub mod invariants;
mod overflow;
mod plan;
pub mod records;
mod second_level;
