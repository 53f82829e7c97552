//! The rules of the repository that a machine can check: which crate may import which, what a kernel may hold, what is generated and whether
//! it is fresh.

mod crates;
mod divergence;
mod glsl;
mod spirv;
mod tree;

use std::path::PathBuf;

/// The root of the repository.
fn root() -> PathBuf {
    gridwalk_shaders::source::find_root(env!("CARGO_MANIFEST_DIR").as_ref()).unwrap()
}
