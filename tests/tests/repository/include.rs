//! The public include as it is published: in one piece, alone, beside a shader's own names.

use std::path::Path;
use std::process::Command;

use gridwalk_shaders::source::{self, global_names};

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
    assert_eq!(source::in_one_piece(&super::root(), "glsl/shared/gridwalk.glsl").unwrap(), gridwalk::GRIDWALK_GLSL);
}

#[test]
fn the_path_leads_to_the_text() {
    let text = std::fs::read_to_string(Path::new(gridwalk::GRIDWALK_GLSL_PATH)).unwrap();
    assert_eq!(text, gridwalk::GRIDWALK_GLSL);
}

/// Compiles a shader; `None` without a compiler, else what it says if it fails.
fn compile(name: &str, text: &str) -> Option<Result<(), String>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("{name}.comp"));
    std::fs::write(&path, text).unwrap();
    let output =
        Command::new("glslangValidator").args(["--target-env", "vulkan1.2", "-o"]).arg(folder.path().join("out.spv")).arg(&path).output();
    let output = output.ok()?;
    Some(if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stdout).into_owned()) })
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
