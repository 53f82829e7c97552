//! The kernels of this crate: SPIR-V and what reflection found in it. Made by `cargo tool shaders`; edit the GLSL instead.

use gridwalk_core::kernel::{Access, Kernel, Kind};

/// SPIR-V as words: files hold it as little-endian bytes.
const fn words<const N: usize>(bytes: &[u8]) -> [u32; N] {
    let (chunks, rest) = bytes.as_chunks::<4>();
    assert!(chunks.len() == N && rest.is_empty());
    let mut words = [0; N];
    let mut i = 0;
    while i < N {
        words[i] = u32::from_le_bytes(chunks[i]);
        i += 1;
    }
    words
}

macro_rules! spirv {
    ($path:literal) => {{
        const BYTES: &[u8] = include_bytes!($path);
        const WORDS: [u32; BYTES.len() / 4] = words(BYTES);
        &WORDS
    }};
}

/// Kernel `any_hit`, from `glsl/map/any_hit.comp`.
pub static ANY_HIT: Kernel = Kernel {
    name: "any_hit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/any_hit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 72,
    accesses: &[
        ("grid", Access::Read),
        ("rays", Access::Read),
        ("occluded", Access::Write),
        ("state", Access::ReadWrite),
        ("walks", Access::ReadWrite),
        ("masks", Access::Read),
        ("geometries", Access::Write),
        ("order", Access::Read),
    ],
    spec_constants: &[
        (1, "CONTINUE", 0),
        (2, "LAST", 0),
        (3, "RESUME", 0),
        (4, "COUNT", 0),
        (5, "EXTRAS", 0),
        (6, "BY_TWO", 0),
        (20, "STRANDS", 1),
    ],
};

/// Kernel `brick_distance_x`, from `glsl/map/brick_distance_x.comp`.
pub static BRICK_DISTANCE_X: Kernel = Kernel {
    name: "brick_distance_x",
    kind: Kind::Map,
    spirv: spirv!("../spirv/brick_distance_x.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 24,
    accesses: &[("grid", Access::Read), ("bricks", Access::Read), ("distances", Access::Write)],
    spec_constants: &[(1, "DISTANCE_RUN", 4), (20, "STRANDS", 1)],
};

/// Kernel `brick_distance_y`, from `glsl/map/brick_distance_y.comp`.
pub static BRICK_DISTANCE_Y: Kernel = Kernel {
    name: "brick_distance_y",
    kind: Kind::Map,
    spirv: spirv!("../spirv/brick_distance_y.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 24,
    accesses: &[("grid", Access::Read), ("distances_x", Access::Read), ("distances", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `brick_distance_z`, from `glsl/map/brick_distance_z.comp`.
pub static BRICK_DISTANCE_Z: Kernel = Kernel {
    name: "brick_distance_z",
    kind: Kind::Map,
    spirv: spirv!("../spirv/brick_distance_z.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 24,
    accesses: &[("grid", Access::Read), ("distances_y", Access::Read), ("bricks", Access::ReadWrite)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `brick_reduce`, from `glsl/cooperative/brick_reduce.comp`.
pub static BRICK_REDUCE: Kernel = Kernel {
    name: "brick_reduce",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/brick_reduce.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[
        ("grid", Access::Read),
        ("used", Access::Read),
        ("cells", Access::Read),
        ("bricks", Access::Write),
        ("partials", Access::Write),
    ],
    spec_constants: &[(1, "BRICKS_EACH", 4), (20, "STRANDS", 1)],
};

/// Kernel `brute_force`, from `glsl/map/brute_force.comp`.
pub static BRUTE_FORCE: Kernel = Kernel {
    name: "brute_force",
    kind: Kind::Map,
    spirv: spirv!("../spirv/brute_force.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[("grid", Access::Read), ("rays", Access::Read), ("hits", Access::Write), ("walks", Access::ReadWrite)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `cell_ranges`, from `glsl/map/cell_ranges.comp`.
pub static CELL_RANGES: Kernel = Kernel {
    name: "cell_ranges",
    kind: Kind::Map,
    spirv: spirv!("../spirv/cell_ranges.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 32,
    accesses: &[("state", Access::Read), ("keys", Access::Read), ("cells", Access::Write), ("report", Access::Write)],
    spec_constants: &[(1, "RANGE_PAIRS", 1), (20, "STRANDS", 1)],
};

/// Kernel `clear_bricks`, from `glsl/map/clear_bricks.comp`.
pub static CLEAR_BRICKS: Kernel = Kernel {
    name: "clear_bricks",
    kind: Kind::Map,
    spirv: spirv!("../spirv/clear_bricks.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 16,
    accesses: &[("grid", Access::Read), ("used", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `clear_cells`, from `glsl/map/clear_cells.comp`.
pub static CLEAR_CELLS: Kernel = Kernel {
    name: "clear_cells",
    kind: Kind::Map,
    spirv: spirv!("../spirv/clear_cells.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 24,
    accesses: &[("grid", Access::Read), ("used", Access::Read), ("cells", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `closest_candidate`, from `glsl/map/closest_candidate.comp`.
pub static CLOSEST_CANDIDATE: Kernel = Kernel {
    name: "closest_candidate",
    kind: Kind::Map,
    spirv: spirv!("../spirv/closest_candidate.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[("grid", Access::Read), ("rays", Access::Read), ("hits", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `closest_hit`, from `glsl/map/closest_hit.comp`.
pub static CLOSEST_HIT: Kernel = Kernel {
    name: "closest_hit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/closest_hit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 80,
    accesses: &[
        ("grid", Access::Read),
        ("rays", Access::Read),
        ("hits", Access::ReadWrite),
        ("state", Access::ReadWrite),
        ("walks", Access::ReadWrite),
        ("counters", Access::ReadWrite),
        ("masks", Access::Read),
        ("geometries", Access::Write),
        ("order", Access::Read),
    ],
    spec_constants: &[
        (1, "CONTINUE", 0),
        (2, "LAST", 0),
        (3, "RESUME", 0),
        (4, "COUNT", 0),
        (5, "EXTRAS", 0),
        (6, "BY_TWO", 0),
        (20, "STRANDS", 1),
    ],
};

/// Kernel `configure`, from `glsl/cooperative/configure.comp`.
pub static CONFIGURE: Kernel = Kernel {
    name: "configure",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/configure.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 104,
    accesses: &[
        ("partials", Access::Read),
        ("grid", Access::Write),
        ("state", Access::ReadWrite),
        ("arguments", Access::Write),
        ("report", Access::Write),
        ("cells", Access::Read),
        ("references", Access::Read),
        ("triangles", Access::Read),
        ("bricks", Access::Read),
    ],
    spec_constants: &[(1, "MAP_SIZE", 64), (2, "SORT_BITS", 10), (3, "BRICK_TILE", 1024), (4, "BOUNDS_TILE", 2048), (20, "STRANDS", 1)],
};

/// Kernel `count_hits`, from `glsl/map/count_hits.comp`.
pub static COUNT_HITS: Kernel = Kernel {
    name: "count_hits",
    kind: Kind::Map,
    spirv: spirv!("../spirv/count_hits.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 72,
    accesses: &[
        ("grid", Access::Read),
        ("rays", Access::Read),
        ("counts", Access::Write),
        ("state", Access::ReadWrite),
        ("walks", Access::ReadWrite),
        ("masks", Access::Read),
        ("order", Access::Read),
    ],
    spec_constants: &[
        (1, "CONTINUE", 0),
        (2, "LAST", 0),
        (3, "RESUME", 0),
        (4, "COUNT", 0),
        (5, "EXTRAS", 0),
        (6, "BY_TWO", 0),
        (20, "STRANDS", 1),
    ],
};

/// Kernel `gather`, from `glsl/cooperative/gather.comp`.
pub static GATHER: Kernel = Kernel {
    name: "gather",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/gather.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("positions", Access::Read),
        ("indices", Access::Read),
        ("triangles", Access::Write),
        ("state", Access::Write),
        ("partials", Access::Write),
    ],
    spec_constants: &[(1, "TRIANGLES_EACH", 8), (20, "STRANDS", 1)],
};

/// Kernel `gather_records`, from `glsl/cooperative/gather_records.comp`.
pub static GATHER_RECORDS: Kernel = Kernel {
    name: "gather_records",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/gather_records.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("records", Access::Read),
        ("firsts", Access::Read),
        ("state", Access::Read),
        ("triangles", Access::Write),
        ("partials", Access::Write),
    ],
    spec_constants: &[(1, "TRIANGLES_EACH", 8), (20, "STRANDS", 1)],
};

/// Kernel `geometry_scan`, from `glsl/cooperative/geometry_scan.comp`.
pub static GEOMETRY_SCAN: Kernel = Kernel {
    name: "geometry_scan",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/geometry_scan.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[("records", Access::Read), ("firsts", Access::Write), ("state", Access::Write), ("arguments", Access::Write)],
    spec_constants: &[(1, "ITEMS_EACH", 16), (2, "MAP_SIZE", 64), (3, "SCAN_TILE", 4096), (4, "BOUNDS_TILE", 2048), (20, "STRANDS", 1)],
};

/// Kernel `leaf_args`, from `glsl/cooperative/leaf_args.comp`.
pub static LEAF_ARGS: Kernel = Kernel {
    name: "leaf_args",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/leaf_args.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("state", Access::ReadWrite),
        ("partials", Access::Read),
        ("offsets", Access::ReadWrite),
        ("arguments", Access::ReadWrite),
        ("report", Access::ReadWrite),
    ],
    spec_constants: &[
        (1, "ITEMS_EACH", 16),
        (2, "MAP_SIZE", 64),
        (5, "RANGE_PAIRS", 1),
        (6, "TABLE_ROWS", 1),
        (7, "SPLIT_CELLS_EACH", 1),
        (8, "SORT_SIZE", 8),
        (9, "LEAF_RUN", 0),
        (20, "STRANDS", 1),
        (21, "SORT_TILE", 8192),
        (22, "SORT_TILES", 1),
        (23, "SORT_ALONE", 0),
    ],
};

/// Kernel `leaf_count`, from `glsl/map/leaf_count.comp`.
pub static LEAF_COUNT: Kernel = Kernel {
    name: "leaf_count",
    kind: Kind::Map,
    spirv: spirv!("../spirv/leaf_count.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 80,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::Read),
        ("split_cells", Access::Read),
        ("references", Access::Read),
        ("triangles", Access::Read),
        ("counts", Access::Write),
        ("masks", Access::Write),
        ("boxes", Access::Write),
        ("owners", Access::Read),
        ("cells", Access::Write),
    ],
    spec_constants: &[(1, "EXACT", 0), (2, "OWNER_SHIFT", 5), (20, "STRANDS", 1)],
};

/// Kernel `leaf_distance`, from `glsl/cooperative/leaf_distance.comp`.
pub static LEAF_DISTANCE: Kernel = Kernel {
    name: "leaf_distance",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/leaf_distance.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [None, None, None],
    push_constant_size: 24,
    accesses: &[("state", Access::Read), ("split_cells", Access::Read), ("cells", Access::ReadWrite)],
    spec_constants: &[(1, "SPLIT_CELLS_EACH", 1), (20, "STRANDS", 1)],
};

/// Kernel `leaf_emit`, from `glsl/map/leaf_emit.comp`.
pub static LEAF_EMIT: Kernel = Kernel {
    name: "leaf_emit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/leaf_emit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 112,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::Read),
        ("split_cells", Access::Read),
        ("references", Access::Read),
        ("triangles", Access::Read),
        ("offsets", Access::Read),
        ("masks", Access::Read),
        ("boxes", Access::Read),
        ("owners", Access::Read),
        ("keys_a", Access::Write),
        ("keys_b", Access::Write),
        ("values_a", Access::Write),
        ("values_b", Access::Write),
        ("cells", Access::Write),
    ],
    spec_constants: &[(1, "EXACT", 0), (2, "OWNER_SHIFT", 5), (20, "STRANDS", 1)],
};

/// Kernel `leaf_emit_large`, from `glsl/map/leaf_emit_large.comp`.
pub static LEAF_EMIT_LARGE: Kernel = Kernel {
    name: "leaf_emit_large",
    kind: Kind::Map,
    spirv: spirv!("../spirv/leaf_emit_large.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 72,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::Read),
        ("split_cells", Access::Read),
        ("references", Access::Read),
        ("triangles", Access::Read),
        ("offsets", Access::Read),
        ("boxes", Access::Read),
        ("owners", Access::Read),
        ("keys", Access::Write),
    ],
    spec_constants: &[(1, "EXACT", 0), (2, "OWNER_SHIFT", 5), (20, "STRANDS", 1)],
};

/// Kernel `leaf_sort`, from `glsl/map/leaf_sort.comp`.
pub static LEAF_SORT: Kernel = Kernel {
    name: "leaf_sort",
    kind: Kind::Map,
    spirv: spirv!("../spirv/leaf_sort.spv"),
    local_size: [8, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 72,
    accesses: &[
        ("state", Access::Read),
        ("split_cells", Access::Read),
        ("offsets", Access::Read),
        ("masks", Access::Read),
        ("boxes", Access::Read),
        ("references", Access::ReadWrite),
        ("cells", Access::ReadWrite),
        ("arguments", Access::ReadWrite),
    ],
    spec_constants: &[
        (1, "LEAF_RUN", 6000),
        (2, "MAP_SIZE", 64),
        (5, "RANGE_PAIRS", 1),
        (6, "TABLE_ROWS", 1),
        (20, "STRANDS", 1),
        (21, "SORT_TILE", 8192),
        (22, "SORT_TILES", 1),
        (23, "SORT_ALONE", 0),
    ],
};

/// Kernel `nearest_hits`, from `glsl/map/nearest_hits.comp`.
pub static NEAREST_HITS: Kernel = Kernel {
    name: "nearest_hits",
    kind: Kind::Map,
    spirv: spirv!("../spirv/nearest_hits.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 80,
    accesses: &[
        ("grid", Access::Read),
        ("rays", Access::Read),
        ("hits", Access::ReadWrite),
        ("state", Access::ReadWrite),
        ("walks", Access::ReadWrite),
        ("masks", Access::Read),
        ("geometries", Access::Write),
        ("order", Access::Read),
    ],
    spec_constants: &[
        (1, "CONTINUE", 0),
        (2, "LAST", 0),
        (3, "RESUME", 0),
        (4, "COUNT", 0),
        (5, "EXTRAS", 0),
        (6, "BY_TWO", 0),
        (20, "STRANDS", 1),
    ],
};

/// Kernel `overlap_count`, from `glsl/map/overlap_count.comp`.
pub static OVERLAP_COUNT: Kernel = Kernel {
    name: "overlap_count",
    kind: Kind::Map,
    spirv: spirv!("../spirv/overlap_count.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::ReadWrite),
        ("triangles", Access::ReadWrite),
        ("counts", Access::Write),
        ("boxes", Access::Write),
        ("used", Access::Write),
    ],
    spec_constants: &[(1, "EXACT", 0), (20, "STRANDS", 1)],
};

/// Kernel `overlap_emit`, from `glsl/map/overlap_emit.comp`.
pub static OVERLAP_EMIT: Kernel = Kernel {
    name: "overlap_emit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/overlap_emit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 64,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::Read),
        ("offsets", Access::Read),
        ("boxes", Access::Read),
        ("keys_a", Access::Write),
        ("keys_b", Access::Write),
        ("values_a", Access::Write),
        ("values_b", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `overlap_emit_large`, from `glsl/map/overlap_emit_large.comp`.
pub static OVERLAP_EMIT_LARGE: Kernel = Kernel {
    name: "overlap_emit_large",
    kind: Kind::Map,
    spirv: spirv!("../spirv/overlap_emit_large.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 72,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::Read),
        ("offsets", Access::Read),
        ("triangles", Access::Read),
        ("keys_a", Access::Write),
        ("keys_b", Access::Write),
        ("values_a", Access::Write),
        ("values_b", Access::Write),
        ("used", Access::Write),
    ],
    spec_constants: &[(1, "PAIRS_EACH", 16), (2, "EXACT", 0), (20, "STRANDS", 1)],
};

/// Kernel `pair_args`, from `glsl/cooperative/pair_args.comp`.
pub static PAIR_ARGS: Kernel = Kernel {
    name: "pair_args",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/pair_args.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("state", Access::ReadWrite),
        ("partials", Access::Read),
        ("offsets", Access::ReadWrite),
        ("arguments", Access::Write),
        ("report", Access::ReadWrite),
    ],
    spec_constants: &[
        (1, "ITEMS_EACH", 16),
        (2, "MAP_SIZE", 64),
        (5, "RANGE_PAIRS", 1),
        (6, "TABLE_ROWS", 1),
        (7, "PAIRS_EACH", 16),
        (20, "STRANDS", 1),
        (21, "SORT_TILE", 8192),
        (22, "SORT_TILES", 1),
        (23, "SORT_ALONE", 0),
    ],
};

/// Kernel `ray_keys`, from `glsl/map/ray_keys.comp`.
pub static RAY_KEYS: Kernel = Kernel {
    name: "ray_keys",
    kind: Kind::Map,
    spirv: spirv!("../spirv/ray_keys.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[
        ("grid", Access::Read),
        ("rays", Access::Read),
        ("state", Access::Read),
        ("keys", Access::Write),
        ("values", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `ray_sort_args`, from `glsl/map/ray_sort_args.comp`.
pub static RAY_SORT_ARGS: Kernel = Kernel {
    name: "ray_sort_args",
    kind: Kind::Map,
    spirv: spirv!("../spirv/ray_sort_args.spv"),
    local_size: [1, 1, 1],
    local_size_ids: [None, None, None],
    push_constant_size: 32,
    accesses: &[("state", Access::Write), ("arguments", Access::Write), ("count", Access::Read)],
    spec_constants: &[
        (1, "MAP_SIZE", 64),
        (2, "SORT_BITS", 10),
        (4, "TABLE_ROWS", 1),
        (20, "STRANDS", 1),
        (21, "SORT_TILE", 8192),
        (22, "SORT_TILES", 1),
        (23, "SORT_ALONE", 0),
    ],
};

/// Kernel `report_spine`, from `glsl/cooperative/report_spine.comp`.
pub static REPORT_SPINE: Kernel = Kernel {
    name: "report_spine",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/report_spine.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 56,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::Read),
        ("partials", Access::ReadWrite),
        ("leaf_state", Access::Write),
        ("arguments", Access::Write),
        ("report", Access::Write),
    ],
    spec_constants: &[(1, "BRICK_TILE", 1024), (2, "MAP_SIZE", 64), (3, "SCAN_TILE", 4096), (4, "SORT_BITS", 10), (20, "STRANDS", 1)],
};

/// Kernel `scan_reduce`, from `glsl/cooperative/scan_reduce.comp`.
pub static SCAN_REDUCE: Kernel = Kernel {
    name: "scan_reduce",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/scan_reduce.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 24,
    accesses: &[("state", Access::Read), ("values", Access::Read), ("partials", Access::Write)],
    spec_constants: &[(1, "ITEMS_EACH", 16), (20, "STRANDS", 1)],
};

/// Kernel `sort_histogram`, from `glsl/cooperative/sort_histogram.comp`.
pub static SORT_HISTOGRAM: Kernel = Kernel {
    name: "sort_histogram",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/sort_histogram.spv"),
    local_size: [8, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[("state", Access::Read), ("keys_a", Access::Read), ("keys_b", Access::Read), ("table", Access::Write)],
    spec_constants: &[
        (1, "SORT_BITS", 10),
        (2, "KEYS_EACH", 1024),
        (20, "STRANDS", 1),
        (21, "SORT_TILE", 8192),
        (22, "SORT_TILES", 1),
        (23, "SORT_ALONE", 0),
    ],
};

/// Kernel `sort_scatter`, from `glsl/cooperative/sort_scatter.comp`.
pub static SORT_SCATTER: Kernel = Kernel {
    name: "sort_scatter",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/sort_scatter.spv"),
    local_size: [8, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 72,
    accesses: &[
        ("state", Access::Read),
        ("keys_a", Access::ReadWrite),
        ("keys_b", Access::ReadWrite),
        ("values_a", Access::ReadWrite),
        ("values_b", Access::ReadWrite),
        ("table", Access::Read),
        ("sums", Access::Read),
        ("kept", Access::Write),
    ],
    spec_constants: &[
        (1, "SORT_BITS", 10),
        (2, "KEYS_EACH", 1024),
        (20, "STRANDS", 1),
        (21, "SORT_TILE", 8192),
        (22, "SORT_TILES", 1),
        (23, "SORT_ALONE", 0),
    ],
};

/// Kernel `split_cells`, from `glsl/cooperative/split_cells.comp`.
pub static SPLIT_CELLS: Kernel = Kernel {
    name: "split_cells",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/split_cells.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 64,
    accesses: &[
        ("grid", Access::Read),
        ("state", Access::Read),
        ("cells", Access::Read),
        ("bricks", Access::Read),
        ("partials", Access::Read),
        ("split_cells", Access::Write),
        ("owners", Access::Write),
    ],
    spec_constants: &[(1, "BRICKS_EACH", 4), (2, "OWNER_SHIFT", 5), (20, "STRANDS", 1)],
};

/// Kernel `table_scan`, from `glsl/cooperative/table_scan.comp`.
pub static TABLE_SCAN: Kernel = Kernel {
    name: "table_scan",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/table_scan.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 32,
    accesses: &[("state", Access::Read), ("table", Access::ReadWrite), ("sums", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1), (21, "SORT_TILE", 8192), (22, "SORT_TILES", 1), (23, "SORT_ALONE", 0)],
};

/// Kernel `trace_args`, from `glsl/map/trace_args.comp`.
pub static TRACE_ARGS: Kernel = Kernel {
    name: "trace_args",
    kind: Kind::Map,
    spirv: spirv!("../spirv/trace_args.spv"),
    local_size: [1, 1, 1],
    local_size_ids: [None, None, None],
    push_constant_size: 24,
    accesses: &[("state", Access::Write), ("count", Access::Read)],
    spec_constants: &[(1, "MAP_SIZE", 64), (20, "STRANDS", 1)],
};

/// Kernel `trace_continue_args`, from `glsl/map/trace_continue_args.comp`.
pub static TRACE_CONTINUE_ARGS: Kernel = Kernel {
    name: "trace_continue_args",
    kind: Kind::Map,
    spirv: spirv!("../spirv/trace_continue_args.spv"),
    local_size: [1, 1, 1],
    local_size_ids: [None, None, None],
    push_constant_size: 8,
    accesses: &[("state", Access::ReadWrite)],
    spec_constants: &[(1, "MAP_SIZE", 64), (20, "STRANDS", 1)],
};

/// Every kernel of this crate, in order of name.
pub static ALL: &[&Kernel] = &[
    &ANY_HIT,
    &BRICK_DISTANCE_X,
    &BRICK_DISTANCE_Y,
    &BRICK_DISTANCE_Z,
    &BRICK_REDUCE,
    &BRUTE_FORCE,
    &CELL_RANGES,
    &CLEAR_BRICKS,
    &CLEAR_CELLS,
    &CLOSEST_CANDIDATE,
    &CLOSEST_HIT,
    &CONFIGURE,
    &COUNT_HITS,
    &GATHER,
    &GATHER_RECORDS,
    &GEOMETRY_SCAN,
    &LEAF_ARGS,
    &LEAF_COUNT,
    &LEAF_DISTANCE,
    &LEAF_EMIT,
    &LEAF_EMIT_LARGE,
    &LEAF_SORT,
    &NEAREST_HITS,
    &OVERLAP_COUNT,
    &OVERLAP_EMIT,
    &OVERLAP_EMIT_LARGE,
    &PAIR_ARGS,
    &RAY_KEYS,
    &RAY_SORT_ARGS,
    &REPORT_SPINE,
    &SCAN_REDUCE,
    &SORT_HISTOGRAM,
    &SORT_SCATTER,
    &SPLIT_CELLS,
    &TABLE_SCAN,
    &TRACE_ARGS,
    &TRACE_CONTINUE_ARGS,
];

/// Bytes of a field, found by a function that takes it.
const fn size<T, F>(_: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

// The host's structures lie in memory as the kernels read them.
const _: () = {
    use crate::push::AnyHit as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, occluded) == 16);
    assert!(size(|host: &Host| &host.occluded) == 8);
    assert!(core::mem::offset_of!(Host, state) == 24);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 32);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(core::mem::offset_of!(Host, masks) == 40);
    assert!(size(|host: &Host| &host.masks) == 8);
    assert!(core::mem::offset_of!(Host, geometries) == 48);
    assert!(size(|host: &Host| &host.geometries) == 8);
    assert!(core::mem::offset_of!(Host, order) == 56);
    assert!(size(|host: &Host| &host.order) == 8);
    assert!(core::mem::offset_of!(Host, mask) == 64);
    assert!(size(|host: &Host| &host.mask) == 4);
    assert!(core::mem::offset_of!(Host, options) == 68);
    assert!(size(|host: &Host| &host.options) == 4);
    assert!(size_of::<Host>() == 72);
};
const _: () = {
    use gridwalk_core::layout::Bounds as Host;
    assert!(core::mem::offset_of!(Host, low) == 0);
    assert!(size(|host: &Host| &host.low) == 12);
    assert!(core::mem::offset_of!(Host, dropped) == 12);
    assert!(size(|host: &Host| &host.dropped) == 4);
    assert!(core::mem::offset_of!(Host, high) == 16);
    assert!(size(|host: &Host| &host.high) == 12);
    assert!(core::mem::offset_of!(Host, reserved) == 28);
    assert!(size(|host: &Host| &host.reserved) == 4);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use gridwalk_core::layout::Brick as Host;
    assert!(core::mem::offset_of!(Host, mask) == 0);
    assert!(size(|host: &Host| &host.mask) == 8);
    assert!(core::mem::offset_of!(Host, distance) == 8);
    assert!(size(|host: &Host| &host.distance) == 4);
    assert!(core::mem::offset_of!(Host, longest_list) == 12);
    assert!(size(|host: &Host| &host.longest_list) == 4);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use crate::push::BrickDistanceX as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, bricks) == 8);
    assert!(size(|host: &Host| &host.bricks) == 8);
    assert!(core::mem::offset_of!(Host, distances) == 16);
    assert!(size(|host: &Host| &host.distances) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::BrickDistanceY as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, distances_x) == 8);
    assert!(size(|host: &Host| &host.distances_x) == 8);
    assert!(core::mem::offset_of!(Host, distances) == 16);
    assert!(size(|host: &Host| &host.distances) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::BrickDistanceZ as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, distances_y) == 8);
    assert!(size(|host: &Host| &host.distances_y) == 8);
    assert!(core::mem::offset_of!(Host, bricks) == 16);
    assert!(size(|host: &Host| &host.bricks) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::BrickReduce as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, used) == 8);
    assert!(size(|host: &Host| &host.used) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 16);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(core::mem::offset_of!(Host, bricks) == 24);
    assert!(size(|host: &Host| &host.bricks) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 32);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::push::BruteForce as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 16);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 24);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(core::mem::offset_of!(Host, ray_count) == 32);
    assert!(size(|host: &Host| &host.ray_count) == 4);
    assert!(core::mem::offset_of!(Host, first) == 36);
    assert!(size(|host: &Host| &host.first) == 4);
    assert!(core::mem::offset_of!(Host, end) == 40);
    assert!(size(|host: &Host| &host.end) == 4);
    assert!(core::mem::offset_of!(Host, last) == 44);
    assert!(size(|host: &Host| &host.last) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use gridwalk_core::layout::BuildState as Host;
    assert!(core::mem::offset_of!(Host, triangle_count) == 0);
    assert!(size(|host: &Host| &host.triangle_count) == 4);
    assert!(core::mem::offset_of!(Host, offset_count) == 4);
    assert!(size(|host: &Host| &host.offset_count) == 4);
    assert!(core::mem::offset_of!(Host, pair_total) == 8);
    assert!(size(|host: &Host| &host.pair_total) == 4);
    assert!(core::mem::offset_of!(Host, pair_count) == 12);
    assert!(size(|host: &Host| &host.pair_count) == 4);
    assert!(core::mem::offset_of!(Host, key_bits) == 16);
    assert!(size(|host: &Host| &host.key_bits) == 4);
    assert!(core::mem::offset_of!(Host, pass_count) == 20);
    assert!(size(|host: &Host| &host.pass_count) == 4);
    assert!(core::mem::offset_of!(Host, overflow) == 24);
    assert!(size(|host: &Host| &host.overflow) == 4);
    assert!(core::mem::offset_of!(Host, triangle_total) == 28);
    assert!(size(|host: &Host| &host.triangle_total) == 4);
    assert!(core::mem::offset_of!(Host, digit_bits) == 32);
    assert!(size(|host: &Host| &host.digit_bits) == 4);
    assert!(core::mem::offset_of!(Host, has_large) == 36);
    assert!(size(|host: &Host| &host.has_large) == 4);
    assert!(core::mem::offset_of!(Host, kept_count) == 40);
    assert!(size(|host: &Host| &host.kept_count) == 4);
    assert!(core::mem::offset_of!(Host, sentinel) == 44);
    assert!(size(|host: &Host| &host.sentinel) == 4);
    assert!(core::mem::offset_of!(Host, first_pair) == 48);
    assert!(size(|host: &Host| &host.first_pair) == 4);
    assert!(core::mem::offset_of!(Host, first_cell) == 52);
    assert!(size(|host: &Host| &host.first_cell) == 4);
    assert!(core::mem::offset_of!(Host, split_cells) == 56);
    assert!(size(|host: &Host| &host.split_cells) == 4);
    assert!(core::mem::offset_of!(Host, least_split) == 60);
    assert!(size(|host: &Host| &host.least_split) == 4);
};
const _: () = {
    use crate::push::CellRanges as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, keys) == 8);
    assert!(size(|host: &Host| &host.keys) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 16);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(core::mem::offset_of!(Host, report) == 24);
    assert!(size(|host: &Host| &host.report) == 8);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use crate::push::ClearBricks as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, used) == 8);
    assert!(size(|host: &Host| &host.used) == 8);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use crate::push::ClearCells as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, used) == 8);
    assert!(size(|host: &Host| &host.used) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 16);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::ClosestCandidate as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 16);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, ray_count) == 24);
    assert!(size(|host: &Host| &host.ray_count) == 4);
    assert!(core::mem::offset_of!(Host, mask) == 28);
    assert!(size(|host: &Host| &host.mask) == 4);
    assert!(core::mem::offset_of!(Host, cull) == 32);
    assert!(size(|host: &Host| &host.cull) == 4);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::push::ClosestHit as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 16);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, state) == 24);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 32);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(core::mem::offset_of!(Host, counters) == 40);
    assert!(size(|host: &Host| &host.counters) == 8);
    assert!(core::mem::offset_of!(Host, masks) == 48);
    assert!(size(|host: &Host| &host.masks) == 8);
    assert!(core::mem::offset_of!(Host, geometries) == 56);
    assert!(size(|host: &Host| &host.geometries) == 8);
    assert!(core::mem::offset_of!(Host, order) == 64);
    assert!(size(|host: &Host| &host.order) == 8);
    assert!(core::mem::offset_of!(Host, mask) == 72);
    assert!(size(|host: &Host| &host.mask) == 4);
    assert!(core::mem::offset_of!(Host, options) == 76);
    assert!(size(|host: &Host| &host.options) == 4);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::push::Configure as Host;
    assert!(core::mem::offset_of!(Host, partials) == 0);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(core::mem::offset_of!(Host, grid) == 8);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 16);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, arguments) == 24);
    assert!(size(|host: &Host| &host.arguments) == 8);
    assert!(core::mem::offset_of!(Host, report) == 32);
    assert!(size(|host: &Host| &host.report) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 40);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(core::mem::offset_of!(Host, references) == 48);
    assert!(size(|host: &Host| &host.references) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 56);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, bricks) == 64);
    assert!(size(|host: &Host| &host.bricks) == 8);
    assert!(core::mem::offset_of!(Host, cell_capacity) == 72);
    assert!(size(|host: &Host| &host.cell_capacity) == 4);
    assert!(core::mem::offset_of!(Host, density) == 76);
    assert!(size(|host: &Host| &host.density) == 4);
    assert!(core::mem::offset_of!(Host, fixed_x) == 80);
    assert!(size(|host: &Host| &host.fixed_x) == 4);
    assert!(core::mem::offset_of!(Host, fixed_y) == 84);
    assert!(size(|host: &Host| &host.fixed_y) == 4);
    assert!(core::mem::offset_of!(Host, fixed_z) == 88);
    assert!(size(|host: &Host| &host.fixed_z) == 4);
    assert!(core::mem::offset_of!(Host, levels) == 92);
    assert!(size(|host: &Host| &host.levels) == 4);
    assert!(core::mem::offset_of!(Host, exact) == 96);
    assert!(size(|host: &Host| &host.exact) == 4);
    assert!(size_of::<Host>() == 104);
};
const _: () = {
    use crate::push::CountHits as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, counts) == 16);
    assert!(size(|host: &Host| &host.counts) == 8);
    assert!(core::mem::offset_of!(Host, state) == 24);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 32);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(core::mem::offset_of!(Host, masks) == 40);
    assert!(size(|host: &Host| &host.masks) == 8);
    assert!(core::mem::offset_of!(Host, order) == 48);
    assert!(size(|host: &Host| &host.order) == 8);
    assert!(core::mem::offset_of!(Host, mask) == 56);
    assert!(size(|host: &Host| &host.mask) == 4);
    assert!(core::mem::offset_of!(Host, options) == 60);
    assert!(size(|host: &Host| &host.options) == 4);
    assert!(core::mem::offset_of!(Host, launch) == 64);
    assert!(size(|host: &Host| &host.launch) == 4);
    assert!(size_of::<Host>() == 72);
};
const _: () = {
    use gridwalk_core::layout::DispatchArguments as Host;
    assert!(core::mem::offset_of!(Host, emit_large) == 0);
    assert!(size(|host: &Host| &host.emit_large) == 16);
    assert!(core::mem::offset_of!(Host, sort) == 16);
    assert!(size(|host: &Host| &host.sort) == 128);
    assert!(core::mem::offset_of!(Host, table_scan) == 144);
    assert!(size(|host: &Host| &host.table_scan) == 128);
    assert!(core::mem::offset_of!(Host, cell_ranges) == 272);
    assert!(size(|host: &Host| &host.cell_ranges) == 16);
    assert!(core::mem::offset_of!(Host, brick_reduce) == 288);
    assert!(size(|host: &Host| &host.brick_reduce) == 16);
    assert!(core::mem::offset_of!(Host, bricks) == 304);
    assert!(size(|host: &Host| &host.bricks) == 16);
    assert!(core::mem::offset_of!(Host, clear_cells) == 320);
    assert!(size(|host: &Host| &host.clear_cells) == 16);
    assert!(core::mem::offset_of!(Host, gather) == 336);
    assert!(size(|host: &Host| &host.gather) == 16);
    assert!(core::mem::offset_of!(Host, overlap_count) == 352);
    assert!(size(|host: &Host| &host.overlap_count) == 16);
    assert!(core::mem::offset_of!(Host, offsets_scan) == 368);
    assert!(size(|host: &Host| &host.offsets_scan) == 16);
    assert!(core::mem::offset_of!(Host, ray_keys) == 384);
    assert!(size(|host: &Host| &host.ray_keys) == 16);
};
const _: () = {
    use crate::push::Gather as Host;
    assert!(core::mem::offset_of!(Host, positions) == 0);
    assert!(size(|host: &Host| &host.positions) == 8);
    assert!(core::mem::offset_of!(Host, indices) == 8);
    assert!(size(|host: &Host| &host.indices) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 16);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, state) == 24);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 32);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(core::mem::offset_of!(Host, vertex_count) == 40);
    assert!(size(|host: &Host| &host.vertex_count) == 4);
    assert!(core::mem::offset_of!(Host, triangle_count) == 44);
    assert!(size(|host: &Host| &host.triangle_count) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::push::GatherRecords as Host;
    assert!(core::mem::offset_of!(Host, records) == 0);
    assert!(size(|host: &Host| &host.records) == 8);
    assert!(core::mem::offset_of!(Host, firsts) == 8);
    assert!(size(|host: &Host| &host.firsts) == 8);
    assert!(core::mem::offset_of!(Host, state) == 16);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 24);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 32);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(core::mem::offset_of!(Host, record_count) == 40);
    assert!(size(|host: &Host| &host.record_count) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use gridwalk_core::GeometryRecord as Host;
    assert!(core::mem::offset_of!(Host, transform) == 0);
    assert!(size(|host: &Host| &host.transform) == 48);
    assert!(core::mem::offset_of!(Host, scale) == 48);
    assert!(size(|host: &Host| &host.scale) == 12);
    assert!(core::mem::offset_of!(Host, stride) == 60);
    assert!(size(|host: &Host| &host.stride) == 4);
    assert!(core::mem::offset_of!(Host, offset) == 64);
    assert!(size(|host: &Host| &host.offset) == 12);
    assert!(core::mem::offset_of!(Host, vertex_count) == 76);
    assert!(size(|host: &Host| &host.vertex_count) == 4);
    assert!(core::mem::offset_of!(Host, positions) == 80);
    assert!(size(|host: &Host| &host.positions) == 8);
    assert!(core::mem::offset_of!(Host, indices) == 88);
    assert!(size(|host: &Host| &host.indices) == 8);
    assert!(core::mem::offset_of!(Host, count) == 96);
    assert!(size(|host: &Host| &host.count) == 8);
    assert!(core::mem::offset_of!(Host, triangle_count) == 104);
    assert!(size(|host: &Host| &host.triangle_count) == 4);
    assert!(core::mem::offset_of!(Host, format) == 108);
    assert!(size(|host: &Host| &host.format) == 4);
    assert!(core::mem::offset_of!(Host, index_type) == 112);
    assert!(size(|host: &Host| &host.index_type) == 4);
    assert!(core::mem::offset_of!(Host, id) == 116);
    assert!(size(|host: &Host| &host.id) == 4);
    assert!(core::mem::offset_of!(Host, mask) == 120);
    assert!(size(|host: &Host| &host.mask) == 4);
    assert!(core::mem::offset_of!(Host, flags) == 124);
    assert!(size(|host: &Host| &host.flags) == 4);
    assert!(size_of::<Host>() == 128);
};
const _: () = {
    use crate::push::GeometryScan as Host;
    assert!(core::mem::offset_of!(Host, records) == 0);
    assert!(size(|host: &Host| &host.records) == 8);
    assert!(core::mem::offset_of!(Host, firsts) == 8);
    assert!(size(|host: &Host| &host.firsts) == 8);
    assert!(core::mem::offset_of!(Host, state) == 16);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, arguments) == 24);
    assert!(size(|host: &Host| &host.arguments) == 8);
    assert!(core::mem::offset_of!(Host, record_count) == 32);
    assert!(size(|host: &Host| &host.record_count) == 4);
    assert!(core::mem::offset_of!(Host, triangle_capacity) == 36);
    assert!(size(|host: &Host| &host.triangle_capacity) == 4);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use gridwalk_core::layout::GridHeader as Host;
    assert!(core::mem::offset_of!(Host, box_min) == 0);
    assert!(size(|host: &Host| &host.box_min) == 12);
    assert!(core::mem::offset_of!(Host, scale) == 12);
    assert!(size(|host: &Host| &host.scale) == 4);
    assert!(core::mem::offset_of!(Host, box_max) == 16);
    assert!(size(|host: &Host| &host.box_max) == 12);
    assert!(core::mem::offset_of!(Host, pad) == 28);
    assert!(size(|host: &Host| &host.pad) == 4);
    assert!(core::mem::offset_of!(Host, cell_size) == 32);
    assert!(size(|host: &Host| &host.cell_size) == 12);
    assert!(core::mem::offset_of!(Host, inverse_scale) == 44);
    assert!(size(|host: &Host| &host.inverse_scale) == 4);
    assert!(core::mem::offset_of!(Host, inverse_cell_size) == 48);
    assert!(size(|host: &Host| &host.inverse_cell_size) == 12);
    assert!(core::mem::offset_of!(Host, cell_count) == 60);
    assert!(size(|host: &Host| &host.cell_count) == 4);
    assert!(core::mem::offset_of!(Host, resolution) == 64);
    assert!(size(|host: &Host| &host.resolution) == 12);
    assert!(core::mem::offset_of!(Host, triangle_count) == 76);
    assert!(size(|host: &Host| &host.triangle_count) == 4);
    assert!(core::mem::offset_of!(Host, cells) == 80);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(core::mem::offset_of!(Host, references) == 88);
    assert!(size(|host: &Host| &host.references) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 96);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, bricks) == 104);
    assert!(size(|host: &Host| &host.bricks) == 8);
    assert!(core::mem::offset_of!(Host, middle) == 112);
    assert!(size(|host: &Host| &host.middle) == 12);
    assert!(core::mem::offset_of!(Host, fine_shift) == 124);
    assert!(size(|host: &Host| &host.fine_shift) == 4);
    assert!(core::mem::offset_of!(Host, fine_cell_size) == 128);
    assert!(size(|host: &Host| &host.fine_cell_size) == 12);
    assert!(core::mem::offset_of!(Host, reserved0) == 140);
    assert!(size(|host: &Host| &host.reserved0) == 4);
    assert!(core::mem::offset_of!(Host, inverse_fine_cell_size) == 144);
    assert!(size(|host: &Host| &host.inverse_fine_cell_size) == 12);
    assert!(core::mem::offset_of!(Host, reserved1) == 156);
    assert!(size(|host: &Host| &host.reserved1) == 4);
};
const _: () = {
    use gridwalk_core::Hit as Host;
    assert!(core::mem::offset_of!(Host, t) == 0);
    assert!(size(|host: &Host| &host.t) == 4);
    assert!(core::mem::offset_of!(Host, u) == 4);
    assert!(size(|host: &Host| &host.u) == 4);
    assert!(core::mem::offset_of!(Host, v) == 8);
    assert!(size(|host: &Host| &host.v) == 4);
    assert!(core::mem::offset_of!(Host, triangle) == 12);
    assert!(size(|host: &Host| &host.triangle) == 4);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use crate::push::LeafArgs as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 8);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 16);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, arguments) == 24);
    assert!(size(|host: &Host| &host.arguments) == 8);
    assert!(core::mem::offset_of!(Host, report) == 32);
    assert!(size(|host: &Host| &host.report) == 8);
    assert!(core::mem::offset_of!(Host, pair_capacity) == 40);
    assert!(size(|host: &Host| &host.pair_capacity) == 4);
    assert!(core::mem::offset_of!(Host, pass_capacity) == 44);
    assert!(size(|host: &Host| &host.pass_capacity) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use gridwalk_core::layout::LeafArguments as Host;
    assert!(core::mem::offset_of!(Host, split_cells) == 0);
    assert!(size(|host: &Host| &host.split_cells) == 16);
    assert!(core::mem::offset_of!(Host, count) == 16);
    assert!(size(|host: &Host| &host.count) == 16);
    assert!(core::mem::offset_of!(Host, offsets_scan) == 32);
    assert!(size(|host: &Host| &host.offsets_scan) == 16);
    assert!(core::mem::offset_of!(Host, args) == 48);
    assert!(size(|host: &Host| &host.args) == 16);
    assert!(core::mem::offset_of!(Host, emit_large) == 64);
    assert!(size(|host: &Host| &host.emit_large) == 16);
    assert!(core::mem::offset_of!(Host, leaf_sort) == 80);
    assert!(size(|host: &Host| &host.leaf_sort) == 16);
    assert!(core::mem::offset_of!(Host, emit) == 96);
    assert!(size(|host: &Host| &host.emit) == 16);
    assert!(core::mem::offset_of!(Host, sort) == 112);
    assert!(size(|host: &Host| &host.sort) == 128);
    assert!(core::mem::offset_of!(Host, table_scan) == 240);
    assert!(size(|host: &Host| &host.table_scan) == 128);
    assert!(core::mem::offset_of!(Host, cell_ranges) == 368);
    assert!(size(|host: &Host| &host.cell_ranges) == 16);
    assert!(core::mem::offset_of!(Host, distance) == 384);
    assert!(size(|host: &Host| &host.distance) == 16);
};
const _: () = {
    use crate::push::LeafCount as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, split_cells) == 16);
    assert!(size(|host: &Host| &host.split_cells) == 8);
    assert!(core::mem::offset_of!(Host, references) == 24);
    assert!(size(|host: &Host| &host.references) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 32);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, counts) == 40);
    assert!(size(|host: &Host| &host.counts) == 8);
    assert!(core::mem::offset_of!(Host, masks) == 48);
    assert!(size(|host: &Host| &host.masks) == 8);
    assert!(core::mem::offset_of!(Host, boxes) == 56);
    assert!(size(|host: &Host| &host.boxes) == 8);
    assert!(core::mem::offset_of!(Host, owners) == 64);
    assert!(size(|host: &Host| &host.owners) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 72);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::push::LeafDistance as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, split_cells) == 8);
    assert!(size(|host: &Host| &host.split_cells) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 16);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::LeafEmit as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, split_cells) == 16);
    assert!(size(|host: &Host| &host.split_cells) == 8);
    assert!(core::mem::offset_of!(Host, references) == 24);
    assert!(size(|host: &Host| &host.references) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 32);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 40);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, masks) == 48);
    assert!(size(|host: &Host| &host.masks) == 8);
    assert!(core::mem::offset_of!(Host, boxes) == 56);
    assert!(size(|host: &Host| &host.boxes) == 8);
    assert!(core::mem::offset_of!(Host, owners) == 64);
    assert!(size(|host: &Host| &host.owners) == 8);
    assert!(core::mem::offset_of!(Host, keys_a) == 72);
    assert!(size(|host: &Host| &host.keys_a) == 8);
    assert!(core::mem::offset_of!(Host, keys_b) == 80);
    assert!(size(|host: &Host| &host.keys_b) == 8);
    assert!(core::mem::offset_of!(Host, values_a) == 88);
    assert!(size(|host: &Host| &host.values_a) == 8);
    assert!(core::mem::offset_of!(Host, values_b) == 96);
    assert!(size(|host: &Host| &host.values_b) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 104);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(size_of::<Host>() == 112);
};
const _: () = {
    use crate::push::LeafEmitLarge as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, split_cells) == 16);
    assert!(size(|host: &Host| &host.split_cells) == 8);
    assert!(core::mem::offset_of!(Host, references) == 24);
    assert!(size(|host: &Host| &host.references) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 32);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 40);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, boxes) == 48);
    assert!(size(|host: &Host| &host.boxes) == 8);
    assert!(core::mem::offset_of!(Host, owners) == 56);
    assert!(size(|host: &Host| &host.owners) == 8);
    assert!(core::mem::offset_of!(Host, keys) == 64);
    assert!(size(|host: &Host| &host.keys) == 8);
    assert!(size_of::<Host>() == 72);
};
const _: () = {
    use crate::push::LeafSort as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, split_cells) == 8);
    assert!(size(|host: &Host| &host.split_cells) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 16);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, masks) == 24);
    assert!(size(|host: &Host| &host.masks) == 8);
    assert!(core::mem::offset_of!(Host, boxes) == 32);
    assert!(size(|host: &Host| &host.boxes) == 8);
    assert!(core::mem::offset_of!(Host, references) == 40);
    assert!(size(|host: &Host| &host.references) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 48);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(core::mem::offset_of!(Host, arguments) == 56);
    assert!(size(|host: &Host| &host.arguments) == 8);
    assert!(core::mem::offset_of!(Host, pass_capacity) == 64);
    assert!(size(|host: &Host| &host.pass_capacity) == 4);
    assert!(size_of::<Host>() == 72);
};
const _: () = {
    use crate::push::NearestHits as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 16);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, state) == 24);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 32);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(core::mem::offset_of!(Host, masks) == 40);
    assert!(size(|host: &Host| &host.masks) == 8);
    assert!(core::mem::offset_of!(Host, geometries) == 48);
    assert!(size(|host: &Host| &host.geometries) == 8);
    assert!(core::mem::offset_of!(Host, order) == 56);
    assert!(size(|host: &Host| &host.order) == 8);
    assert!(core::mem::offset_of!(Host, mask) == 64);
    assert!(size(|host: &Host| &host.mask) == 4);
    assert!(core::mem::offset_of!(Host, options) == 68);
    assert!(size(|host: &Host| &host.options) == 4);
    assert!(core::mem::offset_of!(Host, launch) == 72);
    assert!(size(|host: &Host| &host.launch) == 4);
    assert!(core::mem::offset_of!(Host, nearest) == 76);
    assert!(size(|host: &Host| &host.nearest) == 4);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::push::OverlapCount as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 16);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, counts) == 24);
    assert!(size(|host: &Host| &host.counts) == 8);
    assert!(core::mem::offset_of!(Host, boxes) == 32);
    assert!(size(|host: &Host| &host.boxes) == 8);
    assert!(core::mem::offset_of!(Host, used) == 40);
    assert!(size(|host: &Host| &host.used) == 8);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::push::OverlapEmit as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 16);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, boxes) == 24);
    assert!(size(|host: &Host| &host.boxes) == 8);
    assert!(core::mem::offset_of!(Host, keys_a) == 32);
    assert!(size(|host: &Host| &host.keys_a) == 8);
    assert!(core::mem::offset_of!(Host, keys_b) == 40);
    assert!(size(|host: &Host| &host.keys_b) == 8);
    assert!(core::mem::offset_of!(Host, values_a) == 48);
    assert!(size(|host: &Host| &host.values_a) == 8);
    assert!(core::mem::offset_of!(Host, values_b) == 56);
    assert!(size(|host: &Host| &host.values_b) == 8);
    assert!(size_of::<Host>() == 64);
};
const _: () = {
    use crate::push::OverlapEmitLarge as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 16);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, triangles) == 24);
    assert!(size(|host: &Host| &host.triangles) == 8);
    assert!(core::mem::offset_of!(Host, keys_a) == 32);
    assert!(size(|host: &Host| &host.keys_a) == 8);
    assert!(core::mem::offset_of!(Host, keys_b) == 40);
    assert!(size(|host: &Host| &host.keys_b) == 8);
    assert!(core::mem::offset_of!(Host, values_a) == 48);
    assert!(size(|host: &Host| &host.values_a) == 8);
    assert!(core::mem::offset_of!(Host, values_b) == 56);
    assert!(size(|host: &Host| &host.values_b) == 8);
    assert!(core::mem::offset_of!(Host, used) == 64);
    assert!(size(|host: &Host| &host.used) == 8);
    assert!(size_of::<Host>() == 72);
};
const _: () = {
    use crate::push::PairArgs as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 8);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 16);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, arguments) == 24);
    assert!(size(|host: &Host| &host.arguments) == 8);
    assert!(core::mem::offset_of!(Host, report) == 32);
    assert!(size(|host: &Host| &host.report) == 8);
    assert!(core::mem::offset_of!(Host, pair_capacity) == 40);
    assert!(size(|host: &Host| &host.pair_capacity) == 4);
    assert!(core::mem::offset_of!(Host, pass_capacity) == 44);
    assert!(size(|host: &Host| &host.pass_capacity) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use gridwalk_core::Ray as Host;
    assert!(core::mem::offset_of!(Host, origin) == 0);
    assert!(size(|host: &Host| &host.origin) == 12);
    assert!(core::mem::offset_of!(Host, t_min) == 12);
    assert!(size(|host: &Host| &host.t_min) == 4);
    assert!(core::mem::offset_of!(Host, direction) == 16);
    assert!(size(|host: &Host| &host.direction) == 12);
    assert!(core::mem::offset_of!(Host, t_max) == 28);
    assert!(size(|host: &Host| &host.t_max) == 4);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use crate::push::RayKeys as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, state) == 16);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, keys) == 24);
    assert!(size(|host: &Host| &host.keys) == 8);
    assert!(core::mem::offset_of!(Host, values) == 32);
    assert!(size(|host: &Host| &host.values) == 8);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::push::RaySortArgs as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, arguments) == 8);
    assert!(size(|host: &Host| &host.arguments) == 8);
    assert!(core::mem::offset_of!(Host, count) == 16);
    assert!(size(|host: &Host| &host.count) == 8);
    assert!(core::mem::offset_of!(Host, max_rays) == 24);
    assert!(size(|host: &Host| &host.max_rays) == 4);
    assert!(core::mem::offset_of!(Host, indirect) == 28);
    assert!(size(|host: &Host| &host.indirect) == 4);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use gridwalk_core::layout::Report as Host;
    assert!(core::mem::offset_of!(Host, triangles) == 0);
    assert!(size(|host: &Host| &host.triangles) == 4);
    assert!(core::mem::offset_of!(Host, dropped) == 4);
    assert!(size(|host: &Host| &host.dropped) == 4);
    assert!(core::mem::offset_of!(Host, cells) == 8);
    assert!(size(|host: &Host| &host.cells) == 4);
    assert!(core::mem::offset_of!(Host, cells_in_use) == 12);
    assert!(size(|host: &Host| &host.cells_in_use) == 4);
    assert!(core::mem::offset_of!(Host, resolution) == 16);
    assert!(size(|host: &Host| &host.resolution) == 12);
    assert!(core::mem::offset_of!(Host, longest_list) == 28);
    assert!(size(|host: &Host| &host.longest_list) == 4);
    assert!(core::mem::offset_of!(Host, pairs) == 32);
    assert!(size(|host: &Host| &host.pairs) == 4);
    assert!(core::mem::offset_of!(Host, pair_total) == 36);
    assert!(size(|host: &Host| &host.pair_total) == 4);
    assert!(core::mem::offset_of!(Host, overflow) == 40);
    assert!(size(|host: &Host| &host.overflow) == 4);
    assert!(core::mem::offset_of!(Host, key_bits) == 44);
    assert!(size(|host: &Host| &host.key_bits) == 4);
    assert!(core::mem::offset_of!(Host, box_min) == 48);
    assert!(size(|host: &Host| &host.box_min) == 12);
    assert!(core::mem::offset_of!(Host, density) == 60);
    assert!(size(|host: &Host| &host.density) == 4);
    assert!(core::mem::offset_of!(Host, box_max) == 64);
    assert!(size(|host: &Host| &host.box_max) == 12);
    assert!(core::mem::offset_of!(Host, triangle_total) == 76);
    assert!(size(|host: &Host| &host.triangle_total) == 4);
    assert!(core::mem::offset_of!(Host, split_cells) == 80);
    assert!(size(|host: &Host| &host.split_cells) == 4);
    assert!(core::mem::offset_of!(Host, leaf_cells) == 84);
    assert!(size(|host: &Host| &host.leaf_cells) == 4);
    assert!(core::mem::offset_of!(Host, leaf_pairs) == 88);
    assert!(size(|host: &Host| &host.leaf_pairs) == 4);
    assert!(core::mem::offset_of!(Host, reserved) == 92);
    assert!(size(|host: &Host| &host.reserved) == 4);
};
const _: () = {
    use crate::push::ReportSpine as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 16);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(core::mem::offset_of!(Host, leaf_state) == 24);
    assert!(size(|host: &Host| &host.leaf_state) == 8);
    assert!(core::mem::offset_of!(Host, arguments) == 32);
    assert!(size(|host: &Host| &host.arguments) == 8);
    assert!(core::mem::offset_of!(Host, report) == 40);
    assert!(size(|host: &Host| &host.report) == 8);
    assert!(core::mem::offset_of!(Host, leaf_capacity) == 48);
    assert!(size(|host: &Host| &host.leaf_capacity) == 4);
    assert!(size_of::<Host>() == 56);
};
const _: () = {
    use crate::push::ScanReduce as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, values) == 8);
    assert!(size(|host: &Host| &host.values) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 16);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::SortHistogram as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, keys_a) == 8);
    assert!(size(|host: &Host| &host.keys_a) == 8);
    assert!(core::mem::offset_of!(Host, keys_b) == 16);
    assert!(size(|host: &Host| &host.keys_b) == 8);
    assert!(core::mem::offset_of!(Host, table) == 24);
    assert!(size(|host: &Host| &host.table) == 8);
    assert!(core::mem::offset_of!(Host, pass) == 32);
    assert!(size(|host: &Host| &host.pass) == 4);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::push::SortScatter as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, keys_a) == 8);
    assert!(size(|host: &Host| &host.keys_a) == 8);
    assert!(core::mem::offset_of!(Host, keys_b) == 16);
    assert!(size(|host: &Host| &host.keys_b) == 8);
    assert!(core::mem::offset_of!(Host, values_a) == 24);
    assert!(size(|host: &Host| &host.values_a) == 8);
    assert!(core::mem::offset_of!(Host, values_b) == 32);
    assert!(size(|host: &Host| &host.values_b) == 8);
    assert!(core::mem::offset_of!(Host, table) == 40);
    assert!(size(|host: &Host| &host.table) == 8);
    assert!(core::mem::offset_of!(Host, sums) == 48);
    assert!(size(|host: &Host| &host.sums) == 8);
    assert!(core::mem::offset_of!(Host, kept) == 56);
    assert!(size(|host: &Host| &host.kept) == 8);
    assert!(core::mem::offset_of!(Host, pass) == 64);
    assert!(size(|host: &Host| &host.pass) == 4);
    assert!(size_of::<Host>() == 72);
};
const _: () = {
    use gridwalk_core::layout::SplitCell as Host;
    assert!(core::mem::offset_of!(Host, first_reference) == 0);
    assert!(size(|host: &Host| &host.first_reference) == 4);
    assert!(core::mem::offset_of!(Host, list_begin) == 4);
    assert!(size(|host: &Host| &host.list_begin) == 4);
    assert!(core::mem::offset_of!(Host, list_length) == 8);
    assert!(size(|host: &Host| &host.list_length) == 4);
    assert!(core::mem::offset_of!(Host, leaf_begin) == 12);
    assert!(size(|host: &Host| &host.leaf_begin) == 4);
    assert!(core::mem::offset_of!(Host, cell) == 16);
    assert!(size(|host: &Host| &host.cell) == 4);
    assert!(core::mem::offset_of!(Host, level) == 20);
    assert!(size(|host: &Host| &host.level) == 4);
    assert!(core::mem::offset_of!(Host, xy) == 24);
    assert!(size(|host: &Host| &host.xy) == 4);
    assert!(core::mem::offset_of!(Host, z) == 28);
    assert!(size(|host: &Host| &host.z) == 4);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use crate::push::SplitCells as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, state) == 8);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, cells) == 16);
    assert!(size(|host: &Host| &host.cells) == 8);
    assert!(core::mem::offset_of!(Host, bricks) == 24);
    assert!(size(|host: &Host| &host.bricks) == 8);
    assert!(core::mem::offset_of!(Host, partials) == 32);
    assert!(size(|host: &Host| &host.partials) == 8);
    assert!(core::mem::offset_of!(Host, split_cells) == 40);
    assert!(size(|host: &Host| &host.split_cells) == 8);
    assert!(core::mem::offset_of!(Host, owners) == 48);
    assert!(size(|host: &Host| &host.owners) == 8);
    assert!(core::mem::offset_of!(Host, leaf_capacity) == 56);
    assert!(size(|host: &Host| &host.leaf_capacity) == 4);
    assert!(size_of::<Host>() == 64);
};
const _: () = {
    use crate::push::TableScan as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, table) == 8);
    assert!(size(|host: &Host| &host.table) == 8);
    assert!(core::mem::offset_of!(Host, sums) == 16);
    assert!(size(|host: &Host| &host.sums) == 8);
    assert!(core::mem::offset_of!(Host, pass) == 24);
    assert!(size(|host: &Host| &host.pass) == 4);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use gridwalk_core::layout::TileOccupancy as Host;
    assert!(core::mem::offset_of!(Host, cells_in_use) == 0);
    assert!(size(|host: &Host| &host.cells_in_use) == 4);
    assert!(core::mem::offset_of!(Host, longest_list) == 4);
    assert!(size(|host: &Host| &host.longest_list) == 4);
    assert!(core::mem::offset_of!(Host, split_cells) == 8);
    assert!(size(|host: &Host| &host.split_cells) == 8);
    assert!(core::mem::offset_of!(Host, split_references) == 16);
    assert!(size(|host: &Host| &host.split_references) == 8);
    assert!(core::mem::offset_of!(Host, leaf_cells) == 24);
    assert!(size(|host: &Host| &host.leaf_cells) == 8);
    assert!(core::mem::offset_of!(Host, cells_before) == 32);
    assert!(size(|host: &Host| &host.cells_before) == 4);
    assert!(core::mem::offset_of!(Host, references_before) == 36);
    assert!(size(|host: &Host| &host.references_before) == 4);
    assert!(core::mem::offset_of!(Host, leaves_before) == 40);
    assert!(size(|host: &Host| &host.leaves_before) == 4);
    assert!(core::mem::offset_of!(Host, reserved) == 44);
    assert!(size(|host: &Host| &host.reserved) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::push::TraceArgs as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(core::mem::offset_of!(Host, count) == 8);
    assert!(size(|host: &Host| &host.count) == 8);
    assert!(core::mem::offset_of!(Host, max_rays) == 16);
    assert!(size(|host: &Host| &host.max_rays) == 4);
    assert!(core::mem::offset_of!(Host, indirect) == 20);
    assert!(size(|host: &Host| &host.indirect) == 4);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::TraceContinueArgs as Host;
    assert!(core::mem::offset_of!(Host, state) == 0);
    assert!(size(|host: &Host| &host.state) == 8);
    assert!(size_of::<Host>() == 8);
};
const _: () = {
    use gridwalk_core::layout::TraceState as Host;
    assert!(core::mem::offset_of!(Host, arguments) == 0);
    assert!(size(|host: &Host| &host.arguments) == 16);
    assert!(core::mem::offset_of!(Host, ray_count) == 16);
    assert!(size(|host: &Host| &host.ray_count) == 4);
    assert!(core::mem::offset_of!(Host, unfinished) == 20);
    assert!(size(|host: &Host| &host.unfinished) == 4);
    assert!(core::mem::offset_of!(Host, reserved) == 24);
    assert!(size(|host: &Host| &host.reserved) == 8);
};
const _: () = {
    use gridwalk_core::layout::WalkState as Host;
    assert!(core::mem::offset_of!(Host, given_up) == 0);
    assert!(size(|host: &Host| &host.given_up) == 4);
    assert!(core::mem::offset_of!(Host, cell) == 4);
    assert!(size(|host: &Host| &host.cell) == 4);
    assert!(core::mem::offset_of!(Host, reference) == 8);
    assert!(size(|host: &Host| &host.reference) == 4);
    assert!(core::mem::offset_of!(Host, exit) == 12);
    assert!(size(|host: &Host| &host.exit) == 4);
    assert!(core::mem::offset_of!(Host, best_s) == 16);
    assert!(size(|host: &Host| &host.best_s) == 4);
    assert!(core::mem::offset_of!(Host, best_u) == 20);
    assert!(size(|host: &Host| &host.best_u) == 4);
    assert!(core::mem::offset_of!(Host, best_v) == 24);
    assert!(size(|host: &Host| &host.best_v) == 4);
    assert!(core::mem::offset_of!(Host, best_triangle) == 28);
    assert!(size(|host: &Host| &host.best_triangle) == 4);
    assert!(size_of::<Host>() == 32);
};
