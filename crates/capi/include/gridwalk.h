/*
 * gridwalk: builds uniform grids over triangles on a Vulkan device that it is given, and traces rays through them.
 *
 * Made by cbindgen from crates/capi/src: do not edit it.
 *
 * The library records commands into your command buffers, on your device, in your memory. After gridwalk_tracer_create it creates
 * no Vulkan object, and it never allocates device memory, maps, submits or waits. It calls Vulkan only through the
 * vkGetInstanceProcAddr that you pass: it neither links to a Vulkan loader nor opens one.
 *
 * A frame:
 *
 *     gridwalk_cmd_barrier(tracer, cmd, your stages, your accesses, GRIDWALK_BUILD_STAGES, GRIDWALK_BUILD_ACCESS);
 *     gridwalk_cmd_build(tracer, cmd, &build);
 *     gridwalk_cmd_barrier(tracer, cmd, GRIDWALK_BUILD_STAGES, GRIDWALK_BUILD_ACCESS, GRIDWALK_TRACE_STAGES, GRIDWALK_TRACE_ACCESS);
 *     gridwalk_cmd_closest_hit(tracer, cmd, build.grid.address, &trace);
 *
 * DEVICE. Vulkan 1.3: the instance and the device are created for it, with the features that gridwalk_requirements sets. No
 * descriptor sets, no 64-bit integers, no subgroup operations, any subgroup size. The queue needs compute. Ownership of buffers among
 * queue families is yours to transfer.
 *
 * MEMORY. gridwalk_build_sizes turns capacities into bytes, alignment and usage flags of three regions: the grid, which lives as long as
 * rays are traced through it; the scratch, which is needed while a build runs and may be shared by builds that do not overlap in
 * time; the report, a GridwalkReport, which lives until the host has read it, if it wants to. gridwalk_trace_scratch_size does so for the
 * scratch of a trace. Regions do not overlap; they may lie in one buffer. Their contents need no initialization. Buffers and their memory
 * live until the command buffer has been executed.
 *
 * GEOMETRY. The simple case is one mesh: positions are tightly packed float triples, indices tightly packed uint32_t triples. Otherwise a
 * region of GridwalkGeometryRecords, which the host or a shader writes, describes any number of geometries and instances, with formats,
 * strides, transforms, masks, and numbers of triangles that lie in device memory. A triangle with a vertex that is not finite, or with an
 * index beyond the positions, is dropped and counted in the report. Nothing of it is read after the build. What a record's addresses
 * lead to lives until the command buffer has been executed.
 *
 * BARRIERS. You put a memory barrier (gridwalk_cmd_barrier, or one of your own with these masks)
 *   - before a build: from whatever wrote the geometry, and from the trace of the grid's last use, to the build;
 *   - between a build and the traces through its grid: from the build to the trace;
 *   - around a trace: from whatever wrote the rays or an indirect count to the trace, and from the trace to whatever reads the hits;
 *   - between two builds, or two traces, that share a scratch: from and to the same masks;
 *   - before the host reads a report: from the build to GRIDWALK_HOST_READ_STAGES and GRIDWALK_HOST_READ_ACCESS.
 * Barriers within one build or trace are the library's.
 *
 * STATE. A recording binds compute pipelines and sets push constants; what was bound before is lost. Descriptor sets, graphics state and
 * everything else stay. A command buffer may be submitted again after its geometry, rays or counts changed: all numbers are read on
 * the device. Commands are recorded outside of a render pass.
 *
 * RAYS AND HITS. A direction has any length but zero, t counts in its units; hits lie in the closed interval [t_min, t_max]. The hit point
 * is (1 - u - v) a + u b + v c of the triangle's vertices. Both windings are hit; a triangle seen exactly edge-on is not. A miss has triangle
 * GRIDWALK_MISS and an infinite t. Of hits at equal distance the lowest triangle index wins. A ray with a NaN, with an infinite
 * origin or direction, or with a direction of zero misses. No ray passes between two triangles that share an edge. A walk that
 * was given up has triangle GRIDWALK_UNFINISHED: neither a hit nor a miss.
 *
 * OVERFLOW. Pairs (cell, triangle) beyond the capacity are dropped, never written out of bounds, and the report says which capacity
 * would have sufficed: such a grid is sound but misses triangles. A density that asks for more cells than the capacity is lowered and
 * reported: such a grid is complete.
 *
 * ERRORS. Functions return a GridwalkResult; after one that is not GRIDWALK_RESULT_OK, gridwalk_last_error says in words what is wrong, and
 * nothing was recorded, written or left behind. A null pointer is an error unless a parameter says that it may be null; a pointer that is
 * neither null nor valid cannot be told. No call unwinds or ends the process; recording allocates no memory unless it fails.
 *
 * THREADS. All functions may be called on any thread, several at once with the same tracer, as Vulkan allows it for the command
 * buffer: one thread at a time. gridwalk_tracer_destroy is the exception: no other call uses the tracer then.
 *
 * GROWTH. Structures that begin with struct_size may grow at their end: zero them, set struct_size to their sizeof, and leave what you
 * do not know at zero, which is the default of every field. A library that is newer than the header takes the fields that it does
 * not find for zero; one that is older refuses the fields that it does not know unless they are zero. All other structures are as
 * they are within a major version (while it is 0, within a minor version): compare gridwalk_version with GRIDWALK_VERSION_MAJOR and
 * GRIDWALK_VERSION_MINOR if you open the library at run time.
 *
 * LINKING. The shared library is gridwalk_capi (libgridwalk_capi.so, gridwalk_capi.dll, libgridwalk_capi.dylib). The static one needs what
 * Rust's standard library needs: on Linux -lpthread -ldl -lm.
 */


#ifndef GRIDWALK_H
#define GRIDWALK_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

/**
 * Version of this header, to be compared with `gridwalk_version`.
 */
#define GRIDWALK_VERSION_MAJOR 0

/**
 * Version of this header.
 */
#define GRIDWALK_VERSION_MINOR 1

/**
 * Version of this header.
 */
#define GRIDWALK_VERSION_PATCH 0

/**
 * `GridwalkHit::triangle` of a ray that hits nothing.
 */
#define GRIDWALK_MISS 4294967295u

/**
 * `GridwalkHit::triangle`, and any hit's answer, of a ray whose walk was given up: neither a hit nor a miss.
 */
#define GRIDWALK_UNFINISHED 4294967294u

/**
 * Alignment of the device address of grid, scratch and report regions, bytes.
 */
#define GRIDWALK_REGION_ALIGNMENT 64ull

/**
 * Most triangles of a grid.
 */
#define GRIDWALK_MAX_TRIANGLES 67108864u

/**
 * Most cells of a grid.
 */
#define GRIDWALK_MAX_CELLS 268435456u

/**
 * Most pairs of a grid.
 */
#define GRIDWALK_MAX_PAIRS 268435456u

/**
 * Most rays of a trace.
 */
#define GRIDWALK_MAX_RAYS 268435456u

/**
 * Most geometry records of a grid.
 */
#define GRIDWALK_MAX_GEOMETRIES 65536u

/**
 * Most hits a ray that `gridwalk_cmd_nearest_hits` finds at once.
 */
#define GRIDWALK_MAX_NEAREST 64u

/**
 * Density that is used if none is given: cells a triangle.
 */
#define GRIDWALK_DEFAULT_DENSITY 7.0

/**
 * `GridwalkBuildInfo::overlap`: a cell lists the triangles that it overlaps. Fewer tests when tracing, above all with long thin triangles.
 */
#define GRIDWALK_OVERLAP_EXACT 0u

/**
 * `GridwalkBuildInfo::overlap`: a cell lists the triangles whose boxes it overlaps. The faster build, by less than a tenth.
 */
#define GRIDWALK_OVERLAP_BOX 1u

/**
 * `GridwalkTraceInfo::cull`: both sides of triangles are hit.
 */
#define GRIDWALK_CULL_NONE 0u

/**
 * `GridwalkTraceInfo::cull`: only fronts are hit: where the vertices go round counterclockwise, seen along the ray.
 */
#define GRIDWALK_CULL_BACK 1u

/**
 * `GridwalkTraceInfo::cull`: only backs are hit.
 */
#define GRIDWALK_CULL_FRONT 2u

/**
 * `GridwalkGeometryRecord::format`: three floats a vertex.
 */
#define GRIDWALK_FORMAT_FLOAT32X3 0u

/**
 * `GridwalkGeometryRecord::format`: four half floats a vertex, the fourth unused.
 */
#define GRIDWALK_FORMAT_FLOAT16X4 1u

/**
 * `GridwalkGeometryRecord::format`: four normalized `int16_t` a vertex, the fourth unused.
 */
#define GRIDWALK_FORMAT_SNORM16X4 2u

/**
 * `GridwalkGeometryRecord::index_type`: triangle i has the vertices 3 i, 3 i + 1 and 3 i + 2.
 */
#define GRIDWALK_INDEX_NONE 0u

/**
 * `GridwalkGeometryRecord::index_type`: three `uint16_t` a triangle, tightly packed.
 */
#define GRIDWALK_INDEX_UINT16 1u

/**
 * `GridwalkGeometryRecord::index_type`: three `uint32_t` a triangle, tightly packed.
 */
#define GRIDWALK_INDEX_UINT32 2u

/**
 * `GridwalkGeometryRecord::flags`: front and back are exchanged, as by a transform that mirrors.
 */
#define GRIDWALK_FLAG_FLIP_FACING 1u

/**
 * `GridwalkGeometryRecord::flags`: the geometry is never culled.
 */
#define GRIDWALK_FLAG_TWO_SIDED 2u

/**
 * `GridwalkReport::overflow`: pairs were dropped; `GridwalkReport::pair_total` is the capacity that would have sufficed.
 */
#define GRIDWALK_OVERFLOW_PAIRS 1u

/**
 * `GridwalkReport::overflow`: the resolution was lowered to fit the capacity of cells.
 */
#define GRIDWALK_OVERFLOW_CELLS 2u

/**
 * `GridwalkReport::overflow`: triangles beyond the capacity were left out; `GridwalkReport::triangle_total` would have sufficed.
 */
#define GRIDWALK_OVERFLOW_TRIANGLES 4u

/**
 * Of a report's overflow: some cells that were to be split stayed whole; the grid is complete.
 */
#define GRIDWALK_OVERFLOW_LEAVES 8u

/**
 * Pipeline stages of builds in a barrier: `VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT`.
 */
#define GRIDWALK_BUILD_STAGES 2050ull

/**
 * Accesses of builds in a barrier: `VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
 * VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT`.
 */
#define GRIDWALK_BUILD_ACCESS 25769803777ull

/**
 * Pipeline stages of traces in a barrier, of the library's and of compute shaders with the include.
 */
#define GRIDWALK_TRACE_STAGES 2050ull

/**
 * Accesses of traces in a barrier.
 */
#define GRIDWALK_TRACE_ACCESS 25769803777ull

/**
 * Pipeline stage of the host's reads, for reports and hits: `VK_PIPELINE_STAGE_2_HOST_BIT`.
 */
#define GRIDWALK_HOST_READ_STAGES 16384ull

/**
 * Access of the host's reads: `VK_ACCESS_2_HOST_READ_BIT`.
 */
#define GRIDWALK_HOST_READ_ACCESS 8192ull

/**
 * What a function says of how it went.
 */
enum GridwalkResult
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * All is well.
     */
    GRIDWALK_RESULT_OK = 0,
    /**
     * A pointer or a handle is null that must not be.
     */
    GRIDWALK_RESULT_ERROR_NULL = -1,
    /**
     * A structure's `struct_size` or `sType` is wrong, or it has fields that this version of the library does not know.
     */
    GRIDWALK_RESULT_ERROR_STRUCT = -2,
    /**
     * `vkGetInstanceProcAddr` or `vkGetDeviceProcAddr` does not know a function of Vulkan 1.3: the instance or the device is not for it.
     */
    GRIDWALK_RESULT_ERROR_LOADER = -3,
    /**
     * A Vulkan call failed: `gridwalk_last_vk_result`.
     */
    GRIDWALK_RESULT_ERROR_VULKAN = -4,
    /**
     * The physical device lacks what the kernels need; the message names all of it.
     */
    GRIDWALK_RESULT_ERROR_UNSUITABLE = -5,
    /**
     * A capacity or a count is beyond what a grid can hold.
     */
    GRIDWALK_RESULT_ERROR_CAPACITY = -6,
    /**
     * A region needs more memory than the device can give in one buffer: lower the capacity.
     */
    GRIDWALK_RESULT_ERROR_DEVICE_LIMIT = -7,
    /**
     * A region that was passed is too small, not aligned, or has no buffer where one is needed.
     */
    GRIDWALK_RESULT_ERROR_REGION = -8,
    /**
     * An option has no meaning.
     */
    GRIDWALK_RESULT_ERROR_OPTION = -9,
    /**
     * A defect of the library.
     */
    GRIDWALK_RESULT_ERROR_INTERNAL = -10,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum GridwalkResult GridwalkResult;
#else
typedef int32_t GridwalkResult;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Makes the pipelines once, then records builds and traces for one device.
 */
typedef struct GridwalkTracer GridwalkTracer;

/**
 * The device that a tracer records for.
 */
typedef struct GridwalkDeviceDesc {
    /**
     * `sizeof(GridwalkDeviceDesc)`.
     */
    uint32_t struct_size;
    /**
     * `VK_TRUE` if the instance has `VK_EXT_debug_utils` enabled and wants names of pipelines and labels of steps.
     */
    VkBool32 debug_utils;
    /**
     * Through which all other Vulkan functions are found.
     */
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    /**
     * Instance of the device, created for Vulkan 1.3 or later.
     */
    VkInstance instance;
    /**
     * Physical device of the device.
     */
    VkPhysicalDevice physical_device;
    /**
     * Device with the features of `gridwalk_requirements` enabled. It outlives the tracer.
     */
    VkDevice device;
    /**
     * Cache for the pipelines, or `VK_NULL_HANDLE`. Used while the tracer is made.
     */
    VkPipelineCache pipeline_cache;
} GridwalkDeviceDesc;

/**
 * What a build must have room for. Sizes are made from capacities once; builds of any smaller size fit.
 */
typedef struct GridwalkCapacity {
    /**
     * Triangles, at most `GRIDWALK_MAX_TRIANGLES`.
     */
    uint32_t triangles;
    /**
     * Cells of the grid, at most `GRIDWALK_MAX_CELLS`; a build lowers its density to fit.
     */
    uint32_t cells;
    /**
     * Cells of all triangles, counted once a triangle, at most `GRIDWALK_MAX_PAIRS`: with exact overlap those that it meets, of a box of more
     * than 32 cells all. Pairs beyond are dropped and reported. The pairs of leaf cells lie behind them; where they do not fit, no cell is
     * split.
     */
    uint32_t pairs;
    /**
     * Leaf cells of the second level, at most `GRIDWALK_MAX_CELLS`: cells with many triangles are split into 2^3, 4^3, 8^3, 16^3 or
     * 32^3 of them as long as these fit. 0: a flat grid.
     */
    uint32_t leaf_cells;
} GridwalkCapacity;

/**
 * What a region needs.
 */
typedef struct GridwalkRegionSize {
    /**
     * Bytes.
     */
    VkDeviceSize size;
    /**
     * Alignment of the region's device address, bytes.
     */
    VkDeviceSize alignment;
    /**
     * Usage flags of its buffer.
     */
    VkBufferUsageFlags usage;
} GridwalkRegionSize;

/**
 * What the regions of a build need.
 */
typedef struct GridwalkBuildSizes {
    /**
     * The grid itself, triangles included: needed as long as rays are traced.
     */
    struct GridwalkRegionSize grid;
    /**
     * Needed while a build runs; builds that do not overlap in time may share it.
     */
    struct GridwalkRegionSize scratch;
    /**
     * A `GridwalkReport`, in memory that the host can read if it wants to.
     */
    struct GridwalkRegionSize report;
    /**
     * Timestamps that a build writes if asked to: one before its first step and one after each.
     */
    uint32_t timestamp_count;
} GridwalkBuildSizes;

/**
 * One geometry of several in a grid, in device memory: written by the host (`gridwalk_geometry_record_init`) or by a shader of yours. An
 * instance is a record that shares its addresses with others. 128 bytes, no padding, frozen.
 *
 * A vertex is the stored position, times `scale`, plus `offset`, then transformed. Addresses of positions and of 32-bit indices, and the
 * stride, are multiples of 4; those of 16-bit indices of 2, and the word of 4 bytes that holds the last of them is read whole.
 */
typedef struct GridwalkGeometryRecord {
    /**
     * Three rows of four: the last column is the translation, as in `VkTransformMatrixKHR`.
     */
    float transform[3][4];
    /**
     * Multiplied to a stored position before the transform.
     */
    float scale[3];
    /**
     * Bytes from a vertex to the next, a multiple of 4.
     */
    uint32_t stride;
    /**
     * Added to a scaled position before the transform.
     */
    float offset[3];
    /**
     * Vertices; a triangle with an index beyond is dropped and counted.
     */
    uint32_t vertex_count;
    /**
     * Device address of the first vertex's position.
     */
    VkDeviceAddress positions;
    /**
     * Device address of the first index; not read with `GRIDWALK_INDEX_NONE`.
     */
    VkDeviceAddress indices;
    /**
     * Device address of a `uint32_t`, a multiple of 4: the number of triangles, if it is less than `triangle_count`. 0: that is the number.
     */
    VkDeviceAddress count;
    /**
     * Triangles, or their bound.
     */
    uint32_t triangle_count;
    /**
     * `GRIDWALK_FORMAT_...`.
     */
    uint32_t format;
    /**
     * `GRIDWALK_INDEX_...`.
     */
    uint32_t index_type;
    /**
     * Any number, which a trace gives back for a hit.
     */
    uint32_t id;
    /**
     * A ray with a mask hits the geometry only if the two share a bit.
     */
    uint32_t mask;
    /**
     * 0, or bits `GRIDWALK_FLAG_...`.
     */
    uint32_t flags;
} GridwalkGeometryRecord;

/**
 * A piece of a buffer of yours.
 */
typedef struct GridwalkRegion {
    /**
     * The buffer, with usage `VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT`. Needed of scratch regions alone.
     */
    VkBuffer buffer;
    /**
     * First byte of the region in the buffer.
     */
    VkDeviceSize offset;
    /**
     * Bytes.
     */
    VkDeviceSize size;
    /**
     * Device address of the region's first byte.
     */
    VkDeviceAddress address;
} GridwalkRegion;

/**
 * Indexed triangles in device memory.
 */
typedef struct GridwalkGeometry {
    /**
     * Three floats a vertex, tightly packed.
     */
    struct GridwalkRegion positions;
    /**
     * Three `uint32_t` a triangle, tightly packed.
     */
    struct GridwalkRegion indices;
    /**
     * Vertices in `positions`, at most 2^29; a triangle with an index beyond is dropped.
     */
    uint32_t vertex_count;
    /**
     * Triangles in `indices`.
     */
    uint32_t triangle_count;
} GridwalkGeometry;

/**
 * A build of a grid.
 */
typedef struct GridwalkBuildInfo {
    /**
     * `sizeof(GridwalkBuildInfo)`.
     */
    uint32_t struct_size;
    /**
     * `GRIDWALK_OVERLAP_EXACT` (0) or `GRIDWALK_OVERLAP_BOX`.
     */
    uint32_t overlap;
    /**
     * What is built: one mesh. Zeros if `records` are given.
     */
    struct GridwalkGeometry geometry;
    /**
     * What is built: `GridwalkGeometryRecord`s, the address a multiple of 16. Address 0: the mesh above. Their triangles are numbered one
     * record after another; those beyond the capacity are left out and reported.
     */
    struct GridwalkRegion records;
    /**
     * Records, at most `GRIDWALK_MAX_GEOMETRIES` and at most the capacity of triangles. A record without a triangle is allowed.
     */
    uint32_t record_count;
    /**
     * Where the grid goes. Its address names the grid when tracing.
     */
    struct GridwalkRegion grid;
    /**
     * Memory of the build.
     */
    struct GridwalkRegion scratch;
    /**
     * Where the `GridwalkReport` goes.
     */
    struct GridwalkRegion report;
    /**
     * What the regions were sized for.
     */
    struct GridwalkCapacity capacity;
    /**
     * Cells a triangle; 0: `GRIDWALK_DEFAULT_DENSITY`.
     */
    float density;
    /**
     * Cells along each axis, instead of the density; three zeros: by the density.
     */
    uint32_t resolution[3];
    /**
     * First of the `GridwalkBuildSizes::timestamp_count` queries, which the recording resets.
     */
    uint32_t first_query;
    /**
     * Pool of type `VK_QUERY_TYPE_TIMESTAMP` for the times of the steps, or `VK_NULL_HANDLE`.
     */
    VkQueryPool timestamp_pool;
    /**
     * `VK_TRUE`: the steps of the second level are not recorded, whose launches take time even where no cell is to be split. The grid is
     * complete and flat, and the report counts the cells and leaf cells that there would be. Steps and timestamps are
     * those of a capacity without leaf cells.
     */
    VkBool32 without_second_level;
} GridwalkBuildInfo;

/**
 * A trace of rays through a grid. What is not for a query is zero.
 */
typedef struct GridwalkTraceInfo {
    /**
     * `sizeof(GridwalkTraceInfo)`.
     */
    uint32_t struct_size;
    /**
     * The number of rays; with an indirect count its bound, and rays beyond are not traced.
     */
    uint32_t ray_count;
    /**
     * `GridwalkRay`s; the address is a multiple of 16.
     */
    struct GridwalkRegion rays;
    /**
     * Closest and nearest hits: `GridwalkHit`s, the address a multiple of 16. Any hit: a `uint32_t` a ray: 1, 0 or `GRIDWALK_UNFINISHED`.
     * Count of hits: a `uint32_t` a ray, or `GRIDWALK_UNFINISHED`.
     */
    struct GridwalkRegion hits;
    /**
     * Memory of the trace: `gridwalk_trace_scratch_size`.
     */
    struct GridwalkRegion scratch;
    /**
     * Address 0: as many rays as `ray_count`. Otherwise a `uint32_t` there says how many.
     */
    struct GridwalkRegion indirect_count;
    /**
     * Closest hit only: where each ray's numbers of steps, triangle tests and cells that were not empty are written, as four `uint32_t`;
     * address 0: nowhere.
     */
    struct GridwalkRegion counters;
    /**
     * A `uint32_t` a ray: a mask of its own, of which only the bits of `mask` count; address 0: `mask` alone.
     */
    struct GridwalkRegion masks;
    /**
     * Where the geometry of each hit is written, two `uint32_t` for each: the id of its record, and the triangle's number within it; twice
     * 0xFFFFFFFF where there is no hit. Of closest hits one a ray, left as it is where `resume` leaves the hit; of any hit one a ray, of the
     * hit that ended the search; of nearest hits as many a ray as hits. Address 0: nowhere. A count of hits has none.
     */
    struct GridwalkRegion geometries;
    /**
     * A `uint32_t` a ray: the indices of the rays in the order in which they are traced, as `gridwalk_cmd_sort_rays` makes it; what belongs
     * to a ray lies at its index as ever. `ray_count` is then the number of indices, which are below the number of rays and differ; the
     * other regions hold all rays. Address 0: the rays as they are.
     */
    struct GridwalkRegion order;
    /**
     * Mask of all rays: a geometry is hit only if its mask shares a bit with it. 0: 0xFFFFFFFF, which is also the mask of a mesh without
     * a record.
     */
    uint32_t mask;
    /**
     * Triangles that are not hit because of the side that the ray sees: `GRIDWALK_CULL_...`.
     */
    uint32_t cull;
    /**
     * Closest hit: `VK_TRUE` to go on from the hits that lie in `hits`, which stay unless a closer one is found. So several grids are
     * traced one after another. Nearest hits: `VK_TRUE` for those beyond the last hit that lies there. So all hits are had in portions.
     */
    VkBool32 resume;
} GridwalkTraceInfo;

/**
 * A sort of rays.
 */
typedef struct GridwalkRaySortInfo {
    /**
     * `sizeof(GridwalkRaySortInfo)`.
     */
    uint32_t struct_size;
    /**
     * The number of rays; with an indirect count its bound.
     */
    uint32_t ray_count;
    /**
     * `GridwalkRay`s; the address is a multiple of 16.
     */
    struct GridwalkRegion rays;
    /**
     * Where the order goes, a `uint32_t` a ray: for `GridwalkTraceInfo::order`.
     */
    struct GridwalkRegion order;
    /**
     * Memory of the sort: `gridwalk_ray_sort_scratch_size`. Not needed by the traces that follow, whose scratch it may be.
     */
    struct GridwalkRegion scratch;
    /**
     * Address 0: as many rays as `ray_count`. Otherwise a `uint32_t` there says how many.
     */
    struct GridwalkRegion indirect_count;
} GridwalkRaySortInfo;

/**
 * A ray in device memory.
 */
typedef struct GridwalkRay {
    /**
     * Where it begins.
     */
    float origin[3];
    /**
     * Least t of a hit.
     */
    float t_min;
    /**
     * Where it goes: of any length but zero.
     */
    float direction[3];
    /**
     * Greatest t of a hit; infinity is allowed.
     */
    float t_max;
} GridwalkRay;

/**
 * A hit in device memory.
 */
typedef struct GridwalkHit {
    /**
     * Distance in lengths of the direction; infinite for a miss.
     */
    float t;
    /**
     * Weight of the triangle's second vertex.
     */
    float u;
    /**
     * Weight of the triangle's third vertex.
     */
    float v;
    /**
     * Index of the triangle, `GRIDWALK_MISS` or `GRIDWALK_UNFINISHED`.
     */
    uint32_t triangle;
} GridwalkHit;

/**
 * What a build tells of itself, in device memory.
 */
typedef struct GridwalkReport {
    /**
     * Triangles of the grid, dropped ones included.
     */
    uint32_t triangles;
    /**
     * Triangles left out: a vertex is not finite, or an index lies outside of the positions.
     */
    uint32_t dropped;
    /**
     * Cells of the grid.
     */
    uint32_t cells;
    /**
     * Cells with at least one triangle.
     */
    uint32_t cells_in_use;
    /**
     * Cells along each axis.
     */
    uint32_t resolution[3];
    /**
     * Triangles in the fullest cell.
     */
    uint32_t longest_list;
    /**
     * Pairs (cell, triangle) that the grid lists.
     */
    uint32_t pairs;
    /**
     * Cells of all triangles, with exact overlap those that each meets, of a box of more than 32 cells all; or pairs of both levels if those are
     * more and did not fit: the capacity of pairs that the build needed. 0xFFFFFFFF: that many or more, lower the density.
     */
    uint32_t pair_total;
    /**
     * 0, or bits `GRIDWALK_OVERFLOW_PAIRS`, `GRIDWALK_OVERFLOW_CELLS`, `GRIDWALK_OVERFLOW_TRIANGLES` and `GRIDWALK_OVERFLOW_LEAVES`.
     */
    uint32_t overflow;
    /**
     * Bits of the sort's largest key.
     */
    uint32_t key_bits;
    /**
     * Minimum of the scene box.
     */
    float box_min[3];
    /**
     * Density that was used: what was asked for, or less if the cells did not fit.
     */
    float density;
    /**
     * Maximum of the scene box.
     */
    float box_max[3];
    /**
     * Triangles of all geometries: the capacity of triangles that the build needed. 0xFFFFFFFF: that many or more.
     */
    uint32_t triangle_total;
    /**
     * Cells with so many triangles that they were to be split into leaf cells.
     */
    uint32_t split_cells;
    /**
     * Leaf cells that they asked for: the capacity of leaf cells that the build needed. 0xFFFFFFFF: that many or more.
     */
    uint32_t leaf_cells;
    /**
     * Pairs (leaf cell, triangle) that the grid lists beside `pairs`.
     */
    uint32_t leaf_pairs;
    /**
     * Zero.
     */
    uint32_t reserved;
} GridwalkReport;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Version of the library, as `VK_MAKE_API_VERSION(0, major, minor, patch)`.
 */
uint32_t gridwalk_version(void);

/**
 * Says in words, in English and UTF-8, what was wrong with the last call on this thread that failed; an empty text if none has. Calls that
 * succeed leave it. The text lies in memory of the thread: it is good until the next call that fails, or the thread's end.
 */
const char *gridwalk_last_error(void);

/**
 * What Vulkan said if the last call on this thread that failed did so with `GRIDWALK_RESULT_ERROR_VULKAN`; otherwise `VK_SUCCESS`.
 */
VkResult gridwalk_last_vk_result(void);

/**
 * The text of the GLSL include, which traces from your own shader: pass it the address of a grid region. Its head documents it. The
 * text is constant, and good as long as the library is loaded.
 */
const char *gridwalk_glsl(void);

/**
 * The same in Slang, to be compiled with `-fp-mode precise`.
 */
const char *gridwalk_slang(void);

/**
 * Looks at a physical device before a device is made of it, and enables the features that the library needs.
 *
 * `features` is null or the first structure of a chain by `pNext`, which you then pass to `vkCreateDevice`. It holds a
 * `VkPhysicalDeviceVulkan12Features` and a `VkPhysicalDeviceVulkan13Features`, or the structures of single features,
 * `VkPhysicalDeviceBufferDeviceAddressFeatures` and `VkPhysicalDeviceSynchronization2Features`: the features that the library needs become
 * `VK_TRUE` in them, all others stay as they are. They do so even if the device lacks them.
 *
 * Returns `GRIDWALK_RESULT_ERROR_UNSUITABLE` if the device cannot serve; then `gridwalk_last_error` names all that it lacks, separated by
 * semicolons.
 *
 * # Safety
 * The function and the handles are valid, and of each other. The chain ends, and its structures are as their `sType` says.
 */
GridwalkResult gridwalk_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                     VkInstance instance,
                                     VkPhysicalDevice physical_device,
                                     void *features);

/**
 * Makes a tracer: all pipelines, and nothing else. It takes from milliseconds to seconds, by the driver and the cache. After a failure
 * `*tracer` is null.
 *
 * # Safety
 * The function and the handles are valid, and of each other; the device has the features of `gridwalk_requirements` enabled and outlives
 * the tracer. `desc` has `struct_size` bytes, `tracer` can be written.
 */
GridwalkResult gridwalk_tracer_create(const struct GridwalkDeviceDesc *desc,
                                      struct GridwalkTracer **tracer);

/**
 * Destroys a tracer and its pipelines; null is allowed.
 *
 * # Safety
 * The tracer was made by `gridwalk_tracer_create` and is not used again. All work recorded with it has ended, and its device is still alive.
 */
void gridwalk_tracer_destroy(struct GridwalkTracer *tracer);

/**
 * Tells what the regions of a build need.
 *
 * # Safety
 * The tracer is alive; `capacity` can be read and `sizes` written.
 */
GridwalkResult gridwalk_build_sizes(const struct GridwalkTracer *tracer,
                                    const struct GridwalkCapacity *capacity,
                                    struct GridwalkBuildSizes *sizes);

/**
 * Tells what the scratch of a trace of at most so many rays needs.
 *
 * # Safety
 * The tracer is alive; `size` can be written.
 */
GridwalkResult gridwalk_trace_scratch_size(const struct GridwalkTracer *tracer,
                                           uint32_t max_rays,
                                           struct GridwalkRegionSize *size);

/**
 * Tells what the scratch of a sort of at most so many rays needs.
 *
 * # Safety
 * The tracer is alive; `size` can be written.
 */
GridwalkResult gridwalk_ray_sort_scratch_size(const struct GridwalkTracer *tracer,
                                              uint32_t max_rays,
                                              struct GridwalkRegionSize *size);

/**
 * Writes the name of a build's step: of the one between timestamps `step` and `step + 1`. `name` has room for `name_size` bytes; a name that is
 * longer is cut. No name has more than 63.
 *
 * # Safety
 * The tracer is alive; `capacity` can be read, and `name_size` bytes at `name` written.
 */
GridwalkResult gridwalk_build_step_name(const struct GridwalkTracer *tracer,
                                        const struct GridwalkCapacity *capacity,
                                        uint32_t step,
                                        char *name,
                                        size_t name_size);

/**
 * Sets a geometry record to one without triangles: tightly packed float positions, 32-bit indices, nothing transformed, hit by every mask.
 *
 * # Safety
 * `record` can be written.
 */
GridwalkResult gridwalk_geometry_record_init(struct GridwalkGeometryRecord *record);

/**
 * Records a global memory barrier with `vkCmdPipelineBarrier2`: a convenience.
 *
 * # Safety
 * The tracer is alive; the command buffer is of its device, in the recording state, and outside of a render pass.
 */
GridwalkResult gridwalk_cmd_barrier(const struct GridwalkTracer *tracer,
                                    VkCommandBuffer command_buffer,
                                    VkPipelineStageFlags2 src_stages,
                                    VkAccessFlags2 src_access,
                                    VkPipelineStageFlags2 dst_stages,
                                    VkAccessFlags2 dst_access);

/**
 * Records a build of a grid from nothing.
 *
 * # Safety
 * The tracer is alive, and `info` has `struct_size` bytes. The command buffer is of the tracer's device, in the recording state, outside of a
 * render pass, and for a queue with compute. The regions are of that device, do not overlap, and live until the command buffer has been
 * executed; the scratch's buffer has the usage flags that `gridwalk_build_sizes` names. With timestamps: the queue has them, and the pool
 * holds enough queries from the first on.
 */
GridwalkResult gridwalk_cmd_build(const struct GridwalkTracer *tracer,
                                  VkCommandBuffer command_buffer,
                                  const struct GridwalkBuildInfo *info);

/**
 * Records a search for the closest hit of each ray in the grid at `grid`: the address of the region that it was built in.
 *
 * # Safety
 * As for `gridwalk_cmd_build`; and `grid` holds a grid when the commands are executed, while no build writes it.
 */
GridwalkResult gridwalk_cmd_closest_hit(const struct GridwalkTracer *tracer,
                                        VkCommandBuffer command_buffer,
                                        VkDeviceAddress grid,
                                        const struct GridwalkTraceInfo *info);

/**
 * Records a search for whether each ray hits anything in the grid at `grid`.
 *
 * # Safety
 * As for `gridwalk_cmd_closest_hit`.
 */
GridwalkResult gridwalk_cmd_any_hit(const struct GridwalkTracer *tracer,
                                    VkCommandBuffer command_buffer,
                                    VkDeviceAddress grid,
                                    const struct GridwalkTraceInfo *info);

/**
 * Records a count of the triangles that each ray hits in its interval, in the grid at `grid`.
 *
 * # Safety
 * As for `gridwalk_cmd_closest_hit`.
 */
GridwalkResult gridwalk_cmd_count_hits(const struct GridwalkTracer *tracer,
                                       VkCommandBuffer command_buffer,
                                       VkDeviceAddress grid,
                                       const struct GridwalkTraceInfo *info);

/**
 * Records a search for the `nearest` nearest hits of each ray in the grid at `grid`, at most `GRIDWALK_MAX_NEAREST`: as many `GridwalkHit`s a
 * ray one after another, in order of distance and of equal ones in order of triangle, then misses. Where a walk was given up, the rest is
 * `GRIDWALK_UNFINISHED`. Rays times `nearest` is at most `GRIDWALK_MAX_RAYS`.
 *
 * # Safety
 * As for `gridwalk_cmd_closest_hit`; and with `resume` the hits are of this grid and of these rays.
 */
GridwalkResult gridwalk_cmd_nearest_hits(const struct GridwalkTracer *tracer,
                                         VkCommandBuffer command_buffer,
                                         VkDeviceAddress grid,
                                         const struct GridwalkTraceInfo *info,
                                         uint32_t nearest);

/**
 * Records a sort of rays: makes the order in which rays whose walks through the grid at `grid` begin in the same part of it and in the same
 * direction follow one another, for `GridwalkTraceInfo::order`. It pays for many rays of which neighbours go different ways. Put a barrier
 * between it and the traces, as behind a trace.
 *
 * # Safety
 * As for `gridwalk_cmd_closest_hit`.
 */
GridwalkResult gridwalk_cmd_sort_rays(const struct GridwalkTracer *tracer,
                                      VkCommandBuffer command_buffer,
                                      VkDeviceAddress grid,
                                      const struct GridwalkRaySortInfo *info);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* GRIDWALK_H */
