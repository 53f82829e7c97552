//! The command line.

pub mod high;
pub mod low;
mod values;
