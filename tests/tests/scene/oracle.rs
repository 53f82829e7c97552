//! A second opinion on clean files: `tobj` reads the same triangles in the same order.

use std::fmt::Write as _;
use std::path::Path;

use gridwalk_scene::generate::Random;
use gridwalk_scene::{LoadOptions, Mesh, load, load_reader};

/// Position, texture coordinates and normal.
type Corner = ([f32; 3], Option<[f32; 2]>, Option<[f32; 3]>);

fn tobj_triangles(mut text: &[u8]) -> Vec<[Corner; 3]> {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ignore_lines: true, ignore_points: true };
    let (models, _) = tobj::load_obj_buf(&mut text, &options, |_| Err(tobj::LoadError::OpenFileFailed)).unwrap();
    let mut triangles = Vec::new();
    for model in models {
        let mesh = model.mesh;
        for triangle in mesh.indices.chunks_exact(3) {
            triangles.push([0, 1, 2].map(|at| {
                let at = triangle[at] as usize;
                let position = [0, 1, 2].map(|axis| mesh.positions[3 * at + axis]);
                let uv = (!mesh.texcoords.is_empty()).then(|| [0, 1].map(|axis| mesh.texcoords[2 * at + axis]));
                let normal = (!mesh.normals.is_empty()).then(|| [0, 1, 2].map(|axis| mesh.normals[3 * at + axis]));
                (position, uv, normal)
            }));
        }
    }
    triangles
}

/// The first triangle that differs.
fn difference(mesh: &Mesh, expected: &[[Corner; 3]]) -> Option<usize> {
    if mesh.indices.len() != expected.len() {
        return Some(mesh.indices.len().min(expected.len()));
    }
    mesh.indices.iter().zip(expected).position(|(triangle, expected)| {
        triangle.iter().zip(expected).any(|(&at, (position, uv, normal))| {
            let at = at as usize;
            let length = |normal: &[f32; 3]| normal.iter().map(|value| value * value).sum::<f32>().sqrt();
            let near = |normal: &[f32; 3]| (0..3).all(|axis| (normal[axis] / length(normal) - mesh.normals[at][axis]).abs() < 1e-5);
            mesh.positions[at] != *position || uv.is_some_and(|uv| mesh.uvs[at] != uv) || !normal.as_ref().is_none_or(near)
        })
    })
}

/// A clean file: convex faces of 3 to 6 corners in all index forms, one form a group, over several groups and materials.
fn clean_file(random: &mut Random) -> String {
    let mut text = String::new();
    for group in 0..1 + random.below(5) {
        let _ = writeln!(text, "o part{group}\nusemtl material{}", random.below(3));
        let form = random.below(4);
        for _ in 0..random.below(20) {
            let corners = 3 + random.below(4) as i64;
            let centre: [f32; 3] = std::array::from_fn(|_| random.range(-10.0, 10.0));
            for at in 0..corners {
                let (sine, cosine) = (std::f32::consts::TAU * at as f32 / corners as f32).sin_cos();
                let _ = writeln!(text, "v {} {} {}", centre[0] + cosine, centre[1] + sine, centre[2]);
                let _ = writeln!(text, "vt {} {}", random.unit(), random.unit());
                let [x, y, z] = random.direction();
                let _ = writeln!(text, "vn {x} {y} {z}");
            }
            text += "f";
            for at in -corners..0 {
                let _ = match form {
                    0 => write!(text, " {at}"),
                    1 => write!(text, " {at}/{at}"),
                    2 => write!(text, " {at}//{at}"),
                    _ => write!(text, " {at}/{at}/{at}"),
                };
            }
            text += "\n";
        }
    }
    text
}

#[test]
fn tobj_reads_the_same_from_clean_files() {
    for seed in 0..300 {
        let text = clean_file(&mut Random::new(seed));
        let scene = load_reader(&mut text.as_bytes(), None, &LoadOptions::default()).unwrap();
        let mut expected = tobj_triangles(text.as_bytes());
        assert_eq!(difference(&scene.meshes[0], &expected), None, "seed {seed}");
        // Negative control: two triangles exchanged are seen.
        if expected.len() > 1 {
            expected.swap(0, 1);
            assert_eq!(difference(&scene.meshes[0], &expected), Some(0), "seed {seed}");
        }
    }
}

#[test]
fn sponza() {
    let Some(path) = std::env::var_os("GRIDWALK_SPONZA") else {
        eprintln!("skipped: GRIDWALK_SPONZA does not name sponza.obj");
        return;
    };
    let path = Path::new(&path);
    let scene = load(path, &LoadOptions::default()).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(scene.triangle_count(), 262_267);
    assert_eq!(scene.materials.len(), 26);
    let masks = scene.materials.iter().filter(|material| material.opacity_map.is_some()).count();
    assert_eq!(masks, 3, "leaf, chain and plant");
    let mesh = &scene.meshes[0];
    // Concave faces are cut otherwise than by tobj, within the same place in the order.
    let expected = tobj_triangles(&std::fs::read(path).unwrap());
    assert_eq!(expected.len(), mesh.indices.len());
    let differing = mesh
        .indices
        .iter()
        .zip(&expected)
        .filter(|(triangle, expected)| (0..3).any(|at| mesh.positions[triangle[at] as usize] != expected[at].0))
        .count();
    assert!(differing < mesh.indices.len() / 100, "{differing} triangles differ");
}
