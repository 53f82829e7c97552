//! `cargo tool api`: the public interface of the library, listed by cargo-public-api and kept in docs/api/.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::process::{self, Root};

/// What is listed, and of which items. Of `gridwalk-core` only what `gridwalk` passes on is promised.
const LISTED: [(&str, &[&str]); 2] = [
    ("gridwalk", &["gridwalk"]),
    (
        "gridwalk-core",
        &[
            "gridwalk_core::geometry::GeometryRecord",
            "gridwalk_core::kernel::",
            "gridwalk_core::layout::Report",
            "gridwalk_core::ray::",
            "gridwalk_core::shape::Shape",
        ],
    ),
];

/// The path of what a line of a listing declares, or of the type that it implements something for.
fn item(line: &str) -> &str {
    let mut paths = line.split(|c: char| !(c.is_alphanumeric() || "_:".contains(c))).filter(|word| word.starts_with("gridwalk"));
    if line.starts_with("impl") { paths.next_back() } else { paths.next() }.unwrap_or_default().trim_end_matches(':')
}

/// Whether the listing can be made here.
pub fn installed() -> bool {
    process::installed("cargo-public-api")
}

fn file(root: &Root, package: &str) -> PathBuf {
    root.join(format!("docs/api/{package}.txt"))
}

/// What a package offers now. Blanket and auto traits are left out: they follow from the rest.
fn listing(root: &Root, package: &str, items: &[&str]) -> Result<String> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let mut command = Command::new("cargo");
    command.args(["public-api", "--package", package, "-ss", "--color", "never"]).current_dir(&**root);
    // The stable compiler writes what the tool reads if it is allowed to; a folder of its own, since everything else is built without that.
    command.env("RUSTC_BOOTSTRAP", "1").env("CARGO_TARGET_DIR", target.join("api"));
    let text = String::from_utf8(process::output(&mut command)?).context("cargo public-api: not UTF-8")?;
    let lines: String =
        text.lines().filter(|line| items.iter().any(|start| item(line).starts_with(start))).map(|line| format!("{line}\n")).collect();
    if lines.is_empty() {
        bail!("cargo public-api lists nothing of {package}");
    }
    Ok(lines)
}

/// Writes the listings.
pub fn write(root: &Root) -> Result<()> {
    if !installed() {
        bail!("cargo-public-api is not installed: cargo install --locked cargo-public-api");
    }
    for (package, items) in LISTED {
        let path = file(root, package);
        fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).with_context(|| format!("{}: cannot be made", path.display()))?;
        fs::write(&path, listing(root, package, items)?).with_context(|| format!("{}: cannot be written", path.display()))?;
    }
    Ok(())
}

/// Compares the listings with those that are kept.
pub fn check(root: &Root) -> Result<()> {
    for (package, items) in LISTED {
        let path = file(root, package);
        let kept = fs::read_to_string(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
        let found = listing(root, package, items)?;
        let gone = kept.lines().filter(|line| !found.lines().any(|other| other == *line)).map(|line| format!("-{line}\n"));
        let new = found.lines().filter(|line| !kept.lines().any(|other| other == *line)).map(|line| format!("+{line}\n"));
        let difference: String = gone.chain(new).collect();
        if !difference.is_empty() {
            bail!(
                "the public interface of {package} is not as kept:\n{difference}if that is meant: cargo tool api, a line in CHANGELOG.md, \
                 and where a line is gone a version that says so"
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::item;

    #[test]
    fn items_of_lines() {
        assert_eq!(item("pub gridwalk_core::ray::Ray::origin: [f32; 3]"), "gridwalk_core::ray::Ray::origin");
        assert_eq!(item("impl core::clone::Clone for gridwalk_core::ray::Ray"), "gridwalk_core::ray::Ray");
        assert_eq!(
            item("pub fn gridwalk_core::twin::any_hit::any_hit(&[gridwalk_core::ray::Ray])"),
            "gridwalk_core::twin::any_hit::any_hit"
        );
        assert_eq!(item("impl<'a> gridwalk::DeviceDesc<'a>"), "gridwalk::DeviceDesc");
        assert_eq!(item("pub fn f(ash::vk::Buffer)"), "");
    }
}
