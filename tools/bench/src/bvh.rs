//! The trees of crate `obvhs` as a rival: the binary one of its fastest build, and the eight-way compressed one of its best.

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use glam::Vec3A;
use gridwalk::{Hit, Ray};
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};

use obvhs::ray::RayHit;
use obvhs::triangle::Triangle;
use rayon::ThreadPool;

use crate::contender::Tree;
use crate::host::{HostTree, Library};

/// As the report has it.
pub const NAME: &str = "obvhs";

/// The crate with the triangles that its trees are of.
pub struct Meshed {
    mesh: Arc<Mesh>,
    pool: Arc<ThreadPool>,
}

struct Mesh {
    triangles: Vec<Triangle>,
    /// Of each of them among all: those that are not finite are left out.
    ids: Vec<u32>,
}

/// The threads that build.
///
/// # Errors
/// The system gives none.
pub fn pool(threads: u32) -> Result<Arc<ThreadPool>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build();
    Ok(Arc::new(pool.context("no threads for obvhs")?))
}

impl Meshed {
    /// Copies triangles; `None` where an index leads nowhere.
    pub fn new(pool: &Arc<ThreadPool>, positions: &[[f32; 3]], indices: &[[u32; 3]]) -> Option<Meshed> {
        let mut mesh = Mesh { triangles: Vec::with_capacity(indices.len()), ids: Vec::with_capacity(indices.len()) };
        for (id, [a, b, c]) in (0..).zip(indices) {
            let corner = |index: &u32| positions.get(*index as usize).copied().map(Vec3A::from);
            let triangle = Triangle { v0: corner(a)?, v1: corner(b)?, v2: corner(c)? };
            if [triangle.v0, triangle.v1, triangle.v2].iter().all(|corner| corner.is_finite()) {
                mesh.triangles.push(triangle);
                mesh.ids.push(id);
            }
        }
        Some(Meshed { mesh: Arc::new(mesh), pool: Arc::clone(pool) })
    }
}

impl Library for Meshed {
    type Tree = Built;

    fn name(&self) -> &'static str {
        NAME
    }

    fn threads(&self) -> u32 {
        u32::try_from(self.pool.current_num_threads()).unwrap_or(u32::MAX)
    }

    fn tree(&self, tree: Tree) -> Result<Built> {
        let (mesh, pool) = (Arc::clone(&self.mesh), Arc::clone(&self.pool));
        let bvh = build(&mesh, &pool, tree);
        // For the best rays, in the order in which the leaves name them.
        let ordered = match &bvh {
            Bvh::Binary(_) => Vec::new(),
            Bvh::Wide(bvh) => bvh.primitive_indices.iter().filter_map(|&index| mesh.triangles.get(index as usize).copied()).collect(),
        };
        Ok(Built { mesh, pool, bvh, ordered })
    }
}

enum Bvh {
    Binary(Bvh2),
    Wide(CwBvh),
}

fn build(mesh: &Mesh, pool: &ThreadPool, tree: Tree) -> Bvh {
    let time = &mut Duration::default();
    pool.install(|| match tree {
        Tree::Fast => Bvh::Binary(build_bvh2_from_tris(&mesh.triangles, BvhBuildParams::fastest_build(), time)),
        Tree::Best => Bvh::Wide(build_cwbvh_from_tris(&mesh.triangles, BvhBuildParams::very_slow_build(), time)),
    })
}

/// A tree that was built.
pub struct Built {
    mesh: Arc<Mesh>,
    pool: Arc<ThreadPool>,
    bvh: Bvh,
    ordered: Vec<Triangle>,
}

/// A triangle of a list, and where a ray hits it.
fn distance(triangles: &[Triangle], at: usize, ray: &obvhs::ray::Ray) -> f32 {
    triangles.get(at).map_or(f32::INFINITY, |triangle| triangle.intersect(ray))
}

impl Built {
    /// Where a ray hits what a leaf names.
    fn distance(&self, bvh: &Bvh2, at: usize, ray: &obvhs::ray::Ray) -> f32 {
        bvh.primitive_indices.get(at).map_or(f32::INFINITY, |&index| distance(&self.mesh.triangles, index as usize, ray))
    }
}

impl HostTree for Built {
    fn rebuild(&mut self) -> Result<f64> {
        let tree = match self.bvh {
            Bvh::Binary(_) => Tree::Fast,
            Bvh::Wide(_) => Tree::Best,
        };
        let begin = Instant::now();
        self.bvh = build(&self.mesh, &self.pool, tree);
        Ok(begin.elapsed().as_secs_f64() * 1e3)
    }

    fn closest(&self, ray: &Ray) -> Hit {
        let ray = query(ray);
        let mut hit = RayHit::none();
        let (found, indices) = match &self.bvh {
            Bvh::Binary(bvh) => (bvh.ray_traverse(ray, &mut hit, |ray, at| self.distance(bvh, at, ray)), &bvh.primitive_indices),
            Bvh::Wide(bvh) => (bvh.ray_traverse(ray, &mut hit, |ray, at| distance(&self.ordered, at, ray)), &bvh.primitive_indices),
        };
        let triangle = indices.get(hit.primitive_id as usize).and_then(|&index| self.mesh.ids.get(index as usize));
        match triangle.filter(|_| found) {
            Some(&triangle) => Hit { t: hit.t, u: 0.0, v: 0.0, triangle },
            None => Hit::MISS,
        }
    }

    fn any(&self, ray: &Ray) -> bool {
        let ray = query(ray);
        !match &self.bvh {
            Bvh::Binary(bvh) => bvh.ray_traverse_miss(ray, |ray, at| self.distance(bvh, at, ray)),
            Bvh::Wide(bvh) => bvh.ray_traverse_miss(ray, |ray, at| distance(&self.ordered, at, ray)),
        }
    }

    fn bytes(&self) -> Option<u64> {
        let triangles = size_of_val(self.mesh.triangles.as_slice()).max(size_of_val(self.ordered.as_slice()));
        let (nodes, indices) = match &self.bvh {
            Bvh::Binary(bvh) => (size_of_val(bvh.nodes.as_slice()), &bvh.primitive_indices),
            Bvh::Wide(bvh) => (size_of_val(bvh.nodes.as_slice()), &bvh.primitive_indices),
        };
        Some((triangles + nodes + size_of_val(indices.as_slice())) as u64)
    }
}

fn query(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_and_one_that_is_none() {
        let positions =
            [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [f32::NAN; 3], [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]];
        let pool = pool(2).unwrap();
        assert!(Meshed::new(&pool, &positions, &[[0, 1, 7]]).is_none());
        let rival = Meshed::new(&pool, &positions, &[[4, 5, 6], [0, 1, 3], [0, 1, 2]]).unwrap();
        assert_eq!(rival.threads(), 2);
        let ray = |x: f32, t_max: f32| Ray { origin: [x, 0.25, 0.0], t_min: 0.0, direction: [0.0, 0.0, 1.0], t_max };
        for tree in [Tree::Fast, Tree::Best] {
            let mut built = rival.tree(tree).unwrap();
            assert!(built.rebuild().unwrap() > 0.0 && built.bytes().unwrap() > 0);
            assert_eq!(built.closest(&ray(0.5, f32::INFINITY)), Hit { t: 1.0, u: 0.0, v: 0.0, triangle: 2 });
            assert_eq!(built.closest(&ray(2.0, f32::INFINITY)), Hit::MISS);
            assert_eq!([built.any(&ray(0.5, 1.5)), built.any(&ray(0.5, 0.5)), built.any(&ray(2.0, 9.0))], [true, false, false]);
        }
    }
}
