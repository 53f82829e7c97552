//! Rays of every kind.

use gridwalk::Ray;
use gridwalk_core::layout::GridHeader;
use gridwalk_scene::{Bounds, Framing, frame_camera};
use gridwalk_tests::gpu::Mesh;
use gridwalk_tests::random::Random;

pub type V = [f32; 3];

pub fn zip(a: V, b: V, f: impl Fn(f32, f32) -> f32) -> V {
    std::array::from_fn(|axis| f(a[axis], b[axis]))
}

pub fn add(a: V, b: V) -> V {
    zip(a, b, |a, b| a + b)
}

pub fn sub(a: V, b: V) -> V {
    zip(a, b, |a, b| a - b)
}

pub fn scaled(a: V, factor: f32) -> V {
    a.map(|x| x * factor)
}

pub fn ray(origin: V, direction: V) -> Ray {
    Ray { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
}

/// The box of the vertices that are finite.
pub fn bounds(mesh: &Mesh) -> Bounds {
    let mut bounds = Bounds { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };
    for vertex in mesh.indices.iter().flatten().map(|vertex| mesh.positions[*vertex as usize]) {
        if vertex.iter().all(|x| x.is_finite()) {
            bounds.min = zip(bounds.min, vertex, f32::min);
            bounds.max = zip(bounds.max, vertex, f32::max);
        }
    }
    bounds
}

/// The longest side of the mesh's box.
pub fn extent(mesh: &Mesh) -> f32 {
    let bounds = bounds(mesh);
    sub(bounds.max, bounds.min).into_iter().fold(0.0, f32::max).max(f32::MIN_POSITIVE)
}

/// From anywhere in and around the box, in all directions.
pub fn random_rays(mesh: &Mesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let Bounds { min, max } = bounds(mesh);
    let reach = extent(mesh);
    let point =
        |random: &mut Random, wider: f32| std::array::from_fn(|axis| random.range(min[axis] - wider * reach, max[axis] + wider * reach));
    (0..count)
        .map(|i| {
            let origin = point(&mut random, 0.7);
            // Half of them towards the box, or most rays of a flat scene would miss it.
            let direction = if i % 2 == 0 { random.direction() } else { sub(point(&mut random, 0.0), origin) };
            ray(origin, direction)
        })
        .collect()
}

/// As the automatic camera sees the mesh.
pub fn camera_rays(mesh: &Mesh, width: usize, height: usize) -> Vec<Ray> {
    let framing = Framing { aspect: width as f32 / height as f32, ..Framing::default() };
    let camera = frame_camera(&bounds(mesh), &framing);
    let forward = unit(sub(camera.target, camera.eye));
    let right = unit(cross(forward, camera.up));
    let up = cross(right, forward);
    let tangent = (camera.vertical_fov_degrees.to_radians() * 0.5).tan();
    (0..width * height)
        .map(|pixel| {
            let x = ((pixel % width) as f32 + 0.5) / width as f32 * 2.0 - 1.0;
            let y = 1.0 - ((pixel / width) as f32 + 0.5) / height as f32 * 2.0;
            let aside = add(scaled(right, x * tangent * framing.aspect), scaled(up, y * tangent));
            ray(camera.eye, add(forward, aside))
        })
        .collect()
}

/// From random points of random triangles, by the cosine; a little off the surface, as secondary rays of a renderer.
pub fn diffuse_rays(mesh: &Mesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let t_min = extent(mesh) * 1e-4;
    let mut rays = Vec::with_capacity(count);
    let mut tries = 0;
    while rays.len() < count && tries < 10 * count {
        tries += 1;
        let [a, b, c] = mesh.triangle(random.below(mesh.indices.len() as u32) as usize);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let origin = add(a, add(scaled(sub(b, a), u), scaled(sub(c, a), v)));
        let normal = cross(sub(b, a), sub(c, a));
        let direction = add(unit(normal), random.direction());
        if direction.iter().chain(&origin).all(|x| x.is_finite()) && direction.iter().any(|x| x.abs() > 1e-3) {
            let direction = if random.below(2) == 0 { direction } else { scaled(direction, -1.0) };
            rays.push(Ray { origin, t_min, direction, t_max: f32::INFINITY });
        }
    }
    rays
}

/// The directions to the 26 neighbours, with zeros of both signs.
pub fn axis_directions() -> Vec<V> {
    let mut directions = Vec::new();
    for code in 0..27_i32 {
        let direction = [code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1].map(|x| x as f32);
        if direction != [0.0; 3] {
            directions.push(direction);
            directions.push(direction.map(|x| if x == 0.0 { -0.0 } else { x }));
        }
    }
    directions
}

/// Rays along all axes and diagonals, and a few others, that start on faces, edges and corners of cells and of the box, inside, outside,
/// and far away; at vertices and at the middles of edges.
pub fn hard_rays(mesh: &Mesh, header: &GridHeader, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let mut directions = axis_directions();
    directions.extend((0..10).map(|_| random.direction()));
    // Components that are negligible or not. None is so small that a device which flushes denormals would decide ties otherwise.
    for tiny in [1e-13, 1e-10, 1e-30_f32] {
        directions.push([1.0, tiny, 0.0]);
        directions.push([-tiny, -1.0, tiny]);
        directions.push([tiny, 0.5, -1.0]);
    }
    let input = |point: V| add(scaled(point, header.inverse_scale), header.middle);
    let cell_point = |random: &mut Random, inside: [bool; 3]| {
        input(std::array::from_fn(|axis| {
            let i = random.below(header.resolution[axis] + 1) as f32;
            let i = if inside[axis] { i + random.unit() } else { i };
            header.box_min[axis] + i * header.cell_size[axis]
        }))
    };
    let (low, high) = (input(header.box_min), input(header.box_max));
    let box_bounds = bounds(mesh);
    let reach = sub(high, low).into_iter().fold(0.0, f32::max);
    let mut origins = Vec::new();
    for _ in 0..12 {
        origins.push(cell_point(&mut random, [false, false, false]));
        origins.push(cell_point(&mut random, [true, false, false]));
        origins.push(cell_point(&mut random, [false, true, true]));
        origins.push(cell_point(&mut random, [true, true, true]));
        origins.push(std::array::from_fn(|axis| random.range(low[axis], high[axis])));
        // On the box's faces: the padded one and the triangles' own.
        let axis = random.below(3) as usize;
        let mut point: V = std::array::from_fn(|axis| random.range(low[axis], high[axis]));
        point[axis] = [low[axis], high[axis], box_bounds.min[axis], box_bounds.max[axis]][random.below(4) as usize];
        origins.push(point);
        let vertex = mesh.indices[random.below(mesh.indices.len() as u32) as usize].map(|vertex| mesh.positions[vertex as usize]);
        if vertex.iter().flatten().all(|x| x.is_finite()) {
            origins.push(vertex[0]);
            origins.push(scaled(add(vertex[1], vertex[2]), 0.5));
        }
    }
    let mut rays = Vec::new();
    for origin in &origins {
        for direction in &directions {
            rays.push(ray(*origin, *direction));
            let length = direction.iter().map(|x| x * x).sum::<f32>().sqrt();
            for boxes in [1.0, 1e3, 1e6_f32] {
                let away = scaled(*direction, -reach * boxes / length);
                rays.push(ray(add(*origin, away), *direction));
            }
        }
    }
    rays
}

/// Numbers that no ray should hold.
pub fn invalid_rays() -> Vec<Ray> {
    let good = Ray { origin: [0.1, 0.2, -5.0], t_min: 0.0, direction: [0.0, 0.0, 1.0], t_max: f32::INFINITY };
    let mut rays = vec![Ray { direction: [0.0; 3], ..good }, Ray { direction: [-0.0, 0.0, -0.0], ..good }];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut broken = good;
            broken.origin[axis] = bad;
            rays.push(broken);
            let mut broken = good;
            broken.direction[axis] = bad;
            rays.push(broken);
        }
    }
    rays.push(Ray { t_min: f32::NAN, ..good });
    rays.push(Ray { t_max: f32::NAN, ..good });
    rays.push(Ray { t_min: f32::INFINITY, ..good });
    rays.push(Ray { t_max: f32::NEG_INFINITY, ..good });
    rays.push(Ray { t_min: 2.0, t_max: 1.0, ..good });
    rays
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: V) -> V {
    let largest = a.iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
    let a = a.map(|x| x / largest);
    let length = a.iter().map(|x| x * x).sum::<f32>().sqrt();
    a.map(|x| x / length)
}
