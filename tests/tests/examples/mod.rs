//! The examples, run as their readers run them: what they write, and that the validation layer has nothing to say about it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

struct Picture {
    width: u32,
    height: u32,
    data: Vec<u8>,
}

fn read_png(path: &Path) -> Picture {
    let file = fs::File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut data).unwrap();
    data.truncate(info.buffer_size());
    Picture { width: info.width, height: info.height, data }
}

/// Share of the values that differ visibly. Between drivers some of the random rays fall to either side of an edge.
fn difference(a: &Picture, b: &Picture) -> f64 {
    assert_eq!((a.width, a.height, a.data.len()), (b.width, b.height, b.data.len()));
    a.data.iter().zip(&b.data).filter(|(a, b)| a.abs_diff(**b) > 8).count() as f64 / a.data.len() as f64
}

const MOST_DIFFERENT: f64 = 0.02;

/// What the validation layer is told: to say on standard output which checks it makes, and what it finds wrong. The older layer's name of
/// the checks that are not made unasked, and the newer one's.
const LAYER_SETTINGS: &str = "\
    khronos_validation.report_flags = error,info\n\
    khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG\n\
    khronos_validation.log_filename = stdout\n\
    khronos_validation.enables = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT\n\
    khronos_validation.validate_sync = true\n";

/// Builds an example and runs it in an empty folder, under the validation layer: the loader puts it into the process from outside, as the
/// examples know nothing of it.
fn run(package: &str, kind: &str, name: &str, arguments: &[&Path]) -> TempDir {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut build = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    build.args(["build", "--quiet", "--locked", "--package", package, kind, name, "--message-format", "json"]).current_dir(&root);
    if std::env::current_exe().unwrap().components().any(|part| part.as_os_str() == "release") {
        build.arg("--release");
    }
    let built = build.stderr(Stdio::inherit()).output().unwrap();
    assert!(built.status.success(), "{name} does not build: type cargo build -p {package}");
    let messages = String::from_utf8(built.stdout).unwrap();
    let programs = messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let program = programs.filter_map(|message| message["executable"].as_str().map(PathBuf::from)).next_back().unwrap();

    let folder = tempfile::tempdir().unwrap();
    let validate = std::env::var("GRIDWALK_VALIDATE").map_or(true, |value| value != "0");
    let mut command = Command::new(&program);
    command.args(arguments).arg(folder.path()).current_dir(&root);
    if validate {
        fs::write(folder.path().join("vk_layer_settings.txt"), LAYER_SETTINGS).unwrap();
        command.env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation").env("VK_LAYER_SETTINGS_PATH", folder.path());
    }
    let output = command.output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{name} fails:\n{said}\n{stderr}");
    assert!(!said.contains("Error"), "the validation layer complains about {name}:\n{said}");
    // That it would be heard: it has said what it checks.
    let heard = said.contains("Validation Information") && said.to_lowercase().contains("synchronization");
    assert!(heard || !validate, "nothing is heard of the validation layer:\n{said}\n{stderr}");
    folder
}

/// Compares a picture with the blessed one of its name.
fn check(folder: &Path, file: &str, name: &str) -> Picture {
    let found = read_png(&folder.join(file));
    let (low, high) = (found.data.iter().min().unwrap(), found.data.iter().max().unwrap());
    assert!(high - low > 64, "{file} shows next to nothing: {low} to {high}");
    let blessed = Path::new(env!("CARGO_MANIFEST_DIR")).join("blessed/examples").join(format!("{name}.png"));
    if std::env::var("GRIDWALK_BLESS").is_ok_and(|value| value == "1") {
        fs::create_dir_all(blessed.parent().unwrap()).unwrap();
        fs::copy(folder.join(file), &blessed).unwrap();
    }
    let share = difference(&found, &read_png(&blessed));
    if share > MOST_DIFFERENT {
        let evidence = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
        fs::copy(folder.join(file), &evidence).unwrap();
        panic!(
            "{:.1} % of the values differ: compare {} with {}; if the new one is right: cargo tool bless examples::{name}",
            share * 100.0,
            evidence.display(),
            blessed.display()
        );
    }
    found
}

#[test]
fn embed() {
    let folder = run("gridwalk-examples", "--example", "embed", &[]);
    let first = check(folder.path(), "embed-0.png", "embed");
    let later = read_png(&folder.path().join("embed-2.png"));
    assert!(difference(&first, &later) > MOST_DIFFERENT, "nothing moves, or the comparison sees nothing");
    assert_eq!(first.data, read_png(&folder.path().join("embed-4.png")).data, "the same moment");
}

#[test]
fn bake() {
    let folder = run("gridwalk-examples", "--example", "bake", &[Path::new("scenes/teapot/teapot.obj")]);
    check(folder.path(), "bake.png", "bake");
    // What was written is read as what was meant.
    let scene = gridwalk_scene::load(&folder.path().join("bake.ply"), &gridwalk_scene::LoadOptions::default()).unwrap();
    let model =
        gridwalk_scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/teapot/teapot.obj"), &Default::default()).unwrap();
    let count = |scene: &gridwalk_scene::Scene| scene.meshes.iter().map(|mesh| mesh.indices.len()).sum::<usize>();
    assert_eq!(count(&scene), count(&model));
    let colours = &scene.meshes[0].colours;
    assert_eq!(colours.len(), scene.meshes[0].positions.len(), "a colour a vertex");
    let grey = |share: f32| colours.iter().filter(|colour| colour[0] == colour[1] && colour[0] <= share).count();
    assert!(grey(0.3) * 50 > colours.len() && grey(0.8) < colours.len(), "dark places and light ones");
}

#[test]
fn wgpu() {
    let folder = run("gridwalk-example-wgpu", "--bin", "example-wgpu", &[]);
    check(folder.path(), "wgpu.png", "wgpu");
}

/// An example is read whole.
#[test]
fn examples_are_short() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    for files in [&["embed.rs"][..], &["bake.rs"], &["wgpu/src/main.rs", "wgpu/src/passes.wgsl"]] {
        let lines: usize = files.iter().map(|file| fs::read_to_string(folder.join(file)).unwrap().lines().count()).sum();
        assert!(lines < 300, "{files:?}: {lines} lines");
    }
}
