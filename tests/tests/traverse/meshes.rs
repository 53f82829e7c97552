//! Triangles to trace rays through.

use std::path::{Path, PathBuf};

use gridwalk_scene::{LoadOptions, generate};
use gridwalk_tests::gpu::Mesh;
use gridwalk_tests::random::Random;

/// A mesh and what failures call it.
pub struct Model {
    pub name: String,
    pub mesh: Mesh,
}

fn of_scene(mesh: &gridwalk_scene::Mesh) -> Mesh {
    Mesh { positions: mesh.positions.clone(), indices: mesh.indices.clone() }
}

/// Triangles of about one size without order.
pub fn soup(count: usize, size: f32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let triangles: Vec<_> = (0..count)
        .map(|_| {
            let centre = random.point(-1.0, 1.0);
            std::array::from_fn(|_| {
                let offset = random.point(-size, size);
                std::array::from_fn(|axis| centre[axis] + offset[axis])
            })
        })
        .collect();
    Mesh::from_triangles(&triangles)
}

/// Thin triangles, up to 100,000 times longer than wide, some along the axes.
pub fn needles(count: usize, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let triangles: Vec<_> = (0..count)
        .map(|i| {
            let start = random.point(-1.0, 1.0);
            let along = if i % 4 == 0 { std::array::from_fn(|axis| f32::from(axis == i / 4 % 3)) } else { random.direction() };
            let aside = random.direction();
            let length = random.range(0.5, 1.5);
            let width = 10.0_f32.powf(random.range(-5.0, -2.0));
            let far: [f32; 3] = std::array::from_fn(|axis| start[axis] + along[axis] * length);
            [start, far, std::array::from_fn(|axis| start[axis] + aside[axis] * width)]
        })
        .collect();
    Mesh::from_triangles(&triangles)
}

/// A closed sphere of shared vertices.
pub fn sphere(centre: [f32; 3], radius: f32, segments: u32) -> Mesh {
    of_scene(&generate::sphere(centre, radius, segments))
}

/// Hills over a square of `segments`² quads, shared vertices.
pub fn terrain(segments: u32) -> Mesh {
    let mut mesh = of_scene(&generate::plane([2.0, 2.0], segments));
    for position in &mut mesh.positions {
        let [x, _, z] = *position;
        position[1] = 0.2 * (5.0 * x).sin() * (4.0 * z + 1.0).cos() + 0.05 * (23.0 * x + 17.0 * z).sin();
    }
    mesh
}

/// Boxes on a lattice: faces that lie on the boundaries of cells, or nearly, and are seen edge-on by rays along the axes.
pub fn lattice(count: i32) -> Mesh {
    let cuboid = of_scene(&generate::cuboid([1.0; 3]));
    let mut mesh = Mesh::default();
    for i in 0..count * count * count {
        let offset = [i % count, i / count % count, i / count / count].map(|i| 2.0 * i as f32);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(cuboid.positions.iter().map(|p| std::array::from_fn::<f32, 3, _>(|axis| p[axis] + offset[axis])));
        mesh.indices.extend(cuboid.indices.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    mesh
}

/// Triangles that go wrong elsewhere: no area, equal ones, not finite, huge beside tiny.
pub fn degenerate(seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let mut triangles = Vec::new();
    for i in 0..400_usize {
        let a = random.point(-1.0, 1.0);
        let b = random.point(-1.0, 1.0);
        let c = random.point(-1.0, 1.0);
        let middle = std::array::from_fn(|axis| 0.5 * (a[axis] + b[axis]));
        triangles.push(match i % 8 {
            0 => [a, a, a],
            1 => [a, b, a],
            2 => [a, b, middle],
            3 => [a, [f32::NAN, b[1], b[2]], c],
            4 => [a, b, [c[0], f32::INFINITY, c[2]]],
            5 => [[-1.0, 0.25, -1.0], [1.0, 0.25, -1.0], [0.0, 0.25, 1.0]],
            6 => [a, b, c],
            _ => [a, a.map(|x| x + 1e-7), a.map(|x| x - 1e-7)],
        });
    }
    Mesh::from_triangles(&triangles)
}

/// No extent along one axis, two or three. Few triangles: a walk along thousands of cells that are all full is given up.
pub fn flat(axes: usize, seed: u64) -> Mesh {
    let mut mesh = soup(if axes == 1 { 200 } else { 40 }, 0.2, seed);
    for position in &mut mesh.positions {
        for value in &mut position[..axes] {
            *value = 0.75;
        }
    }
    mesh
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The triangles of an OBJ file, without its materials.
pub fn obj(path: &Path) -> Mesh {
    let mut file = std::fs::File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let scene = gridwalk_scene::load_reader(&mut file, None, &LoadOptions::default()).unwrap();
    of_scene(&scene.meshes[0])
}

/// One of the committed scenes' files.
pub fn committed(file: &str) -> Model {
    Model { name: file.to_owned(), mesh: obj(&workspace().join("scenes").join(file)) }
}

/// The OBJ file that a variable names; without it the test says so and goes on with nothing.
pub fn named_by(variable: &str) -> Option<Model> {
    let Some(path) = std::env::var_os(variable) else {
        eprintln!("SKIPPED: set {variable} to an OBJ file to test with it");
        return None;
    };
    Some(Model { name: variable.to_owned(), mesh: obj(Path::new(&path)) })
}

/// Small ones of every kind, for comparisons that test every triangle.
pub fn small() -> Vec<Model> {
    let model = |name: &str, mesh| Model { name: name.to_owned(), mesh };
    vec![
        model("soup", soup(600, 0.15, 1)),
        model("sphere", sphere([0.25, -0.5, 0.125], 1.0, 24)),
        model("terrain", terrain(20)),
        model("needles", needles(400, 2)),
        committed("teapot/teapot.obj"),
        model("lattice", lattice(3)),
        model("degenerate", degenerate(3)),
        model("flat in x", flat(1, 4)),
        model("a line", flat(2, 5)),
        model("a point", flat(3, 6)),
    ]
}
