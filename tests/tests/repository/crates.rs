//! The direction of imports, and the oldest Rust that everything builds with.

use std::collections::BTreeSet;
use std::process::Command;

use super::metadata;

/// What a crate of this workspace may import of it: the arrows of the architecture. `gridwalk-tests` may import anything.
const ALLOWED: [(&str, &[&str]); 10] = [
    ("gridwalk-core", &[]),
    ("gridwalk", &["gridwalk-core"]),
    ("gridwalk-scene", &["gridwalk-core"]),
    ("gridwalk-render", &["gridwalk", "gridwalk-scene"]),
    ("gridwalk-cli", &["gridwalk-render"]),
    ("gridwalk-capi", &["gridwalk"]),
    ("gridwalk-example-wgpu", &["gridwalk"]),
    ("gridwalk-shaders", &[]),
    // `cargo tool shaders` must run when a crate does not compile because its kernel table is stale.
    ("gridwalk-tools", &[]),
    ("gridwalk-bench", &["gridwalk", "gridwalk-render", "gridwalk-scene"]),
];

/// Every import within the workspace, but those for tests only.
fn edges() -> BTreeSet<(String, String)> {
    let metadata = metadata(&["--no-deps"]);
    let packages = metadata["packages"].as_array().unwrap();
    let members: BTreeSet<&str> = packages.iter().map(|package| package["name"].as_str().unwrap()).collect();
    let mut edges = BTreeSet::new();
    for package in packages {
        for dependency in package["dependencies"].as_array().unwrap() {
            let name = dependency["name"].as_str().unwrap();
            if members.contains(name) && dependency["kind"] != "dev" {
                edges.insert((package["name"].as_str().unwrap().to_owned(), name.to_owned()));
            }
        }
    }
    edges
}

fn forbidden(edges: &BTreeSet<(String, String)>) -> Vec<String> {
    let allowed =
        |from: &str, to: &str| from == "gridwalk-tests" || ALLOWED.iter().any(|(name, imports)| *name == from && imports.contains(&to));
    edges.iter().filter(|(from, to)| !allowed(from, to)).map(|(from, to)| format!("{from} imports {to}")).collect()
}

#[test]
fn imports_follow_the_architecture() {
    let edges = edges();
    assert_eq!(forbidden(&edges), [""; 0], "see ARCHITECTURE.md for which crate may import which");
    assert!(edges.contains(&("gridwalk".to_owned(), "gridwalk-core".to_owned())), "the test sees no imports at all");
}

#[test]
fn a_wrong_import_would_be_seen() {
    let mut edges = edges();
    edges.insert(("gridwalk".to_owned(), "gridwalk-scene".to_owned()));
    edges.insert(("gridwalk-scene".to_owned(), "gridwalk-cli".to_owned()));
    assert_eq!(forbidden(&edges), ["gridwalk imports gridwalk-scene", "gridwalk-scene imports gridwalk-cli"]);
}

/// An engine that takes the library takes little else.
#[test]
fn the_library_imports_few_crates() {
    let metadata = metadata(&["--no-deps"]);
    let library = metadata["packages"].as_array().unwrap().iter().find(|package| package["name"] == "gridwalk").unwrap();
    let allowed = ["ash", "bytemuck", "gridwalk-core", "thiserror"];
    for dependency in library["dependencies"].as_array().unwrap().iter().filter(|dependency| dependency["kind"].is_null()) {
        let name = dependency["name"].as_str().unwrap();
        assert!(allowed.contains(&name), "gridwalk imports {name}; the library is to import {allowed:?} only");
    }
}

fn version(text: &str) -> Vec<u32> {
    let mut parts: Vec<u32> = text.split('.').map(|part| part.parse().unwrap()).collect();
    parts.resize(3, 0);
    parts
}

#[test]
fn no_dependency_needs_a_newer_rust() {
    let rustc = Command::new("rustc").arg("-vV").output().unwrap();
    let host = String::from_utf8(rustc.stdout).unwrap();
    let host = host.lines().find_map(|line| line.strip_prefix("host: ")).unwrap().to_owned();
    let metadata = metadata(&["--filter-platform", &host]);
    let packages = metadata["packages"].as_array().unwrap();
    let ours = packages.iter().find(|package| package["name"] == "gridwalk").unwrap()["rust_version"].as_str().unwrap();
    for package in packages {
        if let Some(needed) = package["rust_version"].as_str() {
            assert!(
                version(needed) <= version(ours),
                "{} {} needs Rust {needed}, but the workspace promises {ours}: cargo update -p {} --precise OLDER",
                package["name"],
                package["version"],
                package["name"]
            );
        }
    }
    assert!(version("1.90.0") > version("1.88") && version("1.88") == version("1.88.0"));
}
