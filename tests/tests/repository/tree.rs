//! Files: how large, where `unsafe` may stand, and whether what the README says to type is there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::divergence::{Token, tokens};
use super::root;

/// Committed files, below the root.
fn files() -> Vec<PathBuf> {
    let output = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output().unwrap();
    assert!(output.status.success(), "git ls-files failed: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let files: Vec<PathBuf> = text.split_terminator('\0').map(PathBuf::from).filter(|path| root().join(path).exists()).collect();
    assert!(!files.is_empty(), "no committed file found");
    files
}

#[test]
fn files_are_small() {
    for path in files() {
        let bytes = fs::metadata(root().join(&path)).unwrap().len();
        assert!(bytes < 3 << 20, "{} has {bytes} bytes; larger scenes are fetched: cargo tool scenes", path.display());
    }
}

/// Where `unsafe` may stand: the crates that call Vulkan or that C calls, their tests and examples, and the benchmark, which calls another
/// ray tracer.
const UNSAFE: [&str; 6] = ["crates/capi", "crates/gridwalk", "crates/render", "examples", "tests", "tools/bench"];

#[test]
fn unsafe_code_is_where_vulkan_is() {
    for path in files().into_iter().filter(|path| path.extension().is_some_and(|e| e == "rs")) {
        if UNSAFE.iter().any(|folder| path.starts_with(folder)) {
            continue;
        }
        let text = fs::read_to_string(root().join(&path)).unwrap();
        assert!(!tokens(&text).contains(&Token::Word("unsafe".to_owned())), "{} holds unsafe code", path.display());
    }
    for file in
        ["crates/core/src/lib.rs", "crates/scene/src/lib.rs", "crates/cli/src/main.rs", "tools/src/main.rs", "tools/shaders/src/lib.rs"]
    {
        let text = fs::read_to_string(root().join(file)).unwrap();
        assert!(text.contains("#![forbid(unsafe_code)]"), "{file} does not forbid unsafe code");
    }
}

/// Lines of the README within fenced blocks of shell commands.
fn commands(text: &str) -> Vec<String> {
    let mut inside = false;
    let mut found = Vec::new();
    for line in text.lines().map(str::trim) {
        if let Some(language) = line.strip_prefix("```") {
            inside = !inside && ["sh", "console", "bash"].contains(&language);
        } else if inside {
            found.push(line.trim_start_matches("$ ").to_owned());
        }
    }
    found
}

fn problem(root: &Path, command: &str) -> Option<String> {
    let mut words = command.split_whitespace();
    match words.next()? {
        program if program.starts_with("tools/") || program.starts_with("./tools/") || program.starts_with(".ci/") => {
            (!root.join(program).is_file()).then(|| format!("{program}: no such file"))
        }
        "cargo" if words.next() == Some("tool") => {
            let tool = words.next()?;
            let main = fs::read_to_string(root.join("tools/src/main.rs")).unwrap();
            let variant = tool[..1].to_uppercase() + &tool[1..];
            let known =
                main.lines().any(|line| line.trim_start().strip_prefix(&variant).is_some_and(|rest| rest.starts_with([' ', '(', ','])));
            (!known).then(|| format!("cargo tool {tool}: no such command"))
        }
        _ => None,
    }
}

#[test]
fn the_readme_names_commands_that_exist() {
    let root = root();
    let commands = commands(&fs::read_to_string(root.join("README.md")).expect("README.md"));
    let problems: Vec<String> = commands.iter().filter_map(|command| problem(&root, command)).collect();
    assert_eq!(problems, [""; 0], "README.md");
    for needed in ["tools/quickstart", "tools/test"] {
        assert!(commands.iter().any(|command| command.trim_start_matches("./").starts_with(needed)), "README.md does not name {needed}");
    }
}

#[test]
fn a_command_that_does_not_exist_would_be_seen() {
    let text = "```sh\n$ tools/nothing --fast\ncargo tool ci\ncargo tool fly\n```\n`tools/neither`\n```rust\ntools/rust\n```\n";
    let commands = commands(text);
    assert_eq!(commands, ["tools/nothing --fast", "cargo tool ci", "cargo tool fly"]);
    let problems: Vec<String> = commands.iter().filter_map(|command| problem(&root(), command)).collect();
    assert_eq!(problems, ["tools/nothing: no such file", "cargo tool fly: no such command"]);
}
