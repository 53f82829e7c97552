//! Affine maps in double precision, as three rows of four numbers.

use crate::vector::{Vector, cross, dot};

pub(super) type Affine = [[f64; 4]; 3];

pub(super) const IDENTITY: Affine = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// First `b`, then `a`.
pub(super) fn product(a: &Affine, b: &Affine) -> Affine {
    a.map(|row| {
        std::array::from_fn(|column| {
            let linear = row[0] * b[0][column] + row[1] * b[1][column] + row[2] * b[2][column];
            if column == 3 { linear + row[3] } else { linear }
        })
    })
}

pub(super) fn point(map: &Affine, [x, y, z]: Vector) -> Vector {
    map.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3])
}

pub(super) fn determinant(map: &Affine) -> f64 {
    let [a, b, c] = map.map(|row| [row[0], row[1], row[2]]);
    dot(a, cross(b, c))
}

/// What normals are multiplied with, up to a factor above 0.
pub(super) fn normal(map: &Affine, value: Vector) -> Vector {
    let [a, b, c] = map.map(|row| [row[0], row[1], row[2]]);
    let sign = if determinant(map) < 0.0 { -1.0 } else { 1.0 };
    [cross(b, c), cross(c, a), cross(a, b)].map(|row| sign * dot(row, value))
}

/// The sum of `b`, weighted, and `a`.
pub(super) fn add_scaled(a: &Affine, b: &Affine, weight: f64) -> Affine {
    std::array::from_fn(|row| std::array::from_fn(|column| a[row][column] + b[row][column] * weight))
}

/// From a translation, a quaternion (x, y, z, w) of any length and a scale.
pub(super) fn from_parts(translation: Vector, rotation: [f64; 4], scale: Vector) -> Affine {
    let square = rotation.iter().map(|value| value * value).sum::<f64>();
    let [x, y, z, w] = if square.is_finite() && square > 0.0 { rotation.map(|value| value / square.sqrt()) } else { [0.0, 0.0, 0.0, 1.0] };
    let linear = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    std::array::from_fn(|row| {
        let [a, b, c] = linear[row];
        [a * scale[0], b * scale[1], c * scale[2], translation[row]]
    })
}

/// From 16 numbers, column by column; the last row counts as 0 0 0 1.
pub(super) fn from_columns(columns: &[f32; 16]) -> Affine {
    std::array::from_fn(|row| std::array::from_fn(|column| f64::from(columns[4 * column + row])))
}
