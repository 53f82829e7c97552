//! The invariants of a grid, checked in double precision and independently of kernels and twins.

use gridwalk::plan::Buffer;
use gridwalk::{BuildOptions, Overlap, Shape};
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::gather::{is_dropped, vertices_of};
use gridwalk_core::grid::{brick_resolution, cell_id, cell_of};
use gridwalk_core::layout::{Brick, GridHeader, TileOccupancy};
use gridwalk_core::twin::brick_distance_x::brick_distance_x;
use gridwalk_core::twin::brick_distance_y::brick_distance_y;
use gridwalk_core::twin::brick_distance_z::brick_distance_z;
use gridwalk_core::twin::brick_reduce::brick_reduce;
use gridwalk_tests::gpu::{Built, Gpu, Mesh};
use gridwalk_tests::meshes::soup;
use gridwalk_tests::random::Random;

macro_rules! require {
    ($holds:expr, $($text:tt)+) => {
        if !$holds {
            return Err(format!($($text)+));
        }
    };
}

pub type Double = [f64; 3];

fn axis_parts(axis: Double, half: Double, v: &[Double; 3]) -> bool {
    let p = v.map(|v| axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]);
    let reach = axis[0].abs() * half[0] + axis[1].abs() * half[1] + axis[2].abs() * half[2];
    p[0].min(p[1]).min(p[2]) > reach || p[0].max(p[1]).max(p[2]) < -reach
}

/// Whether a triangle meets the box [`low`, `high`]; by separating axes, touching counts.
pub fn overlaps(v: &[Double; 3], low: Double, high: Double) -> bool {
    let centre: Double = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
    let half: Double = std::array::from_fn(|i| 0.5 * (high[i] - low[i]));
    let v = v.map(|v| std::array::from_fn(|i| v[i] - centre[i]));
    let edge = |a: usize, b: usize| -> Double { std::array::from_fn(|i| v[b][i] - v[a][i]) };
    let cross = |a: Double, b: Double| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let edges = [edge(0, 1), edge(1, 2), edge(2, 0)];
    let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let parts = |axis| axis_parts(axis, half, &v);
    let products = edges.iter().flat_map(|edge| units.iter().map(move |unit| cross(*unit, *edge)));
    !(units.into_iter().any(parts) || parts(cross(edges[0], edges[1])) || products.into_iter().any(parts))
}

/// Boundaries of a cell, in double precision.
pub fn cell_box(header: &GridHeader, cell: [u32; 3]) -> (Double, Double) {
    let edge = |i: usize, n: u32| f64::from(header.box_min[i]) + f64::from(n) * f64::from(header.cell_size[i]);
    (std::array::from_fn(|i| edge(i, cell[i])), std::array::from_fn(|i| edge(i, cell[i] + 1)))
}

fn triangle_box(v: &[Double; 3]) -> (Double, Double) {
    let fold = |f: fn(f64, f64) -> f64| std::array::from_fn(|i| f(f(v[0][i], v[1][i]), v[2][i]));
    (fold(f64::min), fold(f64::max))
}

/// The triangle in the grid's frame by the input, or `None` if it is to be dropped.
fn expected_triangle(mesh: &Mesh, header: &GridHeader, index: usize) -> Option<[[f32; 3]; 3]> {
    let vertices = mesh.indices[index].map(|vertex| mesh.positions.get(vertex as usize).copied());
    let [Some(a), Some(b), Some(c)] = vertices else { return None };
    let v = [a, b, c];
    v.iter().flatten().all(|x| x.is_finite()).then(|| v.map(|v| header.to_frame(v)))
}

/// A device may take denormals for zero.
fn flushed_or_same(found: f32, expected: f32) -> bool {
    found == expected || found == 0.0 && expected.is_subnormal()
}

/// Checks a grid against its mesh; `Err` says what does not hold.
pub fn check(gpu: &Gpu, built: &Built, mesh: &Mesh) -> Result<(), String> {
    let (header, report) = (built.header(), built.report);
    let cells = built.cells();
    let references = built.references();
    check_with(gpu, built, mesh, &cells, &references).map_err(|error| format!("{error}\n{report:?}\n{header:?}"))
}

fn check_with(gpu: &Gpu, built: &Built, mesh: &Mesh, cells: &[[u32; 2]], references: &[u32]) -> Result<(), String> {
    let (header, report) = (built.header(), built.report);
    require!(header.resolution == report.resolution && header.cell_count == report.cells, "the report is not of this grid");
    require!(header.resolution.iter().map(|n| u64::from(*n)).product::<u64>() == u64::from(header.cell_count), "the number of cells");
    require!(header.cell_count >= 1 && header.cell_count <= built.info.capacity.cells.max(1), "the capacity of cells");

    // Ranges.
    let mut next = 0;
    for (cell, range) in cells.iter().enumerate() {
        if *range == [0, 0] {
            continue;
        }
        require!(range[0] == next && range[1] > range[0], "cell {cell} has {range:?} where {next} follows");
        next = range[1];
        let list = references.get(range[0] as usize..range[1] as usize).ok_or_else(|| format!("cell {cell} has {range:?}"))?;
        require!(list.windows(2).all(|pair| pair[0] < pair[1]), "the list of cell {cell} does not ascend");
    }
    require!(next == report.pairs, "{next} pairs are listed");
    require!(report.cells_in_use as usize == cells.iter().filter(|range| **range != [0, 0]).count(), "cells in use");
    require!(report.longest_list == cells.iter().map(|[begin, end]| end - begin).max().unwrap_or(0), "longest list");
    check_bricks(gpu, built, cells)?;

    // Triangles.
    let mut dropped = 0;
    let found = built.triangles();
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    let mut triangles: Vec<Option<[Double; 3]>> = Vec::new();
    for (index, rows) in found.into_iter().enumerate() {
        let found = vertices_of(rows);
        let expected = expected_triangle(mesh, &header, index);
        dropped += u32::from(expected.is_none());
        let v = expected.unwrap_or([[0.0; 3]; 3]);
        for (corner, found) in found.iter().enumerate() {
            let same =
                (0..3).all(|i| found[i] == v[corner][i] || found[i] == 0.0 && flushed_or_same(0.0, v[corner][i] * header.inverse_scale));
            require!(same, "triangle {index} is {found:?} where {v:?} is expected");
        }
        require!(is_dropped(rows[0]) == expected.is_none(), "triangle {index}: mark of a dropped triangle");
        if expected.is_some() {
            let input = mesh.triangle(index);
            low = input.into_iter().fold(low, gridwalk_core::vector::min);
            high = input.into_iter().fold(high, gridwalk_core::vector::max);
        }
        triangles.push(expected.map(|_| found.map(|v| v.map(f64::from))));
    }
    require!(dropped == report.dropped && mesh.indices.len() as u32 == report.triangles, "the number of triangles, or of dropped ones");
    if (dropped as usize) < mesh.indices.len() {
        let same = |found: [f32; 3], expected: [f32; 3]| (0..3).all(|i| flushed_or_same(found[i], expected[i]));
        require!(same(report.box_min, low) && same(report.box_max, high), "the box is {low:?} {high:?}");
    }

    // No cell lists a triangle whose padded box does not touch it.
    let reach = 4.0 * f64::from(header.pad);
    let mut pairs = Vec::with_capacity(references.len());
    for (id, range) in cells.iter().enumerate() {
        let (cell_low, cell_high) = cell_box(&header, cell_of(id as u32, header.resolution));
        for triangle in &references[range[0] as usize..range[1] as usize] {
            let v = triangles.get(*triangle as usize).copied().flatten();
            let v = v.ok_or_else(|| format!("cell {id} lists triangle {triangle}, which is dropped or does not exist"))?;
            let (low, high) = triangle_box(&v);
            let touches = (0..3).all(|i| low[i] - reach <= cell_high[i] && high[i] + reach >= cell_low[i]);
            require!(touches, "cell {id} lists triangle {triangle}, which is elsewhere: {v:?}");
            pairs.push((*triangle, id as u32));
        }
    }
    pairs.sort_unstable();
    if report.pairs_overflowed() {
        require!(report.pair_total > built.info.capacity.pairs, "an overflow without need");
        return Ok(());
    }
    let exact = built.info.options.overlap == Overlap::Exact;
    require!(report.pairs == report.pair_total || exact && report.pairs < report.pair_total, "pairs are missing");

    // Every cell that a triangle overlaps lists it, and so it must for a triangle up to half a padding away.
    let margin = 0.5 * f64::from(header.pad);
    for (index, v) in triangles.iter().enumerate() {
        let Some(v) = v else { continue };
        let (low, high) = triangle_box(v);
        let index = index as u32;
        let range: [std::ops::RangeInclusive<u32>; 3] = std::array::from_fn(|i| {
            let place = |x: f64| ((x - f64::from(header.box_min[i])) / f64::from(header.cell_size[i])).floor();
            let clamp = |n: f64| n.clamp(0.0, f64::from(header.resolution[i] - 1)) as u32;
            clamp(place(low[i] - margin))..=clamp(place(high[i] + margin))
        });
        let listed = pairs.partition_point(|pair| *pair < (index, 0))..pairs.partition_point(|pair| *pair <= (index, u32::MAX));
        let listed = &pairs[listed];
        require!(!listed.is_empty(), "triangle {index} is in no cell");
        for z in range[2].clone() {
            for y in range[1].clone() {
                for x in range[0].clone() {
                    let (cell_low, cell_high) = cell_box(&header, [x, y, z]);
                    if overlaps(v, cell_low.map(|x| x - margin), cell_high.map(|x| x + margin)) {
                        let id = cell_id([x, y, z], header.resolution);
                        let found = listed.binary_search(&(index, id)).is_ok();
                        require!(found, "cell {id} ({x}, {y}, {z}) does not list triangle {index}: {v:?}");
                    }
                }
            }
        }
    }
    Ok(())
}

fn check_bricks(gpu: &Gpu, built: &Built, cells: &[[u32; 2]]) -> Result<(), String> {
    let header = built.header();
    let resolution = header.resolution;
    let count: u32 = brick_resolution(resolution).iter().product();
    let len = count as usize;
    let found: Vec<Brick> = built.part(gpu, Buffer::Bricks, len);
    let shape = Shape::CPU;
    let groups = split_workgroups(count, shape.map_size);
    let mut bricks = vec![Brick::default(); len];
    let mut partials = vec![TileOccupancy::default(); len];
    let (mut x, mut y) = (vec![0; len], vec![0; len]);
    brick_reduce(&shape, split_workgroups(count, shape.brick_tile()), &header, &vec![1; len], cells, &mut bricks, &mut partials);
    brick_distance_x(&shape, groups, resolution, &bricks, &mut x);
    brick_distance_y(&shape, groups, resolution, &x, &mut y);
    brick_distance_z(&shape, groups, resolution, &y, &mut bricks);
    match found.iter().zip(&bricks).position(|(found, expected)| found != expected) {
        Some(at) => Err(format!("brick {at} is {:?} where {:?} is expected", found[at], bricks[at])),
        None => Ok(()),
    }
}

#[test]
fn grids_of_random_triangles() {
    let shapes = [Gpu::with_shape(Shape::CPU), Gpu::with_shape(Shape::GPU)];
    for (count, size, seed) in [(17, 0.5, 1), (2_000, 0.1, 2), (10_000, 0.02, 3)] {
        let mesh = soup(count, size, seed);
        for overlap in [Overlap::Box, Overlap::Exact] {
            for density in [0.05, 1.0, 8.0] {
                let options = BuildOptions { density, overlap, ..BuildOptions::default() };
                let capacity = gridwalk::Capacity { pairs: 400_000, ..mesh.capacity() };
                for gpu in shapes {
                    let built = gpu.build(&mesh, capacity, options);
                    assert_eq!(built.report.overflow, 0);
                    check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{count} triangles, {options:?}: {error}"));
                }
            }
        }
    }
}

#[test]
fn a_grid_of_many_triangles() {
    let gpu = Gpu::shared();
    let mesh = soup(300_000, 0.01, 8);
    let built = gpu.build(&mesh, gridwalk::Capacity { pairs: 1 << 23, ..mesh.capacity() }, BuildOptions::default());
    assert_eq!(built.report.overflow, 0);
    check(gpu, &built, &mesh).unwrap();
}

#[test]
fn grids_of_fixed_resolutions() {
    let gpu = Gpu::shared();
    let mesh = soup(1_000, 0.2, 4);
    for resolution in [[1, 1, 1], [2, 1, 1], [1, 1, 300], [16, 16, 16], [64, 3, 31], [5_000, 2, 1]] {
        for overlap in [Overlap::Box, Overlap::Exact] {
            let options = BuildOptions { resolution: Some(resolution), overlap, ..BuildOptions::default() };
            let capacity = gridwalk::Capacity { triangles: 1_000, cells: 20_000, pairs: 1 << 20, leaf_cells: 0 };
            let built = gpu.build(&mesh, capacity, options);
            assert_eq!(built.report.resolution, resolution.map(|n| n.min(4096)));
            check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{resolution:?}, {overlap:?}: {error}"));
        }
    }
}

/// Axis-aligned and diagonal triangles whose vertices, edges and planes lie on boundaries of cells.
#[test]
fn grids_of_triangles_on_boundaries() {
    let gpu = Gpu::shared();
    let mut random = Random::new(7);
    let mut triangles = vec![[[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]]];
    for _ in 0..600 {
        let corner: [f32; 3] = std::array::from_fn(|_| random.below(13) as f32 / 8.0 - 1.0);
        let (axis, size) = (random.below(3) as usize, (1 + random.below(3)) as f32 / 8.0);
        let step = |along: usize| {
            let mut vertex = corner;
            vertex[along % 3] += size;
            vertex
        };
        triangles.push([corner, step(axis), if random.below(2) == 0 { step(axis + 1) } else { corner.map(|x| x + size) }]);
    }
    let mesh = Mesh::from_triangles(&triangles);
    for overlap in [Overlap::Box, Overlap::Exact] {
        for resolution in [[16; 3], [8, 4, 32]] {
            let options = BuildOptions { resolution: Some(resolution), overlap, ..BuildOptions::default() };
            let capacity = gridwalk::Capacity { triangles: 601, cells: 4_096, pairs: 1 << 20, leaf_cells: 0 };
            let built = gpu.build(&mesh, capacity, options);
            assert_eq!((built.report.resolution, built.report.overflow), (resolution, 0));
            check(gpu, &built, &mesh).unwrap_or_else(|error| panic!("{resolution:?}, {overlap:?}: {error}"));
        }
    }
}

/// The exact test leaves out nearly all cells that a triangle does not meet.
#[test]
fn exact_overlap_is_nearly_exact() {
    let gpu = Gpu::shared();
    let mesh = soup(500, 0.4, 5);
    let options = |overlap| BuildOptions { resolution: Some([24, 24, 24]), overlap, ..BuildOptions::default() };
    let capacity = gridwalk::Capacity { triangles: 500, cells: 14_000, pairs: 1 << 20, leaf_cells: 0 };
    let exact = gpu.build(&mesh, capacity, options(Overlap::Exact));
    let boxes = gpu.build(&mesh, capacity, options(Overlap::Box));
    let header = exact.header();
    let mut met = 0;
    for rows in exact.triangles() {
        let v = vertices_of(rows).map(|v| v.map(f64::from));
        met += (0..header.cell_count)
            .filter(|id| {
                let (low, high) = cell_box(&header, cell_of(*id, header.resolution));
                overlaps(&v, low, high)
            })
            .count() as u32;
    }
    assert!(exact.report.pairs >= met, "{} pairs of {met}", exact.report.pairs);
    assert!(f64::from(exact.report.pairs) <= 1.001 * f64::from(met), "{} pairs of {met}", exact.report.pairs);
    assert!(boxes.report.pairs > 2 * met, "{} pairs of {met}", boxes.report.pairs);
}

/// The checks notice what they are there for.
#[test]
fn broken_grids_are_noticed() {
    let gpu = Gpu::shared();
    let mesh = soup(300, 0.1, 6);
    let built = gpu.build(&mesh, mesh.capacity(), BuildOptions { density: 1.0, ..BuildOptions::default() });
    let (cells, references) = (built.cells(), built.references());
    check_with(gpu, &built, &mesh, &cells, &references).unwrap();
    let full = cells.iter().position(|[begin, end]| end - begin >= 2).unwrap();
    let [begin, end] = cells[full];
    let broken = |name: &str, cells: &[[u32; 2]], references: &[u32]| {
        assert!(check_with(gpu, &built, &mesh, cells, references).is_err(), "{name} was not noticed");
    };
    let mut other = references.clone();
    other.swap(begin as usize, end as usize - 1);
    broken("a list out of order", &cells, &other);
    let mut other = cells.clone();
    other[full][1] -= 1;
    broken("a hole", &other, &references);
    let mut other = cells.clone();
    let empty = cells.iter().position(|range| *range == [0, 0]).unwrap();
    other[empty] = [begin, begin];
    broken("an empty cell that is not zero", &other, &references);
    // Another triangle at the end of a list: its own is then missing.
    let mut other = references.clone();
    other[end as usize - 1] = 299;
    broken("a triangle in the wrong cell", &cells, &other);
}
