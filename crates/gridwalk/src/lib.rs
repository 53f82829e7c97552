//! Builds uniform grids over triangles on a Vulkan device that it is given, and traces rays through them.
//!
//! The crate records commands into the caller's command buffers, on the caller's device, in the caller's memory. After [`Tracer::new`] it
//! creates nothing, and it never allocates device memory, maps, submits or waits. It implements chapter 3 of a thesis on GPU grid
//! construction for ray tracing dynamic scenes (Ivson, PUC-Rio): the grid is cheap enough to be rebuilt from nothing in every frame.
//!
//! [`integrating`] is the guide, from the device to the picture; what follows here are the rules.
//!
//! # The contract
//!
//! **Device.** Vulkan 1.3 with `bufferDeviceAddress` and `synchronization2` enabled. [`requirements()`] names all that a physical device lacks,
//! or gives the feature structures to chain into the device's creation; [`requirements::fill`] enables the features in a chain of the
//! caller's own. No descriptor sets, no 64-bit integers, no subgroup operations, any subgroup size. The queue needs compute; ownership of
//! buffers among queue families is the caller's affair.
//!
//! **Memory.** [`Tracer::build_sizes`] turns a [`Capacity`] into bytes, alignment and usage flags of three regions:
//!
//! | region | holds | lives |
//! |---|---|---|
//! | grid | header, cells, references, triangles, bricks | as long as rays are traced through it |
//! | scratch | pairs while they are sorted, counters, dispatch arguments | while a build runs; builds that do not overlap in time may share it |
//! | report | a [`Report`] | until the host has read it, if it wants to |
//!
//! These, and the scratch of a trace ([`Tracer::trace_scratch_size`]) or of a sort of rays ([`Tracer::ray_sort_scratch_size`]), begin at
//! multiples of [`REGION_ALIGNMENT`] of their device address. All scratches need `INDIRECT_BUFFER` beside `SHADER_DEVICE_ADDRESS`; all else needs that alone. What the caller writes and reads:
//!
//! | region | an element | address a multiple of |
//! |---|---|---|
//! | positions, indices of one mesh | 12 bytes | 4 |
//! | [`GeometryRecord`]s | 128 bytes | 16 |
//! | [`Ray`]s | 32 bytes | 16 |
//! | [`Hit`]s; answers of any hit and of counts | 16 bytes; 4 | 16; 4 |
//! | number of rays, masks, order | 4 bytes | 4 |
//! | geometries | 8 bytes | 8 |
//! | counters | 16 bytes | 16 |
//!
//! Regions that are written do not overlap any other; all may lie in one buffer. Contents need no initialization and survive nothing but
//! their purpose: a build overwrites all that it later reads. What is too small or badly aligned is refused when recording.
//!
//! **Geometry.** One mesh, as tightly packed `f32` triples and `u32` triples ([`Input::Mesh`]); or any number of geometries and instances, as
//! [`GeometryRecord`]s in device memory that the host or a shader has written ([`Input::Records`]): position formats with stride, scale and
//! offset, index types, a transform, a mask, and a triangle count that may lie in memory. Triangles are numbered over all records in
//! order; those beyond the capacity are left out and reported. A triangle with a vertex that is not finite, or with an index beyond the
//! positions, is dropped and counted. Nothing of this is read after the build: the grid has its own copy of the triangles. Triangles that
//! share vertices by index within a record share them exactly; between records, only if the arithmetic of both gives the same.
//!
//! **Barriers.** The caller puts a memory barrier ([`cmd_barrier`], or one of its own with these masks)
//! - from whatever wrote the geometry, and from [`Tracer::TRACE`] of the grid's last use, to [`Tracer::BUILD`] before a build;
//! - from [`Tracer::BUILD`] to [`Tracer::TRACE`] between a build and the traces through its grid;
//! - from [`Tracer::TRACE`] to whatever reads the hits, and from whatever wrote the rays or an indirect count to [`Tracer::TRACE`];
//! - between two builds that share a scratch region, and between two traces that share one, from and to the same masks;
//! - between a sort of rays and the traces in its order, which take the place of each other in all of these, from and to [`Tracer::TRACE`];
//! - to [`Access::HOST_READ`] before the host reads a report.
//!
//! Barriers among the steps of one build or trace are the library's.
//!
//! **State.** A recording binds compute pipelines and sets push constants; what was bound before is lost. Descriptor sets, graphics state and
//! everything else stay. A command buffer may be submitted again after its geometry, rays or counts changed: all numbers are read on
//! the device. With timestamps, a recording resets the queries that it writes.
//!
//! **In flight.** A grid that is traced and a grid that is built share nothing: frame n may be traced while the grid of frame n + 1 is built,
//! each with scratch of its own. One scratch serves builds, and one trace scratch traces, that barriers keep apart.
//!
//! **Overflow.** Pairs beyond the capacity are dropped, never written out of bounds; the report says so and what would have sufficed
//! ([`Report::pairs_overflowed`], [`Report::needed_pairs`]). Such a grid is sound but misses triangles. A density that asks for more cells than
//! the capacity is lowered and reported; such a grid is complete. So is one whose cells were not split for lack of room
//! ([`Report::leaves_overflowed`]).
//!
//! **Threads.** A [`Tracer`] is `Send` and `Sync`, all methods take `&self`; a command buffer is recorded by one thread at a time.
//!
//! **Destruction.** Drop the tracer after all work recorded with it has ended and before its device is destroyed.
//!
//! **Pipelines** are made once, by [`Tracer::new`], all of them through the caller's cache ([`DeviceDesc::pipeline_cache`]); what the cache
//! began with, and whether it is kept, is the caller's affair. Recording allocates nothing on the heap.
//!
//! **Queues.** A recording needs a queue with compute and nothing else: an asynchronous compute queue serves. What another queue family has
//! written or will read has to be shared (`VK_SHARING_MODE_CONCURRENT`) or handed over by the caller's own barriers; semaphores between queues
//! are the caller's as well.
//!
//! **Elsewhere.** MoltenVK's devices are seen by an instance with `VK_KHR_portability_enumeration` and its flag, and want
//! `VK_KHR_portability_subset` enabled where they offer it; none of the subset's optional features is needed. The crate compiles for Windows and
//! macOS and holds nothing of either system, but has been run on neither.
//!
//! # Rays and hits
//!
//! A [`Ray`]'s direction has any length but zero, `t` counts in its units, and hits lie in the closed interval [`t_min`, `t_max`]. The hit
//! point is (1 - u - v) a + u b + v c of the triangle's vertices; both windings are hit; a triangle seen exactly edge-on is not. A miss has
//! triangle [`MISS`] and an infinite `t`. Of hits at equal distance the lowest triangle index wins. A ray with a NaN, with an infinite origin
//! or direction, or with a direction of zero misses. Components of a direction below 2^-40 of the largest count as zero. A ray that starts
//! outside of the scene box is traced from its entry into the box; one that starts so far away that its origin's rounding exceeds the
//! box's padding is traced as the rounded ray. A walk that was given up after its continuations has triangle [`UNFINISHED`]: neither a hit
//! nor a miss. [`Tracer::cmd_any_hit`] tells whether there is a hit, [`Tracer::cmd_count_hits`] how many, [`Tracer::cmd_nearest_hits`] gives the
//! nearest in order; masks and culling restrict all of them ([`TraceInfo::mask`], [`TraceInfo::cull`]). No ray passes between two triangles that share an edge.
//! The order in which rays are traced changes none of this: [`Tracer::cmd_sort_rays`] makes one in which rays that go the same way follow one
//! another, for any trace ([`TraceInfo::order`]).
//!
//! # In your own shader
//!
//! [`GRIDWALK_GLSL`] is the text of one include, without bindings: pass the grid region's address and call `gridwalk_closest_hit`,
//! `gridwalk_any_hit`, or iterate over candidates. Its head documents the interface; [`GRIDWALK_GLSL_PATH`] is where it lies, for build
//! scripts. All its names begin with `gridwalk`, in the case of their kind, but for the types `Ray` and `Hit`. It may be called in divergent
//! code, with any size of subgroups. [`GRIDWALK_SLANG`] is the same in Slang. Of HLSL nothing is offered: no compiler of it is part of the tests.
//!
//! # Example
//!
//! ```no_run
//! use gridwalk::{ash, *};
//! use ash::vk;
//!
//! # #[allow(clippy::too_many_arguments)]
//! unsafe fn record(
//!     tracer: &Tracer, cmd: vk::CommandBuffer, build: &BuildInfo, rays: Region, hits: Region, trace_scratch: Region,
//! ) -> Result<()> {
//!     let device = tracer.device();
//!     unsafe {
//!         // After the pass that wrote the vertices:
//!         cmd_barrier(device, cmd, Access::COMPUTE, Tracer::BUILD);
//!         tracer.cmd_build(cmd, build)?;
//!         cmd_barrier(device, cmd, Tracer::BUILD, Tracer::TRACE);
//!         let trace = TraceInfo::new(rays, hits, RayCount::Direct(1_000_000), trace_scratch);
//!         tracer.cmd_closest_hit(cmd, build.grid.address, &trace)
//!     }
//! }
//! ```

mod error;
#[doc(hidden)]
pub mod hazard;
#[doc(hidden)]
pub mod kernels;
#[doc(hidden)]
pub mod plan;
mod push;
pub mod requirements;
mod shape;
mod sizes;
mod sync;
mod tracer;

#[doc = include_str!("../docs/integrating.md")]
pub mod integrating {}

pub use ash;
pub use error::{Error, Result};
pub use gridwalk_core;
pub use gridwalk_core::geometry::{
    FLAG_FLIP_FACING, FLAG_TWO_SIDED, FORMAT_FLOAT16X4, FORMAT_FLOAT32X3, FORMAT_SNORM16X4, INDEX_NONE, INDEX_UINT16, INDEX_UINT32,
    MAX_GEOMETRIES,
};
pub use gridwalk_core::{GeometryRecord, Hit, MISS, Ray, Report, UNFINISHED, kernel};
pub use requirements::requirements;
pub use shape::{Shape, split_workgroups};
pub use sizes::{
    BuildSizes, Capacity, MAX_CELLS, MAX_PAIRS, MAX_RAYS, MAX_TRIANGLES, MAX_VERTICES, REGION_ALIGNMENT, RegionSize, region_bytes,
};
pub use sync::{Access, cmd_barrier};
pub use tracer::{
    BuildInfo, BuildOptions, Cull, DeviceDesc, Geometry, Input, MAX_NEAREST, Overlap, RayCount, RaySortInfo, Records, Region, Timestamps,
    TraceInfo, Tracer,
};

/// The public GLSL include in one piece: trace from your own shader.
pub const GRIDWALK_GLSL: &str = include_str!("../glsl/gridwalk.glsl");

/// The same in Slang, to be compiled with `-fp-mode precise`.
pub const GRIDWALK_SLANG: &str = include_str!("../glsl/gridwalk.slang");

/// Where [`GRIDWALK_GLSL`] lay when this crate was compiled: for the include path of a shader compiler in a build script.
pub const GRIDWALK_GLSL_PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/glsl/gridwalk.glsl");

/// Where [`GRIDWALK_SLANG`] lay when this crate was compiled.
pub const GRIDWALK_SLANG_PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/glsl/gridwalk.slang");
