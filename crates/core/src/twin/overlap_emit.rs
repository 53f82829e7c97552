//! Twins of kernels `overlap_emit` and `overlap_emit_large`.

use crate::gather::vertices_of;
use crate::grid::{BRICK_SIZE, brick_resolution, cell_id};
use crate::layout::GridHeader;
use crate::overlap::{CellBox, SeparatingAxes, triangle_cells};
use crate::shape::Shape;
use crate::vector::Vec3;

/// What both kernels read and write.
#[derive(Debug)]
pub struct Emission<'a> {
    /// Head of the grid.
    pub grid: &'a GridHeader,
    /// Pairs that there is room for.
    pub pair_count: u32,
    /// First pair of each triangle, and the end of the last.
    pub offsets: &'a [u32],
    /// Of each triangle what [`super::overlap_count`] keeps: cells of its small box that it overlaps, a bit each, 0 for a large box; the box.
    pub boxes: &'a [[u32; 3]],
    /// In the grid's frame.
    pub triangles: &'a [[f32; 4]],
    /// Cell ids.
    pub keys: &'a mut [u32],
    /// Triangles.
    pub values: &'a mut [u32],
    /// A word a brick: 1 if a triangle may lie in it; of those with large boxes.
    pub used: &'a mut [u32],
}

impl Emission<'_> {
    fn cells(&self, triangle: usize) -> ([Vec3; 3], CellBox) {
        let v = vertices_of(std::array::from_fn(|axis| self.triangles[3 * triangle + axis]));
        (v, triangle_cells(self.grid, v))
    }
}

/// Writes the pairs (cell id, triangle) of the triangles with small boxes.
pub fn overlap_emit(shape: &Shape, groups: [u32; 3], emission: &mut Emission) {
    let covered = (groups.iter().product::<u32>() * shape.map_size) as usize;
    for triangle in 0..covered.min(emission.offsets.len() - 1) {
        let [mask, first, sizes] = emission.boxes[triangle];
        let [x, y] = [sizes & 0xFFFF, sizes >> 16];
        let pairs = emission.offsets[triangle]..emission.pair_count;
        for (pair, n) in pairs.zip((0..u32::BITS).filter(|n| (mask >> n) & 1 != 0)) {
            let local = [n % x, n / x % y, n / x / y];
            emission.keys[pair as usize] = first + cell_id(local, emission.grid.resolution);
            emission.values[pair as usize] = 3 * triangle as u32;
        }
    }
}

/// Writes the pairs of the triangles with large boxes. The kernel hands an invocation a run of pairs and searches for its triangle; here
/// each triangle writes its own, which must come to the same.
pub fn overlap_emit_large(shape: &Shape, groups: [u32; 3], exact: bool, emission: &mut Emission) {
    let covered = groups.iter().product::<u32>() * shape.map_size * shape.emit_pairs;
    let last = emission.pair_count.min(covered);
    for (triangle, ends) in emission.offsets.windows(2).enumerate().take_while(|(_, ends)| ends[0] < last) {
        if emission.boxes[triangle][0] != 0 || ends[0] == ends[1] {
            continue;
        }
        let (v, cells) = emission.cells(triangle);
        let test = exact && !cells.is_row();
        let axes = SeparatingAxes::new(emission.grid, v, cells.low);
        for pair in ends[0]..ends[1].min(last) {
            let cell = cells.cell(pair - ends[0]);
            let overlaps = !test || axes.meets(cell);
            emission.keys[pair as usize] = if overlaps { cell_id(cell, emission.grid.resolution) } else { emission.grid.cell_count };
            emission.values[pair as usize] = 3 * triangle as u32;
            let brick = cell.map(|n| n / BRICK_SIZE);
            emission.used[cell_id(brick, brick_resolution(emission.grid.resolution)) as usize] = 1;
        }
    }
}
