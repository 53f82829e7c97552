//! The rules of the repository that a machine can check: which crate may import which, what a kernel may hold, what is generated and whether
//! it is fresh.

mod api;
mod crates;
mod divergence;
mod glsl;
mod include;
mod spirv;
mod tree;

use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

/// The root of the repository.
pub fn root() -> PathBuf {
    gridwalk_shaders::source::find_root(env!("CARGO_MANIFEST_DIR").as_ref()).unwrap()
}

/// What cargo knows of the workspace.
pub fn metadata(arguments: &[&str]) -> Value {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--locked", "--format-version", "1", "--manifest-path"])
        .arg(root().join("Cargo.toml"))
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "cargo metadata failed:\n{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}
