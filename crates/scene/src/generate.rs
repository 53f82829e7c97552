//! Meshes without files, for scene files, tests and benchmarks: the same numbers on every machine with the same mathematics library, from a
//! seed where chance is wanted. Y is up, triangles are counterclockwise seen from outside, all use material 0.

use std::f64::consts::{PI, TAU};

use crate::normals::{Smooth, compute_normals};
use crate::vector::{Vector, add, cross, normalised, scale, sub};
use crate::{Bounds, Mesh};

/// The most segments that any shape is made of; more count as this many. A torus of them has 33,554,432 triangles.
pub const MAX_SEGMENTS: u32 = 4096;

/// Random numbers from a seed: SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A sequence for each seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    /// A whole number from 0 to `end - 1`; 0 where `end` is 0.
    pub fn below(&mut self, end: u64) -> u64 {
        ((u128::from(self.next_u64()) * u128::from(end)) >> 64) as u64
    }

    /// From 0 to just below 1, every multiple of 2^-24 equally likely.
    pub fn unit(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 * (1.0 / 16_777_216.0)
    }

    /// From `low` to just below `high`, before rounding.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A direction of length one, all equally likely.
    pub fn direction(&mut self) -> [f32; 3] {
        loop {
            let point: [f32; 3] = std::array::from_fn(|_| self.range(-1.0, 1.0));
            let square: f32 = point.iter().map(|value| value * value).sum();
            if square > 1e-4 && square <= 1.0 {
                return point.map(|value| value / square.sqrt());
            }
        }
    }
}

fn rounded(vector: Vector) -> [f32; 3] {
    vector.map(|value| value as f32)
}

fn finished(name: &str, mut mesh: Mesh) -> Mesh {
    mesh.name = name.to_owned();
    mesh.materials = vec![0; mesh.indices.len()];
    mesh
}

/// A sphere of `segments` meridians and half as many rows: closed, poles of one position each. `2 * segments * (segments / 2 - 1)` triangles.
pub fn sphere(centre: [f32; 3], radius: f32, segments: u32) -> Mesh {
    let columns = segments.clamp(3, MAX_SEGMENTS);
    let rows = (columns / 2).max(2);
    let mut mesh = Mesh::default();
    let centre = centre.map(f64::from);
    for row in 0..=rows {
        // Exact at the poles, and the same numbers at both sides of the seam: neighbours share positions bit for bit.
        let (ring, height) = match row {
            0 => (0.0, 1.0),
            row if row == rows => (0.0, -1.0),
            row => (PI * f64::from(row) / f64::from(rows)).sin_cos(),
        };
        for column in 0..=columns {
            let (sine, cosine) = (TAU * f64::from(column % columns) / f64::from(columns)).sin_cos();
            let normal = [ring * sine, height, ring * cosine];
            mesh.positions.push(rounded(add(centre, scale(normal, f64::from(radius)))));
            mesh.normals.push(rounded(normal));
            mesh.uvs.push([column as f32 / columns as f32, 1.0 - row as f32 / rows as f32]);
        }
    }
    let at = |row: u32, column: u32| row * (columns + 1) + column;
    for row in 0..rows {
        for column in 0..columns {
            if row > 0 {
                mesh.indices.push([at(row, column), at(row + 1, column), at(row, column + 1)]);
            }
            if row + 1 < rows {
                mesh.indices.push([at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)]);
            }
        }
    }
    finished("sphere", mesh)
}

/// A floor about the origin, `size` along x and z, facing up: `2 * segments²` triangles. Texture coordinates run from 0 to 1.
pub fn plane(size: [f32; 2], segments: u32) -> Mesh {
    let segments = segments.clamp(1, MAX_SEGMENTS);
    let mut mesh = Mesh::default();
    for row in 0..=segments {
        for column in 0..=segments {
            let (u, v) = (column as f32 / segments as f32, row as f32 / segments as f32);
            mesh.positions.push([(u - 0.5) * size[0], 0.0, (0.5 - v) * size[1]]);
            mesh.normals.push([0.0, 1.0, 0.0]);
            mesh.uvs.push([u, v]);
        }
    }
    let at = |row: u32, column: u32| row * (segments + 1) + column;
    for row in 0..segments {
        for column in 0..segments {
            mesh.indices.push([at(row, column), at(row, column + 1), at(row + 1, column + 1)]);
            mesh.indices.push([at(row, column), at(row + 1, column + 1), at(row + 1, column)]);
        }
    }
    finished("plane", mesh)
}

/// Two triangles between four corners, given around; texture coordinates (0, 0), (1, 0), (1, 1), (0, 1).
pub fn quad(corners: [[f32; 3]; 4]) -> Mesh {
    let mut mesh = Mesh {
        positions: corners.to_vec(),
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    compute_normals(&mut mesh, &[Smooth::Shared { place: 0, group: 0 }; 4]);
    finished("quad", mesh)
}

/// A box about the origin: 12 triangles, every side with its own normals and the whole texture.
pub fn cuboid(size: [f32; 3]) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for sign in [1.0_f32, -1.0] {
            let first = mesh.positions.len() as u32;
            let (side, above) = ((axis + 1) % 3, (axis + 2) % 3);
            for [u, v] in [[0.0_f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
                let mut position = [0.0; 3];
                position[axis] = sign * 0.5 * size[axis];
                position[side] = sign * (u - 0.5) * size[side];
                position[above] = (v - 0.5) * size[above];
                let mut normal = [0.0; 3];
                normal[axis] = sign;
                mesh.positions.push(position);
                mesh.normals.push(normal);
                mesh.uvs.push([u, v]);
            }
            mesh.indices.push([first, first + 1, first + 2]);
            mesh.indices.push([first, first + 2, first + 3]);
        }
    }
    finished("box", mesh)
}

/// A ring around the y axis: `2 * segments²` triangles.
pub fn torus(radius: f32, tube: f32, segments: u32) -> Mesh {
    let segments = segments.clamp(3, MAX_SEGMENTS);
    let radius = f64::from(radius);
    tube_along("torus", segments, segments, f64::from(tube), |t| {
        let (sine, cosine) = (TAU * t).sin_cos();
        ([radius * sine, 0.0, radius * cosine], [cosine, 0.0, -sine])
    })
}

/// A trefoil knot of a tube: `4 * segments²` triangles. It fits into twice `1.5 * radius + tube`.
pub fn knot(radius: f32, tube: f32, segments: u32) -> Mesh {
    let segments = segments.clamp(3, MAX_SEGMENTS / 2);
    let radius = f64::from(radius);
    tube_along("knot", segments * 2, segments, f64::from(tube), |t| {
        let angle = TAU * t;
        let ((s2, c2), (s3, c3)) = ((2.0 * angle).sin_cos(), (3.0 * angle).sin_cos());
        let ring = radius * (1.0 + 0.5 * c3);
        let turn = -1.5 * radius * s3;
        let at = [ring * c2, -0.5 * radius * s3, ring * s2];
        let along = [turn * c2 - 2.0 * ring * s2, -1.5 * radius * c3, turn * s2 + 2.0 * ring * c2];
        (at, along)
    })
}

/// A closed tube along a curve that gives, for t from 0 to 1, a point and a direction that is never vertical.
fn tube_along(name: &str, rings: u32, sides: u32, tube: f64, curve: impl Fn(f64) -> (Vector, Vector)) -> Mesh {
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let (centre, along) = curve(f64::from(ring % rings) / f64::from(rings));
        let right = normalised(cross(along, [0.0, 1.0, 0.0])).unwrap_or([1.0, 0.0, 0.0]);
        let above = normalised(cross(right, along)).unwrap_or([0.0, 1.0, 0.0]);
        for side in 0..=sides {
            let (sine, cosine) = (TAU * f64::from(side % sides) / f64::from(sides)).sin_cos();
            let normal = add(scale(right, cosine), scale(above, sine));
            mesh.positions.push(rounded(add(centre, scale(normal, tube))));
            mesh.normals.push(rounded(normal));
            mesh.uvs.push([ring as f32 / rings as f32, side as f32 / sides as f32]);
        }
    }
    let at = |ring: u32, side: u32| ring * (sides + 1) + side;
    for ring in 0..rings {
        for side in 0..sides {
            mesh.indices.push([at(ring, side), at(ring + 1, side), at(ring, side + 1)]);
            mesh.indices.push([at(ring + 1, side), at(ring + 1, side + 1), at(ring, side + 1)]);
        }
    }
    finished(name, mesh)
}

/// Triangles without order in the unit cube about the origin, each about as large as leaves room for all.
pub fn soup(triangles: u32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let reach = 0.5 / f32::cbrt(triangles.max(1) as f32);
    let mut mesh = Mesh::default();
    for triangle in 0..triangles.min(u32::MAX / 3) {
        let centre: [f32; 3] = std::array::from_fn(|_| random.range(-0.5, 0.5));
        for _ in 0..3 {
            mesh.positions.push(centre.map(|value| value + random.range(-reach, reach)));
        }
        mesh.indices.push([3 * triangle, 3 * triangle + 1, 3 * triangle + 2]);
    }
    mesh.uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].repeat(mesh.indices.len());
    let smooth: Vec<Smooth> = (0..mesh.positions.len() as u32).map(|at| Smooth::Shared { place: at / 3, group: 0 }).collect();
    compute_normals(&mut mesh, &smooth);
    finished("soup", mesh)
}

/// A closed, bumpy, star-shaped body of radius about 1 with triangles of about one size, like a scanned model: `8 f²` triangles with the `f`
/// that comes nearest to the number asked for, at least 8 and at most 33,554,432.
pub fn bumpy_sphere(triangles: u32, seed: u64) -> Mesh {
    let frequency = ((f64::from(triangles) / 8.0).sqrt().round() as u32).clamp(1, MAX_SEGMENTS / 2);
    let mut random = Random::new(seed);
    let waves: [(Vector, f64, f64); 6] = std::array::from_fn(|wave| {
        let pitch = f64::from(2 + 2 * wave as u32);
        (scale(random.direction().map(f64::from), pitch), f64::from(random.range(0.0, 6.0)), 0.28 / pitch)
    });
    let mut mesh = octahedral(frequency, |direction| {
        let bumps: f64 = waves.iter().map(|(wave, phase, height)| height * (crate::vector::dot(*wave, direction) + phase).sin()).sum();
        scale(direction, 1.0 + bumps)
    });
    let smooth: Vec<Smooth> = (0..mesh.positions.len() as u32).map(|at| Smooth::Shared { place: at, group: 1 }).collect();
    compute_normals(&mut mesh, &smooth);
    finished("bumpy", mesh)
}

/// An octahedron whose sides are cut `frequency` times, its vertices moved from the unit sphere by `place`. Vertices are shared, so it is
/// closed.
fn octahedral(frequency: u32, place: impl Fn(Vector) -> Vector) -> Mesh {
    const AXES: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let mut mesh = Mesh::default();
    let layers = 2 * frequency;
    // Layers from the upper tip to the lower one; a layer is a square of `4 * width` vertices, at the tips a single vertex.
    let width = |layer: u32| layer.min(layers - layer);
    let mut firsts = Vec::with_capacity(layers as usize + 1);
    for layer in 0..=layers {
        firsts.push(mesh.positions.len() as u32);
        let m = width(layer);
        for at in 0..(4 * m).max(1) {
            let (quadrant, step) = at.checked_div(m).map_or((0, 0), |quadrant| (quadrant as usize, at % m));
            let (from, to) = (AXES[quadrant % 4], AXES[(quadrant + 1) % 4]);
            let [x, y] = std::array::from_fn(|axis| from[axis] * f64::from(m - step) + to[axis] * f64::from(step));
            let height = f64::from(frequency) - f64::from(layer);
            let direction = normalised([y, height, x]).unwrap_or([0.0, 1.0, 0.0]);
            mesh.positions.push(rounded(place(direction)));
            mesh.uvs.push([(0.5 + x.atan2(y) / TAU) as f32, (0.5 + direction[1].asin() / PI) as f32]);
        }
    }
    let vertex = |layer: u32, quadrant: u32, step: u32| {
        let m = width(layer);
        let around = if m == 0 { 0 } else { (quadrant * m + step) % (4 * m) };
        firsts[layer as usize] + around
    };
    for layer in 0..layers {
        let (narrow, wide) = if width(layer) < width(layer + 1) { (layer, layer + 1) } else { (layer + 1, layer) };
        let downwards = narrow == layer;
        let mut push = |a: u32, b: u32, c: u32| mesh.indices.push(if downwards { [a, b, c] } else { [a, c, b] });
        for quadrant in 0..4 {
            let m = width(narrow);
            for step in 0..=m {
                push(vertex(narrow, quadrant, step), vertex(wide, quadrant, step), vertex(wide, quadrant, step + 1));
                if step < m {
                    push(vertex(narrow, quadrant, step), vertex(wide, quadrant, step + 1), vertex(narrow, quadrant, step + 1));
                }
            }
        }
    }
    mesh
}

/// The teapot in the stadium, hard for every uniform grid: a body of about `triangles` triangles, 2 units wide, on a floor of
/// `floor_size` by `floor_size` units made of two triangles, with a wall of large triangles around it.
pub fn stadium(floor_size: f32, triangles: u32, seed: u64) -> Mesh {
    let mut body = bumpy_sphere(triangles, seed);
    for position in &mut body.positions {
        position[1] += 1.0;
    }
    let floor = plane([floor_size; 2], 1);
    let mut parts = vec![body, floor];
    let (reach, height) = (floor_size * 0.5, floor_size * 0.1);
    for side in 0..16_u32 {
        let corner = |at: u32| {
            let (sine, cosine) = (TAU * f64::from(at % 16) / 16.0).sin_cos();
            [(f64::from(reach) * sine) as f32, (f64::from(reach) * cosine) as f32]
        };
        let ([ax, az], [bx, bz]) = (corner(side), corner(side + 1));
        parts.push(quad([[bx, 0.0, bz], [ax, 0.0, az], [ax, height, az], [bx, height, bz]]));
    }
    finished("stadium", merge(&parts))
}

/// All meshes as one, in order. Vertices or triangles beyond the range of 32 bits are left out with their whole mesh.
pub fn merge(meshes: &[Mesh]) -> Mesh {
    let mut merged = Mesh::default();
    for mesh in meshes {
        let (Ok(first), Ok(_)) =
            (u32::try_from(merged.positions.len()), u32::try_from(merged.positions.len().saturating_add(mesh.positions.len())))
        else {
            break;
        };
        merged.positions.extend_from_slice(&mesh.positions);
        merged.normals.extend_from_slice(&mesh.normals);
        merged.uvs.extend_from_slice(&mesh.uvs);
        if !(merged.colours.is_empty() && mesh.colours.is_empty()) {
            merged.colours.resize(first as usize, [1.0; 3]);
            merged.colours.extend_from_slice(&mesh.colours);
            merged.colours.resize(merged.positions.len(), [1.0; 3]);
        }
        if !(merged.opacities.is_empty() && mesh.opacities.is_empty()) {
            merged.opacities.resize(first as usize, 1.0);
            merged.opacities.extend_from_slice(&mesh.opacities);
            merged.opacities.resize(merged.positions.len(), 1.0);
        }
        merged.indices.extend(mesh.indices.iter().map(|triangle| triangle.map(|at| at + first)));
        merged.materials.extend_from_slice(&mesh.materials);
    }
    finished("merged", merged)
}

/// Random points that lie in a box, for rays in tests.
pub fn point_in(bounds: &Bounds, random: &mut Random) -> [f32; 3] {
    std::array::from_fn(|axis| random.range(bounds.min[axis], bounds.max[axis]))
}

/// The volume that a closed mesh encloses, positive where its triangles are counterclockwise seen from outside: a check on what is made.
pub fn enclosed_volume(mesh: &Mesh) -> f64 {
    let point = |at: u32| mesh.positions.get(at as usize).copied().unwrap_or_default().map(f64::from);
    let origin = mesh.positions.first().copied().unwrap_or_default().map(f64::from);
    mesh.indices
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|at| sub(point(at), origin));
            crate::vector::dot(a, cross(b, c)) / 6.0
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    /// Every edge has exactly one triangle on either side, by position.
    fn assert_closed(mesh: &Mesh) {
        let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        let key = |at: u32| mesh.positions[at as usize].map(|value| (value + 0.0).to_bits());
        for &[a, b, c] in &mesh.indices {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry([key(from), key(to)]).or_default() += 1;
            }
        }
        for ([from, to], count) in &edges {
            assert_eq!(*count, 1, "{}: an edge used twice in one direction", mesh.name);
            assert_eq!(edges.get(&[*to, *from]), Some(&1), "{}: an open edge", mesh.name);
        }
    }

    #[test]
    fn shapes_are_closed_wound_outwards_and_of_the_volume_they_should_have() {
        let cases = [
            (sphere([1.0, 2.0, 3.0], 2.0, 100), 4.0 / 3.0 * PI * 8.0, 2 * 100 * 49),
            (cuboid([1.0, 2.0, 3.0]), 6.0, 12),
            (torus(2.0, 0.5, 80), 2.0 * PI * PI * 2.0 * 0.25, 2 * 80 * 80),
            (knot(1.0, 0.2, 40), f64::NAN, 4 * 40 * 40),
            (bumpy_sphere(69_451, 1), f64::NAN, 8 * 93 * 93),
            (bumpy_sphere(0, 1), f64::NAN, 8),
        ];
        for (mesh, volume, triangles) in cases {
            assert_eq!(mesh.indices.len(), triangles, "{}", mesh.name);
            assert_eq!((mesh.normals.len(), mesh.uvs.len()), (mesh.positions.len(), mesh.positions.len()));
            assert_closed(&mesh);
            let enclosed = enclosed_volume(&mesh);
            assert!(enclosed > 0.0, "{}: {enclosed}", mesh.name);
            assert!(volume.is_nan() || (enclosed / volume - 1.0).abs() < 0.01, "{}: {enclosed} is not {volume}", mesh.name);
        }
    }

    #[test]
    fn normals_agree_with_the_winding() {
        for mesh in [
            sphere([0.0; 3], 1.0, 16),
            plane([2.0, 3.0], 4),
            cuboid([1.0; 3]),
            torus(2.0, 0.5, 16),
            knot(1.0, 0.2, 32),
            soup(100, 7),
            bumpy_sphere(512, 3),
            stadium(100.0, 512, 3),
        ] {
            for triangle in &mesh.indices {
                let [a, b, c] = triangle.map(|at| mesh.positions[at as usize].map(f64::from));
                let normal = cross(sub(b, a), sub(c, a));
                for at in triangle {
                    let shading = mesh.normals[*at as usize].map(f64::from);
                    assert!(crate::vector::dot(normal, shading) > 0.0, "{}: {triangle:?}", mesh.name);
                }
            }
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_mesh_and_another_seed_another() {
        assert_eq!(soup(100, 7), soup(100, 7));
        assert_ne!(soup(100, 7), soup(100, 8));
        assert_ne!(bumpy_sphere(800, 1).positions, bumpy_sphere(800, 2).positions);
    }
}
