//! Where the GLSL lies, and what includes what.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// A crate that owns kernels.
#[derive(Debug)]
pub struct Owner {
    /// Its name in options and in [`HOST_TYPES`](crate::manifest::HOST_TYPES).
    pub name: &'static str,
    /// Folder of the crate, below the root.
    pub folder: &'static str,
    /// Kind of the kernels and the folder of their sources, below the root.
    pub sources: &'static [(&'static str, &'static str)],
    /// Module path, seen from the crate, of the types of its kernel table; `None` for a crate that has no such table.
    pub kernel_types: Option<&'static str>,
    /// The public include that the crate carries in one piece, below `glsl/`.
    pub public_include: Option<&'static str>,
}

/// All crates that own kernels.
pub const OWNERS: [Owner; 5] = [
    Owner {
        name: "gridwalk",
        folder: "crates/gridwalk",
        sources: &[("map", "glsl/map"), ("cooperative", "glsl/cooperative")],
        kernel_types: Some("gridwalk_core::kernel"),
        public_include: Some(PUBLIC_INCLUDE),
    },
    Owner {
        name: "render",
        folder: "crates/render",
        sources: &[("map", "glsl/render/map"), ("cooperative", "glsl/render/cooperative")],
        kernel_types: Some("gridwalk::kernel"),
        public_include: None,
    },
    Owner {
        name: "bench",
        folder: "tools/bench",
        sources: &[("map", "tools/bench/shaders")],
        kernel_types: Some("gridwalk::kernel"),
        public_include: None,
    },
    Owner { name: "examples", folder: "examples", sources: &[("map", "examples/shaders")], kernel_types: None, public_include: None },
    Owner { name: "tests", folder: "tests", sources: &[("map", "tests/shaders")], kernel_types: None, public_include: None },
];

/// The public include's name for those who use the library.
pub const PUBLIC_NAME: &str = "gridwalk.glsl";

/// Its source, below `glsl/`.
const PUBLIC_INCLUDE: &str = "shared/gridwalk.glsl";

/// The path below the root of what an `#include` names: names count from `glsl/`, and the public include is known by its bare name too, as
/// users have it.
pub fn include_path(name: &str) -> String {
    format!("glsl/{}", if name == PUBLIC_NAME { PUBLIC_INCLUDE } else { name })
}

impl Owner {
    /// The crate's folder.
    pub fn folder(&self, root: &Path) -> PathBuf {
        root.join(self.folder)
    }

    /// The crate's kernels, ordered by name. Two kernels of one name are an error.
    pub fn kernels(&self, root: &Path) -> Result<Vec<KernelSource>> {
        let mut kernels = Vec::new();
        for &(kind, folder) in self.sources {
            for path in files(&root.join(folder), "comp")? {
                let name = path.file_stem().and_then(|s| s.to_str()).with_context(|| format!("{}: not UTF-8", path.display()))?;
                if !name.starts_with(|c: char| c.is_ascii_lowercase())
                    || !name.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'_'))
                {
                    bail!("{}: a kernel's name is snake_case", path.display());
                }
                kernels.push(KernelSource { name: name.to_owned(), kind, path: format!("{folder}/{name}.comp") });
            }
        }
        kernels.sort_by(|a, b| a.name.cmp(&b.name));
        if let Some(pair) = kernels.windows(2).find(|pair| pair[0].name == pair[1].name) {
            bail!("two kernels of one name: {} and {}", pair[0].path, pair[1].path);
        }
        Ok(kernels)
    }
}

/// A kernel's source file.
#[derive(Debug, Clone)]
pub struct KernelSource {
    /// File name without its extension.
    pub name: String,
    /// `map` or `cooperative`, by the folder.
    pub kind: &'static str,
    /// Path below the root, with `/`.
    pub path: String,
}

/// The root of the repository: the nearest folder at or above `start` with both `glsl/` and `crates/`.
pub fn find_root(start: &Path) -> Result<PathBuf> {
    let start = start.canonicalize().with_context(|| format!("{}: cannot be opened", start.display()))?;
    start
        .ancestors()
        .find(|folder| folder.join("glsl").is_dir() && folder.join("crates").is_dir())
        .map(Path::to_owned)
        .with_context(|| format!("{}: not inside the repository (no folder with glsl/ and crates/ above)", start.display()))
}

/// Files directly in `folder` with the given extension, in order of name; none when there is no such folder.
pub fn files(folder: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("{}: cannot be listed", folder.display()))? {
        let path = entry.with_context(|| format!("{}: cannot be listed", folder.display()))?.path();
        if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Reads a text file below the root.
pub fn read(root: &Path, path: &str) -> Result<String> {
    fs::read_to_string(root.join(path)).with_context(|| format!("{path}: cannot be read"))
}

/// The name in an `#include "..."` line, if the line is one.
pub fn included(line: &str) -> Option<&str> {
    let rest = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("include")?.trim_start();
    rest.strip_prefix('"')?.split_once('"').map(|(name, _)| name)
}

/// A source file and everything that it includes, by path below the root. Conditions are not evaluated: an include that the preprocessor
/// would skip counts too.
pub fn closure(root: &Path, path: &str) -> Result<BTreeMap<String, String>> {
    let mut found = BTreeMap::new();
    let mut open = vec![path.to_owned()];
    while let Some(path) = open.pop() {
        if found.contains_key(&path) {
            continue;
        }
        let text = read(root, &path)?;
        for (index, line) in text.lines().enumerate() {
            if let Some(name) = included(line) {
                let target = include_path(name);
                if !root.join(&target).is_file() {
                    bail!("{path}:{}: no such include: {target} (names count from glsl/)", index + 1);
                }
                open.push(target);
            }
        }
        found.insert(path, text);
    }
    Ok(found)
}

/// Global names that the public include may use without its prefix: the types of its interface.
const PUBLIC_NAMES: [&str; 2] = ["Ray", "Hit"];

/// A source file with its includes in place, each at its first mention only. Every included file must have an include guard, since that is
/// what makes leaving out the later mentions sound. All global names get the prefix of the public ones, so that none is in the way of the
/// shader that includes the file.
pub fn in_one_piece(root: &Path, path: &str) -> Result<String> {
    let mut out = format!("// Made by `cargo tool shaders` from {path} and its includes: edit those.\n");
    let mut seen = vec![path.to_owned()];
    expand(root, path, &mut seen, &mut out)?;
    Ok(prefixed(&out))
}

/// Prefixes every global name that has no prefix, in code but not in comments.
fn prefixed(text: &str) -> String {
    let names: BTreeMap<&str, String> = global_names(text)
        .into_iter()
        .filter(|name| !name.to_ascii_lowercase().starts_with("gridwalk") && !PUBLIC_NAMES.contains(name))
        .map(|name| {
            let prefix = match name {
                _ if name.starts_with(char::is_lowercase) => "gridwalk_",
                _ if name.contains(char::is_lowercase) => "Gridwalk",
                _ => "GRIDWALK_",
            };
            (name, format!("{prefix}{name}"))
        })
        .collect();
    let mut out = String::with_capacity(text.len() + text.len() / 8);
    for line in text.lines() {
        let (code, comment) = line.split_at(line.find("//").unwrap_or(line.len()));
        for word in words(code) {
            out.push_str(names.get(word).map_or(word, String::as_str));
        }
        out.push_str(comment);
        out.push('\n');
    }
    out
}

/// A line as words and what stands between them.
pub(crate) fn words(line: &str) -> impl Iterator<Item = &str> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    line.split_inclusive(move |c| !is_word(c)).flat_map(move |piece| {
        let (word, sign) = piece.split_at(piece.trim_end_matches(|c| !is_word(c)).len());
        [word, sign]
    })
}

/// Names of functions, structures, buffers, constants and macros that a text declares outside of all braces, in the layout that the sources
/// keep: a declaration begins its line.
pub fn global_names(text: &str) -> Vec<&str> {
    let mut depth = 0_usize;
    let mut names = Vec::new();
    for line in text.lines() {
        let code = &line[..line.find("//").unwrap_or(line.len())];
        if depth == 0 && !code.starts_with(' ') {
            let parts: Vec<&str> = words(code).map(str::trim).filter(|word| !word.is_empty()).collect();
            let name = match parts.as_slice() {
                ["#", "define", name, ..] | ["struct", name, ..] | ["const", _, name, ..] => Some(*name),
                ["layout", ..] => parts.iter().position(|word| *word == "buffer").and_then(|at| parts.get(at + 1)).copied(),
                ["precise", _, name, "(", ..] | [_, name, "(", ..] if *name != "(" => Some(*name),
                _ => None,
            };
            names.extend(name);
        }
        depth = (depth + code.matches('{').count()).saturating_sub(code.matches('}').count());
    }
    names
}

fn expand(root: &Path, path: &str, seen: &mut Vec<String>, out: &mut String) -> Result<()> {
    let text = read(root, path)?;
    if !has_guard(&text) {
        bail!("{path}: needs an include guard (#ifndef NAME, #define NAME, ..., #endif)");
    }
    for line in text.lines() {
        match included(line) {
            Some(name) => {
                let target = include_path(name);
                if !seen.contains(&target) {
                    seen.push(target.clone());
                    expand(root, &target, seen, out)?;
                }
            }
            None if line.contains("GL_GOOGLE_include_directive") => {}
            None => {
                out.push_str(line);
                out.push('\n');
            }
        }
    }
    Ok(())
}

fn has_guard(text: &str) -> bool {
    let mut directives = text.lines().map(str::trim).filter(|line| line.starts_with('#'));
    let Some(name) = directives.next().and_then(|line| line.strip_prefix("#ifndef ")) else { return false };
    directives.next().and_then(|line| line.strip_prefix("#define ")).is_some_and(|defined| defined.trim() == name.trim())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn include_lines() {
        assert_eq!(included("  # include \"shared/a.glsl\" // why"), Some("shared/a.glsl"));
        assert_eq!(included("// #include \"shared/a.glsl\""), None);
        assert_eq!(included("#include <a>"), None);
    }

    #[test]
    fn names_get_a_prefix() {
        let text = "#ifndef A_GLSL\n#define A_GLSL\nconst float BEYOND = 1.0; // BEYOND stays here\nstruct Walk {\n    int walk;\n};\n\
                    layout(buffer_reference) readonly buffer Cells { uvec2 range[]; };\n\
                    void walk_on(inout Walk walk, Ray ray) { walk.walk = min(gridwalk_a(), int(BEYOND)); }\n#endif\n";
        let names = global_names(text);
        assert_eq!(names, ["A_GLSL", "BEYOND", "Walk", "Cells", "walk_on"]);
        let out = prefixed(text);
        assert!(out.contains("const float GRIDWALK_BEYOND = 1.0; // BEYOND stays here"), "{out}");
        assert!(
            out.contains(
                "void gridwalk_walk_on(inout GridwalkWalk walk, Ray ray) { walk.walk = min(gridwalk_a(), int(GRIDWALK_BEYOND)); }"
            )
        );
        assert!(out.contains("#ifndef GRIDWALK_A_GLSL\n") && out.contains("buffer GridwalkCells {"), "{out}");
    }

    #[test]
    fn guards() {
        assert!(has_guard("// text\n#ifndef A\n#define A\nint x;\n#endif\n"));
        assert!(!has_guard("#ifndef A\n#define B\n#endif\n"));
        assert!(!has_guard("int x;\n"));
    }
}
