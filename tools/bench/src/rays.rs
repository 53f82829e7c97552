//! The rays that are measured.

use std::f32::consts::TAU;

use gridwalk::Ray;
use gridwalk_scene::generate::Random;
use gridwalk_scene::{Camera, Mesh};

use crate::vector::{cross, dot, sub, unit};

/// Side of the squares in which camera rays are ordered, in Morton order inside, so that neighbours in the picture are neighbours in memory:
/// the order of `gridwalk render`.
const TILE: u32 = 8;

/// One ray through the middle of each pixel of a square picture, in tiles. `size` is rounded up to whole tiles.
pub fn camera_rays(camera: &Camera, size: u32) -> Vec<Ray> {
    let size = size.next_multiple_of(TILE);
    let forward = unit(sub(camera.target, camera.eye));
    let right = unit(cross(forward, camera.up));
    let up = cross(right, forward);
    let tangent = (camera.vertical_fov_degrees.to_radians() * 0.5).tan();
    let tiles = size / TILE;
    (0..size * size)
        .map(|index| {
            let (tile, inside) = (index / (TILE * TILE), index % (TILE * TILE));
            // Bits 0, 2, 4 of the place in the tile, and 1, 3, 5.
            let [x, y] = [inside, inside >> 1].map(|bits| (bits & 1) | ((bits >> 1) & 2) | ((bits >> 2) & 4));
            let (x, y) = ((tile % tiles) * TILE + x, (tile / tiles) * TILE + y);
            let screen = |pixel: u32| ((pixel as f32 + 0.5) / size as f32 * 2.0 - 1.0) * tangent;
            let (sx, sy) = (screen(x), -screen(y));
            let direction = unit(std::array::from_fn(|axis| forward[axis] + sx * right[axis] + sy * up[axis]));
            Ray { origin: camera.eye, t_min: 0.0, direction, t_max: f32::INFINITY }
        })
        .collect()
}

/// Rays from points all over the surface, in random order, into the half space before the triangle by the cosine law. They start a
/// ten-thousandth of the scene's largest side off the surface.
pub fn diffuse_rays(mesh: &Mesh, count: u32, seed: u64) -> Vec<Ray> {
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| mesh.positions.get(vertex as usize).copied().unwrap_or([f32::NAN; 3]));
    let mut sum = 0.0_f64;
    let sums: Vec<f64> = mesh
        .indices
        .iter()
        .map(|triangle| {
            let [a, b, c] = corners(triangle);
            let normal = cross(sub(b, a), sub(c, a));
            let area = f64::from(dot(normal, normal)).sqrt();
            sum += if area.is_finite() { area } else { 0.0 };
            sum
        })
        .collect();
    let offset = mesh.bounds().map_or(0.0, |bounds| sub(bounds.max, bounds.min).into_iter().fold(0.0, f32::max)) * 1e-4;
    let mut random = Random::new(seed);
    let uniform = |random: &mut Random| (random.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64);
    (0..count)
        .map(|_| {
            let place = uniform(&mut random) * sum;
            let index = sums.partition_point(|&below| below <= place).min(sums.len().saturating_sub(1));
            let [a, b, c] = mesh.indices.get(index).map_or([[0.0; 3]; 3], corners);
            let root = random.unit().sqrt();
            let (u, v) = (1.0 - root, root * random.unit());
            let normal = unit(cross(sub(b, a), sub(c, a)));
            let point: [f32; 3] = std::array::from_fn(|axis| a[axis] + u * (b[axis] - a[axis]) + v * (c[axis] - a[axis]));
            let side = unit(if normal[0].abs() < 0.5 { cross(normal, [1.0, 0.0, 0.0]) } else { cross(normal, [0.0, 1.0, 0.0]) });
            let other = cross(normal, side);
            let (radius, angle) = (random.unit().sqrt(), TAU * random.unit());
            let height = (1.0 - radius * radius).max(0.0).sqrt();
            let (sine, cosine) = angle.sin_cos();
            let direction = std::array::from_fn(|axis| radius * cosine * side[axis] + radius * sine * other[axis] + height * normal[axis]);
            Ray { origin: std::array::from_fn(|axis| point[axis] + offset * normal[axis]), t_min: 0.0, direction, t_max: f32::INFINITY }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gridwalk_scene::{Framing, generate};

    #[test]
    fn camera_rays_come_in_tiles_from_the_upper_left() {
        let mesh = generate::sphere([0.0; 3], 1.0, 8);
        let scene = gridwalk_scene::scene_of_mesh(mesh);
        let camera = scene.frame(&Framing { aspect: 1.0, ..Framing::default() });
        let rays = camera_rays(&camera, 20);
        assert_eq!(rays.len(), 24 * 24);
        let right = unit(cross(sub(camera.target, camera.eye), camera.up));
        let across = |index: usize| dot(rays[index].direction, right);
        let upwards = |index: usize| rays[index].direction[1];
        assert!(across(1) > across(0) && upwards(2) < upwards(0) && across(4) > across(1), "Morton order inside a tile");
        assert!(across(64) > across(63) && across(63) > across(42), "the second tile lies to the right of the first");
    }

    #[test]
    fn diffuse_rays_leave_the_surface() {
        let mesh = generate::sphere([0.0; 3], 1.0, 16);
        let rays = diffuse_rays(&mesh, 1000, 7);
        assert!(rays.iter().all(|ray| dot(ray.direction, ray.origin) > -0.3 && (dot(ray.direction, ray.direction) - 1.0).abs() < 1e-4));
        let upwards = rays.iter().filter(|ray| ray.origin[1] > 0.0).count();
        assert!((400..600).contains(&upwards), "{upwards} of 1000 rays start on the upper half; seed 7");
        assert_eq!(rays, diffuse_rays(&mesh, 1000, 7));
        assert_ne!(rays, diffuse_rays(&mesh, 1000, 8));
    }

    #[test]
    fn nothing_to_start_from_is_no_panic() {
        assert_eq!(diffuse_rays(&Mesh::default(), 3, 1).len(), 3);
    }
}
