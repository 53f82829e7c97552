//! The trace kernels against their twins, and the walk's invariant in double precision.

use gridwalk::{BuildOptions, Hit, Overlap, Ray, Shape};
use gridwalk_core::intersect::{Intersection, move_ray};
use gridwalk_core::layout::{TraceState, WalkState};
use gridwalk_core::twin::any_hit::any_hit_of;
use gridwalk_core::twin::brute_force::brute_force_of;
use gridwalk_core::twin::closest_candidate::gridwalk_closest_hit;
use gridwalk_core::twin::closest_hit::{Launch, Slot, closest_hit_of};
use gridwalk_core::twin::{trace_args::trace_args, trace_continue_args::trace_continue_args};
use gridwalk_core::walk::{Filter, GRIDWALK_TURNS, Grid, Observer, Walk};
use gridwalk_tests::gpu::{Gpu, TraceOptions};
use rayon::prelude::*;

use super::compare::{along, cross, differences, differences_from_twin, dot, edge_on, length, sub, to_triangle};
use super::{meshes, rays};

const CONTINUATIONS: usize = gridwalk::plan::CONTINUATIONS as usize;

/// The launches of a trace.
pub fn launches(resume: bool, filter: Filter) -> [Launch; CONTINUATIONS + 1] {
    std::array::from_fn(|turn| Launch { continues: turn > 0, last: turn == CONTINUATIONS, resume, filter })
}

/// All launches of a trace of the closest hit of one ray.
pub fn closest(grid: &Grid, ray: &Ray, existing: Option<Hit>, observer: &mut impl Observer) -> Slot {
    let mut slot = Slot { hit: existing.unwrap_or(Hit::MISS), ..Slot::NEW };
    for launch in launches(existing.is_some(), Filter::default()) {
        closest_hit_of(grid, ray, &mut slot, launch, observer);
    }
    slot
}

/// All launches of a trace of any hit of one ray.
pub fn any(grid: &Grid, ray: &Ray) -> u32 {
    let (mut occluded, mut walk) = (0, WalkState::default());
    for launch in launches(false, Filter::default()) {
        any_hit_of(grid, ray, &mut occluded, &mut walk, launch, &mut ());
    }
    occluded
}

/// Closest hits of many rays.
pub fn closest_hits(grid: &Grid, rays: &[Ray]) -> Vec<Hit> {
    rays.par_iter().map(|ray| closest(grid, ray, None, &mut ()).hit).collect()
}

/// Closest hits of many rays among all triangles.
pub fn brute_force(grid: &Grid, rays: &[Ray]) -> Vec<Hit> {
    let end = grid.header.triangle_count;
    rays.par_iter().map(|ray| brute_force_of(grid, ray, &mut WalkState::default(), 0..end)).collect()
}

#[test]
fn the_kernels_agree_with_their_twins() {
    let gpu = Gpu::shared();
    for model in meshes::small() {
        for (density, overlap) in [(1.0, Overlap::Exact), (16.0, Overlap::Box)] {
            let label = format!("{} at density {density}, {overlap:?}", model.name);
            let built = super::build(gpu, &model.mesh, BuildOptions { density, overlap, ..BuildOptions::default() });
            let copy = built.copy();
            let grid = copy.view();
            let mut rays = rays::random_rays(&model.mesh, 3_000, 11);
            rays.extend(rays::diffuse_rays(&model.mesh, 1_000, 12));
            rays.extend(rays::hard_rays(&model.mesh, grid.header, 13).into_iter().step_by(7));
            rays.extend(rays::invalid_rays());
            // So far away that rounding moves a ray by more than the box: where it lands does not matter, but all land there.
            let far =
                |ray: &Ray| Ray { origin: rays::sub(ray.origin, rays::scaled(ray.direction, 1e9 * rays::extent(&model.mesh))), ..*ray };
            // So far that products overflow: none is hit.
            let lost =
                |ray: &Ray| Ray { origin: rays::sub(ray.origin, rays::scaled(ray.direction, 1e30 * rays::extent(&model.mesh))), ..*ray };
            rays.extend(rays.clone().iter().step_by(20).flat_map(|ray| [far(ray), lost(ray)]));
            for (index, ray) in rays.iter_mut().enumerate() {
                match index % 8 {
                    0 => ray.t_max = 1.0,
                    1 => ray.t_min = 0.5,
                    2 => ray.t_min = -3.0,
                    _ => {}
                }
            }
            let expected: Vec<_> = rays.par_iter().map(|ray| closest(&grid, ray, None, &mut ())).collect();
            let hits: Vec<_> = expected.iter().map(|slot| slot.hit).collect();
            let (found, counters) = gpu.closest_with(&built, &rays, &TraceOptions { count: true, ..TraceOptions::default() });
            let different = differences_from_twin(gpu, &found, &hits);
            if let Some(&ray) = different.first() {
                panic!("{label}: {} rays, first {ray} {:?}: {:?}, twin {:?}", different.len(), rays[ray], found[ray], hits[ray]);
            }
            for (index, (counted, slot)) in counters.iter().zip(&expected).enumerate() {
                let twin = [slot.counters.steps, slot.counters.tests, slot.counters.cells, 0];
                assert!(
                    !gpu.context.is_cpu() || *counted == twin,
                    "{label}: ray {index} {:?} counts {counted:?}, twin {twin:?}",
                    rays[index]
                );
                let most = (grid.header.resolution.iter().sum::<u32>() << grid.header.fine_shift) + 3;
                assert!(counted[0] <= most, "{label}: ray {index} {:?} takes {} steps of {most}", rays[index], counted[0]);
            }
            let occluded: Vec<_> = rays.par_iter().map(|ray| any(&grid, ray)).collect();
            let found_any = gpu.any(&built, &rays);
            if gpu.context.is_cpu() {
                assert_eq!(found_any, occluded, "{label}");
            }
            let by_include: Vec<_> = rays.par_iter().map(|ray| gridwalk_closest_hit(&grid, ray)).collect();
            // The include gives up after fewer turns than all launches of a kernel together.
            let within = |ray: &usize| expected[*ray].counters.steps + expected[*ray].counters.tests <= GRIDWALK_TURNS;
            let different: Vec<_> = differences(&by_include, &hits).into_iter().filter(within).collect();
            assert_eq!(different, [0; 0], "{label}: the twins of the include and of the kernel");
            let found_by_include = gpu.closest_by_include(&built, &rays);
            assert_eq!(differences_from_twin(gpu, &found_by_include, &by_include), [0; 0], "{label}: the include and its twin");
            let different: Vec<_> = differences(&found_by_include, &found).into_iter().filter(within).collect();
            assert_eq!(different, [0; 0], "{label}: the include and the kernel");

            // Half a scene's hits, beaten by the whole.
            let resumed = |index: usize| if index.is_multiple_of(2) { Hit::MISS } else { Hit { t: 0.3, u: 0.5, v: 0.25, triangle: 7 } };
            let existing: Vec<_> = (0..rays.len()).map(resumed).collect();
            let expected: Vec<_> = rays.par_iter().zip(&existing).map(|(ray, hit)| closest(&grid, ray, Some(*hit), &mut ()).hit).collect();
            let (found, _) = gpu.closest_with(&built, &rays, &TraceOptions { resume: Some(&existing), ..TraceOptions::default() });
            assert_eq!(differences_from_twin(gpu, &found, &expected), [0; 0], "{label}: resumed");

            let few = &rays[..300];
            assert_eq!(differences_from_twin(gpu, &gpu.brute_force(&built, few), &brute_force(&grid, few)), [0; 0], "{label}: brute force");
        }
    }
}

/// A CPU loads the rows of triangles otherwise than a GPU, and each runs one way alone.
#[test]
fn the_kernels_of_both_kinds_of_devices_agree() {
    let [cpu, other] = [Shape::CPU, Shape::GPU].map(Gpu::with_shape);
    assert_ne!(cpu.tracer.shape().by_two, other.tracer.shape().by_two);
    for (name, mesh) in [("soup", meshes::soup(400, 0.3, 25)), ("sphere", meshes::sphere([0.3, -0.1, 0.2], 1.0, 24))] {
        let grids = [cpu, other].map(|gpu| super::build(gpu, &mesh, BuildOptions::default()));
        let copy = grids[1].copy();
        let mut rays = rays::random_rays(&mesh, 3_000, 26);
        rays.extend(rays::diffuse_rays(&mesh, 1_000, 27));
        let expected = closest_hits(&copy.view(), &rays);
        let [by_cpu, by_other] = [(cpu, &grids[0]), (other, &grids[1])].map(|(gpu, grid)| (gpu.closest(grid, &rays), gpu.any(grid, &rays)));
        assert_eq!(differences_from_twin(other, &by_other.0, &expected), [0; 0], "{name}");
        assert_eq!(differences(&by_other.0, &by_cpu.0), [0; 0], "{name}");
        assert_eq!(by_other.1, by_cpu.1, "{name}: any");
        assert!(expected.iter().filter(|hit| hit.is_hit()).count() > 500, "{name}");
    }
}

#[test]
fn a_wrong_vertex_is_found_by_the_twin() {
    let gpu = Gpu::shared();
    let mesh = meshes::sphere([0.0; 3], 1.0, 24);
    let built = super::build(gpu, &mesh, BuildOptions::default());
    let rays = rays::random_rays(&mesh, 5_000, 21);
    let found = gpu.closest(&built, &rays);
    let mut copy = built.copy();
    assert_eq!(differences_from_twin(gpu, &found, &closest_hits(&copy.view(), &rays)), [0; 0]);
    let victim = found.iter().find(|hit| hit.is_hit()).unwrap().triangle as usize;
    copy.triangles[victim][0][0] += 0.01;
    assert!(!differences_from_twin(gpu, &found, &closest_hits(&copy.view(), &rays)).is_empty());
}

#[test]
fn argument_kernels_agree_with_their_twins() {
    let shape = Gpu::shared().tracer.shape();
    for (count, max) in
        [(None, 0), (None, 1), (None, 65_535 * 64), (None, 65_535 * 64 + 1), (Some(0), 9), (Some(10), 9), (Some(u32::MAX), 1 << 28)]
    {
        let mut state = TraceState::default();
        trace_args(&mut state, count, max, &shape);
        let [x, y, z, _] = state.arguments;
        let places = [x, y, z, shape.map_size].map(u64::from).iter().product::<u64>();
        let rays = count.map_or(max, |count| count.min(max));
        assert_eq!((state.ray_count, z), (rays, shape.strands));
        assert!(x <= 65_535 && y <= 65_535 && places >= u64::from(rays));
        trace_continue_args(&mut state, &shape);
        assert_eq!(state.arguments[0], 0, "nothing was given up");
        state.unfinished = 1;
        trace_continue_args(&mut state, &shape);
        assert_eq!((state.arguments, state.unfinished), ([x, y, z, 0], 0));
    }
}

/// Watches a walk in double precision. Numbers are in units of half the padding.
#[derive(Default)]
struct Invariant {
    exit: f64,
    cells: u64,
    hits: u64,
    edge_on: u64,
    worst_point: f64,
    worst_hit: f64,
    broken: Vec<String>,
    ray: Option<Ray>,
}

impl Invariant {
    fn outside(walk: &Walk, grid: &Grid, s: f64) -> f64 {
        let header = grid.header;
        let point = along(walk.ray.origin.map(f64::from), walk.ray.direction.map(f64::from), s);
        let beside = |axis: usize| {
            let low = header.box_min[axis] + walk.low[axis] as f32 * header.fine_cell_size[axis];
            let high = header.box_min[axis] + walk.high[axis] as f32 * header.fine_cell_size[axis];
            (f64::from(low) - point[axis]).max(point[axis] - f64::from(high)).max(0.0)
        };
        (0..3).map(beside).fold(0.0, f64::max) / (0.5 * f64::from(header.pad))
    }

    fn box_entry(walk: &Walk, grid: &Grid) -> f64 {
        let entry = |axis: usize| {
            let (low, high) = (f64::from(grid.header.box_min[axis]), f64::from(grid.header.box_max[axis]));
            let (origin, direction) = (f64::from(walk.ray.origin[axis]), f64::from(walk.ray.direction[axis]));
            if direction == 0.0 { 0.0 } else { ((low - origin) / direction).min((high - origin) / direction) }
        };
        (0..3).map(entry).fold(0.0, f64::max)
    }

    fn demand(&mut self, kept: bool, text: impl FnOnce() -> String) {
        if !kept {
            self.broken.push(text());
        }
    }
}

impl Observer for Invariant {
    fn cell(&mut self, walk: &Walk, grid: &Grid, entry: f32) {
        let (entry, exit) = (f64::from(entry), f64::from(walk.exit));
        self.demand(entry == self.exit, || format!("enters {:?} at {entry}, not where it left the last cell", walk.cell));
        self.demand(exit >= entry, || format!("leaves {:?} at {exit} before {entry}", walk.cell));
        // The walk may begin a little before the box, where nothing can be hit.
        let inside = Self::box_entry(walk, grid);
        self.exit = exit;
        self.cells += 1;
        if exit < inside {
            return;
        }
        // The segment is as near to the block as the farther of its ends.
        let beside = Self::outside(walk, grid, entry.max(inside)).max(Self::outside(walk, grid, exit));
        self.worst_point = self.worst_point.max(beside);
        self.demand(beside <= 1.0, || format!("is {beside:.2} beside {:?} between {entry} and {exit}", walk.cell));
    }

    fn hit(&mut self, walk: &Walk, grid: &Grid, triangle: u32, hit: Intersection) {
        self.hits += 1;
        let direction = walk.ray.direction.map(f64::from);
        let vertices = grid.triangle(triangle).map(|v| v.map(f64::from));
        let point = along(walk.ray.origin.map(f64::from), direction, f64::from(hit.s));
        let beside = to_triangle(point, vertices) / (0.5 * f64::from(grid.header.pad));
        let determinant = self.ray.map_or(1.0, |ray| edge_on(grid, &ray, triangle));
        if determinant < super::compare::EDGE_ON {
            self.edge_on += 1;
            return;
        }
        // Rounding moves the triangle's plane, and the hit along the ray by as much over the sine of the angle between the two.
        let normal = cross(sub(vertices[1], vertices[0]), sub(vertices[2], vertices[0]));
        let sine = dot(normal, direction).abs() / (length(normal) * length(direction));
        let beside = beside * sine;
        self.worst_hit = self.worst_hit.max(beside);
        self.demand(beside <= 1.0, || {
            format!("hits {beside:.2} beside triangle {triangle} at {}, sine {sine:.1e}, relative determinant {determinant:.1e}", hit.s)
        });
    }
}

fn watch(grid: &Grid, rays: &[Ray]) -> Invariant {
    let watch_one = |ray: &Ray| {
        let mut invariant = Invariant { ray: Some(*ray), ..Invariant::default() };
        closest(grid, ray, None, &mut invariant);
        for text in &mut invariant.broken {
            *text = format!("{ray:?} {text}");
        }
        invariant
    };
    rays.par_iter().map(watch_one).reduce(Invariant::default, |mut a, b| {
        a.cells += b.cells;
        a.hits += b.hits;
        a.edge_on += b.edge_on;
        a.worst_point = a.worst_point.max(b.worst_point);
        a.worst_hit = a.worst_hit.max(b.worst_hit);
        a.broken.extend(b.broken);
        a
    })
}

#[test]
fn the_walk_keeps_its_invariant_in_double_precision() {
    let gpu = Gpu::shared();
    let mut models = meshes::small();
    let offset = meshes::sphere([148_376.0, 1_234.0, -223_423.0], 2.0, 50);
    models.push(meshes::Model { name: "sphere far from the origin".to_owned(), mesh: offset });
    for model in models {
        for (density, overlap) in [(0.1, Overlap::Box), (8.0, Overlap::Exact), (64.0, Overlap::Box)] {
            let built = super::build(gpu, &model.mesh, BuildOptions { density, overlap, ..BuildOptions::default() });
            let copy = built.copy();
            let grid = copy.view();
            let mut rays = rays::random_rays(&model.mesh, 20_000, 31);
            rays.extend(rays::diffuse_rays(&model.mesh, 10_000, 32));
            rays.extend(rays::hard_rays(&model.mesh, grid.header, 33));
            // From farther away a ray's own rounding is coarser than the padding.
            rays.retain(|ray| move_ray(ray, grid.header).is_none_or(|moved| moved.start < 65_536.0));
            let seen = watch(&grid, &rays);
            eprintln!(
                "{} at density {density}: {} cells, at most {:.2} half paddings beside one; {} hits, at most {:.2} beside the triangle across its plane, {} edge-on",
                model.name, seen.cells, seen.worst_point, seen.hits, seen.worst_hit, seen.edge_on
            );
            assert!(seen.broken.is_empty(), "{} at density {density}: {} times, first: {}", model.name, seen.broken.len(), seen.broken[0]);
            assert!(seen.cells > 0);
        }
    }
}

#[test]
fn a_walk_beside_its_cells_is_found() {
    let gpu = Gpu::shared();
    let mesh = meshes::soup(500, 0.1, 41);
    let built = super::build(gpu, &mesh, BuildOptions::default());
    let rays = rays::random_rays(&mesh, 2_000, 42);
    let mut copy = built.copy();
    assert!(watch(&copy.view(), &rays).broken.is_empty());
    // The same walk, of which more is asked.
    copy.header.pad *= 1e-3;
    assert!(!watch(&copy.view(), &rays).broken.is_empty());
}
