//! Rays that leave a surface where others hit it.

use anyhow::Result;
use gridwalk::{Hit, Ray};
use gridwalk_render::{Grid, RayBatch};
use gridwalk_scene::{Light, Mesh};

use crate::vector::{cross, dot, sub, unit};

/// Rays of one kind and what they found.
pub struct Traced {
    pub rays: Vec<Ray>,
    pub hits: Vec<Hit>,
}

/// Triangles, as the device has them.
pub struct Surface {
    pub positions: Vec<[f32; 3]>,
    pub indices: Vec<[u32; 3]>,
    /// How far secondary rays start off the surface.
    pub offset: f32,
}

impl Traced {
    /// Finds the closest hits.
    ///
    /// # Errors
    /// What the device reports.
    pub fn new(grid: &Grid, rays: Vec<Ray>) -> Result<Traced> {
        let mut batch = RayBatch::new(grid.context(), &rays)?;
        batch.closest_hit(grid)?;
        let hits = batch.read_hits()?;
        Ok(Traced { rays, hits })
    }
}

impl Surface {
    /// The triangles of a mesh; rays start a ten-thousandth of its largest side off it.
    pub fn new(mesh: &Mesh) -> Surface {
        let extent = mesh.bounds().map_or(0.0, |bounds| sub(bounds.max, bounds.min).into_iter().fold(0.0, f32::max));
        Surface { positions: mesh.positions.clone(), indices: mesh.indices.clone(), offset: extent * 1e-4 }
    }

    /// Where a ray hit, a little off the surface on the ray's side, and the normal on that side.
    fn point(&self, ray: &Ray, hit: &Hit) -> Option<([f32; 3], [f32; 3])> {
        let corners = self.indices.get(hit.triangle as usize)?;
        let [a, b, c] = corners.map(|corner| self.positions.get(corner as usize).copied().unwrap_or([f32::NAN; 3]));
        let mut normal = unit(cross(sub(b, a), sub(c, a)));
        if dot(normal, ray.direction) > 0.0 {
            normal = normal.map(|value| -value);
        }
        let weight = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let point =
            std::array::from_fn(|axis| weight[0] * a[axis] + weight[1] * b[axis] + weight[2] * c[axis] + self.offset * normal[axis]);
        Some((point, normal))
    }

    /// A mirrored ray from each hit.
    pub fn reflections(&self, traced: &Traced) -> Vec<Ray> {
        self.at_hits(traced, |ray, origin, normal| {
            let along = 2.0 * dot(ray.direction, normal);
            let direction = std::array::from_fn(|axis| ray.direction[axis] - along * normal[axis]);
            Some(Ray { origin, t_min: 0.0, direction, t_max: f32::INFINITY })
        })
    }

    /// A ray to the light from each hit that faces it.
    pub fn shadows(&self, traced: &Traced, light: Option<Light>) -> Vec<Ray> {
        self.at_hits(traced, |_, origin, normal| {
            let (direction, t_max) = match light? {
                Light::Directional { direction, .. } => (direction.map(|value| -value), f32::INFINITY),
                Light::Point { position, .. } | Light::Spot { position, .. } => (sub(position, origin), 1.0),
                _ => return None,
            };
            (dot(direction, normal) > 0.0).then_some(Ray { origin, t_min: 0.0, direction, t_max })
        })
    }

    fn at_hits(&self, traced: &Traced, make: impl Fn(&Ray, [f32; 3], [f32; 3]) -> Option<Ray>) -> Vec<Ray> {
        let hits = traced.rays.iter().zip(&traced.hits).filter(|(_, hit)| hit.is_hit());
        hits.filter_map(|(ray, hit)| self.point(ray, hit).and_then(|(point, normal)| make(ray, point, normal))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor() -> Surface {
        let positions = vec![[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [0.0, 0.0, 9.0]];
        Surface { positions, indices: vec![[0, 1, 2]], offset: 0.5 }
    }

    fn downwards() -> Traced {
        let ray = Ray { origin: [0.0, 2.0, 0.0], t_min: 0.0, direction: [1.0, -1.0, 0.0], t_max: f32::INFINITY };
        Traced { rays: vec![ray, ray], hits: vec![Hit { t: 2.0, u: 0.25, v: 0.5, triangle: 0 }, Hit::MISS] }
    }

    #[test]
    fn rays_leave_on_the_side_from_which_they_came() {
        let reflected = floor().reflections(&downwards());
        assert_eq!(reflected.len(), 1, "a miss reflects nothing");
        assert_eq!((reflected[0].origin, reflected[0].direction), ([0.0, 0.5, 0.0], [1.0, 1.0, 0.0]));
    }

    #[test]
    fn shadow_rays_go_to_lights_above_alone() {
        let rays = |light| floor().shadows(&downwards(), Some(light));
        let sun = |y| Light::Directional { direction: [0.0, y, 0.0], irradiance: [1.0; 3] };
        assert_eq!(rays(sun(-1.0)).len(), 1);
        assert!(rays(sun(1.0)).is_empty());
        let lamp = rays(Light::Point { position: [0.0, 4.5, 0.0], intensity: [1.0; 3] });
        assert_eq!((lamp[0].direction, lamp[0].t_max), ([0.0, 4.0, 0.0], 1.0));
        assert!(floor().shadows(&downwards(), None).is_empty());
    }
}
