//! The second level (Kalojanov, Billeter and Slusallek 2011), as `shared/split.glsl` and `shared/leaf.glsl` have it.

use crate::layout::{GridHeader, SplitCell};
use crate::overlap::{CellBox, triangle_cells};
use crate::vector::{Vec3, power_of_two};

/// Most levels: a cell is split into up to 32^3 leaf cells.
pub const MAX_LEVEL: u32 = 5;
/// Least level whose empty leaf cells know how far the nearest is that is not.
pub const LEAST_MEASURED: u32 = 4;
/// Triangles of a list from which on its cell is split.
pub const LEAST_SPLIT: u32 = 24;
/// The same where lists are long all over.
pub const LEAST_SPLIT_OF_LONG: u32 = 64;
/// Mean length of a grid's lists from which on they are long.
pub const LONG_LISTS: u32 = 6;

/// 2^level leaf cells along each axis for a list of so many triangles.
pub fn leaf_level(count: u32, least: u32, most: u32) -> u32 {
    let level = [24, 48, 128, 256, 1024].into_iter().filter(|least| count >= *least).count() as u32;
    if count >= least { level.min(most) } else { 0 }
}

/// Leaf cells of a cell.
pub const fn leaf_count_of(level: u32) -> u32 {
    1 << (3 * level)
}

/// The longest distance of an empty leaf cell to one that is not; the level is at least [`LEAST_MEASURED`].
pub const fn max_leaf_distance(level: u32) -> u32 {
    1 << (level - 2)
}

/// The whole grid with 2^level cells for each along each axis.
pub fn refined(grid: &GridHeader, level: u32) -> GridHeader {
    GridHeader {
        cell_size: grid.cell_size.map(|size| size * power_of_two(-(level as i32))),
        inverse_cell_size: grid.inverse_cell_size.map(|size| size * power_of_two(level as i32)),
        resolution: grid.resolution.map(|cells| cells << level),
        ..*grid
    }
}

/// The cells of the refined grid inside of a split cell that the triangle's box overlaps, if any; and whether one of them may be missed by
/// the triangle.
pub fn leaf_box(fine: &GridHeader, split: &SplitCell, exact: bool, v: [Vec3; 3]) -> Option<(CellBox, bool)> {
    let low = [split.xy & 0xFFFF, split.xy >> 16, split.z].map(|i| i << split.level);
    let all = triangle_cells(fine, v);
    let cut = CellBox {
        low: std::array::from_fn(|axis| all.low[axis].max(low[axis])),
        high: std::array::from_fn(|axis| all.high[axis].min(low[axis] + (1 << split.level) - 1)),
    };
    let empty = split.level == 0 || (0..3).any(|axis| cut.low[axis] > cut.high[axis]);
    (!empty).then_some((cut, exact && !all.is_row()))
}

/// Binary logarithm of the number of references of split cells that share one in the list of owners: at least `least`, so many that there are
/// at most 2^14 blocks.
pub fn owner_shift(least: u32, reference_count: u32) -> u32 {
    least.max((31 - (reference_count | 1).leading_zeros()).max(13) - 13)
}
