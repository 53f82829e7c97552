//! Push constants of the kernels; the generated table asserts their layout. An address is a [`crate::plan::Buffer`] in a plan, and becomes
//! the device address of that buffer when the plan is recorded. Addresses come first, in the order of the kernel's accesses.

use bytemuck::{Pod, Zeroable};

/// Of kernel `brick_reduce`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BrickReduce {
    pub(crate) grid: u64,
    pub(crate) used: u64,
    pub(crate) cells: u64,
    pub(crate) bricks: u64,
    pub(crate) partials: u64,
}

/// Of kernel `report_spine`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ReportSpine {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) partials: u64,
    pub(crate) leaf_state: u64,
    pub(crate) arguments: u64,
    pub(crate) report: u64,
    pub(crate) leaf_capacity: u32,
    pub(crate) padding: u32,
}

/// Of kernel `split_cells`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SplitCells {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) cells: u64,
    pub(crate) bricks: u64,
    pub(crate) partials: u64,
    pub(crate) split_cells: u64,
    pub(crate) owners: u64,
    pub(crate) leaf_capacity: u32,
    pub(crate) padding: u32,
}

/// Of kernel `scan_reduce`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ScanReduce {
    pub(crate) state: u64,
    pub(crate) values: u64,
    pub(crate) partials: u64,
}

/// Of kernel `table_scan`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct TableScan {
    pub(crate) state: u64,
    pub(crate) table: u64,
    pub(crate) sums: u64,
    pub(crate) pass: u32,
    pub(crate) padding: u32,
}

/// Of kernel `sort_histogram`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SortHistogram {
    pub(crate) state: u64,
    pub(crate) keys_a: u64,
    pub(crate) keys_b: u64,
    pub(crate) table: u64,
    pub(crate) pass: u32,
    pub(crate) padding: u32,
}

/// Of kernel `sort_scatter`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SortScatter {
    pub(crate) state: u64,
    pub(crate) keys_a: u64,
    pub(crate) keys_b: u64,
    pub(crate) values_a: u64,
    pub(crate) values_b: u64,
    pub(crate) table: u64,
    pub(crate) sums: u64,
    pub(crate) kept: u64,
    pub(crate) pass: u32,
    pub(crate) padding: u32,
}

/// Of kernel `any_hit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct AnyHit {
    pub(crate) grid: u64,
    pub(crate) rays: u64,
    pub(crate) occluded: u64,
    pub(crate) state: u64,
    pub(crate) walks: u64,
    pub(crate) masks: u64,
    pub(crate) geometries: u64,
    pub(crate) order: u64,
    pub(crate) mask: u32,
    pub(crate) options: u32,
}

/// Of kernel `brute_force`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BruteForce {
    pub(crate) grid: u64,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) walks: u64,
    pub(crate) ray_count: u32,
    pub(crate) first: u32,
    pub(crate) end: u32,
    pub(crate) last: u32,
}

/// Of kernel `cell_ranges`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CellRanges {
    pub(crate) state: u64,
    pub(crate) keys: u64,
    pub(crate) cells: u64,
    pub(crate) report: u64,
}

/// Of kernel `clear_bricks`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ClearBricks {
    pub(crate) grid: u64,
    pub(crate) used: u64,
}

/// Of kernel `clear_cells`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ClearCells {
    pub(crate) grid: u64,
    pub(crate) used: u64,
    pub(crate) cells: u64,
}

/// Of kernel `closest_candidate`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ClosestCandidate {
    pub(crate) grid: u64,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) ray_count: u32,
    pub(crate) mask: u32,
    pub(crate) cull: u32,
    pub(crate) padding: u32,
}

/// Of kernel `closest_hit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ClosestHit {
    pub(crate) grid: u64,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) state: u64,
    pub(crate) walks: u64,
    pub(crate) counters: u64,
    pub(crate) masks: u64,
    pub(crate) geometries: u64,
    pub(crate) order: u64,
    pub(crate) mask: u32,
    pub(crate) options: u32,
}

/// Of kernel `configure`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Configure {
    pub(crate) partials: u64,
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) arguments: u64,
    pub(crate) report: u64,
    pub(crate) cells: u64,
    pub(crate) references: u64,
    pub(crate) triangles: u64,
    pub(crate) bricks: u64,
    pub(crate) cell_capacity: u32,
    pub(crate) density: f32,
    pub(crate) fixed_x: u32,
    pub(crate) fixed_y: u32,
    pub(crate) fixed_z: u32,
    pub(crate) levels: u32,
    pub(crate) exact: u32,
    pub(crate) padding: u32,
}

/// Of kernel `overlap_count`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct OverlapCount {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) triangles: u64,
    pub(crate) counts: u64,
    pub(crate) boxes: u64,
    pub(crate) used: u64,
}

/// Of kernel `overlap_emit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct OverlapEmit {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) offsets: u64,
    pub(crate) boxes: u64,
    pub(crate) keys_a: u64,
    pub(crate) keys_b: u64,
    pub(crate) values_a: u64,
    pub(crate) values_b: u64,
}

/// Of kernel `overlap_emit_large`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct OverlapEmitLarge {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) offsets: u64,
    pub(crate) triangles: u64,
    pub(crate) keys_a: u64,
    pub(crate) keys_b: u64,
    pub(crate) values_a: u64,
    pub(crate) values_b: u64,
    pub(crate) used: u64,
}

/// Of kernel `pair_args`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PairArgs {
    pub(crate) state: u64,
    pub(crate) partials: u64,
    pub(crate) offsets: u64,
    pub(crate) arguments: u64,
    pub(crate) report: u64,
    pub(crate) pair_capacity: u32,
    pub(crate) pass_capacity: u32,
}

/// Of kernel `ray_keys`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct RayKeys {
    pub(crate) grid: u64,
    pub(crate) rays: u64,
    pub(crate) state: u64,
    pub(crate) keys: u64,
    pub(crate) values: u64,
}

/// Of kernel `ray_sort_args`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct RaySortArgs {
    pub(crate) state: u64,
    pub(crate) arguments: u64,
    pub(crate) count: u64,
    pub(crate) max_rays: u32,
    pub(crate) indirect: u32,
}

/// Of kernel `leaf_args`.
pub(crate) type LeafArgs = PairArgs;

/// Of kernel `leaf_count`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LeafCount {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) split_cells: u64,
    pub(crate) references: u64,
    pub(crate) triangles: u64,
    pub(crate) counts: u64,
    pub(crate) masks: u64,
    pub(crate) boxes: u64,
    pub(crate) owners: u64,
    pub(crate) cells: u64,
}

/// Of kernel `leaf_emit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LeafEmit {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) split_cells: u64,
    pub(crate) references: u64,
    pub(crate) triangles: u64,
    pub(crate) offsets: u64,
    pub(crate) masks: u64,
    pub(crate) boxes: u64,
    pub(crate) owners: u64,
    pub(crate) keys_a: u64,
    pub(crate) keys_b: u64,
    pub(crate) values_a: u64,
    pub(crate) values_b: u64,
    pub(crate) cells: u64,
}

/// Of kernel `leaf_emit_large`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LeafEmitLarge {
    pub(crate) grid: u64,
    pub(crate) state: u64,
    pub(crate) split_cells: u64,
    pub(crate) references: u64,
    pub(crate) triangles: u64,
    pub(crate) offsets: u64,
    pub(crate) boxes: u64,
    pub(crate) owners: u64,
    pub(crate) keys: u64,
}

/// Of kernel `leaf_sort`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LeafSort {
    pub(crate) state: u64,
    pub(crate) split_cells: u64,
    pub(crate) offsets: u64,
    pub(crate) masks: u64,
    pub(crate) boxes: u64,
    pub(crate) references: u64,
    pub(crate) cells: u64,
    pub(crate) arguments: u64,
    pub(crate) pass_capacity: u32,
    pub(crate) padding: u32,
}

/// Of kernel `leaf_distance`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LeafDistance {
    pub(crate) state: u64,
    pub(crate) split_cells: u64,
    pub(crate) cells: u64,
}

/// Of kernel `trace_args`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct TraceArgs {
    pub(crate) state: u64,
    pub(crate) count: u64,
    pub(crate) max_rays: u32,
    pub(crate) indirect: u32,
}

/// Of kernel `trace_continue_args`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct TraceContinueArgs {
    pub(crate) state: u64,
}

/// Of kernel `brick_distance_x`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BrickDistanceX {
    pub(crate) grid: u64,
    pub(crate) bricks: u64,
    pub(crate) distances: u64,
}

/// Of kernel `brick_distance_y`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BrickDistanceY {
    pub(crate) grid: u64,
    pub(crate) distances_x: u64,
    pub(crate) distances: u64,
}

/// Of kernel `brick_distance_z`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BrickDistanceZ {
    pub(crate) grid: u64,
    pub(crate) distances_y: u64,
    pub(crate) bricks: u64,
}

/// Of kernel `gather`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Gather {
    pub(crate) positions: u64,
    pub(crate) indices: u64,
    pub(crate) triangles: u64,
    pub(crate) state: u64,
    pub(crate) partials: u64,
    pub(crate) vertex_count: u32,
    pub(crate) triangle_count: u32,
}

/// Of kernel `gather_records`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GatherRecords {
    pub(crate) records: u64,
    pub(crate) firsts: u64,
    pub(crate) state: u64,
    pub(crate) triangles: u64,
    pub(crate) partials: u64,
    pub(crate) record_count: u32,
    pub(crate) padding: u32,
}

/// Of kernel `geometry_scan`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GeometryScan {
    pub(crate) records: u64,
    pub(crate) firsts: u64,
    pub(crate) state: u64,
    pub(crate) arguments: u64,
    pub(crate) record_count: u32,
    pub(crate) triangle_capacity: u32,
}

/// Of kernel `count_hits`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CountHits {
    pub(crate) grid: u64,
    pub(crate) rays: u64,
    pub(crate) counts: u64,
    pub(crate) state: u64,
    pub(crate) walks: u64,
    pub(crate) masks: u64,
    pub(crate) order: u64,
    pub(crate) mask: u32,
    pub(crate) options: u32,
    pub(crate) launch: u32,
    pub(crate) padding: u32,
}

/// Of kernel `nearest_hits`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct NearestHits {
    pub(crate) grid: u64,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) state: u64,
    pub(crate) walks: u64,
    pub(crate) masks: u64,
    pub(crate) geometries: u64,
    pub(crate) order: u64,
    pub(crate) mask: u32,
    pub(crate) options: u32,
    pub(crate) launch: u32,
    pub(crate) nearest: u32,
}
