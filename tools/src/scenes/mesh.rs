//! Triangles on their way from somebody's format to OBJ.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result, bail};

/// Triangles over shared vertices.
#[derive(Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub positions: Vec<[f32; 3]>,
    /// Triangles, by index of vertex.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Reads an ASCII PLY file whose vertices begin with x, y and z and whose faces are a list and nothing else. Faces of more than three
    /// corners become fans.
    pub fn from_ascii_ply(bytes: &[u8]) -> Result<Mesh> {
        let text = std::str::from_utf8(bytes).context("not ASCII")?;
        let mut lines = text.lines();
        let mut counts = [0usize; 2];
        loop {
            let words: Vec<&str> = lines.next().context("the header has no end")?.split_whitespace().collect();
            match words.as_slice() {
                ["format", format, ..] if *format != "ascii" => bail!("format {format}, not ascii"),
                ["element", "vertex", count] => counts[0] = count.parse().context("number of vertices")?,
                ["element", "face", count] => counts[1] = count.parse().context("number of faces")?,
                ["end_header"] => break,
                _ => {}
            }
        }
        let mut mesh = Mesh::default();
        for index in 0..counts[0] {
            let mut words = lines.next().context("vertices are missing")?.split_whitespace();
            let mut position = [0.0; 3];
            for coordinate in &mut position {
                *coordinate = words.next().and_then(|word| word.parse().ok()).with_context(|| format!("vertex {index}"))?;
            }
            mesh.positions.push(position);
        }
        for index in 0..counts[1] {
            let words = lines.next().context("faces are missing")?.split_whitespace().skip(1);
            let corners: Vec<u32> = words.map(str::parse).collect::<Result<_, _>>().with_context(|| format!("face {index}"))?;
            if corners.iter().any(|&corner| corner as usize >= counts[0]) {
                bail!("face {index} names a vertex that is not there");
            }
            mesh.triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
        }
        Ok(mesh)
    }

    /// Writes an OBJ file.
    pub fn write_obj(&self, path: &Path) -> Result<()> {
        let mut text = String::with_capacity(self.positions.len() * 32 + self.triangles.len() * 24);
        for [x, y, z] in &self.positions {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| u64::from(corner) + 1);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        std::fs::write(path, text).with_context(|| format!("{}: cannot be written", path.display()))
    }
}

/// The box of what an OBJ file's faces use.
#[derive(Debug, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub min: [f64; 3],
    /// Greatest corner.
    pub max: [f64; 3],
}

impl Bounds {
    /// The box after a linear map, given by rows; `None` without a face.
    pub fn of_obj(path: &Path, map: &[[f64; 3]; 3]) -> Result<Option<Bounds>> {
        let bytes = std::fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
        let text = String::from_utf8_lossy(&bytes);
        let mut positions: Vec<[f64; 3]> = Vec::new();
        let mut bounds = Bounds { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };
        for line in text.lines() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => {
                    let v: Vec<f64> = words.take(3).filter_map(|word| word.parse().ok()).collect();
                    let [x, y, z] = v[..] else { bail!("{}: {line:?} is no vertex", path.display()) };
                    positions.push(map.map(|row| row[0] * x + row[1] * y + row[2] * z));
                }
                Some("f") => {
                    for corner in words {
                        let index: i64 = corner.split('/').next().and_then(|index| index.parse().ok()).unwrap_or(0);
                        let index = if index < 0 { positions.len() as i64 + index } else { index - 1 };
                        let Some(position) = usize::try_from(index).ok().and_then(|index| positions.get(index)) else { continue };
                        bounds.min = std::array::from_fn(|axis| bounds.min[axis].min(position[axis]));
                        bounds.max = std::array::from_fn(|axis| bounds.max[axis].max(position[axis]));
                    }
                }
                _ => {}
            }
        }
        Ok((bounds.min[0] <= bounds.max[0]).then_some(bounds))
    }

    /// Length along each axis.
    pub fn extent(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.max[axis] - self.min[axis])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn ply_faces_become_fans() {
        let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nelement face 1\nend_header\n0 0 0\n1 0 0 9\n1 1 0\n0 1 0\n4 0 1 2 3\n";
        let mesh = Mesh::from_ascii_ply(ply.as_bytes()).unwrap();
        assert_eq!(mesh.positions.len(), 4);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn bounds_of_what_faces_use() {
        let file = std::env::temp_dir().join(format!("gridwalk-bounds-{}.obj", std::process::id()));
        std::fs::write(&file, "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 2 -3\nf 2//1 3 -1\n").unwrap();
        let bounds = Bounds::of_obj(&file, &[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]).unwrap();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(bounds, Some(Bounds { min: [0.0, 0.0, -3.0], max: [2.0, 1.0, 0.0] }));
    }

    #[test]
    fn broken_ply_is_an_error() {
        for broken in
            ["", "ply\nelement vertex 1\nend_header\n1 2\n", "ply\nelement vertex 1\nelement face 1\nend_header\n0 0 0\n3 0 1 2\n"]
        {
            assert!(Mesh::from_ascii_ply(broken.as_bytes()).is_err(), "{broken:?}");
        }
    }
}
