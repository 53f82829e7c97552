//! The second level: grids whose cells with many triangles are split, against the flat grid of the same triangles and double precision.

use gridwalk::{BuildOptions, Capacity, Overlap, Report};
use gridwalk_core::gather::vertices_of;
use gridwalk_core::grid::{cell_id, cell_of};
use gridwalk_core::layout::{CELL_LEVEL, CELL_SPLIT, GridHeader};
use gridwalk_core::split::{LEAST_SPLIT, LEAST_SPLIT_OF_LONG};
use gridwalk_tests::gpu::{Built, Gpu, Mesh};
use gridwalk_tests::meshes::soup;
use gridwalk_tests::random::Random;

use crate::traverse::rays::random_rays;

use super::invariants::{Double, cell_box, overlaps};

/// Small triangles crowded into few cells of a scene that large ones span.
fn crowd(count: u32, seed: u64) -> Mesh {
    let mut mesh = soup(200, 0.5, seed);
    let mut random = Random::new(seed);
    let centres: Vec<[f32; 3]> = (0..3).map(|_| std::array::from_fn(|_| random.range(-0.8, 0.8))).collect();
    let crowded: Vec<[[f32; 3]; 3]> = (0..count)
        .map(|_| {
            let centre = centres[random.below(3) as usize];
            let corner: [f32; 3] = std::array::from_fn(|axis| centre[axis] + random.range(-0.05, 0.05));
            std::array::from_fn(|_| std::array::from_fn(|axis| corner[axis] + random.range(-0.005, 0.005)))
        })
        .collect();
    let more = Mesh::from_triangles(&crowded);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&more.positions);
    mesh.indices.extend(more.indices.iter().map(|triangle| triangle.map(|index| index + first)));
    mesh
}

/// Such a scene in a grid of few cells, with room for all leaf cells.
fn crowded(seed: u64) -> (Mesh, BuildOptions, Capacity) {
    let options = BuildOptions { resolution: Some([9, 8, 7]), ..BuildOptions::default() };
    let room = Capacity { triangles: 10_000, cells: 10_000, pairs: 1 << 20, leaf_cells: 1 << 18 };
    (crowd(3_000, seed), options, room)
}

/// The list of a cell of the flat grid, and the box of each leaf cell with its list. Cells of each level, and leaf cells that know a distance.
fn check(built: &Built, flat: &Built, exact: bool) -> Result<([u32; 6], u32), String> {
    let (header, cells, references) = (built.header(), built.cells(), built.references());
    let (flat_cells, flat_references) = (flat.cells(), flat.references());
    let triangles: Vec<[Double; 3]> = built.triangles().into_iter().map(|rows| vertices_of(rows).map(|v| v.map(f64::from))).collect();
    let list = |range: [u32; 2]| references.get(range[0] as usize..range[1] as usize).ok_or_else(|| format!("a list at {range:?}"));
    let mut levels = [0; 6];
    let (mut pairs, mut measured) = (0, 0);
    for id in 0..header.cell_count {
        let [begin, end] = flat_cells[id as usize];
        let whole = &flat_references[begin as usize..end as usize];
        let range = cells[id as usize];
        if range[1] & CELL_SPLIT == 0 {
            levels[0] += 1;
            if list(range)? != whole {
                return Err(format!("cell {id}, which is not split, has another list than in the flat grid"));
            }
            continue;
        }
        let level = range[1] & CELL_LEVEL;
        levels[level as usize] += 1;
        if (whole.len() as u32) < LEAST_SPLIT {
            return Err(format!("cell {id} of {} triangles is split", whole.len()));
        }
        let fine = GridHeader { cell_size: header.cell_size.map(|size| size / (1 << level) as f32), ..header };
        let first = cell_of(id, header.resolution).map(|i| i << level);
        let leaf_range = |local: [u32; 3]| cells[(range[0] + cell_id(local, [1 << level; 3])) as usize];
        for leaf in 0..1 << (3 * level) {
            let local = cell_of(leaf, [1 << level; 3]);
            let (low, high) = cell_box(&fine, std::array::from_fn(|axis| first[axis] + local[axis]));
            let range = leaf_range(local);
            let listed = if range[1] == 0 { &[] } else { list(range)? };
            let closer = range[0].saturating_sub(1);
            let [x, y, z] = local.map(|i| i.saturating_sub(closer)..(i + closer + 1).min(1 << level));
            let full = |local: &[u32; 3]| leaf_range(*local)[1] != 0;
            let around = || z.flat_map(|z| y.clone().map(move |y| [y, z])).flat_map(|[y, z]| x.clone().map(move |x| [x, y, z]));
            if range[1] == 0
                && closer > 0
                && let Some(wrong) = around().find(full)
            {
                return Err(format!("leaf cell {local:?} of cell {id}, of distance {}, but {wrong:?} is not empty", range[0]));
            }
            measured += u32::from(range[1] == 0 && closer > 0);
            pairs += listed.len();
            if !listed.windows(2).all(|pair| pair[0] < pair[1]) {
                return Err(format!("leaf cell {local:?} of cell {id} is not in order: {listed:?}"));
            }
            let reach = 8.0 * f64::from(header.pad);
            for triangle in whole {
                let v = &triangles[*triangle as usize];
                let is_listed = listed.binary_search(triangle).is_ok();
                if !is_listed && overlaps(v, low, high) {
                    return Err(format!("leaf cell {local:?} of cell {id} misses triangle {triangle}"));
                }
                let (wide_low, wide_high) = (low.map(|x| x - reach), high.map(|x| x + reach));
                if is_listed && exact && !overlaps(v, wide_low, wide_high) {
                    return Err(format!("leaf cell {local:?} of cell {id} lists triangle {triangle}, which is elsewhere"));
                }
            }
            if listed.iter().any(|triangle| whole.binary_search(triangle).is_err()) {
                return Err(format!("leaf cell {local:?} of cell {id} lists what the cell does not"));
            }
        }
    }
    let report = built.report;
    if pairs as u32 != report.leaf_pairs || levels[1..].iter().sum::<u32>() > report.split_cells {
        return Err(format!("{pairs} pairs of leaf cells, {levels:?} cells by level, but {report:?}"));
    }
    Ok((levels, measured))
}

#[test]
fn leaf_cells_list_what_they_meet() {
    let gpu = Gpu::shared();
    let (mut seen, mut measured) = ([0; 6], 0);
    for (count, resolution, seed) in
        [(3_000, [9, 8, 7], 1), (3_000, [1, 2, 1], 2), (300, [20, 20, 20], 3), (12_000, [3, 3, 3], 4), (1_400, [9, 8, 7], 8)]
    {
        let mesh = crowd(count, seed);
        for overlap in [Overlap::Box, Overlap::Exact] {
            let options = BuildOptions { resolution: Some(resolution), overlap, ..BuildOptions::default() };
            let room = Capacity { triangles: 20_000, cells: 10_000, pairs: 1 << 22, leaf_cells: 0 };
            let flat = gpu.build(&mesh, room, options);
            // Room for all leaf cells, and for some.
            for leaf_cells in [1 << 18, 4_000] {
                let built = gpu.build(&mesh, Capacity { leaf_cells, ..room }, options);
                assert_eq!(built.report.leaves_overflowed(), built.report.leaf_cells > leaf_cells, "{:?}", built.report);
                assert!(!built.report.pairs_overflowed() && built.report.pairs == flat.report.pairs);
                let what = format!("seed {seed}, {overlap:?}, {leaf_cells} leaf cells");
                let (levels, found) = check(&built, &flat, overlap == Overlap::Exact).unwrap_or_else(|error| panic!("{what}: {error}"));
                measured += found;
                seen.iter_mut().zip(levels).for_each(|(seen, level)| *seen += level);
            }
        }
    }
    assert!(seen.iter().all(|count| *count > 0), "cells of each level: {seen:?}");
    assert!(measured > 0);
}

/// Where the pairs of leaf cells do not fit, the grid is the flat one, and the report says how much would do.
#[test]
fn without_room_for_pairs_no_cell_is_split() {
    let gpu = Gpu::shared();
    let (mesh, options, room) = crowded(5);
    let whole = gpu.build(&mesh, room, options);
    let flat = gpu.build(&mesh, Capacity { leaf_cells: 0, ..room }, options);
    let needed = whole.report.pairs + whole.report.leaf_pairs;
    assert!(whole.report.overflow == 0 && whole.report.leaf_pairs > 0);
    for (pairs, fits) in [(needed, true), (needed - 1, false), (flat.report.pair_total, false)] {
        let built = gpu.build(&mesh, Capacity { pairs, ..room }, options);
        assert_eq!((built.report.leaves_overflowed(), built.report.pairs_overflowed()), (!fits, false), "{:?}", built.report);
        if !fits {
            assert_eq!((built.report.leaf_pairs, built.report.needed_pairs()), (0, Some(needed)));
            let count = flat.report.cells as usize;
            assert_eq!(built.cells()[..count], flat.cells()[..count]);
        }
    }
}

/// A build without the steps of the second level counts what they would do, and makes a flat grid.
#[test]
fn a_second_level_that_is_left_out_is_counted() {
    let gpu = Gpu::shared();
    let (mesh, options, room) = crowded(9);
    let whole = gpu.build(&mesh, room, options);
    let flat = gpu.build(&mesh, Capacity { leaf_cells: 0, ..room }, options);
    let rays = random_rays(&mesh, 2_000, 9);
    for leaf_cells in [room.leaf_cells, 100] {
        let mut built = gpu.prepare(&mesh, Capacity { leaf_cells, ..room }, options);
        built.info.second_level = false;
        gpu.rebuild(&mut built);
        assert_eq!(built.report.leaves_overflowed(), leaf_cells == 100);
        assert!(built.report.split_cells > 0 && whole.report.leaf_pairs > 0);
        assert_eq!(Report { overflow: 0, ..built.report }, Report { leaf_pairs: 0, ..whole.report });
        let count = flat.report.cells as usize;
        assert_eq!(built.cells()[..count], flat.cells()[..count]);
        let hits = gpu.closest(&built, &rays);
        assert!(hits.iter().filter(|hit| hit.is_hit()).count() > 200);
        assert_eq!(hits, gpu.closest(&flat, &rays));
        assert_eq!(hits, gpu.closest(&whole, &rays));
        let without = gpu.tracer.build_steps(&Capacity { leaf_cells: 0, ..room }).len();
        assert!(gpu.timestamps(&mut built).is_none_or(|stamps| stamps.len() == without + 1));
        // Again with it, in the same memory.
        built.info.second_level = true;
        gpu.rebuild(&mut built);
        assert_eq!(built.report.leaf_pairs > 0, leaf_cells == room.leaf_cells);
    }
}

/// Lists that are long all over are not split for that alone.
#[test]
fn lists_that_are_long_all_over_stay_whole() {
    let gpu = Gpu::shared();
    let mesh = soup(20_000, 0.05, 6);
    let build = |resolution| {
        let options = BuildOptions { resolution: Some(resolution), ..BuildOptions::default() };
        gpu.build(&mesh, Capacity { triangles: 20_000, cells: 100_000, pairs: 1 << 20, leaf_cells: 1 << 20 }, options).report
    };
    let long = build([11, 11, 11]);
    assert!(long.pairs / long.cells_in_use >= LEAST_SPLIT, "{long:?}");
    assert!(long.longest_list < LEAST_SPLIT_OF_LONG && long.split_cells == 0, "{long:?}");
    let longer = build([6, 6, 6]);
    assert!(longer.longest_list >= LEAST_SPLIT_OF_LONG && longer.split_cells > 0, "{longer:?}");
}

/// The checks notice what they are there for.
#[test]
fn broken_leaf_cells_are_noticed() {
    let gpu = Gpu::shared();
    let (mesh, options, room) = crowded(7);
    let flat = gpu.build(&mesh, Capacity { leaf_cells: 0, ..room }, options);
    let built = gpu.build(&mesh, room, options);
    check(&built, &flat, true).unwrap();
    let victim = built.references()[built.report.pairs as usize];
    built.forget_triangle(victim, victim ^ 1);
    check(&built, &flat, true).unwrap_err();
}
