//! Every byte offset of the library: where the parts of a region lie, and how large regions are.

use ash::vk;
use gridwalk_core::layout::{
    Bounds, Brick, BuildState, DispatchArguments, GridHeader, LeafArguments, MAX_PASSES, Report, SplitCell, TileOccupancy, TraceState,
    WalkState,
};
use gridwalk_core::split::LEAST_SPLIT;

use crate::error::{Error, Result};
use crate::shape::Shape;

/// What a build must have room for. Sizes are made from capacities once; builds of any smaller size fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacity {
    /// Triangles, at most 2^26.
    pub triangles: u32,
    /// Cells of the grid, at most 2^28; a build lowers its density to fit.
    pub cells: u32,
    /// Cells of all triangles, counted once a triangle, at most 2^28: with exact overlap those that it meets, of a box of more than 32 cells all.
    /// Pairs beyond are dropped and reported.
    /// The pairs of leaf cells lie behind them; where they do not fit, no cell is split.
    pub pairs: u32,
    /// Leaf cells of the second level, at most 2^28: cells with many triangles are split into 2^3, 4^3, 8^3, 16^3 or 32^3 of them as
    /// long as these fit. 0: the flat grid of the thesis.
    pub leaf_cells: u32,
}

/// Most triangles of a grid.
pub const MAX_TRIANGLES: u32 = 1 << 26;
/// Most cells of a grid.
pub const MAX_CELLS: u32 = 1 << 28;
/// Most pairs of a grid.
pub const MAX_PAIRS: u32 = 1 << 28;
/// Most vertices of a geometry: SPIR-V takes indices as signed, and the last float of the last vertex must be below 2^31.
pub const MAX_VERTICES: u32 = 1 << 29;
/// Most rays of a trace.
pub const MAX_RAYS: u32 = 1 << 28;

/// Alignment of every region, and of the parts inside. Kernels load 16 bytes at once; a cache line more keeps parts apart.
pub const REGION_ALIGNMENT: u64 = 64;

/// What a region needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RegionSize {
    /// Bytes.
    pub size: u64,
    /// Alignment of the region's device address, bytes.
    pub alignment: u64,
    /// Usage flags of its buffer.
    pub usage: vk::BufferUsageFlags,
}

/// What the regions of a build need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BuildSizes {
    /// The grid itself, triangles included: needed as long as rays are traced.
    pub grid: RegionSize,
    /// Needed while a build runs; builds that do not overlap in time may share it.
    pub scratch: RegionSize,
    /// A [`Report`], in memory that the host can read if it wants to.
    pub report: RegionSize,
    /// Timestamps that a build writes if asked to.
    pub timestamp_count: u32,
}

/// Bytes of the regions of grid and scratch, reckoned without a device: for estimates, before there is one. [`crate::Tracer::build_sizes`] also
/// knows the device's limits, and how its kernels are cut.
pub fn region_bytes(capacity: &Capacity, shape: &Shape) -> (u64, u64) {
    (GridLayout::new(capacity).size, ScratchLayout::new(capacity, shape).size)
}

/// A part of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    pub(crate) offset: u64,
    pub(crate) size: u64,
}

struct Packer(u64);

impl Packer {
    fn part(&mut self, size: u64) -> Part {
        let offset = self.0;
        self.0 = (offset + size).next_multiple_of(REGION_ALIGNMENT);
        Part { offset, size }
    }
}

/// Bricks of 4^3 cells that a grid of so many cells can have. With at most 4,096 cells along an axis the product of (n + 3) / 4 over the
/// axes is greatest for a grid one cell thick: (a + 3) (b + 3) / 16 <= a b / 16 + 1,537.
fn brick_capacity(capacity: &Capacity) -> u64 {
    u64::from(capacity.cells) / 16 + 1_540
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct GridLayout {
    pub(crate) header: Part,
    pub(crate) cells: Part,
    pub(crate) references: Part,
    pub(crate) triangles: Part,
    pub(crate) bricks: Part,
    pub(crate) size: u64,
}

impl GridLayout {
    pub(crate) fn new(capacity: &Capacity) -> GridLayout {
        let mut packer = Packer(0);
        GridLayout {
            header: packer.part(size_of::<GridHeader>() as u64),
            cells: packer.part((u64::from(capacity.cells.max(1)) + u64::from(capacity.leaf_cells)) * 8),
            references: packer.part(u64::from(capacity.pairs.max(1)) * 4),
            triangles: packer.part(u64::from(capacity.triangles.max(1)) * 48),
            bricks: packer.part(brick_capacity(capacity) * size_of::<Brick>() as u64),
            size: packer.0,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ScratchLayout {
    pub(crate) state: Part,
    pub(crate) arguments: Part,
    pub(crate) bounds_partials: Part,
    pub(crate) offsets: Part,
    pub(crate) cell_boxes: Part,
    pub(crate) scan_partials: Part,
    pub(crate) keys_a: Part,
    pub(crate) keys_b: Part,
    pub(crate) values_a: Part,
    pub(crate) table: Part,
    pub(crate) occupancy: Part,
    pub(crate) distances_x: Part,
    pub(crate) distances_y: Part,
    pub(crate) leaf_state: Part,
    pub(crate) leaf_arguments: Part,
    pub(crate) split_cells: Part,
    pub(crate) size: u64,
}

impl ScratchLayout {
    pub(crate) fn new(capacity: &Capacity, shape: &Shape) -> ScratchLayout {
        let offsets = u64::from(capacity.triangles) + 1;
        let table = shape.table_entries(capacity.pairs);
        let pairs = u64::from(capacity.pairs.max(1));
        // Each has a list of so many pairs.
        let split_cells = if capacity.leaf_cells > 0 { pairs / u64::from(LEAST_SPLIT) } else { 0 };
        let mut packer = Packer(0);
        ScratchLayout {
            state: packer.part(size_of::<BuildState>() as u64),
            arguments: packer.part(size_of::<DispatchArguments>() as u64),
            bounds_partials: packer.part(u64::from(shape.bounds_tiles(capacity.triangles)) * size_of::<Bounds>() as u64),
            offsets: packer.part(offsets * 4),
            cell_boxes: packer.part(u64::from(capacity.triangles.max(1)) * 12),
            scan_partials: packer.part(u64::from(shape.scan_partials(capacity.triangles, capacity.pairs.max(1))) * 4),
            // The second level's offsets have an end.
            keys_a: packer.part((pairs + 1) * 4),
            keys_b: packer.part(pairs * 4),
            values_a: packer.part(pairs * 4),
            table: packer.part(table.max(1) * 4),
            occupancy: packer.part(brick_capacity(capacity).div_ceil(u64::from(shape.brick_tile())) * size_of::<TileOccupancy>() as u64),
            distances_x: packer.part(brick_capacity(capacity) * 4),
            distances_y: packer.part(brick_capacity(capacity) * 4),
            leaf_state: packer.part(size_of::<BuildState>() as u64),
            leaf_arguments: packer.part(size_of::<LeafArguments>() as u64),
            split_cells: packer.part(split_cells.max(1) * size_of::<SplitCell>() as u64),
            size: packer.0,
        }
    }
}

/// Name and bytes of every part of the grid and the scratch region, in this order.
pub(crate) fn parts(capacity: &Capacity, shape: &Shape) -> [(&'static str, u64); 21] {
    let grid = GridLayout::new(capacity);
    let scratch = ScratchLayout::new(capacity, shape);
    [
        ("grid header", grid.header),
        ("cells", grid.cells),
        ("references", grid.references),
        ("triangles", grid.triangles),
        ("bricks", grid.bricks),
        ("build state", scratch.state),
        ("dispatch arguments", scratch.arguments),
        ("bounds partials", scratch.bounds_partials),
        ("offsets", scratch.offsets),
        ("cell boxes", scratch.cell_boxes),
        ("scan partials", scratch.scan_partials),
        ("keys a", scratch.keys_a),
        ("keys b", scratch.keys_b),
        ("values a", scratch.values_a),
        ("digit table", scratch.table),
        ("occupancy partials", scratch.occupancy),
        ("distances x", scratch.distances_x),
        ("distances y", scratch.distances_y),
        ("leaf state", scratch.leaf_state),
        ("leaf arguments", scratch.leaf_arguments),
        ("split cells", scratch.split_cells),
    ]
    .map(|(name, part)| (name, part.size))
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct TraceLayout {
    pub(crate) state: Part,
    pub(crate) walks: Part,
    pub(crate) size: u64,
}

impl TraceLayout {
    pub(crate) fn new(max_rays: u32) -> TraceLayout {
        let mut packer = Packer(0);
        TraceLayout {
            state: packer.part(size_of::<TraceState>() as u64),
            walks: packer.part(u64::from(max_rays.max(1)) * size_of::<WalkState>() as u64),
            size: packer.0,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct RaySortLayout {
    pub(crate) state: Part,
    pub(crate) arguments: Part,
    pub(crate) keys_a: Part,
    pub(crate) keys_b: Part,
    pub(crate) values_a: Part,
    pub(crate) table: Part,
    pub(crate) scan_partials: Part,
    pub(crate) size: u64,
}

impl RaySortLayout {
    pub(crate) fn new(max_rays: u32, shape: &Shape) -> RaySortLayout {
        let rays = u64::from(max_rays.max(1));
        let table = shape.table_entries(max_rays).max(1);
        let mut packer = Packer(0);
        RaySortLayout {
            state: packer.part(size_of::<BuildState>() as u64),
            arguments: packer.part(size_of::<DispatchArguments>() as u64),
            keys_a: packer.part(4 * rays),
            keys_b: packer.part(4 * rays),
            values_a: packer.part(4 * rays),
            table: packer.part(4 * table),
            scan_partials: packer.part(4 << shape.sort_bits),
            size: packer.0,
        }
    }
}

/// Passes that a plan records: digits of the largest key that the capacity of cells admits.
pub(crate) fn pass_capacity(capacity: &Capacity, shape: &Shape) -> u32 {
    passes_of(capacity.cells, shape)
}

/// Likewise of the second level.
pub(crate) fn leaf_pass_capacity(capacity: &Capacity, shape: &Shape) -> u32 {
    passes_of(capacity.leaf_cells, shape)
}

fn passes_of(keys: u32, shape: &Shape) -> u32 {
    let key_bits = 32 - (keys.max(1) - 1).leading_zeros();
    key_bits.div_ceil(shape.sort_bits).min(MAX_PASSES as u32)
}

pub(crate) fn check_capacity(capacity: &Capacity, shape: &Shape) -> Result<()> {
    let limits = [
        ("triangles", capacity.triangles, MAX_TRIANGLES),
        ("cells", capacity.cells, MAX_CELLS),
        ("pairs", capacity.pairs, MAX_PAIRS.min(shape.most_sorted())),
        ("leaf cells", capacity.leaf_cells, MAX_CELLS),
    ];
    match limits.into_iter().find(|(_, given, limit)| given > limit) {
        Some((what, given, limit)) => Err(Error::Capacity { what, given: given.into(), limit: limit.into() }),
        None => Ok(()),
    }
}

pub(crate) fn region_size(region: &'static str, size: u64, limit: u64, usage: vk::BufferUsageFlags) -> Result<RegionSize> {
    if size > limit {
        return Err(Error::DeviceLimit { region, needed: size, limit });
    }
    let usage = usage | vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
    Ok(RegionSize { size, alignment: REGION_ALIGNMENT, usage })
}

/// Bytes of a report region.
pub(crate) const REPORT_SIZE: u64 = size_of::<Report>() as u64;
