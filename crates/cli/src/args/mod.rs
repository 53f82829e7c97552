//! The command line.

pub mod high;
pub mod low;
pub mod pattern;
mod values;
