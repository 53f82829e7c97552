//! The crates as somebody else gets them: packed, unpacked, and built by a program that knows nothing of this workspace.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::repository::{metadata, root};

/// All in `crates/` are published, and nothing else.
fn published() -> Vec<serde_json::Value> {
    let metadata = metadata(&["--no-deps"]);
    let packages = metadata["packages"].as_array().unwrap().iter().filter(|package| package["publish"].is_null()).cloned();
    packages.collect()
}

fn name(package: &serde_json::Value) -> &str {
    package["name"].as_str().unwrap()
}

fn cargo(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // What the workspace needs has been fetched by the build of this test: nothing may be asked of a registry.
    command.arg("--offline").args(arguments).current_dir(folder);
    command
}

fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?} failed: {}\n{out}{err}", output.status);
    out.into_owned()
}

#[test]
fn what_is_published_says_what_it_is() {
    let packages = published();
    let folders: BTreeSet<_> = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let manifests: BTreeSet<_> =
        packages.iter().map(|package| Path::new(package["manifest_path"].as_str().unwrap()).parent().unwrap().to_owned()).collect();
    assert_eq!(manifests, folders, "crates/ holds what is published, and only crates/");
    for package in &packages {
        let name = name(package);
        for key in ["description", "license", "repository", "readme", "rust_version"] {
            assert!(package[key].as_str().is_some_and(|text| !text.is_empty()), "{name}: no {key}");
        }
        let count = |key: &str| package[key].as_array().unwrap().len();
        assert!((3..=5).contains(&count("keywords")), "{name}: {} keywords", count("keywords"));
        assert!((1..=5).contains(&count("categories")), "{name}: {} categories", count("categories"));
        let library = package["targets"].as_array().unwrap().iter().any(|target| target["kind"][0] != "bin");
        let targets = package["metadata"]["docs"]["rs"]["targets"].as_array().map_or(0, Vec::len);
        assert!(!library || targets >= 3, "{name}: docs.rs is not told the targets");
    }
}

#[test]
fn packages_hold_what_they_need_and_no_more() {
    for package in published() {
        let name = name(&package);
        let list = run(&mut cargo(&["package", "--list", "--allow-dirty", "--package", name], &root()));
        let files: BTreeSet<&str> = list.lines().collect();
        for file in ["Cargo.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE"] {
            assert!(files.contains(file), "{name}: no {file} in the package");
        }
        let made_by_cargo = [".cargo_vcs_info.json", "Cargo.lock", "Cargo.toml", "Cargo.toml.orig"];
        let folders = ["src/", "spirv/", "glsl/", "include/", "docs/"];
        for file in &files {
            let known = folders.iter().any(|folder| file.starts_with(folder))
                || made_by_cargo.contains(file)
                || file.starts_with("LICENSE-")
                || ["README.md", "cbindgen.toml", "build.rs"].contains(file);
            assert!(known, "{name}: {file} has no business in the package");
        }
    }
}

/// Packs crates and unpacks them into `folder`, which is emptied before.
fn unpack(names: &[&str], folder: &Path) -> Vec<PathBuf> {
    let _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder).unwrap();
    let mut pack = cargo(&["package", "--no-verify", "--allow-dirty", "--quiet", "--target-dir"], &root());
    pack.arg(folder);
    for name in names {
        pack.args(["--package", name]);
    }
    run(&mut pack);
    let version = env!("CARGO_PKG_VERSION");
    let unpacked = names.iter().map(|name| {
        run(Command::new("tar").arg("-xzf").arg(folder.join(format!("package/{name}-{version}.crate"))).arg("-C").arg(folder));
        folder.join(format!("{name}-{version}"))
    });
    unpacked.collect()
}

/// `tests/outside` on the packages, on a device of its own, under the validation layers with synchronization validation.
#[test]
fn an_outside_program_builds_and_traces() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside");
    let packages = unpack(&["gridwalk-core", "gridwalk"], &folder.join("packages"));
    let program = folder.join("program");
    fs::create_dir_all(program.join("src")).unwrap();
    for file in ["Cargo.toml", "src/main.rs"] {
        fs::copy(root().join("tests/outside").join(file), program.join(file)).unwrap();
    }
    // The versions that have been fetched; cargo drops what the program does not use.
    fs::copy(root().join("Cargo.lock"), program.join("Cargo.lock")).unwrap();
    let mut command = cargo(&["run", "--quiet", "--target-dir"], &program);
    command.arg(folder.join("target"));
    for (name, path) in ["gridwalk-core", "gridwalk"].iter().zip(&packages) {
        command.arg("--config").arg(format!("patch.crates-io.{name}.path={:?}", path.to_str().unwrap()));
    }
    if std::env::var("GRIDWALK_VALIDATE").map_or(true, |value| value != "0") {
        // A program without a messenger of its own: the layer writes to standard output.
        command.env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation");
        command.env("VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT");
    }
    assert_eq!(run(&mut command), "3201 rays through 3200 triangles: all as expected\n");
}
