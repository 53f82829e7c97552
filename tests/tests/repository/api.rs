//! The public interface of the library, as `cargo tool api` lists it.

use std::collections::BTreeSet;
use std::fs;

use super::root;

/// The crates that paths in a listing begin with. Labels of loops and lifetimes aside, every path there is written from its crate on.
fn crates(listing: &str) -> BTreeSet<&str> {
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = listing.split(|c: char| !word(c)).filter_map(|path| path.split_once("::"));
    words.map(|(first, _)| first).filter(|first| !first.is_empty()).collect()
}

/// An engine that takes the library takes ash, and no version of anything else; that `Ray`, `Hit` and `Report` can be cast to bytes by
/// bytemuck is a trait of theirs, not a type that anybody must name.
#[test]
fn no_type_of_another_crate_is_in_the_interface() {
    let mut seen = BTreeSet::new();
    for package in ["gridwalk", "gridwalk-core"] {
        let path = root().join(format!("docs/api/{package}.txt"));
        let listing = fs::read_to_string(&path).unwrap();
        for line in listing.lines().filter(|line| !line.starts_with("impl bytemuck::")) {
            for name in crates(line) {
                let allowed = ["gridwalk", "gridwalk_core", "ash", "core", "alloc", "std", "Self"];
                assert!(allowed.contains(&name), "{}: a type of {name}: {line}", path.display());
                seen.insert(name.to_owned());
            }
        }
    }
    assert!(seen.contains("ash") && seen.contains("gridwalk"), "{seen:?}");
    assert!(crates("pub fn gridwalk::f(&glam::f32::vec3::Vec3) -> gridwalk::Result<()>").contains("glam"), "it would not be seen");
}
