//! Recording on a device that is none: its functions count that they were called. So nothing but this crate and the library can
//! allocate, and what reaches a command buffer is known.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::{CStr, c_char};
use std::mem::{MaybeUninit, transmute};

use gridwalk::ash::vk::{self, Handle};

use crate::error::last_message;
use crate::functions::*;
use crate::types::*;

/// Counts what a thread allocates.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u32> = const { Cell::new(0) };
    /// Commands that were recorded on this thread.
    static COMMANDS: Cell<u32> = const { Cell::new(0) };
    /// The function that this thread's Vulkan does not know.
    static UNKNOWN: Cell<&'static CStr> = const { Cell::new(c"") };
}

// SAFETY: the system's allocator does the work.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A function of Vulkan that records a command, or makes or destroys something, and does nothing.
macro_rules! nothing {
    ($commands:expr, $result:expr, ($($argument:ty),*) -> $output:ty) => {{
        unsafe extern "system" fn nothing($(_: $argument),*) -> $output {
            COMMANDS.set(COMMANDS.get() + $commands);
            $result
        }
        nothing as *const ()
    }};
}

unsafe extern "system" fn properties(_: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceProperties) {
    let limits = vk::PhysicalDeviceLimits::default()
        .max_compute_work_group_invocations(1024)
        .max_compute_work_group_size([1024; 3])
        .max_compute_shared_memory_size(1 << 16)
        .max_compute_work_group_count([65_535; 3]);
    // SAFETY: Vulkan's contract.
    unsafe { *found = vk::PhysicalDeviceProperties::default().api_version(vk::API_VERSION_1_3).limits(limits) };
}

unsafe extern "system" fn properties_2(_: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceProperties2) {
    // SAFETY: Vulkan's contract, here and below: a chain is made of structures of these types, and ends.
    let mut next = unsafe { (*found).p_next }.cast::<vk::BaseOutStructure>();
    while !next.is_null() {
        // SAFETY: as above.
        unsafe {
            match (*next).s_type {
                vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES => {
                    (*next.cast::<vk::PhysicalDeviceVulkan11Properties>()).max_memory_allocation_size = 1 << 32;
                }
                vk::StructureType::PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES => {
                    (*next.cast::<vk::PhysicalDeviceMaintenance4Properties>()).max_buffer_size = 1 << 32;
                }
                _ => {}
            }
            next = (*next).p_next;
        }
    }
}

unsafe extern "system" fn features_2(_: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceFeatures2) {
    // SAFETY: as above.
    let mut next = unsafe { (*found).p_next }.cast::<vk::BaseOutStructure>();
    while !next.is_null() {
        // SAFETY: as above.
        unsafe {
            match (*next).s_type {
                vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_2_FEATURES => {
                    (*next.cast::<vk::PhysicalDeviceVulkan12Features>()).buffer_device_address = vk::TRUE;
                }
                vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_3_FEATURES => {
                    (*next.cast::<vk::PhysicalDeviceVulkan13Features>()).synchronization2 = vk::TRUE;
                }
                _ => {}
            }
            next = (*next).p_next;
        }
    }
}

/// No test calls it.
unsafe extern "system" fn other() {
    std::process::abort();
}

unsafe extern "system" fn device_function(_: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: Vulkan's contract.
    let name = unsafe { CStr::from_ptr(name) };
    if name == UNKNOWN.get() {
        return None;
    }
    type Callbacks = *const vk::AllocationCallbacks<'static>;
    let found = match name.to_bytes() {
        b"vkCreatePipelineLayout" => {
            nothing!(0, vk::Result::SUCCESS, (vk::Device, *const (), Callbacks, *mut vk::PipelineLayout) -> vk::Result)
        }
        b"vkCreateShaderModule" => {
            nothing!(0, vk::Result::SUCCESS, (vk::Device, *const (), Callbacks, *mut vk::ShaderModule) -> vk::Result)
        }
        b"vkCreateComputePipelines" => nothing!(
            0,
            vk::Result::SUCCESS,
            (vk::Device, vk::PipelineCache, u32, *const (), Callbacks, *mut vk::Pipeline) -> vk::Result
        ),
        b"vkDestroyShaderModule" => nothing!(0, (), (vk::Device, vk::ShaderModule, Callbacks) -> ()),
        b"vkDestroyPipeline" => nothing!(0, (), (vk::Device, vk::Pipeline, Callbacks) -> ()),
        b"vkDestroyPipelineLayout" => nothing!(0, (), (vk::Device, vk::PipelineLayout, Callbacks) -> ()),
        b"vkCmdBindPipeline" => nothing!(1, (), (vk::CommandBuffer, vk::PipelineBindPoint, vk::Pipeline) -> ()),
        b"vkCmdPushConstants" => {
            nothing!(1, (), (vk::CommandBuffer, vk::PipelineLayout, vk::ShaderStageFlags, u32, u32, *const ()) -> ())
        }
        b"vkCmdDispatch" => nothing!(1, (), (vk::CommandBuffer, u32, u32, u32) -> ()),
        b"vkCmdDispatchIndirect" => nothing!(1, (), (vk::CommandBuffer, vk::Buffer, u64) -> ()),
        b"vkCmdPipelineBarrier2" => nothing!(1, (), (vk::CommandBuffer, *const ()) -> ()),
        b"vkCmdResetQueryPool" => nothing!(1, (), (vk::CommandBuffer, vk::QueryPool, u32, u32) -> ()),
        b"vkCmdWriteTimestamp2" => nothing!(1, (), (vk::CommandBuffer, vk::PipelineStageFlags2, vk::QueryPool, u32) -> ()),
        _ => other as *const (),
    };
    // SAFETY: the functions have the types that their names stand for.
    unsafe { transmute::<*const (), vk::PFN_vkVoidFunction>(found) }
}

unsafe extern "system" fn instance_function(_: vk::Instance, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: Vulkan's contract.
    let name = unsafe { CStr::from_ptr(name) };
    if name == UNKNOWN.get() {
        return None;
    }
    let found = match name.to_bytes() {
        b"vkGetDeviceProcAddr" => device_function as *const (),
        b"vkGetPhysicalDeviceProperties" => properties as *const (),
        b"vkGetPhysicalDeviceProperties2" => properties_2 as *const (),
        b"vkGetPhysicalDeviceFeatures2" => features_2 as *const (),
        _ => other as *const (),
    };
    // SAFETY: as above.
    unsafe { transmute::<*const (), vk::PFN_vkVoidFunction>(found) }
}

/// A structure with all that it may leave out.
fn zeroed<T: Copy>() -> T {
    // SAFETY: the structures of the interface are valid when zero.
    unsafe { MaybeUninit::zeroed().assume_init() }
}

fn desc() -> GridwalkDeviceDesc {
    GridwalkDeviceDesc {
        struct_size: size_of::<GridwalkDeviceDesc>() as u32,
        get_instance_proc_addr: PFN_vkGetInstanceProcAddr(Some(instance_function)),
        instance: vk::Instance::from_raw(1),
        physical_device: vk::PhysicalDevice::from_raw(2),
        device: vk::Device::from_raw(3),
        ..zeroed()
    }
}

struct Tracer(*mut GridwalkTracer);

impl Tracer {
    fn new() -> Tracer {
        let mut tracer = std::ptr::null_mut();
        // SAFETY: the functions are those above, which accept any handle.
        assert_eq!(unsafe { gridwalk_tracer_create(&desc(), &mut tracer) }, GridwalkResult::Ok, "{}", message());
        Tracer(tracer)
    }
}

impl Drop for Tracer {
    fn drop(&mut self) {
        // SAFETY: it is not used again.
        unsafe { gridwalk_tracer_destroy(self.0) };
    }
}

fn message() -> String {
    // SAFETY: the message ends with a zero byte and is of this thread.
    unsafe { CStr::from_ptr(last_message()) }.to_string_lossy().into_owned()
}

fn region(size: u64) -> GridwalkRegion {
    GridwalkRegion { buffer: vk::Buffer::from_raw(7), offset: 0, size, address: 4096 }
}

fn build(tracer: &Tracer) -> GridwalkBuildInfo {
    let capacity = GridwalkCapacity { triangles: 1000, cells: 8000, pairs: 16_000, leaf_cells: 0 };
    let mut sizes = zeroed::<GridwalkBuildSizes>();
    // SAFETY: the tracer is alive, and the pointers are those of references.
    assert_eq!(unsafe { gridwalk_build_sizes(tracer.0, &capacity, &mut sizes) }, GridwalkResult::Ok);
    let geometry = GridwalkGeometry { positions: region(12_000), indices: region(12_000), vertex_count: 1000, triangle_count: 1000 };
    GridwalkBuildInfo {
        struct_size: size_of::<GridwalkBuildInfo>() as u32,
        geometry,
        grid: region(sizes.grid.size),
        scratch: region(sizes.scratch.size),
        report: region(sizes.report.size),
        capacity,
        timestamp_pool: vk::QueryPool::from_raw(8),
        ..zeroed()
    }
}

fn trace() -> GridwalkTraceInfo {
    GridwalkTraceInfo {
        struct_size: size_of::<GridwalkTraceInfo>() as u32,
        ray_count: 100,
        rays: region(3200),
        hits: region(1600),
        scratch: region(1 << 20),
        indirect_count: region(4),
        ..zeroed()
    }
}

fn ray_sort() -> GridwalkRaySortInfo {
    let struct_size = size_of::<GridwalkRaySortInfo>() as u32;
    GridwalkRaySortInfo {
        struct_size,
        ray_count: 100,
        rays: region(3200),
        order: region(400),
        scratch: region(1 << 20),
        indirect_count: region(4),
    }
}

const COMMAND_BUFFER: u64 = 9;

#[test]
fn recording_allocates_nothing() {
    let tracer = Tracer::new();
    let (build, trace) = (build(&tracer), trace());
    let records = GridwalkBuildInfo { geometry: zeroed(), records: region(128 * 10), record_count: 10, timestamp_pool: zeroed(), ..build };
    let sorted = GridwalkTraceInfo { order: region(400), ..trace };
    let all = GridwalkTraceInfo { masks: region(400), mask: 5, cull: GRIDWALK_CULL_BACK, geometries: region(2400), resume: 1, ..sorted };
    let answers = GridwalkTraceInfo { resume: 0, ..all };
    let counts = GridwalkTraceInfo { geometries: zeroed(), ..answers };
    let nearest = GridwalkTraceInfo { hits: region(4800), ..all };
    let cmd = vk::CommandBuffer::from_raw(COMMAND_BUFFER);
    // What a thread allocates when it begins is not recording's.
    for round in 0..2 {
        let before = (ALLOCATIONS.get(), COMMANDS.get());
        // SAFETY: the tracer is alive; nothing follows handles and addresses.
        let results = unsafe {
            [
                gridwalk_cmd_build(tracer.0, cmd, &build),
                gridwalk_cmd_build(tracer.0, cmd, &records),
                gridwalk_cmd_barrier(
                    tracer.0,
                    cmd,
                    vk::PipelineStageFlags2::COMPUTE_SHADER,
                    vk::AccessFlags2::SHADER_WRITE,
                    vk::PipelineStageFlags2::COMPUTE_SHADER,
                    vk::AccessFlags2::SHADER_READ,
                ),
                gridwalk_cmd_closest_hit(tracer.0, cmd, 4096, &trace),
                gridwalk_cmd_closest_hit(tracer.0, cmd, 4096, &all),
                gridwalk_cmd_any_hit(tracer.0, cmd, 4096, &trace),
                gridwalk_cmd_any_hit(tracer.0, cmd, 4096, &answers),
                gridwalk_cmd_count_hits(tracer.0, cmd, 4096, &counts),
                gridwalk_cmd_nearest_hits(tracer.0, cmd, 4096, &nearest, 3),
                gridwalk_cmd_sort_rays(tracer.0, cmd, 4096, &ray_sort()),
            ]
        };
        let after = (ALLOCATIONS.get(), COMMANDS.get());
        assert_eq!(results, [GridwalkResult::Ok; 10], "{}", message());
        assert!(after.1 > before.1 + 100, "{} commands", after.1 - before.1);
        assert!(round == 0 || after.0 == before.0, "{} allocations", after.0 - before.0);
    }
    let before = ALLOCATIONS.get();
    drop(std::hint::black_box(Box::new(1)));
    assert_eq!(ALLOCATIONS.get(), before + 1, "the allocator does not count");
}

#[test]
fn what_is_refused_records_nothing() {
    let tracer = Tracer::new();
    let cmd = vk::CommandBuffer::from_raw(COMMAND_BUFFER);
    let (mut build, mut trace) = (build(&tracer), trace());
    build.grid.size -= 1;
    trace.scratch.size = 64;
    // One record too many; what a query does not have; regions that are too small for the hits of all, or reach beyond all addresses.
    let records =
        GridwalkBuildInfo { grid: region(build.grid.size + 1), geometry: zeroed(), records: region(128), record_count: 2, ..build };
    let counts = GridwalkTraceInfo { scratch: region(1 << 20), geometries: region(800), ..trace };
    let nearest = GridwalkTraceInfo { scratch: region(1 << 20), hits: region(4800), geometries: region(800), ..trace };
    let beyond = GridwalkTraceInfo { scratch: GridwalkRegion { address: u64::MAX - 63, ..region(1 << 20) }, ..trace };
    let order = GridwalkTraceInfo { scratch: region(1 << 20), order: region(396), ..trace };
    let sort = GridwalkRaySortInfo { order: region(396), ..ray_sort() };
    let before = COMMANDS.get();
    // SAFETY: as above.
    let results = unsafe {
        [
            gridwalk_cmd_build(tracer.0, cmd, &build),
            gridwalk_cmd_closest_hit(tracer.0, cmd, 4096, &order),
            gridwalk_cmd_sort_rays(tracer.0, cmd, 4096, &sort),
            gridwalk_cmd_closest_hit(tracer.0, cmd, 4096, &trace),
            gridwalk_cmd_any_hit(tracer.0, cmd, 4096, &trace),
            gridwalk_cmd_build(tracer.0, cmd, &records),
            gridwalk_cmd_nearest_hits(tracer.0, cmd, 4096, &nearest, 3),
            gridwalk_cmd_closest_hit(tracer.0, cmd, 4096, &beyond),
            gridwalk_cmd_count_hits(tracer.0, cmd, 4096, &counts),
            gridwalk_cmd_nearest_hits(tracer.0, cmd, 4096, &counts, 65),
        ]
    };
    let (regions, options) = results.split_at(8);
    assert_eq!(regions, [GridwalkResult::ErrorRegion; 8]);
    assert_eq!(options, [GridwalkResult::ErrorOption; 2]);
    assert_eq!(COMMANDS.get(), before);
}

/// ash would end the process when such a function is called.
#[test]
fn functions_that_vulkan_does_not_know_are_named() {
    for (unknown, of) in [
        (c"vkGetPhysicalDeviceFeatures2", "instance"),
        (c"vkGetPhysicalDeviceToolProperties", "instance"),
        (c"vkCmdPipelineBarrier2", "device"),
        (c"vkCmdDispatch", "device"),
    ] {
        UNKNOWN.set(unknown);
        let mut tracer = std::ptr::null_mut();
        // SAFETY: as above.
        let result = unsafe { gridwalk_tracer_create(&desc(), &mut tracer) };
        UNKNOWN.set(c"");
        assert_eq!(result, GridwalkResult::ErrorLoader);
        assert!(tracer.is_null());
        let message = message();
        assert!(message.contains(unknown.to_str().unwrap_or_default()) && message.contains(of), "{message}");
    }
}

/// The features may lie in the structures of Vulkan's versions or in those of single features.
#[test]
fn the_features_are_set_in_either_kind_of_structure() {
    let requirements = |features: *mut std::ffi::c_void| {
        // SAFETY: the functions are those above, and the chain is one.
        unsafe {
            gridwalk_requirements(desc().get_instance_proc_addr, vk::Instance::from_raw(1), vk::PhysicalDevice::from_raw(2), features)
        }
    };
    let mut synchronization = vk::PhysicalDeviceSynchronization2Features::default();
    let mut address = vk::PhysicalDeviceBufferDeviceAddressFeatures { p_next: (&raw mut synchronization).cast(), ..Default::default() };
    assert_eq!(requirements((&raw mut address).cast()), GridwalkResult::Ok, "{}", message());
    assert_eq!((address.buffer_device_address, synchronization.synchronization2), (vk::TRUE, vk::TRUE));
    assert_eq!(address.buffer_device_address_capture_replay, vk::FALSE);
    let mut alone = vk::PhysicalDeviceVulkan13Features::default();
    assert_eq!(requirements((&raw mut alone).cast()), GridwalkResult::ErrorStruct);
    assert!(message().contains("VkPhysicalDeviceVulkan12Features"), "{}", message());
    assert_eq!(requirements(std::ptr::null_mut()), GridwalkResult::Ok);
}
