//! A C program with a device of its own, compiled as C and as C++, against the static and the shared library.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use super::root;

/// The libraries, built once from the tree that is tested.
fn libraries() -> &'static [PathBuf; 2] {
    static LIBRARIES: OnceLock<[PathBuf; 2]> = OnceLock::new();
    LIBRARIES.get_or_init(|| {
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.args(["build", "--quiet", "--locked", "--package", "gridwalk-capi", "--message-format", "json", "--manifest-path"]);
        command.arg(root().join("Cargo.toml"));
        if std::env::current_exe().unwrap().components().any(|part| part.as_os_str() == "release") {
            command.arg("--release");
        }
        let output = command.stderr(Stdio::inherit()).output().unwrap();
        assert!(output.status.success(), "gridwalk-capi does not build: type cargo build -p gridwalk-capi");
        let messages = String::from_utf8(output.stdout).unwrap();
        let files: Vec<PathBuf> = messages
            .lines()
            .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
            .filter(|message| message["target"]["name"] == "gridwalk_capi")
            .filter_map(|message| message["filenames"].as_array().cloned())
            .flatten()
            .filter_map(|file| file.as_str().map(PathBuf::from))
            .collect();
        ["a", "so"].map(|wanted| {
            let found = files.iter().find(|file| file.extension().is_some_and(|extension| extension == wanted));
            found.unwrap_or_else(|| panic!("no .{wanted} among {files:?}")).clone()
        })
    })
}

/// Says what is missing to compile C, if anything is. `tools/test` installs it.
fn missing(compiler: &str) -> Option<String> {
    let Ok(version) = Command::new(compiler).arg("--version").output() else {
        return Some(format!("no {compiler} here"));
    };
    assert!(version.status.success(), "{compiler} --version failed");
    let language = if compiler == "c++" { "c++" } else { "c" };
    let mut probe = Command::new(compiler);
    probe.args(["-fsyntax-only", "-include", "vulkan/vulkan_core.h", "-x", language, "/dev/null"]);
    let found = probe.output().unwrap();
    (!found.status.success()).then(|| "no Vulkan headers here (apt-get install libvulkan-dev)".to_owned())
}

struct Program {
    path: PathBuf,
    _folder: tempfile::TempDir,
}

/// Compiles the program. `None`, said aloud, where that cannot be done.
fn compile(compiler: &str, arguments: &[&str], library: &Path) -> Option<Program> {
    if let Some(missing) = missing(compiler) {
        eprintln!("SKIPPED: {missing}");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace");
    let mut command = Command::new(compiler);
    command.args(arguments).args(["-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]).arg("-I").arg(root().join("crates/capi/include"));
    command.arg(root().join("tests/capi/trace.c")).arg("-o").arg(&path);
    if library.extension().is_some_and(|extension| extension == "so") {
        let home = library.parent().unwrap();
        command.args(["-x", "none"]).arg("-L").arg(home).arg("-lgridwalk_capi").arg(format!("-Wl,-rpath,{}", home.display()));
    } else {
        command.args(["-x", "none"]).arg(library);
    }
    command.args(["-lpthread", "-ldl", "-lm"]);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}\n{}", String::from_utf8_lossy(&output.stderr));
    Some(Program { path, _folder: folder })
}

fn run(program: &Program, arguments: &[&str]) -> Output {
    Command::new(&program.path).args(arguments).stdin(Stdio::null()).output().unwrap()
}

#[track_caller]
fn agrees(program: &Program) {
    let output = run(program, &[]);
    let (data, messages) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "the C program ended with {}\n{messages}", output.status);
    eprintln!("{}{messages}", data);
    assert!(data.contains("hits in 2 frames"), "{data}");
    let validation = std::env::var("GRIDWALK_VALIDATE").as_deref() != Ok("0") && !messages.contains("SKIPPED");
    assert_eq!(data.contains(", validated"), validation, "{data}{messages}");
}

#[test]
fn a_c_program_agrees_with_brute_force() {
    let Some(program) = compile("cc", &["-x", "c", "-std=c11"], &libraries()[0]) else { return };
    agrees(&program);
}

#[test]
fn the_same_as_cpp_with_the_shared_library() {
    let Some(program) = compile("c++", &["-x", "c++", "-std=c++17"], &libraries()[1]) else { return };
    agrees(&program);
}

/// The negative control: the program expects triangles where they are not.
#[test]
fn a_wrong_expectation_is_seen() {
    let Some(program) = compile("cc", &["-x", "c", "-std=c11"], &libraries()[1]) else { return };
    let output = run(&program, &["--wrong"]);
    let messages = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{messages}");
    assert!(messages.contains("distance: found") && messages.contains("comparisons"), "{messages}");
}

/// Symbols of a library, as `nm` lists them.
fn symbols(library: &Path, which: &str) -> Option<Vec<String>> {
    let Ok(output) = Command::new("nm").args(["--dynamic", which, "--format=just-symbols"]).arg(library).output() else {
        eprintln!("SKIPPED: no nm here (apt-get install binutils)");
        return None;
    };
    assert!(output.status.success(), "nm failed: {}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect())
}

/// The shared library gives what the header declares and nothing else, and needs no Vulkan loader.
#[test]
fn the_shared_library_has_the_functions_of_the_header_alone() {
    let library = &libraries()[1];
    let Some(mut given) = symbols(library, "--defined-only") else { return };
    given.sort();
    let header = std::fs::read_to_string(root().join("crates/capi/include/gridwalk.h")).unwrap();
    let code: String = header.split("*/").filter_map(|part| part.split("/*").next()).collect();
    let mut declared: Vec<String> = code
        .split('(')
        .filter_map(|before| before.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next())
        .filter(|word| word.starts_with("gridwalk_"))
        .map(str::to_owned)
        .collect();
    declared.sort();
    assert!(declared.iter().any(|name| name == "gridwalk_cmd_build"), "{declared:?}");
    assert_eq!(given, declared);
    let needed = symbols(library, "--undefined-only").unwrap();
    assert!(needed.iter().any(|name| name.starts_with("malloc")), "{needed:?}");
    assert_eq!(needed.iter().filter(|name| name.starts_with("vk")).count(), 0, "{needed:?}");
    let bytes = std::fs::read(library).unwrap();
    assert!(!bytes.windows(9).any(|window| window == b"libvulkan"), "the library names a Vulkan loader");
}
