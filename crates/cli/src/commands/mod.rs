//! What the program does, a module a command.

pub mod animate;
pub mod cast;
pub mod devices;
pub mod diff;
pub mod info;
pub mod list;
pub mod manual;
pub mod render;
