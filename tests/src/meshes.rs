//! Triangles to build grids over.

use crate::gpu::Mesh;
use crate::random::Random;

/// Triangles of about `size` around random points of [-1, 1)^3.
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

/// Spoils about one triangle of `every`: a vertex that is not finite, or an index out of range.
pub fn spoil(mesh: &mut Mesh, every: u32, seed: u64) {
    let mut random = Random::new(seed);
    let vertices = mesh.positions.len() as u32;
    for triangle in 0..mesh.indices.len() {
        if random.below(every) != 0 {
            continue;
        }
        let corner = random.below(3) as usize;
        let vertex = mesh.indices[triangle][corner] as usize;
        let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        match random.below(4) {
            3 => mesh.indices[triangle][corner] = if random.below(2) == 0 { vertices } else { u32::MAX },
            which => mesh.positions[vertex][random.below(3) as usize] = bad[which as usize],
        }
    }
}

/// A triangle of `size` around `centre`, in a random plane.
fn triangle(random: &mut Random, centre: [f32; 3], size: f32) -> [[f32; 3]; 3] {
    std::array::from_fn(|_| {
        let offset = random.point(-size, size);
        std::array::from_fn(|axis| centre[axis] + offset[axis])
    })
}

fn scaled(mesh: &Mesh, f: impl Fn([f32; 3]) -> [f32; 3]) -> Mesh {
    Mesh { positions: mesh.positions.iter().map(|p| f(*p)).collect(), indices: mesh.indices.clone() }
}

/// Geometry that has broken ray tracers, with names.
pub fn hostile() -> Vec<(&'static str, Mesh)> {
    let random = &mut Random::new(99);
    let some = soup(400, 0.2, 7);
    let flat = |axis: usize| {
        let mut mesh = soup(400, 0.2, 8);
        mesh.positions.iter_mut().for_each(|p| p[axis] = 0.37);
        mesh
    };
    let line = scaled(&some, |p| [p[0], -2.5, 4.0]);
    let zero_area = Mesh::from_triangles(&std::array::from_fn::<_, 300, _>(|_| {
        let (a, b) = (random.point(-1.0, 1.0), random.point(-1.0, 1.0));
        [a, b, [0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis]))]
    }));
    let needles: Vec<_> = (0..200)
        .map(|_| {
            let (a, b) = (random.point(-1.0, 1.0), random.point(-1.0, 1.0));
            [a, b, [b[0] + 1e-6, b[1] - 1e-6, b[2]]]
        })
        .collect();
    let mut negative_zeros = soup(300, 0.3, 10);
    for (i, p) in negative_zeros.positions.iter_mut().enumerate() {
        p[i % 3] = if i % 2 == 0 { -0.0 } else { 0.0 };
    }
    let mut not_finite = soup(500, 0.2, 11);
    spoil(&mut not_finite, 4, 12);
    let mut out_of_range = soup(300, 0.2, 13);
    out_of_range.indices[0] = [u32::MAX; 3];
    out_of_range.indices[150][2] = out_of_range.positions.len() as u32;
    out_of_range.indices[299][0] = 1 << 31;
    let mut all_dropped = soup(50, 0.2, 14);
    all_dropped.positions.iter_mut().for_each(|p| p[2] = f32::INFINITY);
    let mut stadium: Vec<_> = (0..20_000).map(|_| triangle(random, [0.3, 0.3, 0.3], 1e-4)).collect();
    stadium.insert(777, [[-1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 0.5]]);
    let mut one_cell: Vec<_> = (0..5_000).map(|_| triangle(random, [0.001, 0.001, 0.001], 1e-4)).collect();
    one_cell.extend([[[-1.0; 3]; 3], [[1.0; 3]; 3]]);
    vec![
        ("empty", Mesh::default()),
        ("vertices without a triangle", Mesh { indices: Vec::new(), ..some.clone() }),
        ("one triangle", soup(1, 0.5, 1)),
        (
            "two coplanar",
            Mesh::from_triangles(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.2, 0.2, 0.0], [0.9, 0.0, 0.0], [0.0, 0.5, 0.0]]]),
        ),
        ("identical", Mesh::from_triangles(&vec![[[-1.0, -0.5, 0.0], [1.0, -0.5, 0.3], [0.0, 0.5, 0.7]]; 100_000])),
        ("flat in x", flat(0)),
        ("flat in y", flat(1)),
        ("flat in z", flat(2)),
        ("a line", line),
        ("a point", scaled(&some, |_| [3.0, 4.0, 5.0])),
        ("a point at the origin", scaled(&some, |_| [0.0; 3])),
        ("zero area", zero_area),
        ("needles", Mesh::from_triangles(&needles)),
        ("coordinates of 1e-30", scaled(&some, |p| p.map(|x| x * 1e-30))),
        ("coordinates of 1e18", scaled(&some, |p| p.map(|x| x * 1e18))),
        ("coordinates of 1e30", scaled(&some, |p| p.map(|x| x * 1e30))),
        ("coordinates of 3e38", scaled(&some, |p| p.map(|x| (x * 3e38).clamp(-3e38, 3e38)))),
        ("denormals", scaled(&some, |p| p.map(|x| x * 1e-40))),
        ("far from the origin", scaled(&some, |p| [p[0] + 148_376.0, p[1] + 1_234.0, p[2] - 223_423.0])),
        ("negative zeros", negative_zeros),
        ("not finite", not_finite),
        ("index out of range", out_of_range),
        ("all dropped", all_dropped),
        ("one huge, many tiny", Mesh::from_triangles(&stadium)),
        ("all in one cell", Mesh::from_triangles(&one_cell)),
    ]
}
