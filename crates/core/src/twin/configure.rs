//! Twin of kernel `configure`.
//!
//! Integers that follow from the resolution are the kernel's on every device; the resolution and the sizes of cells come out of divisions,
//! which a GPU rounds by up to 2.5 ulp. So later twins take the device's header, and [`configure_state`] is a function of it.

use super::pair_args::four;
use crate::dispatch::split_workgroups;
use crate::gather::unite;
use crate::grid::{BRICK_SIZE, brick_resolution};
use crate::layout::{Bounds, BuildState, DispatchArguments, GridHeader, OVERFLOW_CELLS, Report};
use crate::shape::Shape;
use crate::sort::passes_of;
use crate::split::{MAX_LEVEL, refined};
use crate::vector::{Vec3, add, clamped_exponent, largest, max, max_f32, min, min_f32, power_of_two, sub};

const MAX_RESOLUTION: f32 = 4096.0;
/// 2^-20.
pub const PAD: f32 = 9.536_743e-7;
const MIN_CELL_IN_PADS: f32 = 4.0;
/// Sizes of the scene from which on its middle is subtracted.
const FAR: f32 = 4.0;
/// 2^-100.
const LEAST_MIDDLE: f32 = 7.888_609e-31;

/// What a build asks `configure` for.
#[derive(Clone, Copy, Debug)]
pub struct Configure {
    /// Triangles, dropped ones included.
    pub triangle_count: u32,
    /// Most cells.
    pub cell_capacity: u32,
    /// Density k of Equation 3-1.
    pub density: f32,
    /// A fixed resolution; the first is 0 without.
    pub fixed: [u32; 3],
    /// Whether cells with many triangles are split.
    pub splits: bool,
    /// Whether cells that only a triangle's box overlaps get the sentinel key.
    pub exact: bool,
}

/// The union of the boxes of all tiles: the scene box.
pub fn unite_bounds(partials: &[Bounds], partial_count: u32) -> Bounds {
    partials[..partial_count as usize].iter().copied().fold(Bounds::EMPTY, unite)
}

fn cells_for(relative: Vec3, limit: Vec3, s: f32) -> f32 {
    let cells = min(max(relative.map(|x| x * s), [1.0; 3]), limit);
    cells[0] * cells[1] * cells[2]
}

fn resolution_for(extent: Vec3, limit: Vec3, target: f32) -> [u32; 3] {
    let longest = largest(extent);
    let relative = extent.map(|x| x / longest);
    let mut low = 1.0;
    let mut high = max_f32(target, 1.0);
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        if cells_for(relative, limit, middle) <= target {
            low = middle;
        } else {
            high = middle;
        }
    }
    min(max(relative.map(|x| (x * low).floor()), [1.0; 3]), limit).map(|x| x as u32)
}

fn cell_size_for(low: f32, high: f32, count: f32) -> f32 {
    let mut size = (high - low) / count;
    for _ in 0..64 {
        let offset = count * size;
        if low + offset >= high {
            break;
        }
        size = f32::from_bits(size.to_bits() + 1);
    }
    size
}

/// The middle of an interval that lies far from zero, for the scene's size. All its points are then between half and twice the middle, and
/// no difference is denormal: subtracting the middle is exact.
fn middle_for(low: f32, high: f32, longest: f32) -> f32 {
    let middle = 0.5 * low + 0.5 * high;
    if middle.abs() >= max_f32(FAR * longest, LEAST_MIDDLE) { middle } else { 0.0 }
}

/// The scene box in the grid's frame, padded, with the middle and the scale that bring it there.
fn padded_box(info: &Configure, scene: &Bounds) -> (Bounds, Vec3, i32, f32) {
    let empty = scene.dropped == info.triangle_count;
    let (low, high) = if empty { ([0.0; 3], [0.0; 3]) } else { (scene.low, scene.high) };
    let longest = largest(sub(high, low));
    let middle: Vec3 = std::array::from_fn(|axis| middle_for(low[axis], high[axis], longest));
    let (low, high) = (sub(low, middle), sub(high, middle));
    let magnitude = largest(max(low.map(f32::abs), high.map(f32::abs)));
    let exponent = if magnitude > 0.0 { clamped_exponent(magnitude) } else { 0 };
    let scale = power_of_two(-exponent);
    let pad = max_f32(magnitude * scale, 1.0) * PAD;
    let low = sub(low.map(|x| x * scale), [pad; 3]);
    let high = add(high.map(|x| x * scale), [pad; 3]);
    (Bounds { low, high, ..*scene }, middle, exponent, pad)
}

/// Whether a capacity has room for all cells of a resolution. Two axes have at most 2^24 cells together, so nothing overflows.
pub fn fits(resolution: [u32; 3], capacity: u32) -> bool {
    resolution[0] * resolution[1] <= capacity / resolution[2]
}

/// The grid's head but for its addresses, the density that was used, and whether the cells did not fit.
pub fn configure_header(info: &Configure, scene: &Bounds, addresses: [[u32; 2]; 4]) -> (GridHeader, f32, u32) {
    let (padded, middle, exponent, pad) = padded_box(info, scene);
    let extent = sub(padded.high, padded.low);
    let limit = extent.map(|x| max_f32((x / (MIN_CELL_IN_PADS * pad)).floor(), 1.0).min(MAX_RESOLUTION));
    let mut density = info.density;
    let mut resolution = [1; 3];
    let mut overflow = 0;
    if scene.dropped != info.triangle_count {
        let triangles = (info.triangle_count - scene.dropped) as f32;
        let capacity = max_f32(info.cell_capacity as f32, 1.0);
        if info.fixed[0] != 0 {
            resolution = std::array::from_fn(|axis| info.fixed[axis].min(limit[axis] as u32));
            if !fits(resolution, info.cell_capacity) {
                overflow = OVERFLOW_CELLS;
                resolution = resolution_for(extent, limit, capacity);
            }
        } else {
            let mut wanted = max_f32(triangles * info.density, 1.0);
            if wanted > capacity {
                overflow = OVERFLOW_CELLS;
                wanted = capacity;
                density = wanted / triangles;
            }
            resolution = resolution_for(extent, limit, wanted);
        }
        // Beyond 2^24 cells the floats above may be off by a few; one slice less is at least 4,096 cells less.
        if !fits(resolution, info.cell_capacity) {
            let longest = resolution[0].max(resolution[1]).max(resolution[2]);
            if let Some(axis) = resolution.iter().position(|n| *n == longest) {
                resolution[axis] = (resolution[axis] - 1).max(1);
            }
        }
    }
    let cell_size: Vec3 = std::array::from_fn(|axis| cell_size_for(padded.low[axis], padded.high[axis], resolution[axis] as f32));
    let [cells, references, triangles, bricks] = addresses;
    let header = GridHeader {
        box_min: padded.low,
        scale: power_of_two(-exponent),
        box_max: padded.high,
        pad,
        cell_size,
        inverse_scale: power_of_two(exponent),
        inverse_cell_size: cell_size.map(|size| 1.0 / size),
        cell_count: resolution.iter().product(),
        resolution,
        triangle_count: info.triangle_count,
        cells,
        references,
        triangles,
        bricks,
        middle,
        fine_shift: 0,
        fine_cell_size: cell_size,
        reserved0: 0,
        inverse_fine_cell_size: cell_size.map(|size| 1.0 / size),
        reserved1: 0,
    };
    let least = min_f32(cell_size[0], min_f32(cell_size[1], cell_size[2]));
    let large_enough = |level: &u32| least >= (1u32 << level) as f32 * (MIN_CELL_IN_PADS * pad);
    let fine_shift = if info.splits { (1..=MAX_LEVEL).filter(large_enough).max().unwrap_or(0) } else { 0 };
    let fine = refined(&header, fine_shift);
    let header = GridHeader { fine_shift, fine_cell_size: fine.cell_size, inverse_fine_cell_size: fine.inverse_cell_size, ..header };
    (header, density, overflow)
}

/// State, arguments and report as they follow from the header and from what the state was; of the arguments and the report only what the
/// kernel writes.
#[allow(clippy::too_many_arguments, reason = "what the kernel writes")]
pub fn configure_state(
    shape: &Shape,
    info: &Configure,
    scene: &Bounds,
    header: &GridHeader,
    density: f32,
    overflow: u32,
    state: &mut BuildState,
    arguments: &mut DispatchArguments,
    report: &mut Report,
) {
    let key_bits = 32 - (header.cell_count - 1).leading_zeros();
    let overflow = state.overflow | overflow;
    let sentinel = if info.exact { header.cell_count } else { u32::MAX };
    let (pass_count, digit_bits) = passes_of(key_bits, shape.sort_bits);
    *state = BuildState { key_bits, pass_count, digit_bits, sentinel, overflow, ..*state };
    let bricks: u32 = brick_resolution(header.resolution).iter().product();
    arguments.brick_reduce = four(shape.deal_workgroups(bricks, shape.brick_tile()));
    arguments.bricks = four(split_workgroups(bricks, shape.map_size));
    arguments.clear_cells = four(shape.deal_workgroups(BRICK_SIZE * bricks, shape.map_size));
    let empty = scene.dropped == info.triangle_count;
    *report = Report {
        triangles: info.triangle_count,
        dropped: scene.dropped,
        cells: header.cell_count,
        cells_in_use: 0,
        resolution: header.resolution,
        longest_list: 0,
        pairs: 0,
        pair_total: 0,
        overflow,
        key_bits,
        box_min: if empty { [0.0; 3] } else { scene.low },
        density,
        box_max: if empty { [0.0; 3] } else { scene.high },
        triangle_total: state.triangle_total,
        split_cells: 0,
        leaf_cells: 0,
        leaf_pairs: 0,
        reserved: 0,
    };
}
