//! Structures in device memory that kernels and host share. Offsets are asserted against the kernels by the generated tables of crate
//! `gridwalk`. Private to gridwalk but for [`Report`]: the rest may change with every version.

use bytemuck::{Pod, Zeroable};

/// Passes of the radix sort that a plan may record: 32 key bits at 4 bits a digit.
pub const MAX_PASSES: usize = 8;

/// [`Report::overflow`]: pairs were dropped; [`Report::pair_total`] is the capacity that would have sufficed, unless saturated.
pub const OVERFLOW_PAIRS: u32 = 1;
/// [`Report::overflow`]: the resolution was lowered to fit the capacity of cells.
pub const OVERFLOW_CELLS: u32 = 2;

/// [`Report::overflow`]: triangles beyond the capacity were left out; [`Report::triangle_total`] would have sufficed, unless saturated.
pub const OVERFLOW_TRIANGLES: u32 = 4;

/// [`Report::overflow`]: some cells that were to be split stayed whole, for lack of room for leaf cells or for their pairs.
pub const OVERFLOW_LEAVES: u32 = 8;

/// Of the second word of a cell's range: the cell is split; the first word is the index of its first leaf cell.
pub const CELL_SPLIT: u32 = 1 << 31;
/// Of the same word: the level, 2^level leaf cells along each axis.
pub const CELL_LEVEL: u32 = 7;

/// Of the word in a triangle's first row: a vertex is not finite, or an index out of range. Then all its vertices are zero.
pub const TRIANGLE_DROPPED: u32 = 1 << 31;
/// Of the same word: the triangle's front is where its vertices go round clockwise.
pub const TRIANGLE_FLIPPED: u32 = 1 << 30;
/// Of the same word: the triangle is never culled.
pub const TRIANGLE_TWO_SIDED: u32 = 1 << 29;
/// Of the same word: the triangle's number in its geometry.
pub const TRIANGLE_NUMBER: u32 = (1 << 26) - 1;

/// Head of a grid in device memory; in the grid's frame: (input coordinate - `middle`) * `scale`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GridHeader {
    /// Padded minimum of the scene box.
    pub box_min: [f32; 3],
    /// Power of two that brings the largest |coordinate - middle| into [1, 2).
    pub scale: f32,
    /// Padded maximum of the scene box.
    pub box_max: [f32; 3],
    /// 2^-20 of the largest |coordinate| of the frame.
    pub pad: f32,
    /// Size of a cell; the last boundary is at or beyond `box_max`.
    pub cell_size: [f32; 3],
    /// 1 / `scale`.
    pub inverse_scale: f32,
    /// 1 / `cell_size`, rounded.
    pub inverse_cell_size: [f32; 3],
    /// Product of `resolution`.
    pub cell_count: u32,
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// Triangles of the build, dropped ones included.
    pub triangle_count: u32,
    /// Device address of the cell ranges (low word first): begin and end of a list; of an empty leaf cell, how far others are, and 0.
    pub cells: [u32; 2],
    /// Device address of the references, each the index of a triangle's first row.
    pub references: [u32; 2],
    /// Device address of the triangles.
    pub triangles: [u32; 2],
    /// Device address of the bricks.
    pub bricks: [u32; 2],
    /// Zero but along axes on which the scene lies far from the origin; subtracting it from a vertex is exact.
    pub middle: [f32; 3],
    /// Most levels of a split cell: a cell is 2^`fine_shift` of a walk's fine cells along each axis. 0: no cell is split.
    pub fine_shift: u32,
    /// `cell_size` / 2^`fine_shift`.
    pub fine_cell_size: [f32; 3],
    /// Zero.
    pub reserved0: u32,
    /// `inverse_cell_size` * 2^`fine_shift`.
    pub inverse_fine_cell_size: [f32; 3],
    /// Zero.
    pub reserved1: u32,
}

impl GridHeader {
    /// A point brought into the grid's frame.
    pub fn to_frame(&self, point: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| (point[axis] - self.middle[axis]) * self.scale)
    }
}

/// A block of 4^3 cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Brick {
    /// Bit x + 4 y + 16 z, low word first, of each cell that is not empty.
    pub mask: [u32; 2],
    /// All bricks closer than this, in the maximum norm, are empty.
    pub distance: u32,
    /// Triangles in the fullest of its cells, before that was split.
    pub longest_list: u32,
}

/// What a tile of bricks adds to the report, and gives the second level to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct TileOccupancy {
    /// Cells with at least one triangle.
    pub cells_in_use: u32,
    /// Triangles in the fullest cell.
    pub longest_list: u32,
    /// Cells to be split if [`crate::split::LEAST_SPLIT`] triangles are the least list, and if [`crate::split::LEAST_SPLIT_OF_LONG`] are.
    pub split_cells: [u32; 2],
    /// Triangles in their lists.
    pub split_references: [u32; 2],
    /// Their leaf cells.
    pub leaf_cells: [u32; 2],
    /// `split_cells` of all tiles before; this and those below are written by `report_spine`.
    pub cells_before: u32,
    /// `split_references` of all tiles before.
    pub references_before: u32,
    /// `leaf_cells` of all tiles before, saturating.
    pub leaves_before: u32,
    /// Zero.
    pub reserved: u32,
}

/// A cell with many triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SplitCell {
    /// Its first reference among those of all split cells.
    pub first_reference: u32,
    /// Its list in the grid's references.
    pub list_begin: u32,
    /// Length of its list.
    pub list_length: u32,
    /// Its first leaf cell among all.
    pub leaf_begin: u32,
    /// Index of the cell.
    pub cell: u32,
    /// 2^`level` leaf cells along each axis; 0: they did not fit, so the cell stays whole.
    pub level: u32,
    /// The cell's coordinates x (low half) and y.
    pub xy: u32,
    /// The cell's coordinate z.
    pub z: u32,
}

/// Numbers that later steps of a build take from earlier ones. The second level has a state of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct BuildState {
    /// Triangles of the build.
    pub triangle_count: u32,
    /// `triangle_count` + 1.
    pub offset_count: u32,
    /// Cells of all triangles, saturating.
    pub pair_total: u32,
    /// `pair_total`, at most the capacity.
    pub pair_count: u32,
    /// Bits of the largest key.
    pub key_bits: u32,
    /// Digits in use.
    pub pass_count: u32,
    /// [`OVERFLOW_PAIRS`], [`OVERFLOW_CELLS`], [`OVERFLOW_TRIANGLES`].
    pub overflow: u32,
    /// Triangles of all geometries, saturating; `triangle_count` is at most the capacity.
    pub triangle_total: u32,
    /// Bits of the digit of each pass.
    pub digit_bits: u32,
    /// 1: some triangle's box holds more cells than a mask has bits.
    pub has_large: u32,
    /// Pairs with a cell: the first pass of the sort leaves the others behind.
    pub kept_count: u32,
    /// Key of a pair without a cell.
    pub sentinel: u32,
    /// First of the pairs: 0, or of the second level, whose pairs lie behind those of the first.
    pub first_pair: u32,
    /// First of the cells: 0, or of the second level, whose leaf cells lie behind the cells.
    pub first_cell: u32,
    /// Cells that are to be split; of the second level.
    pub split_cells: u32,
    /// Triangles of the shortest list whose cell is split; of the second level.
    pub least_split: u32,
}

/// Arguments of the build's indirect dispatches; each a `VkDispatchIndirectCommand` and a word of padding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct DispatchArguments {
    /// Of `overlap_emit_large`.
    pub emit_large: [u32; 4],
    /// Of `sort_histogram` and `sort_scatter`, for each pass.
    pub sort: [[u32; 4]; MAX_PASSES],
    /// Of `table_scan`, for each pass.
    pub table_scan: [[u32; 4]; MAX_PASSES],
    /// Of `cell_ranges`.
    pub cell_ranges: [u32; 4],
    /// Of `brick_reduce`.
    pub brick_reduce: [u32; 4],
    /// Of `clear_bricks`, `brick_distance_y` and `_z`: an invocation a brick. Of `brick_distance_x` too, whose invocations take a run of bricks:
    /// most have none.
    pub bricks: [u32; 4],
    /// Of `clear_cells`: an invocation a slice of a brick.
    pub clear_cells: [u32; 4],
    /// Of `gather_records`; this and those below are written only where geometries are counted on the device.
    pub gather: [u32; 4],
    /// Of `overlap_count` and `overlap_emit`.
    pub overlap_count: [u32; 4],
    /// Of `scan_reduce` over its counts, and of `pair_args`, which scans them.
    pub offsets_scan: [u32; 4],
    /// Of `ray_keys`: written only where rays are sorted; then only this and the first passes' of the sort are.
    pub ray_keys: [u32; 4],
}

/// Arguments of the indirect dispatches of the second level; as [`DispatchArguments`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct LeafArguments {
    /// Of `split_cells`.
    pub split_cells: [u32; 4],
    /// Of `leaf_count`.
    pub count: [u32; 4],
    /// Of `scan_reduce` over its counts.
    pub offsets_scan: [u32; 4],
    /// Of `leaf_args`, which scans them.
    pub args: [u32; 4],
    /// Of `leaf_emit_large`.
    pub emit_large: [u32; 4],
    /// Of `leaf_sort`.
    pub leaf_sort: [u32; 4],
    /// Of `leaf_emit`; this and those of the sort and of `cell_ranges` are none where `leaf_sort` makes the lists.
    pub emit: [u32; 4],
    /// Of `sort_histogram` and `sort_scatter`, for each pass.
    pub sort: [[u32; 4]; MAX_PASSES],
    /// Of `table_scan`, for each pass.
    pub table_scan: [[u32; 4]; MAX_PASSES],
    /// Of `cell_ranges`.
    pub cell_ranges: [u32; 4],
    /// Of `leaf_distance`.
    pub distance: [u32; 4],
}

/// The box of some triangles.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Bounds {
    /// Minimum; infinite without a triangle.
    pub low: [f32; 3],
    /// Triangles left out.
    pub dropped: u32,
    /// Maximum; minus infinity without a triangle.
    pub high: [f32; 3],
    /// Zero.
    pub reserved: u32,
}

impl Bounds {
    /// The box of no triangle.
    pub const EMPTY: Bounds = Bounds { low: [f32::INFINITY; 3], dropped: 0, high: [f32::NEG_INFINITY; 3], reserved: 0 };
}

/// What a build tells its caller: written to the report region by every build, to be read after the device has executed it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Report {
    /// Triangles of the grid, dropped ones included.
    pub triangles: u32,
    /// Triangles left out: a vertex is not finite, or an index lies outside of the positions.
    pub dropped: u32,
    /// Cells of the grid.
    pub cells: u32,
    /// Cells with at least one triangle.
    pub cells_in_use: u32,
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// Triangles in the fullest cell.
    pub longest_list: u32,
    /// Pairs (cell, triangle) that the grid lists.
    pub pairs: u32,
    /// Cells of all triangles, as [`BuildState::pair_total`], or pairs of both levels if those are more and did not fit: the capacity of pairs that the build needed. 0xFFFFFFFF: that many or more.
    pub pair_total: u32,
    /// 0, or bits [`OVERFLOW_PAIRS`], [`OVERFLOW_CELLS`], [`OVERFLOW_TRIANGLES`] and [`OVERFLOW_LEAVES`].
    pub overflow: u32,
    /// Bits of the sort's largest key.
    pub key_bits: u32,
    /// Minimum of the scene box, in input coordinates.
    pub box_min: [f32; 3],
    /// Density k that was used: what was asked for, or less if the cells did not fit.
    pub density: f32,
    /// Maximum of the scene box, in input coordinates.
    pub box_max: [f32; 3],
    /// Triangles of all geometries: the capacity of triangles that the build needed. 0xFFFFFFFF: that many or more.
    pub triangle_total: u32,
    /// Cells with so many triangles that they were to be split into leaf cells.
    pub split_cells: u32,
    /// Leaf cells that they asked for: the capacity of leaf cells that the build needed. 0xFFFFFFFF: that many or more.
    pub leaf_cells: u32,
    /// Pairs (leaf cell, triangle) that the grid lists beside `pairs`.
    pub leaf_pairs: u32,
    /// Zero.
    pub reserved: u32,
}

impl Report {
    /// Whether pairs were dropped for lack of capacity: the grid is sound but misses triangles, so grow and build again.
    pub const fn pairs_overflowed(&self) -> bool {
        self.overflow & OVERFLOW_PAIRS != 0
    }

    /// Whether the resolution was lowered for lack of capacity: the grid is complete, only coarser than asked for.
    pub const fn cells_overflowed(&self) -> bool {
        self.overflow & OVERFLOW_CELLS != 0
    }

    /// Whether some cells stayed whole that were to be split, for lack of capacity: the grid is complete, only slower.
    pub const fn leaves_overflowed(&self) -> bool {
        self.overflow & OVERFLOW_LEAVES != 0
    }

    /// Whether triangles were left out for lack of capacity: the grid is sound but misses the last of them.
    pub const fn triangles_overflowed(&self) -> bool {
        self.overflow & OVERFLOW_TRIANGLES != 0
    }

    /// The capacity of pairs that the build needed; `None` if only a lower density helps.
    pub const fn needed_pairs(&self) -> Option<u32> {
        if self.pair_total == u32::MAX { None } else { Some(self.pair_total) }
    }
}

/// Head of a trace's scratch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct TraceState {
    /// `VkDispatchIndirectCommand` of the next trace, and padding.
    pub arguments: [u32; 4],
    /// Rays of the trace.
    pub ray_count: u32,
    /// 1 if a walk was given up.
    pub unfinished: u32,
    /// Zero.
    pub reserved: [u32; 2],
}

/// First bit of the place within the cell in [`WalkState::given_up`]: fine cells, eight bits an axis.
pub const WALK_FINE: u32 = 8;

/// Where a walk was given up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct WalkState {
    /// Not 0 if the walk is to be continued; from bit [`WALK_FINE`] on the place within the cell.
    pub given_up: u32,
    /// Cell id.
    pub cell: u32,
    /// Next entry of the cell's list.
    pub reference: u32,
    /// Exit of the cell.
    pub exit: f32,
    /// Best hit so far, in the moved frame.
    pub best_s: f32,
    /// Its barycentrics.
    pub best_u: f32,
    /// Its barycentrics.
    pub best_v: f32,
    /// Its triangle.
    pub best_triangle: u32,
}
