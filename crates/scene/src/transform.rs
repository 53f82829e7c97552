//! Where a scene file puts a mesh.

use crate::Mesh;
use crate::vector::{Vector, cross, dot, normalised, single};

/// An affine map: three rows of a linear part, and a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transform {
    rows: [Vector; 3],
    translation: Vector,
}

impl Transform {
    pub(crate) const IDENTITY: Self = Self { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// Scales, then turns about x, y and z in this order (degrees, counterclockwise seen from the axis' tip), then moves.
    pub(crate) fn new(scale: Vector, rotation: Vector, translation: Vector) -> Self {
        let [x, y, z] = rotation.map(quarter_exact);
        let turn_x = [[1.0, 0.0, 0.0], [0.0, x.1, -x.0], [0.0, x.0, x.1]];
        let turn_y = [[y.1, 0.0, y.0], [0.0, 1.0, 0.0], [-y.0, 0.0, y.1]];
        let turn_z = [[z.1, -z.0, 0.0], [z.0, z.1, 0.0], [0.0, 0.0, 1.0]];
        let turned = product(&turn_z, &product(&turn_y, &turn_x));
        let rows = turned.map(|row| std::array::from_fn(|axis| row[axis] * scale[axis]));
        Self { rows, translation }
    }

    /// From 3 or 4 rows; `None` for any other number, for a last row that is not 0 0 0 1, and for maps that flatten space.
    pub(crate) fn from_rows(rows: &[[f64; 4]]) -> Option<Self> {
        let (rows, last) = rows.split_at_checked(3)?;
        if !(last.is_empty() || last == [[0.0, 0.0, 0.0, 1.0]]) {
            return None;
        }
        let transform = Self {
            rows: std::array::from_fn(|row| std::array::from_fn(|axis| rows[row][axis])),
            translation: std::array::from_fn(|row| rows[row][3]),
        };
        let determinant = transform.determinant();
        (determinant.is_finite() && determinant != 0.0).then_some(transform)
    }

    /// Three rows of four numbers, the last of each the translation's.
    pub(crate) fn rows(&self) -> [[f64; 4]; 3] {
        std::array::from_fn(|row| {
            let [x, y, z] = self.rows[row];
            [x, y, z, self.translation[row]]
        })
    }

    /// The same in single precision.
    pub(crate) fn matrix(&self) -> [[f32; 4]; 3] {
        self.rows().map(|row| row.map(single))
    }

    pub(crate) fn is_mirrored(&self) -> bool {
        self.determinant() < 0.0
    }

    fn determinant(&self) -> f64 {
        dot(self.rows[0], cross(self.rows[1], self.rows[2]))
    }

    /// Moves a mesh's vertices and normals. A mirroring map also turns the winding of the triangles, so that it goes on to agree with the
    /// normals.
    pub(crate) fn apply(&self, mesh: &mut Mesh) {
        if *self == Self::IDENTITY {
            return;
        }
        for position in &mut mesh.positions {
            let from = position.map(f64::from);
            *position = std::array::from_fn(|row| (dot(self.rows[row], from) + self.translation[row]) as f32);
        }
        // The cofactors are the inverse transpose times the determinant, whose sign the winding takes care of.
        let [a, b, c] = self.rows;
        let mirrored = self.determinant() < 0.0;
        let sign = if mirrored { -1.0 } else { 1.0 };
        let cofactors = [cross(b, c), cross(c, a), cross(a, b)];
        for normal in &mut mesh.normals {
            let from = normal.map(f64::from);
            let turned = std::array::from_fn(|row| sign * dot(cofactors[row], from));
            if let Some(turned) = normalised(turned) {
                *normal = turned.map(|value| value as f32);
            }
        }
        if mirrored {
            for triangle in &mut mesh.indices {
                triangle.swap(1, 2);
            }
        }
    }
}

/// What a scene file does to a mesh after it was read.
#[derive(Clone, Debug)]
pub(crate) struct Edit {
    /// Instead of the file's name.
    pub(crate) name: Option<String>,
    /// For all triangles, instead of the file's own.
    pub(crate) material: Option<u32>,
    /// A factor on texture coordinates.
    pub(crate) uv_scale: Option<f32>,
    pub(crate) transform: Transform,
}

impl Default for Edit {
    fn default() -> Self {
        Self { name: None, material: None, uv_scale: None, transform: Transform::IDENTITY }
    }
}

impl Edit {
    pub(crate) fn apply(&self, mesh: &mut Mesh) {
        if let Some(name) = &self.name {
            mesh.name.clone_from(name);
        }
        if let Some(material) = self.material {
            mesh.materials.fill(material);
        }
        if let Some(scale) = self.uv_scale {
            for uv in mesh.uvs.as_flattened_mut() {
                *uv *= scale;
            }
        }
        self.transform.apply(mesh);
    }
}

fn product(a: &[Vector; 3], b: &[Vector; 3]) -> [Vector; 3] {
    a.map(|row| std::array::from_fn(|column| row[0] * b[0][column] + row[1] * b[1][column] + row[2] * b[2][column]))
}

/// Sine and cosine, exact at multiples of 90 degrees, so that turned boxes stay aligned with the axes.
fn quarter_exact(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probe() -> Mesh {
        Mesh {
            positions: vec![[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]],
            normals: vec![[0.0, 1.0, 0.0]; 3],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        }
    }

    #[test]
    fn scale_turn_move_in_this_order() {
        let mut mesh = probe();
        Transform::new([2.0, 1.0, 1.0], [0.0, 0.0, 90.0], [10.0, 0.0, 0.0]).apply(&mut mesh);
        assert_eq!(mesh.positions, [[10.0, 2.0, 0.0], [8.0, 0.0, 0.0], [10.0, 0.0, 3.0]]);
        assert_eq!(mesh.normals[0], [-1.0, 0.0, 0.0]);
        assert_eq!(mesh.indices, [[0, 1, 2]]);
    }

    #[test]
    fn a_mirror_turns_the_winding_and_keeps_normals_outside() {
        let mut mesh = probe();
        Transform::new([-1.0, 1.0, 1.0], [0.0; 3], [0.0; 3]).apply(&mut mesh);
        assert_eq!(mesh.indices, [[0, 2, 1]]);
        assert_eq!(mesh.normals[0], [0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_matrix_that_flattens_is_refused() {
        assert!(Transform::from_rows(&[[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]).is_none());
        assert!(Transform::from_rows(&[[1.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]).is_some());
        assert!(Transform::from_rows(&[[0.0; 4]; 2]).is_none());
    }
}
