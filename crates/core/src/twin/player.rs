//! Plays the steps of a rebuild on the CPU, so that each can be compared with what the device did.

use bytemuck::{Pod, Zeroable, bytes_of};

use super::brick_distance_x::brick_distance_x;
use super::brick_distance_y::brick_distance_y;
use super::brick_distance_z::brick_distance_z;
use super::brick_reduce::brick_reduce;
use super::cell_ranges::cell_ranges;
use super::clear_bricks::clear_bricks;
use super::clear_cells::clear_cells;
use super::configure::{Configure, configure_header, configure_state, unite_bounds};
use super::gather::gather;
use super::gather_records::gather_records;
use super::geometry_scan::geometry_scan;
use super::leaf_args::leaf_args;
use super::leaf_count::{Leaves, leaf_count, leaf_emit, leaf_emit_large};
use super::leaf_distance::leaf_distance;
use super::leaf_sort::leaf_sort;
use super::overlap_count::overlap_count;
use super::overlap_emit::{Emission, overlap_emit, overlap_emit_large};
use super::pair_args::pair_args;
use super::report_spine::report_spine;
use super::scan_reduce::scan_reduce;
use super::sort_histogram::sort_histogram;
use super::sort_scatter::{Pairs, sort_scatter};
use super::split_cells::split_cells;
use super::table_scan::table_scan;
use crate::geometry::{AddressedMemory, GeometryRecord};
use crate::layout::{Bounds, Brick, BuildState, DispatchArguments, GridHeader, LeafArguments, Report, SplitCell, TileOccupancy};
use crate::shape::Shape;
use crate::sort::writes_a;
use crate::split::LEAST_SPLIT;

/// Which of the two states a step takes its numbers from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Cells.
    First,
    /// Leaf cells.
    Second,
}

/// The number of workgroups of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// Given.
    Direct([u32; 3]),
    /// At a byte offset into a level's arguments.
    Indirect(Level, u64),
}

/// A step of a plan, as the twins see it.
#[derive(Clone, Copy, Debug)]
pub struct PlayedStep<'a> {
    /// Name of the kernel.
    pub kernel: &'a str,
    /// How many workgroups.
    pub groups: Groups,
    /// Push constants after the addresses.
    pub words: &'a [u32],
    /// Whose numbers of pairs and keys the step reads.
    pub level: Level,
    /// Whether the step runs the kernel's exact variant.
    pub exact: bool,
}

/// Memory of a rebuild, named as in the plan.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names are those of the plan's buffers")]
pub struct Memory {
    pub positions: Vec<f32>,
    pub indices: Vec<u32>,
    /// Geometries, if the build is of such, and the memory that they name.
    pub records: Vec<GeometryRecord>,
    pub addressed: AddressedMemory,
    pub header: GridHeader,
    pub cells: Vec<[u32; 2]>,
    pub references: Vec<u32>,
    pub triangles: Vec<[f32; 4]>,
    pub bricks: Vec<Brick>,
    pub report: Report,
    pub state: BuildState,
    pub arguments: DispatchArguments,
    pub bounds_partials: Vec<Bounds>,
    pub offsets: Vec<u32>,
    pub cell_boxes: Vec<[u32; 3]>,
    pub scan_partials: Vec<u32>,
    pub keys_a: Vec<u32>,
    pub keys_b: Vec<u32>,
    pub values_a: Vec<u32>,
    pub table: Vec<u32>,
    pub occupancy: Vec<TileOccupancy>,
    pub distances_x: Vec<u32>,
    pub distances_y: Vec<u32>,
    pub leaf_state: BuildState,
    pub leaf_arguments: LeafArguments,
    pub split_cells: Vec<SplitCell>,
}

fn level_state<'a>(level: Level, first: &'a mut BuildState, second: &'a mut BuildState) -> &'a mut BuildState {
    match level {
        Level::First => first,
        Level::Second => second,
    }
}

fn filled<T: Pod>(word: u32) -> T {
    let mut value = T::zeroed();
    for bytes in bytemuck::bytes_of_mut(&mut value).chunks_mut(4) {
        bytes.copy_from_slice(&bytes_of(&word)[..bytes.len()]);
    }
    value
}

impl Memory {
    /// Memory for a geometry and for `triangles`, `cells`, `pairs`, `leaf_cells` and `bricks` at most, of which every word is `word`.
    pub fn filled(
        word: u32,
        shape: &Shape,
        positions: Vec<f32>,
        indices: Vec<u32>,
        [triangles, cells, pairs, leaf_cells, bricks]: [u32; 5],
    ) -> Memory {
        let table = shape.table_entries(pairs) as usize;
        let (cells, pairs) = (cells.max(1), pairs.max(1) as usize);
        let offsets = triangles as usize + 1;
        let split_cells = if leaf_cells > 0 { pairs / LEAST_SPLIT as usize } else { 0 };
        Memory {
            positions,
            indices,
            records: Vec::new(),
            addressed: AddressedMemory::default(),
            header: filled(word),
            cells: vec![[word; 2]; (cells + leaf_cells) as usize],
            references: vec![word; pairs],
            triangles: vec![filled(word); 3 * triangles.max(1) as usize],
            bricks: vec![filled(word); bricks as usize],
            report: filled(word),
            state: filled(word),
            arguments: filled(word),
            bounds_partials: vec![filled(word); shape.bounds_tiles(triangles) as usize],
            offsets: vec![word; offsets],
            cell_boxes: vec![[word; 3]; triangles.max(1) as usize],
            scan_partials: vec![word; shape.scan_partials(triangles, pairs as u32) as usize],
            keys_a: vec![word; pairs + 1],
            keys_b: vec![word; pairs],
            values_a: vec![word; pairs],
            table: vec![word; table.max(1)],
            occupancy: vec![filled(word); bricks.div_ceil(shape.brick_tile()) as usize],
            distances_x: vec![word; bricks as usize],
            distances_y: vec![word; bricks as usize],
            leaf_state: filled(word),
            leaf_arguments: filled(word),
            split_cells: vec![filled(word); split_cells.max(1)],
        }
    }

    /// Runs a step.
    ///
    /// # Errors
    /// The name of a kernel that has no twin.
    pub fn play<'a>(&mut self, shape: &Shape, step: &PlayedStep<'a>, addresses: [[u32; 2]; 4]) -> Result<(), &'a str> {
        let groups = match step.groups {
            Groups::Direct(groups) => groups,
            Groups::Indirect(level, offset) => {
                let mut groups = <[u32; 3]>::zeroed();
                let words: &[u32] = match level {
                    Level::First => bytemuck::cast_slice(bytes_of(&self.arguments)),
                    Level::Second => bytemuck::cast_slice(bytes_of(&self.leaf_arguments)),
                };
                groups.copy_from_slice(&words[offset as usize / 4..][..3]);
                groups
            }
        };
        if groups.contains(&0) {
            return Ok(());
        }
        let words = step.words;
        let GridHeader { resolution, .. } = self.header;
        let BuildState { triangle_count, pair_count, .. } = self.state;
        match step.kernel {
            "gather" => {
                let (triangles, state, partials) = (&mut self.triangles, &mut self.state, &mut self.bounds_partials);
                gather(shape, groups, &self.positions, &self.indices, triangles, state, partials, words[0], words[1]);
            }
            "geometry_scan" => {
                let (state, arguments) = (&mut self.state, &mut self.arguments);
                geometry_scan(shape, &self.addressed, &self.records, &mut self.offsets, state, arguments, words[1]);
            }
            "gather_records" => {
                let (firsts, triangles, partials) = (&self.offsets, &mut self.triangles, &mut self.bounds_partials);
                gather_records(shape, groups, &self.addressed, &self.records, firsts, triangle_count, triangles, partials);
            }
            "configure" => {
                let scene = unite_bounds(&self.bounds_partials, shape.bounds_tiles(triangle_count));
                let info = Configure {
                    triangle_count,
                    cell_capacity: words[0],
                    density: f32::from_bits(words[1]),
                    fixed: [words[2], words[3], words[4]],
                    splits: words[5] > 1,
                    exact: words[6] != 0,
                };
                let (header, density, overflow) = configure_header(&info, &scene, addresses);
                self.header = header;
                let (state, arguments, report) = (&mut self.state, &mut self.arguments, &mut self.report);
                configure_state(shape, &info, &scene, &header, density, overflow, state, arguments, report);
            }
            "clear_bricks" => clear_bricks(shape, groups, resolution, &mut self.distances_x),
            "clear_cells" => clear_cells(shape, groups, resolution, &self.distances_x, &mut self.cells),
            "overlap_count" => {
                let (triangles, counts, boxes) = (&mut self.triangles, &mut self.offsets, &mut self.cell_boxes);
                let used = &mut self.distances_x;
                overlap_count(shape, groups, step.exact, &self.header, &mut self.state, triangles, counts, boxes, used);
            }
            "scan_reduce" => {
                let values = match step.level {
                    Level::First => &self.offsets,
                    Level::Second => &self.keys_a,
                };
                let length = level_state(step.level, &mut self.state, &mut self.leaf_state).offset_count;
                scan_reduce(shape, groups, length, values, &mut self.scan_partials);
            }
            "pair_args" => {
                let (state, arguments, report) = (&mut self.state, &mut self.arguments, &mut self.report);
                let (partials, offsets) = (&self.scan_partials, &mut self.offsets);
                pair_args(shape, groups, state, partials, offsets, arguments, report, words[0], words[1]);
            }
            "table_scan" => {
                let state = *level_state(step.level, &mut self.state, &mut self.leaf_state);
                table_scan(shape, groups, &state, &mut self.table, &mut self.scan_partials, words[0]);
            }
            "overlap_emit" | "overlap_emit_large" => {
                let (keys, values) = match writes_a(self.state.pass_count, 0) {
                    true => (&mut self.keys_a, &mut self.values_a),
                    false => (&mut self.keys_b, &mut self.references),
                };
                let offsets = &self.offsets[..self.state.offset_count as usize];
                let (grid, boxes, triangles) = (&self.header, &self.cell_boxes, &self.triangles);
                let used = &mut self.distances_x;
                let mut emission = Emission { grid, pair_count, offsets, boxes, triangles, keys, values, used };
                match step.kernel {
                    "overlap_emit" => overlap_emit(shape, groups, &mut emission),
                    _ => overlap_emit_large(shape, groups, step.exact, &mut emission),
                }
            }
            "sort_histogram" => {
                let state = *level_state(step.level, &mut self.state, &mut self.leaf_state);
                let keys = if writes_a(state.pass_count, words[0]) { &self.keys_a } else { &self.keys_b };
                sort_histogram(shape, groups, &state, keys, &mut self.table, words[0]);
            }
            "sort_scatter" => {
                let a = (&mut self.keys_a, &mut self.values_a);
                let b = (&mut self.keys_b, &mut self.references);
                let state = level_state(step.level, &mut self.state, &mut self.leaf_state);
                let (from, to) = if writes_a(state.pass_count, words[0]) { (a, b) } else { (b, a) };
                let pairs = Pairs { keys: from.0.as_slice(), values: from.1.as_slice() };
                sort_scatter(shape, groups, state, &pairs, to.0, to.1, &self.table, &self.scan_partials, words[0]);
            }
            "cell_ranges" => {
                let state = *level_state(step.level, &mut self.state, &mut self.leaf_state);
                cell_ranges(shape, groups, &state, &self.keys_b, &mut self.cells, &mut self.report);
            }
            "brick_reduce" => {
                brick_reduce(shape, groups, &self.header, &self.distances_x, &self.cells, &mut self.bricks, &mut self.occupancy)
            }
            "report_spine" => {
                let (leaf_state, arguments) = (&mut self.leaf_state, &mut self.leaf_arguments);
                let (partials, report) = (&mut self.occupancy, &mut self.report);
                report_spine(shape, &self.header, &self.state, partials, leaf_state, arguments, report, words[0]);
            }
            "split_cells" => {
                let (cells, bricks, partials) = (&self.cells, &self.bricks, &self.occupancy);
                let (records, owners) = (&mut self.split_cells, &mut self.table);
                split_cells(shape, groups, &self.header, &self.leaf_state, cells, bricks, partials, records, owners, words[0]);
            }
            "leaf_args" => {
                let (state, arguments, report) = (&mut self.leaf_state, &mut self.leaf_arguments, &mut self.report);
                let (partials, offsets) = (&self.scan_partials, &mut self.keys_a);
                leaf_args(shape, groups, state, partials, offsets, arguments, report, words[0], words[1]);
            }
            "leaf_count" | "leaf_emit" | "leaf_emit_large" => {
                let leaves = Leaves {
                    grid: &self.header,
                    state: &self.leaf_state,
                    split_cells: &self.split_cells,
                    triangles: &self.triangles,
                    exact: step.exact,
                };
                if step.kernel == "leaf_count" {
                    let (counts, masks, boxes) = (&mut self.keys_a, &mut self.keys_b, &mut self.values_a);
                    leaf_count(shape, groups, &leaves, &self.references, counts, masks, boxes, &mut self.cells);
                } else if step.kernel == "leaf_emit_large" {
                    leaf_emit_large(shape, groups, &leaves, &self.references, &self.keys_a, &self.values_a, &mut self.keys_b);
                } else {
                    let pairs = leaf_emit(shape, groups, &leaves, &self.references, &mut self.cells);
                    let (keys, values) = match writes_a(self.leaf_state.pass_count, 0) {
                        true => (&mut self.keys_a, &mut self.values_a),
                        false => (&mut self.keys_b, &mut self.references),
                    };
                    for (pair, (key, value)) in (self.leaf_state.first_pair as usize..).zip(pairs) {
                        keys[pair] = key;
                        values[pair] = value;
                    }
                }
            }
            "leaf_sort" => {
                let (offsets, masks, boxes) = (&self.keys_a, &self.keys_b, &self.values_a);
                let (state, records, arguments) = (&self.leaf_state, &self.split_cells, &mut self.leaf_arguments);
                let (references, cells) = (&mut self.references, &mut self.cells);
                leaf_sort(shape, groups, state, records, offsets, masks, boxes, references, cells, arguments, words[0]);
            }
            "leaf_distance" => leaf_distance(shape, groups, &self.leaf_state, &self.split_cells, &mut self.cells),
            "brick_distance_x" => brick_distance_x(shape, groups, resolution, &self.bricks, &mut self.distances_x),
            "brick_distance_y" => brick_distance_y(shape, groups, resolution, &self.distances_x, &mut self.distances_y),
            "brick_distance_z" => brick_distance_z(shape, groups, resolution, &self.distances_y, &mut self.bricks),
            unknown => return Err(unknown),
        }
        Ok(())
    }
}
