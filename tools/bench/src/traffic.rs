//! How many bytes the steps of a build and the rays of a trace have to move, to be held against what the memory can.
//!
//! The estimates count every array that a kernel goes through once, each element at its size, and nothing twice: no header, no partial sums, no
//! search. A step that moves more than its share of the bandwidth is bound by something else.

use crate::report::WalkCounts;

/// Bytes of a triangle of three indices, of its three vertices, and of it in the grid.
const INDICES: u64 = 12;
const VERTICES: u64 = 36;
const TRIANGLE: u64 = 48;
/// Bytes of a key, a triangle's number, an offset.
const WORD: u64 = 4;
/// Bytes of a cell's range of references.
const CELL: u64 = 8;
/// Bytes of a brick, and its cells.
const BRICK: u64 = 16;
const CELLS_A_BRICK: u64 = 64;
/// Bytes of a ray and its hit.
const RAY: f64 = 48.0;

/// What a build goes through.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub triangles: u64,
    pub cells: u64,
    pub cells_in_use: u64,
    /// Pairs that are written, of which the first pass of the sort leaves those without a cell behind.
    pub written: u64,
    /// Pairs that are listed.
    pub pairs: u64,
    /// Passes of the sort over them; further launches sort the pairs of leaf cells.
    pub passes: u32,
    /// Leaf cells of the second level, and their pairs, where these are sorted all together.
    pub leaf_cells: u64,
    pub leaf_pairs: u64,
}

impl Size {
    /// Bytes that a kernel of the build reads and writes in so many launches; none of a kernel that is not known, or that moves next to nothing.
    pub fn step(&self, kernel: &str, launches: u32) -> Option<u64> {
        let Size { triangles, cells, cells_in_use, written, pairs, passes, leaf_cells, leaf_pairs } = *self;
        let bricks = cells / CELLS_A_BRICK;
        let later = u64::from(launches.min(passes)).saturating_sub(1);
        let of_leaves = u64::from(launches.saturating_sub(passes)) * leaf_pairs;
        Some(match kernel {
            "gather" => triangles * (INDICES + VERTICES + TRIANGLE),
            "overlap_count" => triangles * (2 * TRIANGLE + 4 * WORD),
            "overlap_emit" => triangles * 4 * WORD + pairs * 2 * WORD,
            "scan_reduce" => triangles * WORD,
            "pair_args" => triangles * 2 * WORD,
            "sort_histogram" => (written + later * pairs + of_leaves) * WORD,
            "sort_scatter" => (written + pairs + later * 2 * pairs + 2 * of_leaves) * 2 * WORD,
            "cell_ranges" => (pairs + leaf_pairs) * WORD + (cells_in_use + leaf_cells) * CELL,
            "brick_distance_x" | "brick_distance_z" => bricks * (BRICK + WORD),
            "brick_distance_y" => bricks * 2 * WORD,
            _ => return None,
        })
    }
}

impl WalkCounts {
    /// Bytes that a ray asks for, most of which caches answer: a brick a step, the range of each cell in use, a reference and a triangle a test,
    /// the ray and its hit.
    pub fn bytes(&self) -> f64 {
        self.steps * BRICK as f64 + self.cells * CELL as f64 + self.tests * (WORD + TRIANGLE) as f64 + RAY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_large_step_is_known() {
        let size =
            Size { triangles: 1000, cells: 8000, cells_in_use: 500, written: 4000, pairs: 3000, passes: 3, leaf_cells: 0, leaf_pairs: 0 };
        assert_eq!(size.step("gather", 1), Some(96_000));
        assert_eq!(size.step("sort_histogram", 3), Some(40_000));
        assert_eq!(size.step("sort_scatter", 3), Some(56_000 + 2 * 48_000));
        let split = Size { leaf_cells: 100, leaf_pairs: 200, ..size };
        assert_eq!(split.step("sort_histogram", 5), Some(40_000 + 2 * 800));
        assert_eq!(split.step("sort_scatter", 5), Some(56_000 + 2 * 48_000 + 2 * 3_200));
        assert_eq!(size.step("configure", 1), None);
        assert_eq!(WalkCounts { steps: 2.0, tests: 1.0, cells: 1.0 }.bytes(), 140.0);
    }
}
