//! The program, run as its users run it: what it writes where, and with which status it ends.

mod animate;
mod cast;
mod diff;
mod json;
mod lists;
mod output;
mod render;
mod usage;

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// The program, built once from the tree that is tested. `GRIDWALK_BIN` names another.
pub fn binary() -> &'static Path {
    static BINARY: OnceLock<PathBuf> = OnceLock::new();
    BINARY.get_or_init(|| {
        if let Some(path) = std::env::var_os("GRIDWALK_BIN") {
            return path.into();
        }
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.args(["build", "--quiet", "--locked", "--package", "gridwalk-cli", "--message-format", "json", "--manifest-path"]);
        command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml"));
        if std::env::current_exe().unwrap().components().any(|part| part.as_os_str() == "release") {
            command.arg("--release");
        }
        let output = command.stderr(Stdio::inherit()).output().unwrap();
        assert!(output.status.success(), "gridwalk-cli does not build: type cargo build -p gridwalk-cli");
        let messages = String::from_utf8(output.stdout).unwrap();
        let executable = messages
            .lines()
            .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
            .filter_map(|message| message["executable"].as_str().map(PathBuf::from))
            .next_back();
        executable.expect("cargo names the program that it built")
    })
}

/// What a run of the program did.
pub struct Run {
    pub status: i32,
    pub stdout: Vec<u8>,
    pub stderr: String,
    command: String,
}

impl Run {
    fn new(command: String, output: Output) -> Run {
        Run {
            status: output.status.code().unwrap_or_else(|| panic!("{command}: ended by {}", output.status)),
            stdout: output.stdout,
            stderr: String::from_utf8(output.stderr).unwrap(),
            command,
        }
    }

    #[track_caller]
    pub fn expect(self, status: i32) -> Run {
        assert_eq!(self.status, status, "{}\n{}", self.command, self.stderr);
        self
    }

    /// Ends with a status, says these words on standard error, and nothing on standard output.
    #[track_caller]
    pub fn fails(self, status: i32, words: &[&str]) -> Run {
        let run = self.expect(status);
        for word in words {
            assert!(run.stderr.contains(word), "{}\nexpected \"{word}\" in:\n{}", run.command, run.stderr);
        }
        assert!(run.stdout.is_empty(), "{}\nstandard output is for data", run.command);
        assert!(!run.stderr.contains("panicked"), "{}\n{}", run.command, run.stderr);
        run
    }

    pub fn text(&self) -> String {
        String::from_utf8(self.stdout.clone()).unwrap()
    }

    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        let text = self.text();
        assert!(text.ends_with('\n') && text.lines().count() == 1, "{}\none line of JSON, but got: {text}", self.command);
        serde_json::from_str(&text).unwrap()
    }
}

/// Runs the program in a folder, with the environment of the tests but for its own variables.
pub fn gridwalk<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>) -> Run {
    with_input(folder, arguments, &[])
}

pub fn with_input<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>, input: &[u8]) -> Run {
    let mut command = prepared(folder, arguments);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A program that does not read its input closes it; that is its right.
    let _ = child.stdin.take().unwrap().write_all(input);
    Run::new(format!("{command:?}"), child.wait_with_output().unwrap())
}

pub fn prepared<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(binary());
    command.current_dir(folder).env_remove("GRIDWALK_DEVICE").env_remove("NO_COLOR").args(arguments);
    command
}

/// Arguments as one types them; none here holds a blank.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// One triangle in the plane z = 0, corners (0, 0), (1, 0), (0, 1), and a second at z = -1 with corners (0, 0), (2, 0), (0, 2).
pub const TRIANGLES: &str = "o two\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 -1\nv 2 0 -1\nv 0 2 -1\nf 1 2 3\nf 4 5 6\n";

/// A folder with a small scene, `two.obj`.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("two.obj"), TRIANGLES).unwrap();
    folder
}

/// Names in a folder, sorted.
pub fn entries(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Width, height, colour type and pixels.
pub fn decode_png(bytes: &[u8]) -> (u32, u32, png::ColorType, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
    (info.width, info.height, info.color_type, pixels)
}

pub fn read_png(path: &Path) -> (u32, u32, png::ColorType, Vec<u8>) {
    decode_png(&std::fs::read(path).unwrap())
}
