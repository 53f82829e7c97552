//! The functions of the C interface.

use std::ffi::{c_char, c_void};
use std::fmt::Write;

use gridwalk::ash::vk::{
    self, AccessFlags2 as VkAccessFlags2, CommandBuffer as VkCommandBuffer, DeviceAddress as VkDeviceAddress, Instance as VkInstance,
    PhysicalDevice as VkPhysicalDevice, PipelineStageFlags2 as VkPipelineStageFlags2, Result as VkResult,
};
use gridwalk::{
    Access, BuildInfo, BuildOptions, Capacity, Cull, DeviceDesc, GRIDWALK_GLSL, GRIDWALK_SLANG, Geometry, GeometryRecord, Input, Overlap,
    RayCount, RaySortInfo, Records, Region, RegionSize, Timestamps, TraceInfo, Tracer, cmd_barrier, requirements,
};

use crate::error::{self, Failure, Result, Text, guard};
use crate::input::{read_growing, reference, write};
use crate::load;
use crate::types::{
    GRIDWALK_CULL_BACK, GRIDWALK_CULL_FRONT, GRIDWALK_CULL_NONE, GRIDWALK_OVERLAP_BOX, GRIDWALK_OVERLAP_EXACT, GRIDWALK_VERSION_MAJOR,
    GRIDWALK_VERSION_MINOR, GRIDWALK_VERSION_PATCH, GridwalkBuildInfo, GridwalkBuildSizes, GridwalkCapacity, GridwalkDeviceDesc,
    GridwalkGeometryRecord, GridwalkRaySortInfo, GridwalkRegion, GridwalkRegionSize, GridwalkResult, GridwalkTraceInfo, GridwalkTracer,
    PFN_vkGetInstanceProcAddr,
};

/// Version of the library, as `VK_MAKE_API_VERSION(0, major, minor, patch)`.
#[unsafe(no_mangle)]
pub extern "C" fn gridwalk_version() -> u32 {
    vk::make_api_version(0, GRIDWALK_VERSION_MAJOR, GRIDWALK_VERSION_MINOR, GRIDWALK_VERSION_PATCH)
}

/// Says in words, in English and UTF-8, what was wrong with the last call on this thread that failed; an empty text if none has. Calls that
/// succeed leave it. The text lies in memory of the thread: it is good until the next call that fails, or the thread's end.
#[unsafe(no_mangle)]
pub extern "C" fn gridwalk_last_error() -> *const c_char {
    error::last_message()
}

/// What Vulkan said if the last call on this thread that failed did so with `GRIDWALK_RESULT_ERROR_VULKAN`; otherwise `VK_SUCCESS`.
#[unsafe(no_mangle)]
pub extern "C" fn gridwalk_last_vk_result() -> VkResult {
    error::last_vk_result()
}

/// A text, and the zero byte that C wants.
const fn ended<const SIZE: usize>(text: &str) -> [u8; SIZE] {
    let mut bytes = [0; SIZE];
    let mut i = 0;
    while i < text.len() {
        bytes[i] = text.as_bytes()[i];
        i += 1;
    }
    bytes
}

static GLSL: [u8; GRIDWALK_GLSL.len() + 1] = ended(GRIDWALK_GLSL);
static SLANG: [u8; GRIDWALK_SLANG.len() + 1] = ended(GRIDWALK_SLANG);

/// The text of the GLSL include, which traces from your own shader: pass it the address of a grid region. Its head documents it. The
/// text is constant, and good as long as the library is loaded.
#[unsafe(no_mangle)]
pub extern "C" fn gridwalk_glsl() -> *const c_char {
    GLSL.as_ptr().cast()
}

/// The same in Slang, to be compiled with `-fp-mode precise`.
#[unsafe(no_mangle)]
pub extern "C" fn gridwalk_slang() -> *const c_char {
    SLANG.as_ptr().cast()
}

/// Looks at a physical device before a device is made of it, and enables the features that the library needs.
///
/// `features` is null or the first structure of a chain by `pNext`, which you then pass to `vkCreateDevice`. It holds a
/// `VkPhysicalDeviceVulkan12Features` and a `VkPhysicalDeviceVulkan13Features`, or the structures of single features,
/// `VkPhysicalDeviceBufferDeviceAddressFeatures` and `VkPhysicalDeviceSynchronization2Features`: the features that the library needs become
/// `VK_TRUE` in them, all others stay as they are. They do so even if the device lacks them.
///
/// Returns `GRIDWALK_RESULT_ERROR_UNSUITABLE` if the device cannot serve; then `gridwalk_last_error` names all that it lacks, separated by
/// semicolons.
///
/// # Safety
/// The function and the handles are valid, and of each other. The chain ends, and its structures are as their `sType` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_requirements(
    get_instance_proc_addr: PFN_vkGetInstanceProcAddr,
    instance: VkInstance,
    physical_device: VkPhysicalDevice,
    features: *mut c_void,
) -> GridwalkResult {
    guard(|| {
        if !features.is_null() {
            // SAFETY: the caller's contract.
            unsafe { requirements::fill(features)? };
        }
        // SAFETY: the caller's contract.
        let instance = unsafe { load::instance(get_instance_proc_addr, instance)? };
        if physical_device == VkPhysicalDevice::null() {
            return Err(Failure::Null("physical_device"));
        }
        // SAFETY: the caller's contract.
        let missing = unsafe { requirements::query(&instance, physical_device) }.missing;
        if missing.is_empty() { Ok(()) } else { Err(gridwalk::Error::Unsuitable { missing }.into()) }
    })
}

/// Makes a tracer: all pipelines, and nothing else. It takes from milliseconds to seconds, by the driver and the cache. After a failure
/// `*tracer` is null.
///
/// # Safety
/// The function and the handles are valid, and of each other; the device has the features of `gridwalk_requirements` enabled and outlives
/// the tracer. `desc` has `struct_size` bytes, `tracer` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_tracer_create(desc: *const GridwalkDeviceDesc, tracer: *mut *mut GridwalkTracer) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe {
            write(tracer, "tracer", std::ptr::null_mut())?;
            let desc = read_growing(desc)?;
            let instance = load::instance(desc.get_instance_proc_addr, desc.instance)?;
            if desc.physical_device == VkPhysicalDevice::null() {
                return Err(Failure::Null("physical_device"));
            }
            let device = load::device(&instance, desc.device)?;
            let debug_utils = if desc.debug_utils == vk::FALSE { None } else { Some(load::debug_utils(&instance, &device)?) };
            let made = Tracer::new(&DeviceDesc {
                instance: &instance,
                physical_device: desc.physical_device,
                device: &device,
                pipeline_cache: desc.pipeline_cache,
                shape: None,
                debug_utils: debug_utils.as_ref(),
            })?;
            write(tracer, "tracer", Box::into_raw(Box::new(GridwalkTracer { tracer: made })))
        }
    })
}

/// Destroys a tracer and its pipelines; null is allowed.
///
/// # Safety
/// The tracer was made by `gridwalk_tracer_create` and is not used again. All work recorded with it has ended, and its device is still alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_tracer_destroy(tracer: *mut GridwalkTracer) {
    guard(|| {
        if !tracer.is_null() {
            // SAFETY: the caller's contract.
            drop(unsafe { Box::from_raw(tracer) });
        }
        Ok(())
    });
}

/// Tells what the regions of a build need.
///
/// # Safety
/// The tracer is alive; `capacity` can be read and `sizes` written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_build_sizes(
    tracer: *const GridwalkTracer,
    capacity: *const GridwalkCapacity,
    sizes: *mut GridwalkBuildSizes,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let (tracer, capacity) = unsafe { (reference(tracer, "tracer")?, reference(capacity, "capacity")?) };
        let found = tracer.tracer.build_sizes(&capacity.into())?;
        let value = GridwalkBuildSizes {
            grid: found.grid.into(),
            scratch: found.scratch.into(),
            report: found.report.into(),
            timestamp_count: found.timestamp_count,
        };
        // SAFETY: the caller's contract.
        unsafe { write(sizes, "sizes", value) }
    })
}

/// Tells what the scratch of a trace of at most so many rays needs.
///
/// # Safety
/// The tracer is alive; `size` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_trace_scratch_size(
    tracer: *const GridwalkTracer,
    max_rays: u32,
    size: *mut GridwalkRegionSize,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let tracer = unsafe { reference(tracer, "tracer")? };
        let found = tracer.tracer.trace_scratch_size(max_rays)?;
        // SAFETY: the caller's contract.
        unsafe { write(size, "size", found.into()) }
    })
}

/// Tells what the scratch of a sort of at most so many rays needs.
///
/// # Safety
/// The tracer is alive; `size` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_ray_sort_scratch_size(
    tracer: *const GridwalkTracer,
    max_rays: u32,
    size: *mut GridwalkRegionSize,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let tracer = unsafe { reference(tracer, "tracer")? };
        let found = tracer.tracer.ray_sort_scratch_size(max_rays)?;
        // SAFETY: the caller's contract.
        unsafe { write(size, "size", found.into()) }
    })
}

/// Writes the name of a build's step: of the one between timestamps `step` and `step + 1`. `name` has room for `name_size` bytes; a name that is
/// longer is cut. No name has more than 63.
///
/// # Safety
/// The tracer is alive; `capacity` can be read, and `name_size` bytes at `name` written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_build_step_name(
    tracer: *const GridwalkTracer,
    capacity: *const GridwalkCapacity,
    step: u32,
    name: *mut c_char,
    name_size: usize,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let (tracer, capacity) = unsafe { (reference(tracer, "tracer")?, reference(capacity, "capacity")?) };
        if name.is_null() {
            return Err(Failure::Null("name"));
        }
        let capacity: Capacity = capacity.into();
        // Plans are made for capacities that were checked.
        tracer.tracer.build_sizes(&capacity)?;
        let steps = tracer.tracer.build_steps(&capacity);
        let Some(kernel) = steps.get(step as usize) else {
            return Err(Failure::Option(format!("step = {step}: there are {}", steps.len())));
        };
        // SAFETY: the caller's contract; bytes that C may have left unset are written before they are read.
        let room = unsafe {
            name.write_bytes(0, name_size);
            std::slice::from_raw_parts_mut(name.cast::<u8>(), name_size)
        };
        // A name that does not fit is cut.
        let _ = Text::new(room).write_str(kernel.name);
        Ok(())
    })
}

/// Sets a geometry record to one without triangles: tightly packed float positions, 32-bit indices, nothing transformed, hit by every mask.
///
/// # Safety
/// `record` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_geometry_record_init(record: *mut GridwalkGeometryRecord) -> GridwalkResult {
    // SAFETY: the caller's contract; the two types have one layout, asserted where ours is defined.
    guard(|| unsafe { write(record.cast::<GeometryRecord>(), "record", GeometryRecord::default()) })
}

/// Records a global memory barrier with `vkCmdPipelineBarrier2`: a convenience.
///
/// # Safety
/// The tracer is alive; the command buffer is of its device, in the recording state, and outside of a render pass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_cmd_barrier(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    src_stages: VkPipelineStageFlags2,
    src_access: VkAccessFlags2,
    dst_stages: VkPipelineStageFlags2,
    dst_access: VkAccessFlags2,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let tracer = unsafe { recorder(tracer, command_buffer)? };
        let before = Access { stages: src_stages, access: src_access };
        let after = Access { stages: dst_stages, access: dst_access };
        // SAFETY: the caller's contract.
        unsafe { cmd_barrier(tracer.device(), command_buffer, before, after) };
        Ok(())
    })
}

/// Records a build of a grid from nothing.
///
/// # Safety
/// The tracer is alive, and `info` has `struct_size` bytes. The command buffer is of the tracer's device, in the recording state, outside of a
/// render pass, and for a queue with compute. The regions are of that device, do not overlap, and live until the command buffer has been
/// executed; the scratch's buffer has the usage flags that `gridwalk_build_sizes` names. With timestamps: the queue has them, and the pool
/// holds enough queries from the first on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_cmd_build(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    info: *const GridwalkBuildInfo,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let (tracer, info) = unsafe { (recorder(tracer, command_buffer)?, read_growing(info)?) };
        let (grid, scratch, report) = (info.grid.into(), info.scratch.into(), info.report.into());
        let build = BuildInfo {
            options: build_options(&info)?,
            second_level: info.without_second_level == vk::FALSE,
            timestamps: (info.timestamp_pool != vk::QueryPool::null())
                .then_some(Timestamps { pool: info.timestamp_pool, first_query: info.first_query }),
            ..BuildInfo::new(input(&info)?, grid, scratch, report, (&info.capacity).into())
        };
        // SAFETY: the caller's contract.
        unsafe { tracer.cmd_build(command_buffer, &build)? };
        Ok(())
    })
}

/// Records a search for the closest hit of each ray in the grid at `grid`: the address of the region that it was built in.
///
/// # Safety
/// As for `gridwalk_cmd_build`; and `grid` holds a grid when the commands are executed, while no build writes it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_cmd_closest_hit(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    grid: VkDeviceAddress,
    info: *const GridwalkTraceInfo,
) -> GridwalkResult {
    // SAFETY: the caller's contract.
    unsafe { trace(tracer, command_buffer, info, |tracer, info| tracer.cmd_closest_hit(command_buffer, grid, info)) }
}

/// Records a search for whether each ray hits anything in the grid at `grid`.
///
/// # Safety
/// As for `gridwalk_cmd_closest_hit`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_cmd_any_hit(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    grid: VkDeviceAddress,
    info: *const GridwalkTraceInfo,
) -> GridwalkResult {
    // SAFETY: the caller's contract.
    unsafe { trace(tracer, command_buffer, info, |tracer, info| tracer.cmd_any_hit(command_buffer, grid, info)) }
}

/// Records a count of the triangles that each ray hits in its interval, in the grid at `grid`.
///
/// # Safety
/// As for `gridwalk_cmd_closest_hit`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_cmd_count_hits(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    grid: VkDeviceAddress,
    info: *const GridwalkTraceInfo,
) -> GridwalkResult {
    // SAFETY: the caller's contract.
    unsafe { trace(tracer, command_buffer, info, |tracer, info| tracer.cmd_count_hits(command_buffer, grid, info)) }
}

/// Records a search for the `nearest` nearest hits of each ray in the grid at `grid`, at most `GRIDWALK_MAX_NEAREST`: as many `GridwalkHit`s a
/// ray one after another, in order of distance and of equal ones in order of triangle, then misses. Where a walk was given up, the rest is
/// `GRIDWALK_UNFINISHED`. Rays times `nearest` is at most `GRIDWALK_MAX_RAYS`.
///
/// # Safety
/// As for `gridwalk_cmd_closest_hit`; and with `resume` the hits are of this grid and of these rays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_cmd_nearest_hits(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    grid: VkDeviceAddress,
    info: *const GridwalkTraceInfo,
    nearest: u32,
) -> GridwalkResult {
    // SAFETY: the caller's contract.
    unsafe { trace(tracer, command_buffer, info, |tracer, info| tracer.cmd_nearest_hits(command_buffer, grid, info, nearest)) }
}

/// Records a sort of rays: makes the order in which rays whose walks through the grid at `grid` begin in the same part of it and in the same
/// direction follow one another, for `GridwalkTraceInfo::order`. It pays for many rays of which neighbours go different ways. Put a barrier
/// between it and the traces, as behind a trace.
///
/// # Safety
/// As for `gridwalk_cmd_closest_hit`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gridwalk_cmd_sort_rays(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    grid: VkDeviceAddress,
    info: *const GridwalkRaySortInfo,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let (tracer, info) = unsafe { (recorder(tracer, command_buffer)?, read_growing(info)?) };
        let count = ray_count(info.ray_count, &info.indirect_count);
        let sort = RaySortInfo::new(info.rays.into(), count, info.order.into(), info.scratch.into());
        // SAFETY: the caller's contract.
        unsafe { tracer.cmd_sort_rays(command_buffer, grid, &sort)? };
        Ok(())
    })
}

/// Records a trace by one of the library's functions.
///
/// # Safety
/// As for `gridwalk_cmd_closest_hit`.
unsafe fn trace(
    tracer: *const GridwalkTracer,
    command_buffer: VkCommandBuffer,
    info: *const GridwalkTraceInfo,
    record: impl FnOnce(&Tracer, &TraceInfo) -> gridwalk::Result<()>,
) -> GridwalkResult {
    guard(|| {
        // SAFETY: the caller's contract.
        let (tracer, info) = unsafe { (recorder(tracer, command_buffer)?, read_growing(info)?) };
        Ok(record(tracer, &trace_info(&info)?)?)
    })
}

/// # Safety
/// The tracer is null or alive.
unsafe fn recorder<'a>(tracer: *const GridwalkTracer, command_buffer: VkCommandBuffer) -> Result<&'a Tracer> {
    // SAFETY: the caller's contract.
    let tracer = unsafe { reference(tracer, "tracer")? };
    if command_buffer == VkCommandBuffer::null() {
        return Err(Failure::Null("command_buffer"));
    }
    Ok(&tracer.tracer)
}

fn input(info: &GridwalkBuildInfo) -> Result<Input> {
    let mesh = &info.geometry;
    if info.records.address == 0 && info.record_count == 0 {
        return Ok(Input::Mesh(Geometry {
            positions: mesh.positions.into(),
            vertex_count: mesh.vertex_count,
            indices: mesh.indices.into(),
            triangle_count: mesh.triangle_count,
        }));
    }
    if mesh.triangle_count != 0 {
        return Err(Failure::Option(format!("geometry.triangle_count = {}: 0 where records are given", mesh.triangle_count)));
    }
    Ok(Input::Records(Records { records: info.records.into(), count: info.record_count }))
}

fn build_options(info: &GridwalkBuildInfo) -> Result<BuildOptions> {
    Ok(BuildOptions {
        density: if info.density == 0.0 { BuildOptions::DEFAULT_DENSITY } else { info.density },
        resolution: (info.resolution != [0; 3]).then_some(info.resolution),
        overlap: match info.overlap {
            GRIDWALK_OVERLAP_EXACT => Overlap::Exact,
            GRIDWALK_OVERLAP_BOX => Overlap::Box,
            other => return Err(Failure::Option(format!("overlap = {other}: 0 (exact) or 1 (box)"))),
        },
    })
}

fn ray_count(count: u32, indirect: &GridwalkRegion) -> RayCount {
    match indirect.address {
        0 => RayCount::Direct(count),
        _ => RayCount::Indirect { count: (*indirect).into(), max: count },
    }
}

fn trace_info(info: &GridwalkTraceInfo) -> Result<TraceInfo> {
    let count = ray_count(info.ray_count, &info.indirect_count);
    let optional = |given: GridwalkRegion| (given.address != 0).then(|| given.into());
    let (rays, hits, scratch) = (info.rays.into(), info.hits.into(), info.scratch.into());
    Ok(TraceInfo {
        resume: info.resume != vk::FALSE,
        counters: optional(info.counters),
        mask: if info.mask == 0 { u32::MAX } else { info.mask },
        masks: optional(info.masks),
        cull: match info.cull {
            GRIDWALK_CULL_NONE => Cull::None,
            GRIDWALK_CULL_BACK => Cull::Back,
            GRIDWALK_CULL_FRONT => Cull::Front,
            other => return Err(Failure::Option(format!("cull = {other}: 0 (none), 1 (back) or 2 (front)"))),
        },
        geometries: optional(info.geometries),
        order: optional(info.order),
        ..TraceInfo::new(rays, hits, count, scratch)
    })
}

impl From<GridwalkRegion> for Region {
    fn from(region: GridwalkRegion) -> Region {
        let GridwalkRegion { buffer, offset, size, address } = region;
        Region { buffer, offset, size, address }
    }
}

impl From<&GridwalkCapacity> for Capacity {
    fn from(capacity: &GridwalkCapacity) -> Capacity {
        let GridwalkCapacity { triangles, cells, pairs, leaf_cells } = *capacity;
        Capacity { triangles, cells, pairs, leaf_cells }
    }
}

impl From<RegionSize> for GridwalkRegionSize {
    fn from(size: RegionSize) -> GridwalkRegionSize {
        GridwalkRegionSize { size: size.size, alignment: size.alignment, usage: size.usage }
    }
}
