//! The program `gridwalk`.
#![forbid(unsafe_code)]
fn main() {}
