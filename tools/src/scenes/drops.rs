//! The committed scene `drops`: balls that melt into one another and part again, a mesh with other triangles in every key-frame.

use std::f32::consts::TAU;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use fast_surface_nets::ndshape::{ConstShape, ConstShape3u32};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};

const KEY_FRAMES: u32 = 48;
/// Samples along an axis, of a cube whose sides are `SIDE` long around `MIDDLE`.
const SAMPLES: u32 = 40;
const SIDE: f32 = 3.6;
const MIDDLE: [f32; 3] = [0.0, 1.15, 0.0];
/// How far apart two surfaces begin to reach for each other.
const REACH: f32 = 0.34;

type Samples = ConstShape3u32<SAMPLES, SAMPLES, SAMPLES>;

struct Ball {
    middle: [f32; 3],
    radius: f32,
}

/// Each ball goes round an ellipse of its own once or twice in a loop.
fn balls(time: f32) -> [Ball; 6] {
    let ball = |middle: [f32; 3], swing: [f32; 3], turns: f32, phase: f32, radius: f32| {
        let angle = TAU * (turns * time + phase);
        let (sine, cosine) = angle.sin_cos();
        Ball { middle: [middle[0] + swing[0] * cosine, middle[1] + swing[1] * sine, middle[2] + swing[2] * sine], radius }
    };
    [
        ball([0.0, 1.0, 0.0], [0.12, 0.1, 0.1], 1.0, 0.0, 0.52),
        ball([0.0, 1.15, 0.0], [1.05, 0.35, 0.75], 1.0, 0.1, 0.33),
        ball([0.0, 1.2, 0.0], [-0.85, 0.5, 0.9], 1.0, 0.45, 0.28),
        ball([0.2, 1.1, 0.0], [0.25, 0.85, 0.2], 1.0, 0.7, 0.3),
        ball([-0.15, 0.95, 0.1], [0.6, 0.3, -1.0], 2.0, 0.2, 0.2),
        ball([0.0, 1.5, -0.1], [-1.1, 0.2, 0.3], 1.0, 0.85, 0.24),
    ]
}

/// Distance to the surface of all balls under a smooth minimum (Quilez's polynomial one), negative inside.
fn distance(balls: &[Ball], point: [f32; 3]) -> f32 {
    balls.iter().fold(f32::MAX, |least, ball| {
        let away: [f32; 3] = std::array::from_fn(|axis| point[axis] - ball.middle[axis]);
        let other = away.iter().map(|value| value * value).sum::<f32>().sqrt() - ball.radius;
        let overlap = (REACH - (least - other).abs()).max(0.0) / REACH;
        least.min(other) - overlap * overlap * REACH * 0.25
    })
}

fn gradient(balls: &[Ball], point: [f32; 3]) -> [f32; 3] {
    const STEP: f32 = 1e-3;
    std::array::from_fn(|axis| {
        let at = |step: f32| {
            let mut point = point;
            point[axis] += step;
            distance(balls, point)
        };
        (at(STEP) - at(-STEP)) / (2.0 * STEP)
    })
}

/// A key-frame as binary PLY.
fn key_frame(time: f32) -> Vec<u8> {
    let balls = balls(time);
    let cell = SIDE / (SAMPLES - 1) as f32;
    let place = |at: [f32; 3]| -> [f32; 3] { std::array::from_fn(|axis| MIDDLE[axis] - SIDE * 0.5 + at[axis] * cell) };
    let samples: Vec<f32> =
        (0..Samples::SIZE).map(|index| distance(&balls, place(Samples::delinearize(index).map(|n| n as f32)))).collect();
    let mut surface = SurfaceNetsBuffer::default();
    surface_nets(&samples, &Samples {}, [0; 3], [SAMPLES - 1; 3], &mut surface);

    let faces = surface.indices.len() / 3;
    let mut ply = format!(
        "ply\nformat binary_little_endian 1.0\ncomment made by: cargo tool scenes drops\nelement vertex {}\nproperty float x\nproperty float \
         y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face {faces}\nproperty list uchar ushort \
         vertex_indices\nend_header\n",
        surface.positions.len()
    )
    .into_bytes();
    for &position in &surface.positions {
        let mut point = place(position);
        // The nets cut corners: two steps of Newton's method bring a vertex back onto the surface.
        for _ in 0..2 {
            let (slope, away) = (gradient(&balls, point), distance(&balls, point));
            let square = slope.iter().map(|value| value * value).sum::<f32>().max(1e-6);
            point = std::array::from_fn(|axis| point[axis] - away * slope[axis] / square);
        }
        let normal = gradient(&balls, point);
        let length = normal.iter().map(|value| value * value).sum::<f32>().sqrt().max(1e-6);
        ply.extend(point.into_iter().chain(normal.map(|value| value / length)).flat_map(f32::to_le_bytes));
    }
    for triangle in surface.indices.chunks_exact(3) {
        ply.push(3);
        // Far fewer vertices than 65,536: the samples have 64,000 cells.
        ply.extend(triangle.iter().flat_map(|&index| (index as u16).to_le_bytes()));
    }
    ply
}

/// Writes the key-frames into a folder.
pub fn write(folder: &Path) -> Result<()> {
    for key in 0..KEY_FRAMES {
        let path = folder.join(format!("drops.{key:04}.ply"));
        let bytes = key_frame(key as f32 / KEY_FRAMES as f32);
        fs::write(&path, bytes).with_context(|| format!("{}: cannot be written", path.display()))?;
    }
    Ok(())
}
