//! Scenes put together from the models of others: scene files that place them.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::mesh::Bounds;

/// An affine map: three rows, the last column moves.
type Matrix = [[f64; 4]; 3];

/// A scene file in the making.
pub struct SceneFile(String);

impl SceneFile {
    /// A scene of the given title, as a comment.
    pub fn new(title: &str) -> SceneFile {
        SceneFile(format!("# {title}\n"))
    }

    /// Places a file of the scene's folder.
    pub fn place(&mut self, file: &str, matrix: &Matrix) {
        let rows: Vec<String> = matrix.iter().map(|row| format!("{row:?}")).collect();
        let _ = writeln!(self.0, "\n[[mesh]]\nfile = {file:?}\nmatrix = [{}]", rows.join(", "));
    }

    /// Puts a rectangle on the ground, seen from above.
    pub fn ground(&mut self, min: [f64; 2], max: [f64; 2], colour: [f64; 3]) {
        let corners = [[min[0], 0.0, max[1]], [max[0], 0.0, max[1]], [max[0], 0.0, min[1]], [min[0], 0.0, min[1]]];
        let _ = writeln!(self.0, "\n[[material]]\nname = \"ground\"\ndiffuse = {colour:?}");
        let _ = writeln!(self.0, "\n[[mesh]]\nshape = \"quad\"\ncorners = {corners:?}\nmaterial = \"ground\"");
    }

    /// Places the key-frames of a moving model of the scene's folder, ten a second, again and again.
    fn play(&mut self, sequence: &str) {
        let _ = writeln!(self.0, "\n[[mesh]]\nsequence = {sequence:?}\nfps = 10\nloop = true");
    }

    /// Writes the file.
    pub fn write(&self, path: &Path) -> Result<()> {
        fs::write(path, &self.0).with_context(|| format!("{}: cannot be written", path.display()))
    }
}

/// A piece of furniture and the size that the catalogue wants it to have.
struct Model {
    file: String,
    matrix: Matrix,
    size: [f64; 3],
}

impl Model {
    /// The model turned and moved. The turn is about the vertical, its size a factor.
    fn at(&self, angle: f64, factor: f64, x: f64, z: f64) -> Matrix {
        let (sin, cos) = (angle.sin() * factor, angle.cos() * factor);
        let turn = [[cos, 0.0, sin], [0.0, factor, 0.0], [-sin, 0.0, cos]];
        let mut matrix = product(&turn, &self.matrix);
        matrix[0][3] += x;
        matrix[2][3] += z;
        matrix
    }
}

fn product(a: &[[f64; 3]; 3], b: &Matrix) -> Matrix {
    a.map(|row| std::array::from_fn(|column| row[0] * b[0][column] + row[1] * b[1][column] + row[2] * b[2][column]))
}

/// The models of a furniture library, in the order of its catalogue, each at its size in centimetres, standing on the origin.
fn library(folder: &Path, name: &str) -> Result<Vec<Model>> {
    let path = folder.join(name).join("PluginFurnitureCatalog.properties");
    let bytes = fs::read(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
    // The catalogue is Latin-1.
    let text: String = bytes.iter().map(|&byte| char::from(byte)).collect();
    let mut entries: BTreeMap<u32, BTreeMap<&str, &str>> = BTreeMap::new();
    for line in text.lines() {
        let Some((key, value)) = line.split_once('=') else { continue };
        let Some((key, number)) = key.trim().split_once('#') else { continue };
        if let Ok(number) = number.parse() {
            entries.entry(number).or_default().insert(key, value.trim());
        }
    }
    let mut models = Vec::new();
    for entry in entries.values() {
        let Some(model) = entry.get("model").filter(|model| model.to_ascii_lowercase().ends_with(".obj")) else { continue };
        let file = format!("{name}/{}", model.trim_start_matches('/'));
        if !folder.join(&file).is_file() {
            continue;
        }
        let mut turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        if let Some(rotation) = entry.get("modelRotation") {
            let numbers: Vec<f64> = rotation.split_whitespace().filter_map(|number| number.parse().ok()).collect();
            if numbers.len() == 9 {
                turn = std::array::from_fn(|row| std::array::from_fn(|column| numbers[3 * row + column]));
            }
        }
        let Some(bounds) = Bounds::of_obj(&folder.join(&file), &turn)? else { continue };
        let extent = bounds.extent().map(|extent| extent.max(1e-6));
        let number = |name| entry.get(name).and_then(|value| value.parse::<f64>().ok()).filter(|value| *value > 0.0);
        let size = match (number("width"), number("height"), number("depth")) {
            (Some(width), Some(height), Some(depth)) => [width, height, depth],
            _ => {
                let largest = extent.into_iter().fold(0.0, f64::max);
                extent.map(|extent| 100.0 * extent / largest)
            }
        };
        let middle = [(bounds.min[0] + bounds.max[0]) / 2.0, bounds.min[1], (bounds.min[2] + bounds.max[2]) / 2.0];
        let matrix = std::array::from_fn(|axis| {
            let scale = size[axis] / extent[axis];
            [scale * turn[axis][0], scale * turn[axis][1], scale * turn[axis][2], -scale * middle[axis]]
        });
        models.push(Model { file, matrix, size });
    }
    Ok(models)
}

/// Every model of the furniture libraries, in rows.
pub fn warehouse(folder: &Path) -> Result<()> {
    let mut scene = SceneFile::new("Every model of the furniture libraries, in rows. Centimetres.");
    let (mut x, mut z, mut depth) = (0.0, 0.0, 0.0f64);
    let width = 6000.0;
    for name in ["BlendSwap-CC-0", "BlendSwap-CC-BY", "KatorLegaz", "Reallusion", "Scopia"] {
        for model in library(folder, name)? {
            if x + model.size[0] > width {
                z += depth + 40.0;
                (x, depth) = (0.0, 0.0);
            }
            scene.place(&model.file, &model.at(0.0, 1.0, x + model.size[0] / 2.0, z + model.size[2] / 2.0));
            x += model.size[0] + 30.0;
            depth = depth.max(model.size[2]);
        }
    }
    scene.ground([-100.0, -100.0], [width + 100.0, z + depth + 100.0], [0.6, 0.6, 0.58]);
    scene.write(&folder.join("warehouse.toml"))
}

/// Forty trees and shrubs, scattered on a plane.
pub fn forest(folder: &Path) -> Result<()> {
    let models = library(folder, "Scopia")?;
    let wanted =
        "japaneseMaple sycamoreMaple copperBeech poplar pine acacia coconutTree ficusTree peachBlossom bush palm bamboo high-hedge";
    let plants: Vec<&Model> = wanted
        .split(' ')
        .filter_map(|name| models.iter().find(|model| Path::new(&model.file).file_stem().is_some_and(|stem| stem == name)))
        .collect();
    plants.first().context("the furniture library has no plants")?;
    let mut scene = SceneFile::new("Forty trees and shrubs of the furniture libraries. Centimetres.");
    let count = 40;
    let side = 350.0 * f64::from(count).sqrt();
    let mut random = Random(1);
    for (_, plant) in (0..count).zip(plants.iter().cycle()) {
        let (angle, factor) = (random.next() * TAU, 0.7 + 0.6 * random.next());
        scene.place(&plant.file, &plant.at(angle, factor, random.next() * side, random.next() * side));
    }
    scene.ground([-500.0, -500.0], [side + 500.0, side + 500.0], [0.35, 0.42, 0.2]);
    scene.write(&folder.join("forest.toml"))
}

/// SplitMix64 (Steele, Lea and Flood 2014), as numbers from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Three times three copies of a mesh of the folder, on a plane.
pub fn army(folder: &Path, file: &str) -> Result<()> {
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let bounds = Bounds::of_obj(&folder.join(file), &identity)?.with_context(|| format!("{file}: empty"))?;
    let [width, height, depth] = bounds.extent();
    let scale = 1.0 / height;
    let step = [1.15 * width * scale, 1.3 * depth * scale];
    let mut scene = SceneFile::new("Nine dragons.");
    for i in 0..3 {
        for j in 0..3 {
            let to = [f64::from(i) * step[0], 0.0, f64::from(j) * step[1]];
            let from = [(bounds.min[0] + bounds.max[0]) / 2.0, bounds.min[1], (bounds.min[2] + bounds.max[2]) / 2.0];
            let mut matrix = [[0.0; 4]; 3];
            for axis in 0..3 {
                matrix[axis][axis] = scale;
                matrix[axis][3] = to[axis] - scale * from[axis];
            }
            scene.place(file, &matrix);
        }
    }
    scene.ground([-step[0], -step[1]], [3.0 * step[0], 3.0 * step[1]], [0.6, 0.6, 0.6]);
    scene.write(&folder.join("scene.toml"))
}

/// A teapot of 30 cm in the middle of a stadium: the pitch and the teapot are files of the folder, the stands are made here.
pub fn stadium(folder: &Path, pitch: &str, teapot: &str) -> Result<()> {
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let bounds = Bounds::of_obj(&folder.join(teapot), &identity)?.with_context(|| format!("{teapot}: empty"))?;
    let scale = 0.3 / bounds.extent()[0];
    let mut scene = SceneFile::new("A teapot of 30 cm in the middle of a stadium. Metres.");
    scene.place(pitch, &[[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0]]);
    let lift = 0.01 - bounds.min[1] * scale;
    scene.place(teapot, &[[scale, 0.0, 0.0, 0.0], [0.0, scale, 0.0, lift], [0.0, 0.0, scale, 0.0]]);
    scene.place("stands.obj", &[[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
    write_stands(folder)?;
    scene.write(&folder.join("scene.toml"))
}

/// Forty oval rows of seats, each a box without a bottom, on steps.
fn write_stands(folder: &Path) -> Result<()> {
    let mtl = "newmtl seat0\nKd .75 .1 .1\nnewmtl seat1\nKd .85 .85 .85\nnewmtl seat2\nKd .1 .2 .6\nnewmtl step\nKd .5 .5 .5\n";
    let mut obj = String::from("mtllib stands.mtl\n");
    let mut base = 1u32;
    for row in 0..40u32 {
        let (a, b, height) = (46.0 + f64::from(row) * 0.85, 31.0 + f64::from(row) * 0.85, 0.6 + f64::from(row) * 0.42);
        let seats = (TAU * ((a * a + b * b) / 2.0).sqrt() / 0.6) as u32;
        let _ = writeln!(obj, "usemtl seat{}", row / 6 % 3);
        for seat in 0..seats {
            let angle = TAU * f64::from(seat) / f64::from(seats);
            let (sin, cos) = (b * angle.cos()).atan2(-a * angle.sin()).sin_cos();
            for corner in 0..8u32 {
                let side = |bit: u32| if corner & bit == 0 { -0.22 } else { 0.22 };
                let (x, z) = (side(1), side(2));
                let y = if corner & 4 == 0 { 0.0 } else { 0.45 };
                let _ = writeln!(
                    obj,
                    "v {:.4} {:.4} {:.4}",
                    a * angle.cos() + cos * x - sin * z,
                    height + y,
                    b * angle.sin() + sin * x + cos * z
                );
            }
            for [p, q, r, s] in [[4, 6, 7, 5], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]] {
                let _ = writeln!(obj, "f {} {} {} {}", base + p, base + q, base + r, base + s);
            }
            base += 8;
        }
        let _ = writeln!(obj, "usemtl step");
        let parts = 128;
        for part in 0..parts {
            let (sin, cos) = (TAU * f64::from(part) / f64::from(parts)).sin_cos();
            for (out, y) in [(-0.4, height - 0.42), (-0.4, height), (0.45, height)] {
                let _ = writeln!(obj, "v {:.4} {y:.4} {:.4}", (a + out) * cos, (b + out) * sin);
            }
        }
        for part in 0..parts {
            let (this, next) = (base + 3 * part, base + 3 * ((part + 1) % parts));
            for k in 0..2 {
                let _ = writeln!(obj, "f {} {} {} {}", this + k, next + k, next + k + 1, this + k + 1);
            }
        }
        base += 3 * parts;
    }
    for (name, text) in [("stands.mtl", mtl), ("stands.obj", &obj)] {
        let path: PathBuf = folder.join(name);
        fs::write(&path, text).with_context(|| format!("{}: cannot be written", path.display()))?;
    }
    Ok(())
}

/// MegaGlest's forest: models whose key-frames `g3d::convert` has written into the folder, each where the game puts it.
pub fn megaglest_forest(folder: &Path, models: [&str; 5]) -> Result<()> {
    let mut scene =
        SceneFile::new("The forest behind the menu of MegaGlest, and four groups that move in it; CC BY-SA 3.0, MegaGlest team");
    // From where the game's menu looks first. A dome of sky shuts out every light but one inside of it.
    let _ = writeln!(scene.0, "\nambient = 0.5\n\n[[camera]]\nname = \"menu\"\neye = [5, 10, 40]\ntarget = [5, 9.5, 0]\nfov = 60");
    let _ = writeln!(scene.0, "\n[[light]]\nkind = \"point\"\nposition = [10, 30, 25]\nintensity = 9000");
    for model in models {
        let first = format!("{model}.0000.obj");
        if folder.join(format!("{model}.0001.obj")).exists() {
            scene.play(&format!("{model}.%04d.obj"));
        } else {
            scene.place(&first, &[[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
        }
    }
    scene.write(&folder.join("scene.toml"))
}
