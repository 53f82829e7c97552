//! Builds and traces as data: lists of kernels and barriers that are recorded from top to bottom.

use bytemuck::Pod;
use gridwalk_core::kernel::Kernel;
use gridwalk_core::layout::{DispatchArguments, MAX_PASSES};
use gridwalk_core::sort::{passes_of, writes_a};
use gridwalk_core::twin::ray_keys::RAY_KEY_BITS;
use std::mem::offset_of;

use crate::kernels::*;
use crate::push;
use crate::shape::{Shape, split_workgroups};
use crate::sizes::{Capacity, leaf_pass_capacity, pass_capacity};

/// Memory that the kernels of a plan share: each kernel's accesses to it come from the kernel's own qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u64)]
#[allow(missing_docs, reason = "the names are those of the kernels' push constants")]
pub enum Buffer {
    Positions,
    Indices,
    Records,
    Header,
    Cells,
    References,
    Triangles,
    Bricks,
    Report,
    State,
    Arguments,
    BoundsPartials,
    Offsets,
    CellBoxes,
    ScanPartials,
    KeysA,
    KeysB,
    ValuesA,
    Table,
    Occupancy,
    DistancesX,
    DistancesY,
    LeafState,
    LeafArguments,
    SplitCells,
    Rays,
    Hits,
    RayCount,
    TraceState,
    Walks,
    Counters,
    Masks,
    Geometries,
    Order,
}

impl Buffer {
    /// All of them, in order of their tokens.
    pub const ALL: [Buffer; 34] = [
        Buffer::Positions,
        Buffer::Indices,
        Buffer::Records,
        Buffer::Header,
        Buffer::Cells,
        Buffer::References,
        Buffer::Triangles,
        Buffer::Bricks,
        Buffer::Report,
        Buffer::State,
        Buffer::Arguments,
        Buffer::BoundsPartials,
        Buffer::Offsets,
        Buffer::CellBoxes,
        Buffer::ScanPartials,
        Buffer::KeysA,
        Buffer::KeysB,
        Buffer::ValuesA,
        Buffer::Table,
        Buffer::Occupancy,
        Buffer::DistancesX,
        Buffer::DistancesY,
        Buffer::LeafState,
        Buffer::LeafArguments,
        Buffer::SplitCells,
        Buffer::Rays,
        Buffer::Hits,
        Buffer::RayCount,
        Buffer::TraceState,
        Buffer::Walks,
        Buffer::Counters,
        Buffer::Masks,
        Buffer::Geometries,
        Buffer::Order,
    ];

    const fn token(self) -> u64 {
        self as u64
    }
}

const _: () = {
    let mut token = 0;
    while token < Buffer::ALL.len() {
        assert!(Buffer::ALL[token] as usize == token);
        token += 1;
    }
};

/// The number of workgroups of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dispatch {
    /// Known when recording.
    Direct([u32; 3]),
    /// A `VkDispatchIndirectCommand` at a byte offset into a buffer.
    Indirect(Buffer, u64),
}

/// Push constants are at most this long on every device.
pub const MAX_PUSH: usize = 128;

/// One launch of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// What runs.
    pub kernel: &'static Kernel,
    /// Specialization that differs between launches of one kernel: bit i sets the kernel's i-th boolean constant.
    pub variant: u32,
    /// How many workgroups.
    pub dispatch: Dispatch,
    push: [u8; MAX_PUSH],
}

impl Step {
    fn new<P: Pod>(kernel: &'static Kernel, dispatch: Dispatch, push: P) -> Step {
        let mut bytes = [0; MAX_PUSH];
        let source = bytemuck::bytes_of(&push);
        bytes[..source.len()].copy_from_slice(source);
        Step { kernel, variant: 0, dispatch, push: bytes }
    }

    fn variant(self, variant: u32) -> Step {
        Step { variant, ..self }
    }

    /// The buffer behind the kernel's i-th access.
    pub fn buffer(&self, access: usize) -> Buffer {
        let mut token = [0; 8];
        token.copy_from_slice(&self.push[8 * access..8 * access + 8]);
        Buffer::ALL[u64::from_ne_bytes(token) as usize]
    }

    /// The push constants after the addresses.
    pub fn words(&self) -> Vec<u32> {
        let bytes = &self.push[8 * self.kernel.accesses.len()..self.kernel.push_constant_size as usize];
        bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect()
    }

    /// The push constants with every buffer replaced by its address.
    pub(crate) fn resolve(&self, address: impl Fn(Buffer) -> u64) -> [u8; MAX_PUSH] {
        let mut push = self.push;
        for access in 0..self.kernel.accesses.len() {
            push[8 * access..8 * access + 8].copy_from_slice(&address(self.buffer(access)).to_ne_bytes());
        }
        push
    }
}

/// A global memory barrier between the kernels of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Barrier {
    /// Compute shaders see what compute shaders wrote.
    Shader,
    /// Likewise, and indirect dispatches too.
    ShaderAndIndirect,
}

/// An entry of a plan.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "a plan is a flat array without allocation")]
pub enum Item {
    /// A launch.
    Step(Step),
    /// A barrier between what stands before and what stands after it.
    Barrier(Barrier),
}

const MAX_ITEMS: usize = 60 + 12 * MAX_PASSES;

/// A list of steps and barriers, without allocation.
#[derive(Clone, Debug)]
pub struct Plan {
    items: [Item; MAX_ITEMS],
    len: usize,
}

impl Plan {
    fn new() -> Plan {
        Plan { items: [Item::Barrier(Barrier::Shader); MAX_ITEMS], len: 0 }
    }

    fn push(&mut self, item: Item) {
        // The bound holds for every capacity: a pass of either level adds six items, everything else fewer than 60.
        debug_assert!(self.len < MAX_ITEMS);
        if let Some(slot) = self.items.get_mut(self.len) {
            *slot = item;
            self.len += 1;
        }
    }

    fn step(&mut self, step: Step) {
        self.push(Item::Step(step));
    }

    fn barrier(&mut self, barrier: Barrier) {
        self.push(Item::Barrier(barrier));
    }

    /// The entries, in order.
    pub fn items(&self) -> &[Item] {
        &self.items[..self.len]
    }

    /// The launches, in order.
    pub fn steps(&self) -> impl Iterator<Item = &Step> {
        self.items().iter().filter_map(|item| match item {
            Item::Step(step) => Some(step),
            Item::Barrier(_) => None,
        })
    }
}

/// Where a build's triangles come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// One mesh, whose size is known when recording.
    Mesh {
        /// Triangles.
        triangle_count: u32,
        /// Vertices.
        vertex_count: u32,
    },
    /// Geometry records in memory.
    Records {
        /// How many.
        record_count: u32,
    },
}

/// What of its input the plan of a build depends on.
#[derive(Clone, Copy, Debug)]
pub struct BuildInputs {
    /// Where triangles come from.
    pub source: Source,
    /// Density k of Equation 3-1.
    pub density: f32,
    /// A fixed resolution instead.
    pub resolution: Option<[u32; 3]>,
    /// Whether cells are listed by exact overlap.
    pub exact: bool,
    /// Whether cells with many triangles are split, if the capacity has leaf cells.
    pub second_level: bool,
}

/// Bit of [`Step::variant`] of `overlap_count`, `overlap_emit_large`, `leaf_count`, `leaf_emit` and `leaf_emit_large`.
pub(crate) const EXACT: u32 = 1;

fn argument(offset: usize) -> Dispatch {
    Dispatch::Indirect(Buffer::Arguments, offset as u64)
}

fn leaf_argument(offset: usize) -> Dispatch {
    Dispatch::Indirect(Buffer::LeafArguments, offset as u64)
}

fn map_groups(elements: u32, shape: &Shape) -> Dispatch {
    Dispatch::Direct(split_workgroups(elements.div_ceil(shape.map_size)))
}

/// Workgroups of a pass of the sort.
struct SortGroups {
    sort: Dispatch,
    table_scan: Dispatch,
}

/// Sorts pairs, a digit a pass; after the last pass the values lie in `values_b`.
fn sort(plan: &mut Plan, state: Buffer, passes: u32, values_b: Buffer, groups: impl Fn(usize) -> SortGroups) {
    use Buffer::*;
    let (keys_a, keys_b, values_a, values_b, table) = (KeysA.token(), KeysB.token(), ValuesA.token(), values_b.token(), Table.token());
    let sums = ScanPartials.token();
    for pass in 0..passes {
        let groups = groups(pass as usize);
        plan.barrier(Barrier::Shader);
        let histogram = push::SortHistogram { state: state.token(), keys_a, keys_b, table, pass, padding: 0 };
        plan.step(Step::new(&SORT_HISTOGRAM, groups.sort, histogram));
        plan.barrier(Barrier::Shader);
        plan.step(Step::new(&TABLE_SCAN, groups.table_scan, push::TableScan { state: state.token(), table, sums, pass, padding: 0 }));
        plan.barrier(Barrier::Shader);
        let (state, kept) = (state.token(), state.token());
        let scatter = push::SortScatter { state, keys_a, keys_b, values_a, values_b, table, sums, kept, pass, padding: 0 };
        plan.step(Step::new(&SORT_SCATTER, groups.sort, scatter));
    }
}

/// Workgroups of the steps that run over all triangles.
struct TriangleGroups {
    overlap_count: Dispatch,
    offsets_scan: Dispatch,
}

/// Triangles into one array, in input coordinates, with the boxes of its tiles; and how many workgroups later steps take for them.
fn gather(plan: &mut Plan, capacity: &Capacity, source: Source, shape: &Shape) -> TriangleGroups {
    use Buffer::*;
    let (state, triangles, partials) = (State.token(), Triangles.token(), BoundsPartials.token());
    match source {
        Source::Mesh { triangle_count, vertex_count } => {
            let (positions, indices) = (Positions.token(), Indices.token());
            let push = push::Gather { positions, indices, triangles, state, partials, vertex_count, triangle_count };
            // One tile even without a triangle: the state is begun, and the scene has a box.
            plan.step(Step::new(&GATHER, Dispatch::Direct(split_workgroups(shape.bounds_tiles(triangle_count))), push));
            plan.barrier(Barrier::Shader);
            let groups = |count: u32, size: u32| Dispatch::Direct(split_workgroups(count.div_ceil(size)));
            TriangleGroups {
                overlap_count: map_groups(triangle_count + 1, shape),
                offsets_scan: groups(triangle_count + 1, shape.scan_tile()),
            }
        }
        Source::Records { record_count } => {
            // The first triangles lie where the offsets will: there are no more geometries than the capacity has triangles.
            let (records, firsts) = (Records.token(), Offsets.token());
            let arguments = Arguments.token();
            let push = push::GeometryScan { records, firsts, state, arguments, record_count, triangle_capacity: capacity.triangles };
            plan.step(Step::new(&GEOMETRY_SCAN, Dispatch::Direct([1, 1, 1]), push));
            plan.barrier(Barrier::ShaderAndIndirect);
            let push = push::GatherRecords { records, firsts, state, triangles, partials, record_count, padding: 0 };
            plan.step(Step::new(&GATHER_RECORDS, argument(offset_of!(DispatchArguments, gather)), push));
            plan.barrier(Barrier::Shader);
            TriangleGroups {
                overlap_count: argument(offset_of!(DispatchArguments, overlap_count)),
                offsets_scan: argument(offset_of!(DispatchArguments, offsets_scan)),
            }
        }
    }
}

/// The rebuild, from positions and indices to cell ranges (thesis sections 3.1 and 3.4).
pub fn build_plan(capacity: &Capacity, inputs: &BuildInputs, shape: &Shape) -> Plan {
    use Buffer::*;
    let [fixed_x, fixed_y, fixed_z] = inputs.resolution.unwrap_or([0; 3]);
    let (grid, state) = (Header.token(), State.token());
    let passes = pass_capacity(capacity, shape);
    let mut plan = Plan::new();

    let groups = gather(&mut plan, capacity, inputs.source, shape);
    plan.step(Step::new(
        &CONFIGURE,
        Dispatch::Direct([1, 1, 1]),
        push::Configure {
            partials: BoundsPartials.token(),
            grid,
            state: State.token(),
            arguments: Arguments.token(),
            report: Report.token(),
            cells: Cells.token(),
            references: References.token(),
            triangles: Triangles.token(),
            bricks: Bricks.token(),
            cell_capacity: capacity.cells,
            density: inputs.density,
            fixed_x,
            fixed_y,
            fixed_z,
            levels: if capacity.leaf_cells > 0 { 2 } else { 1 },
            exact: inputs.exact.into(),
            padding: 0,
        },
    ));
    plan.barrier(Barrier::ShaderAndIndirect);
    // Which bricks are used stands where their distances will.
    let (bricks, used) = (argument(offset_of!(DispatchArguments, bricks)), DistancesX.token());
    plan.step(Step::new(&CLEAR_BRICKS, bricks, push::ClearBricks { grid, used }));
    plan.barrier(Barrier::Shader);
    let exact = if inputs.exact { EXACT } else { 0 };
    let (offsets, boxes, triangles) = (Offsets.token(), CellBoxes.token(), Triangles.token());
    plan.step(
        Step::new(&OVERLAP_COUNT, groups.overlap_count, push::OverlapCount { grid, state, triangles, counts: offsets, boxes, used })
            .variant(exact),
    );
    plan.barrier(Barrier::Shader);
    let partials = ScanPartials.token();
    plan.step(Step::new(&SCAN_REDUCE, groups.offsets_scan, push::ScanReduce { state, values: offsets, partials }));
    plan.barrier(Barrier::Shader);
    plan.step(Step::new(
        &PAIR_ARGS,
        groups.offsets_scan,
        push::PairArgs {
            state,
            partials,
            offsets,
            arguments: Arguments.token(),
            report: Report.token(),
            pair_capacity: capacity.pairs,
            pass_capacity: passes,
        },
    ));
    plan.barrier(Barrier::ShaderAndIndirect);
    let (keys_a, keys_b, values_a, values_b) = (KeysA.token(), KeysB.token(), ValuesA.token(), References.token());
    let emission = push::OverlapEmit { grid, state, offsets, boxes, keys_a, keys_b, values_a, values_b };
    plan.step(Step::new(&OVERLAP_EMIT, groups.overlap_count, emission));
    // The two write different words, but of the same arrays, and hazards are told by arrays.
    plan.barrier(Barrier::Shader);
    let emission = push::OverlapEmitLarge { grid, state, offsets, triangles, keys_a, keys_b, values_a, values_b, used };
    plan.step(Step::new(&OVERLAP_EMIT_LARGE, argument(offset_of!(DispatchArguments, emit_large)), emission).variant(exact));
    sort(&mut plan, State, passes, References, |pass| SortGroups {
        sort: argument(offset_of!(DispatchArguments, sort) + 16 * pass),
        table_scan: argument(offset_of!(DispatchArguments, table_scan) + 16 * pass),
    });
    if passes == 0 {
        plan.barrier(Barrier::Shader);
    }
    plan.step(Step::new(
        &CLEAR_CELLS,
        argument(offset_of!(DispatchArguments, clear_cells)),
        push::ClearCells { grid, used, cells: Cells.token() },
    ));
    plan.barrier(Barrier::Shader);
    plan.step(Step::new(
        &CELL_RANGES,
        argument(offset_of!(DispatchArguments, cell_ranges)),
        push::CellRanges { state: State.token(), keys: KeysB.token(), cells: Cells.token(), report: Report.token() },
    ));
    plan.barrier(Barrier::Shader);
    plan.step(Step::new(
        &BRICK_REDUCE,
        argument(offset_of!(DispatchArguments, brick_reduce)),
        push::BrickReduce { grid, used, cells: Cells.token(), bricks: Bricks.token(), partials: Occupancy.token() },
    ));
    plan.barrier(Barrier::Shader);
    let (x, y) = (DistancesX.token(), DistancesY.token());
    plan.step(Step::new(&BRICK_DISTANCE_X, bricks, push::BrickDistanceX { grid, bricks: Bricks.token(), distances: x }));
    plan.step(Step::new(
        &REPORT_SPINE,
        Dispatch::Direct([1, 1, 1]),
        push::ReportSpine {
            grid,
            state,
            partials: Occupancy.token(),
            leaf_state: LeafState.token(),
            arguments: LeafArguments.token(),
            report: Report.token(),
            leaf_capacity: capacity.leaf_cells,
            padding: 0,
        },
    ));
    let splits = inputs.second_level && capacity.leaf_cells > 0;
    plan.barrier(if splits { Barrier::ShaderAndIndirect } else { Barrier::Shader });
    plan.step(Step::new(&BRICK_DISTANCE_Y, bricks, push::BrickDistanceY { grid, distances_x: x, distances: y }));
    if splits {
        plan.step(Step::new(
            &SPLIT_CELLS,
            leaf_argument(offset_of!(gridwalk_core::layout::LeafArguments, split_cells)),
            push::SplitCells {
                grid,
                state: LeafState.token(),
                cells: Cells.token(),
                bricks: Bricks.token(),
                partials: Occupancy.token(),
                split_cells: SplitCells.token(),
                owners: Table.token(),
                leaf_capacity: capacity.leaf_cells,
                padding: 0,
            },
        ));
    }
    plan.barrier(Barrier::Shader);
    plan.step(Step::new(&BRICK_DISTANCE_Z, bricks, push::BrickDistanceZ { grid, distances_y: y, bricks: Bricks.token() }));
    if splits {
        second_level(&mut plan, capacity, exact, shape);
    }
    plan
}

/// The lists of leaf cells, from the records of the cells that are split.
fn second_level(plan: &mut Plan, capacity: &Capacity, exact: u32, shape: &Shape) {
    use Buffer::*;
    type Arguments = gridwalk_core::layout::LeafArguments;
    let (grid, state, cells, triangles, references) =
        (Header.token(), LeafState.token(), Cells.token(), Triangles.token(), References.token());
    let (split_cells, report, arguments) = (SplitCells.token(), Report.token(), LeafArguments.token());
    // Offsets, masks and boxes lie where the first level's sorted keys are no longer needed, and owners where the digit table will.
    let (offsets, masks, boxes, owners) = (KeysA.token(), KeysB.token(), ValuesA.token(), Table.token());
    let passes = leaf_pass_capacity(capacity, shape);
    let count = leaf_argument(offset_of!(Arguments, count));
    plan.step(
        Step::new(
            &LEAF_COUNT,
            count,
            push::LeafCount { grid, state, split_cells, references, triangles, counts: offsets, masks, boxes, owners, cells },
        )
        .variant(exact),
    );
    plan.barrier(Barrier::Shader);
    let partials = ScanPartials.token();
    let reduce = push::ScanReduce { state, values: offsets, partials };
    plan.step(Step::new(&SCAN_REDUCE, leaf_argument(offset_of!(Arguments, offsets_scan)), reduce));
    plan.barrier(Barrier::Shader);
    let (pair_capacity, pass_capacity) = (capacity.pairs, passes);
    plan.step(Step::new(
        &LEAF_ARGS,
        leaf_argument(offset_of!(Arguments, args)),
        push::LeafArgs { state, partials, offsets, arguments, report, pair_capacity, pass_capacity },
    ));
    plan.barrier(Barrier::ShaderAndIndirect);
    if shape.leaf_run > 0 {
        let keys = masks;
        let large = push::LeafEmitLarge { grid, state, split_cells, references, triangles, offsets, boxes, owners, keys };
        plan.step(Step::new(&LEAF_EMIT_LARGE, leaf_argument(offset_of!(Arguments, emit_large)), large).variant(exact));
        plan.barrier(Barrier::Shader);
        let sort = push::LeafSort { state, split_cells, offsets, masks, boxes, references, cells, arguments, pass_capacity, padding: 0 };
        plan.step(Step::new(&LEAF_SORT, leaf_argument(offset_of!(Arguments, leaf_sort)), sort));
        plan.barrier(Barrier::ShaderAndIndirect);
    }
    let (keys_a, keys_b, values_a, values_b) = (KeysA.token(), KeysB.token(), ValuesA.token(), references);
    let emission = push::LeafEmit {
        grid,
        state,
        split_cells,
        references,
        triangles,
        offsets,
        masks,
        boxes,
        owners,
        keys_a,
        keys_b,
        values_a,
        values_b,
        cells,
    };
    plan.step(Step::new(&LEAF_EMIT, leaf_argument(offset_of!(Arguments, emit)), emission).variant(exact));
    sort(plan, LeafState, passes, References, |pass| SortGroups {
        sort: leaf_argument(offset_of!(Arguments, sort) + 16 * pass),
        table_scan: leaf_argument(offset_of!(Arguments, table_scan) + 16 * pass),
    });
    plan.barrier(Barrier::Shader);
    let ranges = push::CellRanges { state, keys: keys_b, cells, report };
    plan.step(Step::new(&CELL_RANGES, leaf_argument(offset_of!(Arguments, cell_ranges)), ranges));
    plan.barrier(Barrier::Shader);
    plan.step(Step::new(&LEAF_DISTANCE, leaf_argument(offset_of!(Arguments, distance)), push::LeafDistance { state, split_cells, cells }));
}

/// Times that a trace goes on with walks that ran out of their budget before they are reported: 209,600 triangles a ray in all, or more
/// cells in use than the longest way through any flat grid passes. A continuation that is not needed costs two dispatches of next to nothing.
pub const CONTINUATIONS: u32 = 7;

/// Bits of [`Step::variant`] of the trace kernels.
pub(crate) const CONTINUE: u32 = 1;
pub(crate) const LAST: u32 = 2;
pub(crate) const RESUME: u32 = 4;
pub(crate) const COUNT: u32 = 8;
pub(crate) const EXTRAS: u32 = 16;
/// The same of `any_hit`, which has neither RESUME nor COUNT.
pub(crate) const ANY_EXTRAS: u32 = 4;

/// Bits of [`Extras::options`]; those below are `GRIDWALK_CULL_*`.
pub const OPTION_MASKS: u32 = 4;
/// See [`OPTION_MASKS`].
pub const OPTION_GEOMETRIES: u32 = 8;
/// Of the push constant alone: rays are traced in the order that is given.
const OPTION_ORDER: u32 = 16;

/// What a trace looks at beside rays and triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extras {
    /// Mask of all rays.
    pub mask: u32,
    /// What is culled, and `OPTION_*` bits.
    pub options: u32,
}

impl Extras {
    /// Nothing beside.
    pub const NONE: Extras = Extras { mask: u32::MAX, options: 0 };
}

/// What a trace computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// A `Hit` a ray.
    Closest {
        /// Whether existing hits are to be beaten.
        resume: bool,
        /// Whether steps, tests and cells are counted.
        count: bool,
    },
    /// A word a ray: 1 or 0.
    Any,
    /// A word a ray: the number of hits.
    Count,
    /// Some `Hit`s a ray.
    Nearest {
        /// How many.
        nearest: u32,
        /// Whether they are to lie beyond the last of the existing ones.
        resume: bool,
    },
}

/// The rays of a trace.
#[derive(Clone, Copy, Debug)]
pub struct RayInputs {
    /// How many, or the bound of a number in memory.
    pub max: u32,
    /// Whether the number is in memory.
    pub indirect: bool,
    /// Whether they are traced in an order that is given.
    pub ordered: bool,
}

/// A trace over a buffer of rays.
pub fn trace_plan(query: Query, extras: Extras, rays: &RayInputs) -> Plan {
    use Buffer::*;
    let state = TraceState.token();
    let mut plan = Plan::new();
    plan.step(Step::new(
        &TRACE_ARGS,
        Dispatch::Direct([1, 1, 1]),
        push::TraceArgs { state, count: RayCount.token(), max_rays: rays.max, indirect: rays.indirect.into() },
    ));
    for turn in 0..=CONTINUATIONS {
        if turn > 0 {
            plan.barrier(Barrier::Shader);
            plan.step(Step::new(&TRACE_CONTINUE_ARGS, Dispatch::Direct([1, 1, 1]), push::TraceContinueArgs { state }));
        }
        plan.barrier(Barrier::ShaderAndIndirect);
        let launch = if turn > 0 { CONTINUE } else { 0 } | if turn == CONTINUATIONS { LAST } else { 0 };
        plan.step(trace_step(query, extras, rays.ordered, launch));
    }
    plan
}

/// The order of rays by their keys: by the kernels of the build's sort, on a state of their own. Of `rays` the order counts for nothing.
pub fn ray_sort_plan(rays: &RayInputs, shape: &Shape) -> Plan {
    use Buffer::*;
    let (passes, _) = passes_of(RAY_KEY_BITS, shape.sort_bits);
    let (state, arguments, count) = (State.token(), Arguments.token(), RayCount.token());
    let mut plan = Plan::new();
    let args = push::RaySortArgs { state, arguments, count, max_rays: rays.max, indirect: rays.indirect.into() };
    plan.step(Step::new(&RAY_SORT_ARGS, Dispatch::Direct([1, 1, 1]), args));
    plan.barrier(Barrier::ShaderAndIndirect);
    let (keys, values) = if writes_a(passes, 0) { (KeysA, ValuesA) } else { (KeysB, Order) };
    let push = push::RayKeys { grid: Header.token(), rays: Rays.token(), state, keys: keys.token(), values: values.token() };
    plan.step(Step::new(&RAY_KEYS, argument(offset_of!(DispatchArguments, ray_keys)), push));
    // The first pass's arguments are those of all.
    sort(&mut plan, State, passes, Order, |_| SortGroups {
        sort: argument(offset_of!(DispatchArguments, sort)),
        table_scan: argument(offset_of!(DispatchArguments, table_scan)),
    });
    plan
}

fn trace_step(query: Query, extras: Extras, ordered: bool, launch: u32) -> Step {
    use Buffer::*;
    let dispatch = Dispatch::Indirect(TraceState, offset_of!(gridwalk_core::layout::TraceState, arguments) as u64);
    let (grid, rays, state, walks) = (Header.token(), Rays.token(), TraceState.token(), Walks.token());
    let (masks, geometries, order) = (Masks.token(), Geometries.token(), Order.token());
    let Extras { mask, options } = extras;
    let options = options | if ordered { OPTION_ORDER } else { 0 };
    let extra = if extras == Extras::NONE { 0 } else { EXTRAS };
    match query {
        Query::Closest { resume, count } => {
            let variant = launch | extra | if resume { RESUME } else { 0 } | if count { COUNT } else { 0 };
            let (hits, counters) = (Hits.token(), Counters.token());
            let push = push::ClosestHit { grid, rays, hits, state, walks, counters, masks, geometries, order, mask, options };
            Step::new(&CLOSEST_HIT, dispatch, push).variant(variant)
        }
        Query::Any => {
            let push = push::AnyHit { grid, rays, occluded: Hits.token(), state, walks, masks, geometries, order, mask, options };
            let extra = if extra == 0 { 0 } else { ANY_EXTRAS };
            Step::new(&ANY_HIT, dispatch, push).variant(launch | extra)
        }
        Query::Count => {
            let push = push::CountHits { grid, rays, counts: Hits.token(), state, walks, masks, order, mask, options, launch, padding: 0 };
            Step::new(&COUNT_HITS, dispatch, push)
        }
        Query::Nearest { nearest, resume } => {
            let launch = launch | if resume { RESUME } else { 0 };
            let hits = Hits.token();
            let push = push::NearestHits { grid, rays, hits, state, walks, masks, geometries, order, mask, options, launch, nearest };
            Step::new(&NEAREST_HITS, dispatch, push)
        }
    }
}

/// Triangles a dispatch of the brute-force oracle; the loop budget of lavapipe allows no more than 65,535.
pub(crate) const BRUTE_FORCE_TRIANGLES: u32 = 32_768;

/// One range of the brute-force oracle, from triangle `first` on.
pub(crate) fn brute_force_step(ray_count: u32, triangle_count: u32, first: u32, shape: &Shape) -> Step {
    let end = triangle_count.min(first + BRUTE_FORCE_TRIANGLES);
    Step::new(
        &BRUTE_FORCE,
        map_groups(ray_count, shape),
        push::BruteForce {
            grid: Buffer::Header.token(),
            rays: Buffer::Rays.token(),
            hits: Buffer::Hits.token(),
            walks: Buffer::Walks.token(),
            ray_count,
            first,
            end,
            last: (end == triangle_count).into(),
        },
    )
}

/// The closest hits through the public include.
pub(crate) fn candidate_step(ray_count: u32, extras: Extras, shape: &Shape) -> Step {
    Step::new(
        &CLOSEST_CANDIDATE,
        map_groups(ray_count, shape),
        push::ClosestCandidate {
            grid: Buffer::Header.token(),
            rays: Buffer::Rays.token(),
            hits: Buffer::Hits.token(),
            ray_count,
            mask: extras.mask,
            cull: extras.options,
            padding: 0,
        },
    )
}
