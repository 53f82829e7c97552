//! Grids that size themselves, and rays of the caller's own.

use gridwalk::{Hit, MISS, Ray};
use gridwalk_render::{ContextDesc, Error, RayBatch, cast, occluded};
use gridwalk_scene::generate;
use gridwalk_tests::random::Random;

use super::*;

/// Triangles that each cross the whole scene: pairs by the cell.
fn crossing(triangles: u32) -> Scene {
    let mut random = Random::new(11);
    let positions: Vec<[f32; 3]> = (0..3 * triangles).map(|_| random.point(-1.0, 1.0)).collect();
    let mesh = Mesh {
        name: "crossing".into(),
        normals: vec![[0.0, 1.0, 0.0]; positions.len()],
        uvs: vec![[0.0; 2]; positions.len()],
        colours: Vec::new(),
        opacities: Vec::new(),
        indices: (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        materials: Vec::new(),
        positions,
    };
    scene(vec![(mesh, matt(0.5))])
}

#[test]
fn a_grid_that_does_not_fit_is_made_coarser() {
    let scene = crossing(3000);
    let context = Context::new(&ContextDesc { memory_limit: Some(16 << 20), ..ContextDesc::default() }).unwrap();
    let gpu = GpuScene::upload(&context, &scene).unwrap();
    let builder = GridBuilder::new(&context).unwrap();
    let grid = builder.build(&gpu, &BuildSettings { density: 50.0, ..BuildSettings::default() }).unwrap();
    let stats = grid.stats();
    assert!(stats.attempts > 2 && stats.report.density < 50.0 && !stats.report.pairs_overflowed(), "{stats:?}");
    let first = stats.report.density;
    drop(grid);
    // However much was asked for, and down to the half of what fits at worst: so two of them differ by less than 2.
    for density in [f32::MAX, 1e4, 31.0] {
        let grid = builder.build(&gpu, &BuildSettings { density, ..BuildSettings::default() }).unwrap();
        let report = grid.stats().report;
        assert!(!report.pairs_overflowed() && (0.5..=2.0).contains(&(report.density / first)), "{density}: {report:?}, {first} from 50");
    }
    // A resolution is what was asked for, or an error.
    let exact = BuildSettings { resolution: Some([60, 60, 60]), ..BuildSettings::default() };
    let error = builder.build(&gpu, &exact).unwrap_err();
    assert!(matches!(error, Error::OutOfDeviceMemory { .. }), "{error}");
    assert!(context.peak_bytes() <= 16 << 20);
    let coarse = BuildSettings { resolution: Some([5, 6, 7]), ..BuildSettings::default() };
    assert_eq!(builder.build(&gpu, &coarse).unwrap().stats().report.resolution, [5, 6, 7]);
}

#[test]
fn build_settings_without_a_meaning_are_refused() {
    let (gpu, _) = studio().load(&crossing(10));
    for density in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let error = studio().builder.build(&gpu, &BuildSettings { density, ..BuildSettings::default() }).unwrap_err();
        assert!(matches!(error, Error::Setting { setting: "density", .. }), "{error}");
    }
    for resolution in [[u32::MAX; 3], [1 << 14, 1 << 14, 2]] {
        let settings = BuildSettings { resolution: Some(resolution), ..BuildSettings::default() };
        let error = studio().builder.build(&gpu, &settings).unwrap_err();
        assert!(matches!(error, Error::Setting { setting: "resolution", .. }), "{error}");
    }
    let settings = BuildSettings { resolution: Some([0, 1, 1]), ..BuildSettings::default() };
    assert!(matches!(studio().builder.build(&gpu, &settings), Err(Error::Gridwalk(_))));
}

#[test]
fn a_grid_can_be_built_again_in_its_memory() {
    let (gpu, mut grid) = studio().load(&scene(vec![(generate::sphere([0.0; 3], 1.0, 40), matt(0.5))]));
    let first = grid.stats().clone();
    let address = grid.address();
    let bytes = context().allocated_bytes();
    grid.rebuild(&gpu).unwrap();
    assert_eq!((grid.address(), grid.stats().report), (address, first.report));
    grid.free_scratch();
    grid.rebuild(&gpu).unwrap();
    assert_eq!((grid.address(), grid.stats().report), (address, first.report));
    assert!(grid.stats().grid_bytes == first.grid_bytes && bytes > 0);
    // Another scene in the same memory, and one for which it must grow.
    let (small, _) = studio().load(&scene(vec![(generate::cuboid([1.0; 3]), matt(0.5))]));
    grid.rebuild(&small).unwrap();
    assert_eq!((grid.address(), grid.stats().report.triangles), (address, 12));
    let (large, _) = studio().load(&scene(vec![(generate::sphere([0.0; 3], 1.0, 80), matt(0.5))]));
    grid.rebuild(&large).unwrap();
    assert_eq!(grid.stats().report.triangles, large.triangle_count());
    let ray = Ray { origin: [0.0, 0.0, 3.0], t_min: 0.0, direction: [0.0, 0.0, -1.0], t_max: f32::INFINITY };
    assert!((cast(&grid, &[ray]).unwrap()[0].t - 2.0).abs() < 0.01);
}

/// More rays than one submission takes: the parts must not mix.
#[test]
fn rays_keep_their_places() {
    let (_gpu, grid) = studio().load(&scene(vec![(generate::sphere([0.0; 3], 1.0, 64), matt(0.5))]));
    let count = 2 * context().rays_per_submission() as usize + 12_345;
    let mut random = Random::new(5);
    let rays: Vec<Ray> = (0..count)
        .map(|_| Ray { origin: random.point(-2.0, 2.0), t_min: 0.0, direction: random.direction(), t_max: random.range(0.1, 4.0) })
        .collect();
    let hits = cast(&grid, &rays).unwrap();
    let answers = occluded(&grid, &rays).unwrap();
    assert_eq!((hits.len(), answers.len()), (count, count));
    assert!(hits.iter().zip(&answers).all(|(hit, &answer)| answer == u32::from(hit.is_hit())));
    let found = hits.iter().filter(|hit| hit.is_hit()).count();
    assert!(found > count / 20 && found < count / 2, "{found} of {count}");
    for (hit, ray) in hits.iter().zip(&rays).filter(|(hit, _)| hit.is_hit()) {
        let at: f32 = (0..3).map(|i| (ray.origin[i] + hit.t * ray.direction[i]).powi(2)).sum::<f32>().sqrt();
        assert!((0.99..1.001).contains(&at) && hit.t <= ray.t_max, "{ray:?}: {hit:?} lies at {at} of the centre");
    }
    let single: Vec<Hit> = [0, 70_000, count - 1].into_iter().flat_map(|i| cast(&grid, &rays[i..=i]).unwrap()).collect();
    assert_eq!(single, [hits[0], hits[70_000], hits[count - 1]]);
    assert_eq!(cast(&grid, &[]).unwrap(), []);
    let mut batch = RayBatch::new(context(), &rays[..1000]).unwrap();
    let ms = batch.closest_hit(&grid).unwrap();
    assert!(ms >= 0.0);
    assert_eq!(batch.read_hits().unwrap(), hits[..1000]);
    batch.any_hit(&grid).unwrap();
    assert_eq!(batch.read_occluded().unwrap(), answers[..1000]);
    assert_eq!(batch.sort_ms(), 0.0);
    // The order of all of them, traced part by part.
    let mut batch = RayBatch::sorted(context(), &rays).unwrap();
    for _ in 0..2 {
        let ms = batch.closest_hit(&grid).unwrap();
        assert!(ms > batch.sort_ms() && (batch.sort_ms() > 0.0 || !context().has_timestamps()));
        assert_eq!(batch.read_hits().unwrap(), hits);
        batch.any_hit(&grid).unwrap();
        assert_eq!(batch.read_occluded().unwrap(), answers);
    }
    assert!(RayBatch::sorted(context(), &[]).unwrap().closest_hit(&grid).is_ok());
}

#[test]
fn a_scene_without_triangles_has_a_grid() {
    let (gpu, grid) = studio().load(&scene(Vec::new()));
    assert_eq!(grid.stats().report.triangles, 0);
    assert_eq!(gpu.locate(0), None);
    let ray = Ray { origin: [0.0; 3], t_min: 0.0, direction: [1.0, 0.0, 0.0], t_max: f32::INFINITY };
    assert_eq!(cast(&grid, &[ray]).unwrap()[0].triangle, MISS);
    assert_eq!(occluded(&grid, &[ray]).unwrap(), [0]);
}

#[test]
fn triangles_are_counted_within_their_mesh() {
    let parts = vec![(generate::cuboid([1.0; 3]), matt(0.5)), (Mesh::default(), matt(0.5)), (generate::plane([1.0; 2], 2), matt(0.5))];
    let (gpu, _) = studio().load(&scene(parts));
    assert_eq!(gpu.mesh_starts(), [0, 12, 12]);
    assert_eq!([0, 11, 12, 19, 20].map(|triangle| gpu.locate(triangle)), [Some((0, 0)), Some((0, 11)), Some((2, 0)), Some((2, 7)), None]);
}

/// A density that was lowered for many triangles comes back when there are few.
#[test]
fn a_grid_that_was_made_coarser_becomes_finer_again() {
    let context = Context::new(&ContextDesc { memory_limit: Some(16 << 20), ..ContextDesc::default() }).unwrap();
    let [many, fewer, few] = [3000, 2900, 20].map(|triangles| GpuScene::upload(&context, &crossing(triangles)).unwrap());
    let builder = GridBuilder::new(&context).unwrap();
    let settings = BuildSettings { density: 50.0, ..BuildSettings::default() };
    let mut grid = builder.build(&many, &settings).unwrap();
    let lowered = grid.stats().report.density;
    assert!(lowered < 50.0);
    let made = context.allocations();
    grid.rebuild(&fewer).unwrap();
    assert_eq!((grid.stats().report.density, context.allocations()), (lowered, made), "nearly as many: in the same memory");
    for _ in 0..2 {
        grid.rebuild(&few).unwrap();
        let alone = builder.build(&few, &settings).unwrap();
        let (again, alone) = (&grid.stats().report, &alone.stats().report);
        assert_eq!((again.density, again.resolution, again.pairs), (50.0, alone.resolution, alone.pairs));
        grid.rebuild(&many).unwrap();
        assert_eq!(grid.stats().report.density, lowered);
    }
}

/// A small round thing in a wide scene: its cells are split.
fn crowded() -> Scene {
    let small = generate::sphere([0.31, 0.31, 0.31], 0.02, 60);
    scene(vec![(generate::plane([4.0; 2], 2), matt(0.5)), (small, matt(0.5)), (generate::cuboid([1.0; 3]), matt(0.5))])
}

/// The memory for leaf cells grows to what they need, once.
#[test]
fn room_for_leaf_cells_is_found_and_kept() {
    let context = Context::new(&ContextDesc::default()).unwrap();
    let gpu = GpuScene::upload(&context, &crowded()).unwrap();
    let builder = GridBuilder::new(&context).unwrap();
    let mut grid = builder.build(&gpu, &BuildSettings::default()).unwrap();
    let report = grid.stats().report;
    assert!(report.leaf_pairs > 0 && report.overflow == 0 && grid.capacity().leaf_cells >= report.leaf_cells, "{report:?}");
    let made = context.allocations();
    for _ in 0..3 {
        grid.rebuild(&gpu).unwrap();
        assert_eq!((grid.stats().report, grid.stats().attempts, context.allocations()), (report, 1, made));
    }
    let flat = builder.build(&gpu, &BuildSettings { split: false, ..BuildSettings::default() }).unwrap();
    assert_eq!((flat.stats().report.leaf_pairs, flat.capacity().leaf_cells), (0, 0));
    assert_eq!(flat.stats().report.pairs, report.pairs);
}

/// Steps are timed where they are asked for; the whole always is.
#[test]
fn steps_are_timed_on_demand() {
    let context = Context::new(&ContextDesc::default()).unwrap();
    let gpu = GpuScene::upload(&context, &crowded()).unwrap();
    let mut grid = GridBuilder::new(&context).unwrap().build(&gpu, &BuildSettings::default()).unwrap();
    for time_steps in [false, true, false, true] {
        grid.time_steps(time_steps);
        grid.rebuild(&gpu).unwrap();
        let stats = grid.stats();
        assert_eq!(!stats.steps.is_empty(), time_steps && context.has_timestamps());
        assert_eq!(stats.ms > 0.0, context.has_timestamps());
        if time_steps {
            let sum: f64 = stats.steps.iter().map(|step| step.ms).sum();
            assert!((sum - stats.ms).abs() <= 1e-6 * stats.ms, "{sum} of {} ms", stats.ms);
        }
    }
}

/// The second level costs nothing where no cell is split, and is back with the first build that splits one.
#[test]
fn the_second_level_comes_and_goes() {
    let context = Context::new(&ContextDesc::default()).unwrap();
    let [crowded, even] =
        [crowded(), scene(vec![(generate::plane([1.0; 2], 40), matt(0.5))])].map(|scene| GpuScene::upload(&context, &scene).unwrap());
    let builder = GridBuilder::new(&context).unwrap();
    let splits = |grid: &Grid| grid.stats().steps.iter().any(|step| step.name == "leaf_count") || !context.has_timestamps();
    let mut grid = builder.build(&crowded, &BuildSettings { time_steps: true, ..BuildSettings::default() }).unwrap();
    let first = grid.stats().report;
    assert!(first.leaf_pairs > 0 && splits(&grid));
    for turn in 0..2 {
        for has_second_level in [true, false, false] {
            grid.rebuild(&even).unwrap();
            assert_eq!((grid.stats().report.split_cells, splits(&grid)), (0, has_second_level || !context.has_timestamps()), "{turn}");
        }
        grid.rebuild(&crowded).unwrap();
        assert_eq!((grid.stats().report, grid.stats().attempts), (first, 1));
        assert!(splits(&grid));
    }
}

/// Cells that large triangles fill have little use for leaf cells: not all that they ask for is taken, and no rebuild tries again.
#[test]
fn leaf_cells_that_need_too_much_are_not_all_made() {
    let context = Context::new(&ContextDesc::default()).unwrap();
    let gpu = GpuScene::upload(&context, &crossing(3000)).unwrap();
    let builder = GridBuilder::new(&context).unwrap();
    let settings = BuildSettings { resolution: Some([5, 6, 7]), ..BuildSettings::default() };
    let mut grid = builder.build(&gpu, &settings).unwrap();
    let flat = builder.build(&gpu, &BuildSettings { split: false, ..settings }).unwrap();
    let report = grid.stats().report;
    assert!(report.leaves_overflowed() && !report.pairs_overflowed() && report.pairs == flat.stats().report.pairs, "{report:?}");
    assert!(grid.capacity().leaf_cells < report.leaf_cells, "{report:?} {:?}", grid.capacity());
    let made = context.allocations();
    for _ in 0..2 {
        grid.rebuild(&gpu).unwrap();
        assert_eq!((grid.stats().attempts, context.allocations()), (1, made));
    }
}

/// Where memory is short it is the leaf cells that give way, not the density.
#[test]
fn leaf_cells_give_way_where_memory_is_short() {
    let build = |split, memory_limit| {
        let context = Context::new(&ContextDesc { memory_limit, ..ContextDesc::default() }).unwrap();
        let gpu = GpuScene::upload(&context, &crowded()).unwrap();
        let grid = GridBuilder::new(&context).unwrap().build(&gpu, &BuildSettings { split, ..BuildSettings::default() }).unwrap();
        (grid.stats().report, context.peak_bytes())
    };
    let (flat, least) = build(false, None);
    let (split, most) = build(true, None);
    assert!(split.leaf_pairs > 0 && most > least, "{least} bytes, {most} with leaf cells");
    for limit in [least, (least + most) / 2, most - 1] {
        let (report, peak) = build(true, Some(limit));
        assert_eq!((report.density, report.pairs, report.pairs_overflowed()), (flat.density, flat.pairs, false), "{report:?}");
        assert!(peak <= limit);
    }
}
