//! Twins of kernels `leaf_count`, `leaf_emit` and `leaf_emit_large`.

use crate::gather::vertices_of;
use crate::grid::cell_id;
use crate::layout::{BuildState, CELL_SPLIT, GridHeader, SplitCell};
use crate::overlap::{CellBox, SMALL_BOX, SeparatingAxes};
use crate::shape::Shape;
use crate::split::{leaf_box, leaf_count_of, refined};

/// What these kernels read.
#[derive(Clone, Copy, Debug)]
pub struct Leaves<'a> {
    /// Head of the grid.
    pub grid: &'a GridHeader,
    /// Of the second level.
    pub state: &'a BuildState,
    /// Records of the cells that are to be split.
    pub split_cells: &'a [SplitCell],
    /// In the grid's frame.
    pub triangles: &'a [[f32; 4]],
    /// Whether a triangle that misses a leaf cell is left out of its list.
    pub exact: bool,
}

/// A reference of a split cell.
struct Listed<'a> {
    split: &'a SplitCell,
    place: u32,
}

impl Leaves<'_> {
    fn listed(&self, reference: u32) -> Listed<'_> {
        let records = &self.split_cells[..self.state.split_cells as usize];
        let owner = records.partition_point(|split| split.first_reference <= reference) - 1;
        let split = &records[owner];
        Listed { split, place: reference - split.first_reference }
    }

    /// The box of leaf cells, and those that the triangle of this first row overlaps.
    fn overlapped(&self, split: &SplitCell, row: u32) -> Option<(CellBox, Vec<u32>)> {
        let fine = refined(self.grid, split.level);
        let v = vertices_of(std::array::from_fn(|axis| self.triangles[row as usize + axis]));
        let (cells, test) = leaf_box(&fine, split, self.exact, v)?;
        let axes = SeparatingAxes::new(&fine, v, cells.low);
        let overlapped = (0..cells.count()).filter(|n| !test || axes.meets(cells.cell(*n))).collect();
        Some((cells, overlapped))
    }

    fn covered(&self, shape: &Shape, groups: [u32; 3]) -> std::ops::Range<u32> {
        0..(groups.iter().product::<u32>() * shape.map_size).min(self.state.offset_count - 1)
    }
}

/// What the count keeps of a large box.
pub(super) const LARGE_LEAF_BOX: u32 = 1 << 31;

/// What it keeps of a small one: its first leaf cell, its sizes less one along x and y, and the level.
fn box_word(cells: &CellBox, level: u32) -> u32 {
    let low = cells.low.map(|n| n & ((1 << level) - 1));
    let [x, y] = [0, 1].map(|axis| cells.high[axis] - cells.low[axis]);
    cell_id(low, [1 << level; 3]) | x << 15 | y << 20 | level << 25
}

/// Counts the leaf cells that each triangle of a split cell overlaps, and empties the leaf cells.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn leaf_count(
    shape: &Shape,
    groups: [u32; 3],
    leaves: &Leaves,
    references: &[u32],
    counts: &mut [u32],
    masks: &mut [u32],
    boxes: &mut [u32],
    cells: &mut [[u32; 2]],
) {
    counts[leaves.state.offset_count as usize - 1] = 0;
    for reference in leaves.covered(shape, groups) {
        let Listed { split, place } = leaves.listed(reference);
        if place == 0 && split.level != 0 {
            let first = (leaves.state.first_cell + split.leaf_begin) as usize;
            cells[first..first + leaf_count_of(split.level) as usize].fill([0, 0]);
        }
        let overlapped = leaves.overlapped(split, references[(split.list_begin + place) as usize]);
        let (count, mask, word) = overlapped.map_or((0, 0, 0), |(cells, overlapped)| {
            let small = cells.count() <= SMALL_BOX;
            let mask = overlapped.iter().filter(|_| small).fold(0, |mask, n| mask | 1 << n);
            (overlapped.len() as u32, mask, if small { box_word(&cells, split.level) } else { LARGE_LEAF_BOX })
        });
        counts[reference as usize] = count;
        masks[reference as usize] = mask;
        boxes[reference as usize] = word;
    }
}

/// Pairs (leaf cell, triangle) in order, and the cells that are split. The first pair is the state's `first_pair`.
pub fn leaf_emit(shape: &Shape, groups: [u32; 3], leaves: &Leaves, references: &[u32], cells: &mut [[u32; 2]]) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for reference in leaves.covered(shape, groups) {
        let Listed { split, place } = leaves.listed(reference);
        if place == 0 && split.level != 0 {
            cells[split.cell as usize] = [leaves.state.first_cell + split.leaf_begin, CELL_SPLIT | split.level];
        }
        let row = references[(split.list_begin + place) as usize];
        for (cells, n) in leaves.overlapped(split, row).into_iter().flat_map(|(cells, all)| all.into_iter().map(move |n| (cells, n))) {
            let local = cells.cell(n).map(|i| i & ((1 << split.level) - 1));
            pairs.push((split.leaf_begin + cell_id(local, [1 << split.level; 3]), row));
        }
    }
    pairs
}

/// The leaf cells that triangles with large boxes overlap, where their pairs' keys go.
pub fn leaf_emit_large(
    shape: &Shape,
    groups: [u32; 3],
    leaves: &Leaves,
    references: &[u32],
    offsets: &[u32],
    boxes: &[u32],
    keys: &mut [u32],
) {
    for reference in leaves.covered(shape, groups).filter(|reference| boxes[*reference as usize] == LARGE_LEAF_BOX) {
        let Listed { split, place } = leaves.listed(reference);
        let first = (leaves.state.first_pair + offsets[reference as usize]) as usize;
        if let Some((cells, all)) = leaves.overlapped(split, references[(split.list_begin + place) as usize]) {
            for (key, n) in keys[first..].iter_mut().zip(all) {
                *key = split.leaf_begin + cell_id(cells.cell(n).map(|i| i & ((1 << split.level) - 1)), [1 << split.level; 3]);
            }
        }
    }
}
