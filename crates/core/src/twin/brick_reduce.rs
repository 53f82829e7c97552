//! Twin of kernel `brick_reduce`.

use crate::dispatch::workgroups;
use crate::grid::{BRICK_SIZE, brick_resolution, cell_id, cell_of};
use crate::layout::Brick;
use crate::shape::Shape;

pub(super) fn unite(a: [u32; 2], b: [u32; 2]) -> [u32; 2] {
    [a[0] + b[0], a[1].max(b[1])]
}

fn brick(resolution: [u32; 3], index: u32, cells: &[[u32; 2]]) -> (Brick, [u32; 2]) {
    let low = cell_of(index, brick_resolution(resolution)).map(|n| n * BRICK_SIZE);
    let mut mask = 0u64;
    let mut longest = 0;
    for bit in 0..64 {
        let cell: [u32; 3] = std::array::from_fn(|axis| low[axis] + (bit >> (2 * axis)) % BRICK_SIZE);
        if cell.iter().zip(&resolution).all(|(cell, count)| cell < count) {
            let [begin, end] = cells[cell_id(cell, resolution) as usize];
            mask |= u64::from(end != 0) << bit;
            longest = longest.max(end - begin);
        }
    }
    (Brick { mask: [mask as u32, (mask >> 32) as u32], ..Brick::default() }, [mask.count_ones(), longest])
}

/// Which cells of each brick are in use; cells in use and longest list of each tile of bricks.
pub fn brick_reduce(
    shape: &Shape,
    groups: [u32; 3],
    resolution: [u32; 3],
    cells: &[[u32; 2]],
    bricks: &mut [Brick],
    partials: &mut [[u32; 2]],
) {
    let count: u32 = brick_resolution(resolution).iter().product();
    for tile in workgroups(groups) {
        let first = tile * shape.brick_tile();
        if first >= count {
            continue;
        }
        partials[tile as usize] = (first..count.min(first + shape.brick_tile())).fold([0, 0], |sum, index| {
            let occupancy;
            (bricks[index as usize], occupancy) = brick(resolution, index, cells);
            unite(sum, occupancy)
        });
    }
}
