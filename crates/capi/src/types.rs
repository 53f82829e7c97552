//! What C sees: structures, constants, results.

use std::mem::offset_of;

use gridwalk::ash::vk::{
    self, Bool32 as VkBool32, Buffer as VkBuffer, BufferUsageFlags as VkBufferUsageFlags, Device as VkDevice,
    DeviceAddress as VkDeviceAddress, DeviceSize as VkDeviceSize, Instance as VkInstance, PhysicalDevice as VkPhysicalDevice,
    PipelineCache as VkPipelineCache, QueryPool as VkQueryPool,
};
use gridwalk::{Access, Tracer};

/// Version of this header, to be compared with `gridwalk_version`.
pub const GRIDWALK_VERSION_MAJOR: u32 = 0;
/// Version of this header.
pub const GRIDWALK_VERSION_MINOR: u32 = 1;
/// Version of this header.
pub const GRIDWALK_VERSION_PATCH: u32 = 0;

/// `GridwalkHit::triangle` of a ray that hits nothing.
pub const GRIDWALK_MISS: u32 = 0xFFFF_FFFF_u32;
/// `GridwalkHit::triangle`, and any hit's answer, of a ray whose walk was given up: neither a hit nor a miss.
pub const GRIDWALK_UNFINISHED: u32 = 0xFFFF_FFFE_u32;

/// Alignment of the device address of grid, scratch and report regions, bytes.
pub const GRIDWALK_REGION_ALIGNMENT: u64 = 64u64;
/// Most triangles of a grid.
pub const GRIDWALK_MAX_TRIANGLES: u32 = 67108864u32;
/// Most cells of a grid.
pub const GRIDWALK_MAX_CELLS: u32 = 268435456u32;
/// Most pairs of a grid.
pub const GRIDWALK_MAX_PAIRS: u32 = 268435456u32;
/// Most rays of a trace.
pub const GRIDWALK_MAX_RAYS: u32 = 268435456u32;
/// Most geometry records of a grid.
pub const GRIDWALK_MAX_GEOMETRIES: u32 = 65536u32;
/// Most hits a ray that `gridwalk_cmd_nearest_hits` finds at once.
pub const GRIDWALK_MAX_NEAREST: u32 = 64u32;
/// Density that is used if none is given: cells a triangle.
pub const GRIDWALK_DEFAULT_DENSITY: f32 = 7.0;

/// `GridwalkBuildInfo::overlap`: a cell lists the triangles that it overlaps. Fewer tests when tracing, above all with long thin triangles.
pub const GRIDWALK_OVERLAP_EXACT: u32 = 0u32;
/// `GridwalkBuildInfo::overlap`: a cell lists the triangles whose boxes it overlaps. The faster build, by less than a tenth.
pub const GRIDWALK_OVERLAP_BOX: u32 = 1u32;

/// `GridwalkTraceInfo::cull`: both sides of triangles are hit.
pub const GRIDWALK_CULL_NONE: u32 = 0u32;
/// `GridwalkTraceInfo::cull`: only fronts are hit: where the vertices go round counterclockwise, seen along the ray.
pub const GRIDWALK_CULL_BACK: u32 = 1u32;
/// `GridwalkTraceInfo::cull`: only backs are hit.
pub const GRIDWALK_CULL_FRONT: u32 = 2u32;

/// `GridwalkGeometryRecord::format`: three floats a vertex.
pub const GRIDWALK_FORMAT_FLOAT32X3: u32 = 0u32;
/// `GridwalkGeometryRecord::format`: four half floats a vertex, the fourth unused.
pub const GRIDWALK_FORMAT_FLOAT16X4: u32 = 1u32;
/// `GridwalkGeometryRecord::format`: four normalized `int16_t` a vertex, the fourth unused.
pub const GRIDWALK_FORMAT_SNORM16X4: u32 = 2u32;
/// `GridwalkGeometryRecord::index_type`: triangle i has the vertices 3 i, 3 i + 1 and 3 i + 2.
pub const GRIDWALK_INDEX_NONE: u32 = 0u32;
/// `GridwalkGeometryRecord::index_type`: three `uint16_t` a triangle, tightly packed.
pub const GRIDWALK_INDEX_UINT16: u32 = 1u32;
/// `GridwalkGeometryRecord::index_type`: three `uint32_t` a triangle, tightly packed.
pub const GRIDWALK_INDEX_UINT32: u32 = 2u32;
/// `GridwalkGeometryRecord::flags`: front and back are exchanged, as by a transform that mirrors.
pub const GRIDWALK_FLAG_FLIP_FACING: u32 = 1u32;
/// `GridwalkGeometryRecord::flags`: the geometry is never culled.
pub const GRIDWALK_FLAG_TWO_SIDED: u32 = 2u32;

/// `GridwalkReport::overflow`: pairs were dropped; `GridwalkReport::pair_total` is the capacity that would have sufficed.
pub const GRIDWALK_OVERFLOW_PAIRS: u32 = 1u32;
/// `GridwalkReport::overflow`: the resolution was lowered to fit the capacity of cells.
pub const GRIDWALK_OVERFLOW_CELLS: u32 = 2u32;
/// `GridwalkReport::overflow`: triangles beyond the capacity were left out; `GridwalkReport::triangle_total` would have sufficed.
pub const GRIDWALK_OVERFLOW_TRIANGLES: u32 = 4u32;
/// Of a report's overflow: some cells that were to be split stayed whole; the grid is complete.
pub const GRIDWALK_OVERFLOW_LEAVES: u32 = 8u32;

/// Pipeline stages of builds in a barrier: `VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT`.
pub const GRIDWALK_BUILD_STAGES: u64 = 0x802u64;
/// Accesses of builds in a barrier: `VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
/// VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT`.
pub const GRIDWALK_BUILD_ACCESS: u64 = 0x6_0000_0001_u64;
/// Pipeline stages of traces in a barrier, of the library's and of compute shaders with the include.
pub const GRIDWALK_TRACE_STAGES: u64 = 0x802u64;
/// Accesses of traces in a barrier.
pub const GRIDWALK_TRACE_ACCESS: u64 = 0x6_0000_0001_u64;
/// Pipeline stage of the host's reads, for reports and hits: `VK_PIPELINE_STAGE_2_HOST_BIT`.
pub const GRIDWALK_HOST_READ_STAGES: u64 = 0x4000u64;
/// Access of the host's reads: `VK_ACCESS_2_HOST_READ_BIT`.
pub const GRIDWALK_HOST_READ_ACCESS: u64 = 0x2000u64;

/// What a function says of how it went.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridwalkResult {
    /// All is well.
    Ok = 0,
    /// A pointer or a handle is null that must not be.
    ErrorNull = -1,
    /// A structure's `struct_size` or `sType` is wrong, or it has fields that this version of the library does not know.
    ErrorStruct = -2,
    /// `vkGetInstanceProcAddr` or `vkGetDeviceProcAddr` does not know a function of Vulkan 1.3: the instance or the device is not for it.
    ErrorLoader = -3,
    /// A Vulkan call failed: `gridwalk_last_vk_result`.
    ErrorVulkan = -4,
    /// The physical device lacks what the kernels need; the message names all of it.
    ErrorUnsuitable = -5,
    /// A capacity or a count is beyond what a grid can hold.
    ErrorCapacity = -6,
    /// A region needs more memory than the device can give in one buffer: lower the capacity.
    ErrorDeviceLimit = -7,
    /// A region that was passed is too small, not aligned, or has no buffer where one is needed.
    ErrorRegion = -8,
    /// An option has no meaning.
    ErrorOption = -9,
    /// A defect of the library.
    ErrorInternal = -10,
}

/// Makes the pipelines once, then records builds and traces for one device.
pub struct GridwalkTracer {
    pub(crate) tracer: Tracer,
}

/// `PFN_vkGetInstanceProcAddr`, which may be null.
#[repr(transparent)]
#[derive(Clone, Copy)]
#[allow(non_camel_case_types, reason = "Vulkan's name")]
pub struct PFN_vkGetInstanceProcAddr(pub(crate) Option<vk::PFN_vkGetInstanceProcAddr>);

/// The device that a tracer records for.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkDeviceDesc {
    /// `sizeof(GridwalkDeviceDesc)`.
    pub struct_size: u32,
    /// `VK_TRUE` if the instance has `VK_EXT_debug_utils` enabled and wants names of pipelines and labels of steps.
    pub debug_utils: VkBool32,
    /// Through which all other Vulkan functions are found.
    pub get_instance_proc_addr: PFN_vkGetInstanceProcAddr,
    /// Instance of the device, created for Vulkan 1.3 or later.
    pub instance: VkInstance,
    /// Physical device of the device.
    pub physical_device: VkPhysicalDevice,
    /// Device with the features of `gridwalk_requirements` enabled. It outlives the tracer.
    pub device: VkDevice,
    /// Cache for the pipelines, or `VK_NULL_HANDLE`. Used while the tracer is made.
    pub pipeline_cache: VkPipelineCache,
}

/// A piece of a buffer of yours.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkRegion {
    /// The buffer, with usage `VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT`. Needed of scratch regions alone.
    pub buffer: VkBuffer,
    /// First byte of the region in the buffer.
    pub offset: VkDeviceSize,
    /// Bytes.
    pub size: VkDeviceSize,
    /// Device address of the region's first byte.
    pub address: VkDeviceAddress,
}

/// What a build must have room for. Sizes are made from capacities once; builds of any smaller size fit.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkCapacity {
    /// Triangles, at most `GRIDWALK_MAX_TRIANGLES`.
    pub triangles: u32,
    /// Cells of the grid, at most `GRIDWALK_MAX_CELLS`; a build lowers its density to fit.
    pub cells: u32,
    /// Cells of all triangles, counted once a triangle, at most `GRIDWALK_MAX_PAIRS`: with exact overlap those that it meets, of a box of more
    /// than 32 cells all. Pairs beyond are dropped and reported. The pairs of leaf cells lie behind them; where they do not fit, no cell is
    /// split.
    pub pairs: u32,
    /// Leaf cells of the second level, at most `GRIDWALK_MAX_CELLS`: cells with many triangles are split into 2^3, 4^3, 8^3, 16^3 or
    /// 32^3 of them as long as these fit. 0: a flat grid.
    pub leaf_cells: u32,
}

/// What a region needs.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkRegionSize {
    /// Bytes.
    pub size: VkDeviceSize,
    /// Alignment of the region's device address, bytes.
    pub alignment: VkDeviceSize,
    /// Usage flags of its buffer.
    pub usage: VkBufferUsageFlags,
}

/// What the regions of a build need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkBuildSizes {
    /// The grid itself, triangles included: needed as long as rays are traced.
    pub grid: GridwalkRegionSize,
    /// Needed while a build runs; builds that do not overlap in time may share it.
    pub scratch: GridwalkRegionSize,
    /// A `GridwalkReport`, in memory that the host can read if it wants to.
    pub report: GridwalkRegionSize,
    /// Timestamps that a build writes if asked to: one before its first step and one after each.
    pub timestamp_count: u32,
}

/// One geometry of several in a grid, in device memory: written by the host (`gridwalk_geometry_record_init`) or by a shader of yours. An
/// instance is a record that shares its addresses with others. 128 bytes, no padding, frozen.
///
/// A vertex is the stored position, times `scale`, plus `offset`, then transformed. Addresses of positions and of 32-bit indices, and the
/// stride, are multiples of 4; those of 16-bit indices of 2, and the word of 4 bytes that holds the last of them is read whole.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkGeometryRecord {
    /// Three rows of four: the last column is the translation, as in `VkTransformMatrixKHR`.
    pub transform: [[f32; 4]; 3],
    /// Multiplied to a stored position before the transform.
    pub scale: [f32; 3],
    /// Bytes from a vertex to the next, a multiple of 4.
    pub stride: u32,
    /// Added to a scaled position before the transform.
    pub offset: [f32; 3],
    /// Vertices; a triangle with an index beyond is dropped and counted.
    pub vertex_count: u32,
    /// Device address of the first vertex's position.
    pub positions: VkDeviceAddress,
    /// Device address of the first index; not read with `GRIDWALK_INDEX_NONE`.
    pub indices: VkDeviceAddress,
    /// Device address of a `uint32_t`, a multiple of 4: the number of triangles, if it is less than `triangle_count`. 0: that is the number.
    pub count: VkDeviceAddress,
    /// Triangles, or their bound.
    pub triangle_count: u32,
    /// `GRIDWALK_FORMAT_...`.
    pub format: u32,
    /// `GRIDWALK_INDEX_...`.
    pub index_type: u32,
    /// Any number, which a trace gives back for a hit.
    pub id: u32,
    /// A ray with a mask hits the geometry only if the two share a bit.
    pub mask: u32,
    /// 0, or bits `GRIDWALK_FLAG_...`.
    pub flags: u32,
}

/// Indexed triangles in device memory.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkGeometry {
    /// Three floats a vertex, tightly packed.
    pub positions: GridwalkRegion,
    /// Three `uint32_t` a triangle, tightly packed.
    pub indices: GridwalkRegion,
    /// Vertices in `positions`, at most 2^29; a triangle with an index beyond is dropped.
    pub vertex_count: u32,
    /// Triangles in `indices`.
    pub triangle_count: u32,
}

/// A build of a grid.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkBuildInfo {
    /// `sizeof(GridwalkBuildInfo)`.
    pub struct_size: u32,
    /// `GRIDWALK_OVERLAP_EXACT` (0) or `GRIDWALK_OVERLAP_BOX`.
    pub overlap: u32,
    /// What is built: one mesh. Zeros if `records` are given.
    pub geometry: GridwalkGeometry,
    /// What is built: `GridwalkGeometryRecord`s, the address a multiple of 16. Address 0: the mesh above. Their triangles are numbered one
    /// record after another; those beyond the capacity are left out and reported.
    pub records: GridwalkRegion,
    /// Records, at most `GRIDWALK_MAX_GEOMETRIES` and at most the capacity of triangles. A record without a triangle is allowed.
    pub record_count: u32,
    /// Where the grid goes. Its address names the grid when tracing.
    pub grid: GridwalkRegion,
    /// Memory of the build.
    pub scratch: GridwalkRegion,
    /// Where the `GridwalkReport` goes.
    pub report: GridwalkRegion,
    /// What the regions were sized for.
    pub capacity: GridwalkCapacity,
    /// Cells a triangle; 0: `GRIDWALK_DEFAULT_DENSITY`.
    pub density: f32,
    /// Cells along each axis, instead of the density; three zeros: by the density.
    pub resolution: [u32; 3],
    /// First of the `GridwalkBuildSizes::timestamp_count` queries, which the recording resets.
    pub first_query: u32,
    /// Pool of type `VK_QUERY_TYPE_TIMESTAMP` for the times of the steps, or `VK_NULL_HANDLE`.
    pub timestamp_pool: VkQueryPool,
    /// `VK_TRUE`: the steps of the second level are not recorded, whose launches take time even where no cell is to be split. The grid is
    /// complete and flat, and the report counts the cells and leaf cells that there would be. Steps and timestamps are
    /// those of a capacity without leaf cells.
    pub without_second_level: VkBool32,
}

/// A trace of rays through a grid. What is not for a query is zero.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkTraceInfo {
    /// `sizeof(GridwalkTraceInfo)`.
    pub struct_size: u32,
    /// The number of rays; with an indirect count its bound, and rays beyond are not traced.
    pub ray_count: u32,
    /// `GridwalkRay`s; the address is a multiple of 16.
    pub rays: GridwalkRegion,
    /// Closest and nearest hits: `GridwalkHit`s, the address a multiple of 16. Any hit: a `uint32_t` a ray: 1, 0 or `GRIDWALK_UNFINISHED`.
    /// Count of hits: a `uint32_t` a ray, or `GRIDWALK_UNFINISHED`.
    pub hits: GridwalkRegion,
    /// Memory of the trace: `gridwalk_trace_scratch_size`.
    pub scratch: GridwalkRegion,
    /// Address 0: as many rays as `ray_count`. Otherwise a `uint32_t` there says how many.
    pub indirect_count: GridwalkRegion,
    /// Closest hit only: where each ray's numbers of steps, triangle tests and cells that were not empty are written, as four `uint32_t`;
    /// address 0: nowhere.
    pub counters: GridwalkRegion,
    /// A `uint32_t` a ray: a mask of its own, of which only the bits of `mask` count; address 0: `mask` alone.
    pub masks: GridwalkRegion,
    /// Where the geometry of each hit is written, two `uint32_t` for each: the id of its record, and the triangle's number within it; twice
    /// 0xFFFFFFFF where there is no hit. Of closest hits one a ray, left as it is where `resume` leaves the hit; of any hit one a ray, of the
    /// hit that ended the search; of nearest hits as many a ray as hits. Address 0: nowhere. A count of hits has none.
    pub geometries: GridwalkRegion,
    /// A `uint32_t` a ray: the indices of the rays in the order in which they are traced, as `gridwalk_cmd_sort_rays` makes it; what belongs
    /// to a ray lies at its index as ever. `ray_count` is then the number of indices, which are below the number of rays and differ; the
    /// other regions hold all rays. Address 0: the rays as they are.
    pub order: GridwalkRegion,
    /// Mask of all rays: a geometry is hit only if its mask shares a bit with it. 0: 0xFFFFFFFF, which is also the mask of a mesh without
    /// a record.
    pub mask: u32,
    /// Triangles that are not hit because of the side that the ray sees: `GRIDWALK_CULL_...`.
    pub cull: u32,
    /// Closest hit: `VK_TRUE` to go on from the hits that lie in `hits`, which stay unless a closer one is found. So several grids are
    /// traced one after another. Nearest hits: `VK_TRUE` for those beyond the last hit that lies there. So all hits are had in portions.
    pub resume: VkBool32,
}

/// A sort of rays.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkRaySortInfo {
    /// `sizeof(GridwalkRaySortInfo)`.
    pub struct_size: u32,
    /// The number of rays; with an indirect count its bound.
    pub ray_count: u32,
    /// `GridwalkRay`s; the address is a multiple of 16.
    pub rays: GridwalkRegion,
    /// Where the order goes, a `uint32_t` a ray: for `GridwalkTraceInfo::order`.
    pub order: GridwalkRegion,
    /// Memory of the sort: `gridwalk_ray_sort_scratch_size`. Not needed by the traces that follow, whose scratch it may be.
    pub scratch: GridwalkRegion,
    /// Address 0: as many rays as `ray_count`. Otherwise a `uint32_t` there says how many.
    pub indirect_count: GridwalkRegion,
}

/// A ray in device memory.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkRay {
    /// Where it begins.
    pub origin: [f32; 3],
    /// Least t of a hit.
    pub t_min: f32,
    /// Where it goes: of any length but zero.
    pub direction: [f32; 3],
    /// Greatest t of a hit; infinity is allowed.
    pub t_max: f32,
}

/// A hit in device memory.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkHit {
    /// Distance in lengths of the direction; infinite for a miss.
    pub t: f32,
    /// Weight of the triangle's second vertex.
    pub u: f32,
    /// Weight of the triangle's third vertex.
    pub v: f32,
    /// Index of the triangle, `GRIDWALK_MISS` or `GRIDWALK_UNFINISHED`.
    pub triangle: u32,
}

/// What a build tells of itself, in device memory.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct GridwalkReport {
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
    /// Cells of all triangles, with exact overlap those that each meets, of a box of more than 32 cells all; or pairs of both levels if those are
    /// more and did not fit: the capacity of pairs that the build needed. 0xFFFFFFFF: that many or more, lower the density.
    pub pair_total: u32,
    /// 0, or bits `GRIDWALK_OVERFLOW_PAIRS`, `GRIDWALK_OVERFLOW_CELLS`, `GRIDWALK_OVERFLOW_TRIANGLES` and `GRIDWALK_OVERFLOW_LEAVES`.
    pub overflow: u32,
    /// Bits of the sort's largest key.
    pub key_bits: u32,
    /// Minimum of the scene box.
    pub box_min: [f32; 3],
    /// Density that was used: what was asked for, or less if the cells did not fit.
    pub density: f32,
    /// Maximum of the scene box.
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

/// The library's own types and numbers are the header's.
const _: () = {
    assert!(GRIDWALK_MISS == gridwalk::MISS && GRIDWALK_UNFINISHED == gridwalk::UNFINISHED);
    assert!(GRIDWALK_REGION_ALIGNMENT == gridwalk::REGION_ALIGNMENT);
    assert!(GRIDWALK_MAX_TRIANGLES == gridwalk::MAX_TRIANGLES && GRIDWALK_MAX_CELLS == gridwalk::MAX_CELLS);
    assert!(GRIDWALK_MAX_PAIRS == gridwalk::MAX_PAIRS && GRIDWALK_MAX_RAYS == gridwalk::MAX_RAYS);
    assert!(GRIDWALK_DEFAULT_DENSITY == gridwalk::BuildOptions::DEFAULT_DENSITY);
    assert!(GRIDWALK_OVERFLOW_PAIRS == gridwalk::gridwalk_core::layout::OVERFLOW_PAIRS);
    assert!(GRIDWALK_OVERFLOW_CELLS == gridwalk::gridwalk_core::layout::OVERFLOW_CELLS);
    assert!(GRIDWALK_OVERFLOW_TRIANGLES == gridwalk::gridwalk_core::layout::OVERFLOW_TRIANGLES);
    assert!(GRIDWALK_OVERFLOW_LEAVES == gridwalk::gridwalk_core::layout::OVERFLOW_LEAVES);
    assert!(GRIDWALK_MAX_GEOMETRIES == gridwalk::MAX_GEOMETRIES && GRIDWALK_MAX_NEAREST == gridwalk::MAX_NEAREST);
    use gridwalk::gridwalk_core::geometry as core;
    assert!(GRIDWALK_FORMAT_FLOAT32X3 == core::FORMAT_FLOAT32X3 && GRIDWALK_FORMAT_FLOAT16X4 == core::FORMAT_FLOAT16X4);
    assert!(GRIDWALK_FORMAT_SNORM16X4 == core::FORMAT_SNORM16X4 && GRIDWALK_INDEX_NONE == core::INDEX_NONE);
    assert!(GRIDWALK_INDEX_UINT16 == core::INDEX_UINT16 && GRIDWALK_INDEX_UINT32 == core::INDEX_UINT32);
    assert!(GRIDWALK_FLAG_FLIP_FACING == core::FLAG_FLIP_FACING && GRIDWALK_FLAG_TWO_SIDED == core::FLAG_TWO_SIDED);
    const fn same(access: Access, stages: u64, accesses: u64) -> bool {
        access.stages.as_raw() == stages && access.access.as_raw() == accesses
    }
    assert!(same(Tracer::BUILD, GRIDWALK_BUILD_STAGES, GRIDWALK_BUILD_ACCESS));
    assert!(same(Tracer::TRACE, GRIDWALK_TRACE_STAGES, GRIDWALK_TRACE_ACCESS));
    assert!(same(Access::HOST_READ, GRIDWALK_HOST_READ_STAGES, GRIDWALK_HOST_READ_ACCESS));
    const fn number(text: &str) -> u32 {
        match u32::from_str_radix(text, 10) {
            Ok(number) => number,
            Err(_) => u32::MAX,
        }
    }
    assert!(GRIDWALK_VERSION_MAJOR == number(env!("CARGO_PKG_VERSION_MAJOR")));
    assert!(GRIDWALK_VERSION_MINOR == number(env!("CARGO_PKG_VERSION_MINOR")));
    assert!(GRIDWALK_VERSION_PATCH == number(env!("CARGO_PKG_VERSION_PATCH")));
};

/// Asserts that two structures have the same size and the named fields in the same places.
macro_rules! same_layout {
    ($ours:ty, $theirs:ty, $($field:ident)*) => {
        const _: () = {
            assert!(size_of::<$ours>() == size_of::<$theirs>());
            $(assert!(offset_of!($ours, $field) == offset_of!($theirs, $field));)*
        };
    };
}

same_layout!(GridwalkRay, gridwalk::Ray, origin t_min direction t_max);
same_layout!(GridwalkHit, gridwalk::Hit, t u v triangle);
same_layout!(GridwalkReport, gridwalk::Report,
    triangles dropped cells cells_in_use resolution longest_list pairs pair_total overflow key_bits box_min density box_max triangle_total
    split_cells leaf_cells leaf_pairs reserved);
same_layout!(GridwalkGeometryRecord, gridwalk::GeometryRecord,
    transform scale stride offset vertex_count positions indices count triangle_count format index_type id mask flags);
