//! The committed SPIR-V: fresh, valid, and within what the target devices have.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gridwalk_shaders::manifest;
use gridwalk_shaders::source::{self, OWNERS};

use super::root;

/// Every committed module: path, kind of the kernel, words.
fn modules() -> Vec<(PathBuf, &'static str, Vec<u32>)> {
    let root = root();
    let mut all = Vec::new();
    for owner in &OWNERS {
        for kernel in owner.kernels(&root).unwrap() {
            let path = owner.folder(&root).join("spirv").join(format!("{}.spv", kernel.name));
            let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}: {}", path.display(), manifest::CURE));
            let words = bytes.chunks(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect();
            all.push((path, kernel.kind, words));
        }
    }
    assert!(!all.is_empty(), "no SPIR-V found");
    all
}

/// The instructions of a module: opcode and operands.
fn instructions(words: &[u32]) -> Vec<(u32, &[u32])> {
    assert_eq!(words[0], 0x0723_0203, "no SPIR-V");
    let mut rest = &words[5..];
    let mut all = Vec::new();
    while let Some(&first) = rest.first() {
        let (instruction, after) = rest.split_at((first >> 16) as usize);
        all.push((first & 0xFFFF, &instruction[1..]));
        rest = after;
    }
    all
}

#[test]
fn what_is_generated_is_fresh() {
    let stale = manifest::stale(&root()).unwrap();
    assert!(stale.is_empty(), "stale:\n  {}\nThis mends it: {}", stale.join("\n  "), manifest::CURE);
}

/// Copies what the freshness of the kernels depends on.
fn copy_of_sources() -> tempfile::TempDir {
    let copy = tempfile::tempdir().unwrap();
    let root = root();
    let mut open = vec![PathBuf::from("glsl")];
    for owner in &OWNERS {
        open.extend(["spirv", "src", "glsl"].map(|name| Path::new(owner.folder).join(name)));
        open.extend(owner.sources.iter().map(|(_, folder)| PathBuf::from(folder)));
    }
    while let Some(folder) = open.pop() {
        fs::create_dir_all(copy.path().join(&folder)).unwrap();
        for entry in fs::read_dir(root.join(&folder)).into_iter().flatten() {
            let entry = entry.unwrap();
            let path = folder.join(entry.file_name());
            if entry.file_type().unwrap().is_dir() {
                open.push(path);
            } else {
                fs::copy(entry.path(), copy.path().join(path)).unwrap();
            }
        }
    }
    fs::copy(root.join("Cargo.lock"), copy.path().join("Cargo.lock")).unwrap();
    copy
}

#[test]
fn what_is_stale_would_be_seen() {
    let root = root();
    let before = manifest::stale(&root).unwrap();
    let stale_after = |change: &dyn Fn(&Path)| {
        let copy = copy_of_sources();
        assert_eq!(manifest::stale(copy.path()).unwrap(), before);
        change(copy.path());
        manifest::stale(copy.path()).unwrap().len() > before.len()
    };
    let kernel = OWNERS[0].kernels(&root).unwrap().remove(0);
    let include = source::closure(&root, &kernel.path).unwrap().into_keys().find(|path| path.ends_with(".glsl")).unwrap();
    let append = |path: PathBuf| fs::write(&path, [fs::read(&path).unwrap(), b"\n".to_vec()].concat()).unwrap();
    assert!(stale_after(&|copy| append(copy.join(&kernel.path))), "a changed kernel");
    assert!(stale_after(&|copy| append(copy.join(&include))), "a changed include");
    assert!(stale_after(&|copy| append(copy.join("crates/gridwalk/src/kernels.rs"))), "an edited table");
    assert!(stale_after(&|copy| append(copy.join(format!("crates/gridwalk/spirv/{}.spv", kernel.name)))), "an edited module");
    assert!(
        stale_after(&|copy| fs::remove_file(copy.join(format!("crates/gridwalk/spirv/{}.spv", kernel.name))).unwrap()),
        "a lost module"
    );
    assert!(stale_after(&|copy| fs::write(copy.join("glsl/map/new_kernel.comp"), "").unwrap()), "a new kernel");
    assert!(stale_after(&|copy| fs::write(copy.join("crates/gridwalk/spirv/old.spv"), "").unwrap()), "an orphan");
}

/// What the benchmark's rival asks for: it is made where the device offers it alone.
const RAY_QUERY: u32 = 4472;

/// Capabilities that every device of the target has. SwiftShader has no 64-bit integers, no device that we know lacks these.
const CAPABILITIES: [u32; 5] = [
    1,    // Shader
    61,   // GroupNonUniform
    63,   // GroupNonUniformArithmetic
    64,   // GroupNonUniformBallot
    5347, // PhysicalStorageBufferAddresses
];

#[test]
fn modules_ask_for_no_rare_capability() {
    for (path, _, words) in modules() {
        let instructions = instructions(&words);
        for (_, operands) in instructions.iter().filter(|(op, _)| *op == 17) {
            let is_rival = operands[0] == RAY_QUERY && path.ends_with("tools/bench/spirv/ray_query.spv");
            assert!(CAPABILITIES.contains(&operands[0]) || is_rival, "{}: declares capability {}", path.display(), operands[0]);
        }
        assert!(words[1] <= 0x0001_0500, "{}: SPIR-V {:#x}, and Vulkan 1.2 takes 1.5", path.display(), words[1]);
        // LocalSizeId would need maintenance4.
        assert!(!instructions.iter().any(|(op, operands)| *op == 331 && operands[1] == 38), "{}: declares LocalSizeId", path.display());
    }
}

#[test]
fn map_modules_exchange_nothing() {
    let mut seen_in_cooperative = false;
    for (path, kind, words) in modules() {
        let exchanges = instructions(&words).iter().any(|(op, operands)| match op {
            224 | 225 | 227..=242 | 333..=366 => true, // barriers, atomics, subgroup operations
            59 => operands[2] == 4,                    // a variable in a workgroup's memory
            _ => false,
        });
        assert!(kind != "map" || !exchanges, "{}: a map kernel that exchanges data", path.display());
        seen_in_cooperative |= kind == "cooperative" && exchanges;
    }
    assert!(seen_in_cooperative, "the test sees no exchange at all");
}

/// Operations whose result is float arithmetic: negation, sum, difference, product, quotient, remainders, products of vectors and matrices.
const ARITHMETIC: [u32; 14] = [127, 129, 131, 133, 136, 140, 141, 142, 143, 144, 145, 146, 147, 148];

#[test]
fn float_arithmetic_is_never_contracted() {
    let mut operations = 0;
    for (path, _, words) in modules() {
        let instructions = instructions(&words);
        let exact: BTreeSet<u32> =
            instructions.iter().filter(|(op, operands)| *op == 71 && operands[1] == 42).map(|(_, operands)| operands[0]).collect();
        for (op, operands) in instructions.iter().filter(|(op, _)| ARITHMETIC.contains(op)) {
            assert!(exact.contains(&operands[1]), "{}: operation {op} may be contracted", path.display());
            operations += 1;
        }
    }
    assert!(operations > 0, "the test sees no arithmetic at all");
}

#[test]
fn the_validator_accepts_every_module() {
    if Command::new("spirv-val").arg("--version").output().is_err() {
        eprintln!("SKIPPED: spirv-val is not installed (apt-get install spirv-tools)");
        return;
    }
    let validate = |path: &Path| Command::new("spirv-val").args(["--target-env", "vulkan1.2"]).arg(path).output().unwrap();
    for (path, _, _) in modules() {
        let output = validate(&path);
        assert!(output.status.success(), "{}: {}", path.display(), String::from_utf8_lossy(&output.stderr));
    }
    let broken = tempfile::NamedTempFile::new().unwrap();
    let (_, _, mut words) = modules().remove(0);
    words.truncate(words.len() - 1);
    fs::write(broken.path(), words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>()).unwrap();
    assert!(!validate(broken.path()).status.success(), "the validator accepts a broken module");
}

/// A specialization constant that nobody sets keeps its default without a word, as one does whose name was changed in the shader.
#[test]
fn every_specialization_constant_is_set() {
    let of_launches = ["CONTINUE", "LAST", "RESUME", "COUNT", "EXTRAS", "EXACT", "BLEND"];
    let is_set = |name: &str| of_launches.contains(&name) || gridwalk::Shape::CPU.constant(name).is_some();
    let mut seen = 0;
    for kernel in gridwalk::kernels::ALL.iter().chain(gridwalk_render::kernels::ALL) {
        for (_, name, _) in kernel.spec_constants {
            assert!(is_set(name), "{}: nobody sets {name}", kernel.name);
            seen += 1;
        }
    }
    assert!(seen > 0 && !is_set("LOADS_AHEAD"));
}
