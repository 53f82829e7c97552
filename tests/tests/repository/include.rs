//! The public include as it is published: in one piece, alone, beside a shader's own names.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use gridwalk_shaders::source::{self, global_names};
use gridwalk_shaders::{manifest, published};

const HEAD: &str = "#version 460\n#extension GL_EXT_buffer_reference : require\n#extension GL_EXT_buffer_reference_uvec2 : require\n";

#[test]
fn every_global_name_has_the_prefix() {
    let names = global_names(gridwalk::GRIDWALK_GLSL);
    let known = ["gridwalk_closest_hit", "gridwalk_walk_step", "GridwalkGrid", "GRIDWALK_MISS", "Ray", "Hit"];
    assert!(known.iter().all(|name| names.contains(name)), "{names:?}");
    let strange: Vec<_> =
        names.iter().filter(|name| !name.to_ascii_lowercase().starts_with("gridwalk") && !["Ray", "Hit"].contains(name)).collect();
    assert!(strange.is_empty(), "{strange:?}");
}

/// The committed file is what the sources make, in one piece and prefixed.
#[test]
fn it_is_what_the_sources_make() {
    let (root, path) = (super::root(), source::include_path(source::PUBLIC_NAME));
    assert_eq!(published::glsl(&root, &path).unwrap(), gridwalk::GRIDWALK_GLSL);
    assert_eq!(published::slang(&root, &path).unwrap(), gridwalk::GRIDWALK_SLANG);
}

#[test]
fn the_path_leads_to_the_text() {
    let text = std::fs::read_to_string(Path::new(gridwalk::GRIDWALK_GLSL_PATH)).unwrap();
    assert_eq!(text, gridwalk::GRIDWALK_GLSL);
    let text = std::fs::read_to_string(Path::new(gridwalk::GRIDWALK_SLANG_PATH)).unwrap();
    assert_eq!(text, gridwalk::GRIDWALK_SLANG);
}

/// The tests' shaders in Slang were compiled from what lies here.
#[test]
fn what_is_made_of_slang_is_fresh() {
    let root = super::root();
    let text = std::fs::read_to_string(root.join("tests/slang/made-from.toml")).unwrap();
    let entries: Vec<(&str, &str)> = text.lines().filter_map(|line| line.split_once(" = ")).collect();
    assert!(entries.len() > 1, "{text}");
    for (path, hash) in entries {
        let bytes = std::fs::read(root.join(path.trim_matches('"'))).unwrap();
        assert_eq!(manifest::hash(&bytes), hash.trim_matches('"'), "{path} has changed since: cargo tool slang");
    }
}

/// Results of an instruction, and what it reads: words of a binary instruction after its type.
fn contractible(spirv: &[u8]) -> (usize, Vec<u32>) {
    let words: Vec<u32> = spirv.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect();
    let (mut exact, mut products, mut sums) = (BTreeSet::new(), BTreeSet::new(), Vec::new());
    let mut at = 5;
    while at < words.len() {
        let (length, opcode) = ((words[at] >> 16) as usize, words[at] & 0xFFFF);
        let operands = &words[at + 1..at + length];
        match opcode {
            71 if operands[1] == 42 => drop(exact.insert(operands[0])), // OpDecorate NoContraction
            133 | 142 => drop(products.insert(operands[1])),            // OpFMul, OpVectorTimesScalar
            129 | 131 => sums.push(operands.to_vec()),                  // OpFAdd, OpFSub
            _ => {}
        }
        at += length.max(1);
    }
    let count = products.len() + sums.len();
    let sums = sums.into_iter().filter(|sum| sum[2..].iter().any(|term| products.contains(term))).map(|sum| sum[1]);
    // A product that is contracted into a sum must allow it, and so must the sum.
    let free: Vec<u32> = products.iter().copied().chain(sums).filter(|result| !exact.contains(result)).collect();
    (count, free)
}

/// In a shader of the user's own, by a compiler that knows nothing of our rules.
#[test]
fn nothing_of_it_can_be_contracted() {
    let shader = |text: &str| {
        format!(
            "{HEAD}{text}layout(local_size_x = 1) in;\nlayout(push_constant, std430) uniform Push {{ GridwalkGrid grid; uvec2 other; }};\n\
            layout(buffer_reference, std430, buffer_reference_align = 16) buffer Out {{ Hit hit; }};\n\
            void main() {{ Out(other).hit = gridwalk_closest_hit_filtered(grid, Ray(vec3(0.0), 0.0, vec3(1.0), 1e30), 3u, 1u); }}\n"
        )
    };
    let Some(module) = module_of("exact", &shader(gridwalk::GRIDWALK_GLSL)) else {
        eprintln!("skipped: no glslangValidator");
        return;
    };
    let (count, free) = contractible(&module.unwrap());
    assert!(count > 80, "{count} products and sums");
    assert_eq!(free, [0; 0], "may be contracted");
    // A negative control: without the word.
    let (_, free) = contractible(&module_of("inexact", &shader(&gridwalk::GRIDWALK_GLSL.replace("precise ", ""))).unwrap().unwrap());
    assert!(free.len() > 40, "{}", free.len());
}

/// Compiles a shader; `None` without a compiler, else what it says if it fails.
fn compile(name: &str, text: &str) -> Option<Result<(), String>> {
    module_of(name, text).map(|result| result.map(drop))
}

/// The module itself.
fn module_of(name: &str, text: &str) -> Option<Result<Vec<u8>, String>> {
    let folder = tempfile::tempdir().unwrap();
    let (path, module) = (folder.path().join(format!("{name}.comp")), folder.path().join("out.spv"));
    std::fs::write(&path, text).unwrap();
    let output = Command::new("glslangValidator").args(["--target-env", "vulkan1.2", "-o"]).arg(&module).arg(&path).output().ok()?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    Some(if output.status.success() { Ok(std::fs::read(&module).unwrap()) } else { Err(said) })
}

/// A shader whose own names are those that the library's kernels have for what the include holds.
#[test]
fn it_compiles_beside_a_shaders_own_names() {
    let own = "struct Walk { int x; };\nstruct Cells { int x; };\nconst float BEYOND = 1.0;\n#define WALK_GLSL\n\
        float boundary(float x) { return x; }\nbool walk_step(Walk walk) { return walk.x > 0; }\n\
        bool is_finite(float x) { return x < BEYOND; }\nint select(int a) { return a; }\nvec3 permute(vec3 v) { return v.zyx; }\n";
    let main = "layout(local_size_x = 1) in;\nlayout(push_constant, std430) uniform Push { GridwalkGrid grid; uvec2 other; };\n\
        layout(buffer_reference, std430, buffer_reference_align = 4) buffer Out { float t; uvec2 geometry; };\n\
        void main() {\n    Ray ray = Ray(vec3(0.0), 0.0, vec3(1.0), 1e30);\n    Hit hit = gridwalk_closest_hit(grid, ray);\n\
        \x20   hit = gridwalk_is_hit(hit) ? hit : gridwalk_any_hit_filtered(grid, ray, 3u, GRIDWALK_CULL_BACK);\n\
        \x20   GridwalkCandidates all = gridwalk_candidates_filtered(grid, ray, 1u, 0u);\n\
        \x20   while (gridwalk_next(all)) { if (all.hit.u < 0.5) { gridwalk_commit(all); } else { gridwalk_terminate(all); } }\n\
        \x20   Out(other).t = boundary(hit.t) + gridwalk_committed(all).t;\n    Out(other).geometry = gridwalk_geometry(grid, hit.triangle);\n}\n";
    let shader = format!("{HEAD}{own}{}{main}", gridwalk::GRIDWALK_GLSL);
    let Some(result) = compile("beside", &shader) else {
        eprintln!("skipped: no glslangValidator");
        return;
    };
    assert_eq!(result, Ok(()));
    // Twice is once.
    let text = gridwalk::GRIDWALK_GLSL;
    assert_eq!(compile("twice", &format!("{HEAD}{own}{text}{text}{main}")), Some(Ok(())));
    // A negative control: a name of the include's.
    let clash = format!("{HEAD}{own}float gridwalk_boundary;\n{text}{main}");
    assert!(compile("clash", &clash).is_some_and(|result| result.is_err()));
}
