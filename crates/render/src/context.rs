//! The device of the renderer: memory, and submissions that are waited for.

use crate::{
    Error, Result,
    device::{Candidate, DeviceInfo, DeviceKind, DeviceSelector, Instance, RAY_QUERY_EXTENSIONS, buffer_usage},
    host_memory::{self, HostMemory, Importer},
};
use ash::{ext, vk};
use bytemuck::{AnyBitPattern, NoUninit};
use gpu_allocator::{
    AllocationError, AllocationSizes, AllocatorDebugSettings, MemoryLocation,
    vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc},
};
use gridwalk::{Region, Shape};
use std::{
    ffi::CString,
    fmt,
    mem::ManuallyDrop,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::Duration,
};

/// What to open a device for.
#[derive(Clone, Debug, Default)]
pub struct ContextDesc<'a> {
    /// Which device.
    pub device: DeviceSelector,
    /// Turns the Khronos validation layer on, synchronization validation included. Messages wait in
    /// [`Context::take_validation_messages`].
    pub validation: bool,
    /// Name of the device object in debuggers.
    pub name: &'a str,
    /// Bytes of device memory that may be used at most, below what the device has; for tests and for sharing a device.
    pub memory_limit: Option<u64>,
    /// Enables the device's own acceleration structures and ray queries where it has them ([`Context::has_ray_query`]): buffers may then hold
    /// them, and what they are built from. Nothing here uses them; they are for the caller's own commands.
    pub ray_query: bool,
}

/// Who reads and writes a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BufferKind {
    /// The device alone; the host through copies (or directly, on a device that shares its memory).
    Device,
    /// Written by the host, read by the device.
    Upload,
    /// Written by the device, read by the host.
    Readback,
}

/// Describes a buffer.
#[derive(Clone, Copy, Debug)]
pub struct BufferDesc<'a> {
    /// Name in messages and debuggers.
    pub name: &'a str,
    /// Size in bytes; 0 is made 16, so that every buffer has an address.
    pub size: u64,
    /// Who reads and writes it.
    pub kind: BufferKind,
    /// Gives the buffer its own block of memory: for few large buffers that come and go, as the grid and its scratch do.
    pub dedicated: bool,
}

/// An open device with a queue, and where it has one with a second for copies. Cheap to clone; the device is closed with the last clone and the last buffer.
#[derive(Clone)]
pub struct Context {
    shared: Arc<Shared>,
}

struct Shared {
    /// `None` only while dropping.
    allocator: Mutex<Option<Allocator>>,
    /// On a CPU driver, for large buffers.
    importer: Option<Importer>,
    commands: Mutex<Commands>,
    /// Held for the submission alone, not while it is waited for, so that another thread can submit copies beside it.
    queue: Mutex<vk::Queue>,
    /// The queue for copies; `None` where they share the other one.
    copy_queue: Option<Mutex<vk::Queue>>,
    pipeline_cache: vk::PipelineCache,
    device: ash::Device,
    debug: Option<ext::debug_utils::Device>,
    candidate: Candidate,
    heap_budget: Budget,
    shape: Shape,
    has_ray_query: bool,
    /// Bytes of all living buffers.
    allocated: AtomicU64,
    /// Most bytes that lived at once.
    peak: AtomicU64,
    /// Buffers that were made.
    made: AtomicU64,
    /// Set when the device was lost or a submission is still running after its time: nothing may be called or freed any more.
    lost: AtomicBool,
    abandoned: AtomicBool,
    instance: ManuallyDrop<Instance>,
}

struct Commands {
    pool: vk::CommandPool,
    buffer: vk::CommandBuffer,
    fence: vk::Fence,
}

/// A value that a timeline semaphore must have reached.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) semaphore: vk::Semaphore,
    pub(crate) value: u64,
}

struct Budget {
    heap: u32,
    limit: Option<u64>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl fmt::Debug for Context {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Context").field("device", &self.shared.candidate.info.name).finish_non_exhaustive()
    }
}

/// Which part of a heap may be used: the rest belongs to the desktop and to other programs. (With a budget, 0.8 of it.)
const HEAP_SHARE: f64 = 0.7;
const BUDGET_SHARE: f64 = 0.8;

/// Size of the pieces in which data travels to and from memory that the host cannot see.
const STAGING_BYTES: u64 = 64 << 20;

impl Context {
    /// Opens a device.
    ///
    /// # Errors
    /// [`Error::NoVulkan`], [`Error::NoDevice`] with every reason, [`Error::NoSuchDevice`], [`Error::NoValidationLayer`], or what a Vulkan
    /// call returned.
    pub fn new(desc: &ContextDesc<'_>) -> Result<Context> {
        let instance = Instance::new(desc.validation)?;
        let candidate = instance.select(&desc.device)?;
        let priorities = [1.0, 1.0];
        let queue = |family, count| {
            vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(priorities.get(..count).unwrap_or_default())
        };
        let queues = match candidate.copy_family {
            Some(family) if family == candidate.queue_family => vec![queue(family, 2)],
            Some(family) => vec![queue(candidate.queue_family, 1), queue(family, 1)],
            None => vec![queue(candidate.queue_family, 1)],
        };
        let has_ray_query = desc.ray_query && candidate.has_ray_query;
        let more = if has_ray_query { &RAY_QUERY_EXTENSIONS[..] } else { &[] };
        let extensions: Vec<_> = candidate.extensions.iter().chain(more).map(|name| name.as_ptr()).collect();
        let mut features = gridwalk::requirements::features();
        // Every device of Vulkan 1.3 has timeline semaphores.
        features.vulkan_12 = features.vulkan_12.timeline_semaphore(true).host_query_reset(candidate.has_host_query_reset);
        let mut structures = vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default().acceleration_structure(true);
        let mut ray_query = vk::PhysicalDeviceRayQueryFeaturesKHR::default().ray_query(true);
        let mut info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .push_next(&mut features.vulkan_12)
            .push_next(&mut features.vulkan_13);
        if has_ray_query {
            info = info.push_next(&mut structures).push_next(&mut ray_query);
        }
        // SAFETY: the physical device comes from this instance; features and extensions were found on it; every pointer outlives the call.
        let device = unsafe { instance.raw.create_device(candidate.handle, &info, None) }.map_err(Error::vulkan("vkCreateDevice"))?;
        let debug = instance.debug.as_ref().map(|_| ext::debug_utils::Device::new(&instance.raw, &device));
        // SAFETY: the handle comes from this instance.
        let memory = unsafe { instance.raw.get_physical_device_memory_properties(candidate.handle) };
        let heap = memory
            .memory_heaps_as_slice()
            .iter()
            .enumerate()
            .filter(|(_, heap)| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL))
            .max_by_key(|(_, heap)| heap.size)
            .map_or(0, |(index, _)| index);
        // From here on `Shared` owns all that was made, and frees it whatever fails below: destroying null handles is allowed.
        let mut shared = Shared {
            allocator: Mutex::new(None),
            importer: Importer::new(&instance.raw, &device, &candidate),
            commands: Mutex::new(Commands { pool: vk::CommandPool::null(), buffer: vk::CommandBuffer::null(), fence: vk::Fence::null() }),
            queue: Mutex::new(vk::Queue::null()),
            copy_queue: candidate.copy_family.map(|_| Mutex::new(vk::Queue::null())),
            pipeline_cache: vk::PipelineCache::null(),
            device,
            debug,
            heap_budget: Budget { heap: u32::try_from(heap).unwrap_or(0), limit: desc.memory_limit },
            shape: Shape::of_device(candidate.info.kind == DeviceKind::Cpu),
            has_ray_query,
            allocated: AtomicU64::new(0),
            peak: AtomicU64::new(0),
            made: AtomicU64::new(0),
            lost: AtomicBool::new(false),
            abandoned: AtomicBool::new(false),
            candidate,
            instance: ManuallyDrop::new(instance),
        };
        shared.init()?;
        if !desc.name.is_empty() {
            shared.set_name(shared.device.handle(), desc.name);
        }
        Ok(Context { shared: Arc::new(shared) })
    }

    /// The device and its limits.
    pub fn device_info(&self) -> &DeviceInfo {
        &self.shared.candidate.info
    }

    /// Whether the device is a CPU.
    pub fn is_cpu(&self) -> bool {
        self.device_info().kind == DeviceKind::Cpu
    }

    /// How kernels are cut into workgroups on this device.
    pub(crate) fn shape(&self) -> &Shape {
        &self.shared.shape
    }

    /// The logical device, for recording commands. It is closed with the context: do not keep it longer.
    pub fn device(&self) -> &ash::Device {
        &self.shared.device
    }

    /// The instance of the device.
    pub fn instance(&self) -> &ash::Instance {
        &self.shared.instance.raw
    }

    /// The physical device.
    pub fn physical_device(&self) -> vk::PhysicalDevice {
        self.shared.candidate.handle
    }

    /// `VK_EXT_debug_utils`, where the instance has it.
    pub fn debug_utils(&self) -> Option<&ext::debug_utils::Device> {
        self.shared.debug.as_ref()
    }

    /// A pipeline cache for all pipelines of the context.
    pub fn pipeline_cache(&self) -> vk::PipelineCache {
        self.shared.pipeline_cache
    }

    /// Whether acceleration structures and ray queries of the device's own were asked for and are enabled.
    pub fn has_ray_query(&self) -> bool {
        self.shared.has_ray_query
    }

    /// Whether the queue can take timestamps.
    pub fn has_timestamps(&self) -> bool {
        self.device_info().limits.timestamp_period_ns > 0.0
    }

    /// Bytes of all living buffers of the context.
    pub fn allocated_bytes(&self) -> u64 {
        self.shared.allocated.load(Ordering::Relaxed)
    }

    /// Most bytes of buffers that lived at once.
    pub fn peak_bytes(&self) -> u64 {
        self.shared.peak.load(Ordering::Relaxed)
    }

    /// How many buffers were made so far: what does not grow from one picture to the next allocates nothing.
    pub fn allocations(&self) -> u64 {
        self.shared.made.load(Ordering::Relaxed)
    }

    /// Takes the messages that the validation layer has sent since the last call; none when it is off.
    pub fn take_validation_messages(&self) -> Vec<String> {
        std::mem::take(&mut *lock(&self.shared.instance.messages.0))
    }

    /// Gives a Vulkan object of this device its name in debuggers and validation messages.
    pub fn set_name<H: vk::Handle>(&self, handle: H, name: &str) {
        self.shared.set_name(handle, name);
    }

    /// Bytes that can still be allocated, by the budget where the driver tells one.
    pub fn available_bytes(&self) -> u64 {
        self.shared.available()
    }

    /// Makes a buffer. Its content is undefined.
    ///
    /// # Errors
    /// [`Error::OutOfDeviceMemory`] when it is larger than a buffer or an allocation may be, or than what is left of the budget;
    /// [`Error::DeviceLost`] after a loss or a time-out.
    pub fn buffer(&self, desc: &BufferDesc<'_>) -> Result<Buffer> {
        self.make_buffer(desc, &[])
    }

    /// As [`Context::buffer`], for one that the queue for copies writes and the other reads.
    pub(crate) fn shared_buffer(&self, desc: &BufferDesc<'_>) -> Result<Buffer> {
        let candidate = &self.shared.candidate;
        match candidate.copy_family.filter(|&family| family != candidate.queue_family) {
            Some(family) => self.make_buffer(desc, &[candidate.queue_family, family]),
            None => self.make_buffer(desc, &[]),
        }
    }

    fn make_buffer(&self, desc: &BufferDesc<'_>, families: &[u32]) -> Result<Buffer> {
        let importer = self.shared.importer.as_ref().filter(|_| desc.kind == BufferKind::Device);
        match self.make_bound(desc, families, importer) {
            // What memory of the host is refused for need not hold for the driver's own.
            Err(Error::Vulkan { .. } | Error::Allocator { .. }) if importer.is_some() => self.make_bound(desc, families, None),
            made => made,
        }
    }

    fn make_bound(&self, desc: &BufferDesc<'_>, families: &[u32], importer: Option<&Importer>) -> Result<Buffer> {
        self.shared.check()?;
        let size = desc.size.max(16).next_multiple_of(16);
        let limits = &self.shared.candidate.info.limits;
        let largest = limits.max_buffer_bytes.min(limits.max_allocation_bytes);
        let available = self.shared.available().min(largest);
        let out_of_memory = || Error::OutOfDeviceMemory { name: desc.name.to_owned(), needed: size, available };
        if size > available {
            return Err(out_of_memory());
        }
        let importer = importer.filter(|importer| importer.bytes_for(size).is_some_and(|bytes| bytes <= available));
        let sharing = if families.is_empty() { vk::SharingMode::EXCLUSIVE } else { vk::SharingMode::CONCURRENT };
        let mut external = vk::ExternalMemoryBufferCreateInfo::default().handle_types(host_memory::HANDLE_TYPE);
        let mut info = vk::BufferCreateInfo::default()
            .size(size)
            .usage(buffer_usage(self.shared.has_ray_query))
            .sharing_mode(sharing)
            .queue_family_indices(families);
        if importer.is_some() {
            info = info.push_next(&mut external);
        }
        let device = &self.shared.device;
        // SAFETY: the device lives; size and usage are valid, and the size is within the device's limit.
        let raw = unsafe { device.create_buffer(&info, None) }.map_err(|result| match result {
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY => out_of_memory(),
            result => Error::vulkan("vkCreateBuffer")(result),
        })?;
        // Owns what exists so far; an early return destroys it.
        let mut buffer =
            Buffer { shared: Arc::clone(&self.shared), name: desc.name.to_owned(), raw, size, address: 0, memory: None, counted: 0 };
        // SAFETY: the buffer belongs to this device.
        let mut requirements = unsafe { device.get_buffer_memory_requirements(raw) };
        requirements.alignment = requirements.alignment.max(gridwalk::REGION_ALIGNMENT);
        let memory = match importer {
            Some(importer) => Memory::OfHost(importer.allocate(&requirements, desc.name, out_of_memory)?),
            None => {
                let location = match desc.kind {
                    BufferKind::Device => MemoryLocation::GpuOnly,
                    BufferKind::Upload => MemoryLocation::CpuToGpu,
                    BufferKind::Readback => MemoryLocation::GpuToCpu,
                };
                let allocation_scheme =
                    if desc.dedicated { AllocationScheme::DedicatedBuffer(raw) } else { AllocationScheme::GpuAllocatorManaged };
                let request = AllocationCreateDesc { name: desc.name, requirements, location, linear: true, allocation_scheme };
                let mut allocator = lock(&self.shared.allocator);
                let allocator = allocator.as_mut().ok_or(Error::DeviceLost)?;
                Memory::Allocated(allocator.allocate(&request).map_err(|error| match error {
                    AllocationError::OutOfMemory => out_of_memory(),
                    other => Error::Allocator { name: desc.name.to_owned(), reason: other.to_string() },
                })?)
            }
        };
        let (raw_memory, offset) = match &memory {
            // SAFETY: the allocation is not freed while the buffer has it.
            Memory::Allocated(allocation) => (unsafe { allocation.memory() }, allocation.offset()),
            Memory::OfHost(memory) => (memory.raw(), 0),
        };
        // SAFETY: the memory lives as long as the buffer and is bound to it alone at this offset.
        let bound = unsafe { device.bind_buffer_memory(raw, raw_memory, offset) };
        buffer.memory = Some(memory);
        buffer.counted = importer.and_then(|importer| importer.bytes_for(size)).unwrap_or(size);
        let now = self.shared.allocated.fetch_add(buffer.counted, Ordering::Relaxed) + buffer.counted;
        self.shared.peak.fetch_max(now, Ordering::Relaxed);
        self.shared.made.fetch_add(1, Ordering::Relaxed);
        bound.map_err(Error::vulkan("vkBindBufferMemory"))?;
        // SAFETY: the buffer has SHADER_DEVICE_ADDRESS usage and is bound to memory.
        buffer.address = unsafe { device.get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(raw)) };
        self.shared.set_name(raw, desc.name);
        Ok(buffer)
    }

    /// Makes a buffer for the device and fills it.
    ///
    /// # Errors
    /// Those of [`Context::buffer`] and [`Context::submit`].
    pub fn upload<T: NoUninit>(&self, name: &str, data: &[T]) -> Result<Buffer> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let buffer = self.buffer(&BufferDesc { name, size: bytes.len() as u64, kind: BufferKind::Device, dedicated: false })?;
        buffer.write(0, data)?;
        Ok(buffer)
    }

    /// Records commands, submits them and waits until the device has done them. All writes are visible to the host and to later
    /// submissions afterwards. `label` names the submission in messages.
    ///
    /// The closure must record only commands whose objects outlive this call: it is what they are borrowed for.
    ///
    /// # Errors
    /// What the closure returns; [`Error::Timeout`] after 300 s on a CPU and 10 s on a GPU; [`Error::DeviceLost`]; after both of these the
    /// context is of no further use, and what it owns is given up rather than freed under a running device.
    pub fn submit<R>(&self, label: &str, record: impl FnOnce(vk::CommandBuffer) -> Result<R>) -> Result<R> {
        self.submit_after(label, None, record)
    }

    /// As [`Context::submit`], of commands that the device begins only after a moment that was submitted before.
    pub(crate) fn submit_after<R>(
        &self,
        label: &str,
        after: Option<Moment>,
        record: impl FnOnce(vk::CommandBuffer) -> Result<R>,
    ) -> Result<R> {
        let commands = lock(&self.shared.commands);
        self.shared.submit(&commands, label, after, record)
    }

    /// The family of the queue for copies: its command buffers go to [`Context::submit_copies`].
    pub(crate) fn copy_family(&self) -> u32 {
        self.shared.candidate.copy_family.unwrap_or(self.shared.candidate.queue_family)
    }

    /// Bits of a timestamp that the queue for copies takes; 0 where it takes none, or where the host cannot reset it.
    pub(crate) fn copy_timestamp_bits(&self) -> u32 {
        if self.shared.candidate.has_host_query_reset { self.shared.candidate.copy_timestamp_bits } else { 0 }
    }

    /// Submits copies, which reach a moment when they are done, and does not wait for them.
    ///
    /// # Safety
    /// The command buffer is of [`Context::copy_family`], was ended, and is not pending; nothing it uses is freed or written before the
    /// moment was waited for; the moment's value is above all that were submitted for its semaphore.
    pub(crate) unsafe fn submit_copies(&self, cmd: vk::CommandBuffer, done: Moment) -> Result<()> {
        self.shared.check()?;
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(cmd)];
        let signals = [vk::SemaphoreSubmitInfo::default()
            .semaphore(done.semaphore)
            .value(done.value)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)];
        let submits = [vk::SubmitInfo2::default().command_buffer_infos(&buffers).signal_semaphore_infos(&signals)];
        let queue = lock(self.shared.copy_queue.as_ref().unwrap_or(&self.shared.queue));
        // SAFETY: the caller's contract; the lock keeps other submissions to the queue out.
        unsafe { self.shared.device.queue_submit2(*queue, &submits, vk::Fence::null()) }
            .map_err(|result| self.shared.lost(Error::vulkan("vkQueueSubmit2")(result)))
    }

    /// Waits on the host for a moment that was submitted.
    pub(crate) fn wait(&self, label: &str, moment: Moment) -> Result<()> {
        self.shared.check()?;
        let (semaphores, values) = ([moment.semaphore], [moment.value]);
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        // A submission of the other kind may stand before it in the queue.
        let timeout = 2 * self.shared.timeout();
        // SAFETY: the semaphore is of this device and lives.
        let waited = unsafe { self.shared.device.wait_semaphores(&info, nanoseconds(timeout)) };
        self.shared.waited("vkWaitSemaphores", label, timeout, waited)
    }

    /// Records commands under a name that debuggers and validation messages show.
    pub(crate) fn label<R>(&self, cmd: vk::CommandBuffer, name: &str, record: impl FnOnce() -> R) -> R {
        let labelled = self.shared.debug.as_ref().zip(CString::new(name).ok());
        if let Some((debug, name)) = &labelled {
            // SAFETY: the command buffer is recording (the caller is within `submit`), and the instance enables debug_utils.
            unsafe { debug.cmd_begin_debug_utils_label(cmd, &vk::DebugUtilsLabelEXT::default().label_name(name)) };
        }
        let result = record();
        if let Some((debug, _)) = &labelled {
            // SAFETY: as above; the label was begun in this command buffer.
            unsafe { debug.cmd_end_debug_utils_label(cmd) };
        }
        result
    }

    /// Destroys device objects of the caller, unless the device may still be using them.
    pub(crate) fn destroy(&self, destroy: impl FnOnce(&ash::Device)) {
        if !self.shared.abandoned.load(Ordering::Acquire) {
            destroy(&self.shared.device);
        }
    }
}

impl Shared {
    fn init(&mut self) -> Result<()> {
        let Commands { pool, buffer, fence } = self.commands.get_mut().unwrap_or_else(PoisonError::into_inner);
        let device = &self.device;
        let queue = self.queue.get_mut().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the device lives and has the queues that its creation asked for (of one family two, where the one for copies is of the
        // same), and every info is complete. The pool and the fence are owned by `self` from the moment of their creation.
        unsafe {
            *queue = device.get_device_queue(self.candidate.queue_family, 0);
            if let (Some(family), Some(copies)) = (self.candidate.copy_family, &mut self.copy_queue) {
                let index = u32::from(family == self.candidate.queue_family);
                *copies.get_mut().unwrap_or_else(PoisonError::into_inner) = device.get_device_queue(family, index);
            }
            *pool = device
                .create_command_pool(
                    &vk::CommandPoolCreateInfo::default()
                        .flags(vk::CommandPoolCreateFlags::TRANSIENT)
                        .queue_family_index(self.candidate.queue_family),
                    None,
                )
                .map_err(Error::vulkan("vkCreateCommandPool"))?;
            let buffers = device
                .allocate_command_buffers(&vk::CommandBufferAllocateInfo::default().command_pool(*pool).command_buffer_count(1))
                .map_err(Error::vulkan("vkAllocateCommandBuffers"))?;
            *buffer = buffers.first().copied().unwrap_or_default();
            *fence = device.create_fence(&vk::FenceCreateInfo::default(), None).map_err(Error::vulkan("vkCreateFence"))?;
            self.pipeline_cache = device
                .create_pipeline_cache(&vk::PipelineCacheCreateInfo::default(), None)
                .map_err(Error::vulkan("vkCreatePipelineCache"))?;
        }
        const MIB: u64 = 1 << 20;
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: self.instance.raw.clone(),
            device: self.device.clone(),
            physical_device: self.candidate.handle,
            debug_settings: AllocatorDebugSettings::default(),
            buffer_device_address: true,
            allocation_sizes: AllocationSizes::new(8 * MIB, 8 * MIB)
                .with_max_device_memblock_size(64 * MIB)
                .with_max_host_memblock_size(64 * MIB),
        })
        .map_err(|error| Error::Allocator { name: "the allocator".to_owned(), reason: error.to_string() })?;
        *self.allocator.get_mut().unwrap_or_else(PoisonError::into_inner) = Some(allocator);
        Ok(())
    }

    fn set_name<H: vk::Handle>(&self, handle: H, name: &str) {
        let (Some(debug), Ok(name)) = (&self.debug, CString::new(name)) else { return };
        // SAFETY: the handle belongs to this device. A name is a help: a failure to set it changes nothing.
        let _ = unsafe {
            debug.set_debug_utils_object_name(&vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name))
        };
    }

    fn check(&self) -> Result<()> {
        if self.lost.load(Ordering::Acquire) { Err(Error::DeviceLost) } else { Ok(()) }
    }

    /// lavapipe hands out more than its heap and its limits; so what may be used is reckoned here.
    fn available(&self) -> u64 {
        let heap = self.heap_budget.heap as usize;
        let used = self.allocated.load(Ordering::Relaxed);
        let left = if self.candidate.has_budget {
            let mut budget = vk::PhysicalDeviceMemoryBudgetPropertiesEXT::default();
            let mut memory = vk::PhysicalDeviceMemoryProperties2::default().push_next(&mut budget);
            // SAFETY: the physical device has the budget extension, so it knows both structs.
            unsafe { self.instance.raw.get_physical_device_memory_properties2(self.candidate.handle, &mut memory) };
            let total = budget.heap_budget.get(heap).copied().unwrap_or(0);
            let usage = budget.heap_usage.get(heap).copied().unwrap_or(0);
            share(total, BUDGET_SHARE).saturating_sub(usage)
        } else {
            share(self.candidate.info.limits.heap_bytes, HEAP_SHARE).saturating_sub(used)
        };
        self.heap_budget.limit.map_or(left, |limit| left.min(limit.saturating_sub(used)))
    }

    /// How long a submission may take.
    fn timeout(&self) -> Duration {
        Duration::from_secs(if self.candidate.info.kind == DeviceKind::Cpu { 300 } else { 10 })
    }

    /// Keeps in mind that the device was lost.
    fn lost(&self, error: Error) -> Error {
        if matches!(error, Error::DeviceLost) {
            self.lost.store(true, Ordering::Release);
        }
        error
    }

    /// What a wait for the device has come to.
    fn waited(&self, call: &'static str, label: &str, timeout: Duration, result: ash::prelude::VkResult<()>) -> Result<()> {
        match result {
            Ok(()) => Ok(()),
            Err(vk::Result::TIMEOUT) => {
                self.lost.store(true, Ordering::Release);
                self.abandoned.store(true, Ordering::Release);
                Err(Error::Timeout { label: label.to_owned(), seconds: timeout.as_secs() })
            }
            Err(result) => {
                // Whether the work still runs is unknown.
                self.lost.store(true, Ordering::Release);
                if result != vk::Result::ERROR_DEVICE_LOST {
                    self.abandoned.store(true, Ordering::Release);
                }
                Err(Error::vulkan(call)(result))
            }
        }
    }

    fn submit<R>(
        &self,
        commands: &Commands,
        label: &str,
        after: Option<Moment>,
        record: impl FnOnce(vk::CommandBuffer) -> Result<R>,
    ) -> Result<R> {
        self.check()?;
        let lost = |error: Error| self.lost(error);
        let device = &self.device;
        let cmd = commands.buffer;
        // SAFETY: the lock on `commands` is held, and every earlier submission was waited for, so that pool, command buffer and fence are
        // idle. What the closure records lives until this function returns, which is after the device has finished; if it does not finish,
        // `abandoned` keeps everything of this context from being freed.
        unsafe {
            device
                .reset_command_pool(commands.pool, vk::CommandPoolResetFlags::empty())
                .map_err(Error::vulkan("vkResetCommandPool"))
                .map_err(lost)?;
            device.reset_fences(&[commands.fence]).map_err(Error::vulkan("vkResetFences")).map_err(lost)?;
            device
                .begin_command_buffer(cmd, &vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT))
                .map_err(Error::vulkan("vkBeginCommandBuffer"))
                .map_err(lost)?;
            let labelled = self.debug.as_ref().zip(CString::new(label).ok());
            if let Some((debug, label)) = &labelled {
                debug.cmd_begin_debug_utils_label(cmd, &vk::DebugUtilsLabelEXT::default().label_name(label));
            }
            let recorded = record(cmd);
            if let Some((debug, _)) = &labelled {
                debug.cmd_end_debug_utils_label(cmd);
            }
            let barrier = vk::MemoryBarrier2::default()
                .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
                .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
                .dst_stage_mask(vk::PipelineStageFlags2::HOST | vk::PipelineStageFlags2::ALL_COMMANDS)
                .dst_access_mask(vk::AccessFlags2::HOST_READ | vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE);
            device.cmd_pipeline_barrier2(cmd, &vk::DependencyInfo::default().memory_barriers(&[barrier]));
            device.end_command_buffer(cmd).map_err(Error::vulkan("vkEndCommandBuffer")).map_err(lost)?;
            let recorded = recorded?;
            let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(cmd)];
            let waits = after.map(|moment| {
                vk::SemaphoreSubmitInfo::default()
                    .semaphore(moment.semaphore)
                    .value(moment.value)
                    .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            });
            let submits = [vk::SubmitInfo2::default().command_buffer_infos(&buffers).wait_semaphore_infos(waits.as_slice())];
            {
                let queue = lock(&self.queue);
                device.queue_submit2(*queue, &submits, commands.fence).map_err(Error::vulkan("vkQueueSubmit2")).map_err(lost)?;
            }
            let timeout = self.timeout();
            let waited = device.wait_for_fences(&[commands.fence], true, nanoseconds(timeout));
            self.waited("vkWaitForFences", label, timeout, waited)?;
            Ok(recorded)
        }
    }
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

fn share(bytes: u64, part: f64) -> u64 {
    (bytes as f64 * part) as u64
}

impl Drop for Shared {
    fn drop(&mut self) {
        if self.abandoned.load(Ordering::Acquire) {
            // The device is still running what it was given: freeing anything under it would be worse than leaking it.
            std::mem::forget(lock(&self.allocator).take());
            return;
        }
        let commands = self.commands.get_mut().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the last context and the last buffer are gone and every submission was waited for, so nothing of this device is in use;
        // null handles may be destroyed. The allocator frees its memory before the device goes, the device before the instance.
        unsafe {
            drop(self.allocator.get_mut().unwrap_or_else(PoisonError::into_inner).take());
            self.device.destroy_fence(commands.fence, None);
            self.device.destroy_command_pool(commands.pool, None);
            self.device.destroy_pipeline_cache(self.pipeline_cache, None);
            self.device.destroy_device(None);
            ManuallyDrop::drop(&mut self.instance);
        }
    }
}

/// Memory of the device, with its address. Freed when dropped; keeps the device open.
pub struct Buffer {
    shared: Arc<Shared>,
    name: String,
    raw: vk::Buffer,
    size: u64,
    address: vk::DeviceAddress,
    memory: Option<Memory>,
    counted: u64,
}

enum Memory {
    Allocated(Allocation),
    OfHost(HostMemory),
}

impl fmt::Debug for Buffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Buffer").field("name", &self.name).field("size", &self.size).finish_non_exhaustive()
    }
}

impl Buffer {
    /// The Vulkan buffer.
    pub fn raw(&self) -> vk::Buffer {
        self.raw
    }

    /// Size in bytes, a multiple of 16.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// Device address of the first byte.
    pub fn address(&self) -> vk::DeviceAddress {
        self.address
    }

    /// The whole buffer as a region for the library.
    pub fn region(&self) -> Region {
        Region { buffer: self.raw, offset: 0, size: self.size, address: self.address }
    }

    /// Name, as given.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn context(&self) -> Context {
        Context { shared: Arc::clone(&self.shared) }
    }

    fn check(&self, offset: u64, bytes: usize) -> Result<()> {
        let end = offset.saturating_add(bytes as u64);
        if end > self.size {
            return Err(Error::OutOfRange { name: self.name.clone(), size: self.size, begin: offset, end });
        }
        Ok(())
    }

    /// Where the host sees memory that it writes piece by piece, beside the device's reading of other pieces; `None` where it sees none.
    pub(crate) fn pointer(&self) -> Option<*mut u8> {
        self.mapped(false)
    }

    /// Where the host sees the memory, if it does without flushes; `cached` asks for memory that is fast to read.
    fn mapped(&self, cached: bool) -> Option<*mut u8> {
        let (properties, pointer) = match self.memory.as_ref()? {
            Memory::Allocated(allocation) => (allocation.memory_properties(), allocation.mapped_ptr()?.as_ptr().cast()),
            Memory::OfHost(memory) => (memory.properties(), memory.pointer()),
        };
        let mut wanted = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        if cached {
            wanted |= vk::MemoryPropertyFlags::HOST_CACHED;
        }
        properties.contains(wanted).then_some(pointer)
    }

    /// Copies data into the buffer, `offset` bytes from its beginning (a multiple of 4).
    ///
    /// # Errors
    /// [`Error::OutOfRange`], or those of [`Context::submit`] where the host cannot see the memory.
    pub fn write<T: NoUninit>(&self, offset: u64, data: &[T]) -> Result<()> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        self.check(offset, bytes.len())?;
        if bytes.is_empty() {
            return Ok(());
        }
        self.shared.check()?;
        if let Some(pointer) = self.mapped(false) {
            // Held for the copy: no submission but of copies from elsewhere runs, and no other thread copies into the same bytes.
            let _commands = lock(&self.shared.commands);
            // SAFETY: the allocation maps `size` bytes from `pointer`, and `offset + bytes` is within; the source is borrowed, so it does not
            // overlap; the lock keeps others out.
            unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), pointer.add(offset as usize), bytes.len()) };
            return Ok(());
        }
        self.write_staged(offset, bytes, STAGING_BYTES)
    }

    fn write_staged(&self, offset: u64, bytes: &[u8], most: u64) -> Result<()> {
        let context = self.context();
        let piece = most.min(bytes.len() as u64);
        let staging = context.buffer(&BufferDesc { name: "upload staging", size: piece, kind: BufferKind::Upload, dedicated: false })?;
        let mut at = offset;
        for chunk in bytes.chunks(piece as usize) {
            staging.write(0, chunk)?;
            context.copy(&staging, 0, self, at, chunk.len() as u64)?;
            at += chunk.len() as u64;
        }
        Ok(())
    }

    /// Copies `count` elements out of the buffer, `offset` bytes from its beginning (a multiple of 4).
    ///
    /// # Errors
    /// [`Error::OutOfRange`], or those of [`Context::submit`] where the host cannot see the memory.
    pub fn read<T: AnyBitPattern + NoUninit>(&self, offset: u64, count: usize) -> Result<Vec<T>> {
        self.read_by(None, offset, count)
    }

    /// Whether the host reads the memory directly.
    pub(crate) fn is_seen(&self) -> bool {
        self.mapped(true).is_some()
    }

    /// As [`Buffer::read`], where the host cannot see the memory by way of a buffer made for read-back, or of a new one.
    pub(crate) fn read_by<T: AnyBitPattern + NoUninit>(&self, way: Option<&Buffer>, offset: u64, count: usize) -> Result<Vec<T>> {
        let length = count.saturating_mul(size_of::<T>());
        self.check(offset, length)?;
        let mut data = vec![T::zeroed(); count];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut data);
        if bytes.is_empty() {
            return Ok(data);
        }
        self.shared.check()?;
        if let Some(pointer) = self.mapped(true) {
            let _commands = lock(&self.shared.commands);
            // SAFETY: as in `write`; the device has finished (every submission is waited for, with a barrier to the host).
            unsafe { std::ptr::copy_nonoverlapping(pointer.add(offset as usize), bytes.as_mut_ptr(), bytes.len()) };
            return Ok(data);
        }
        match way {
            Some(way) => self.read_through(way, offset, bytes)?,
            None => self.read_staged(offset, bytes, STAGING_BYTES)?,
        }
        Ok(data)
    }

    fn read_staged(&self, offset: u64, bytes: &mut [u8], most: u64) -> Result<()> {
        let size = most.min(bytes.len() as u64);
        let desc = BufferDesc { name: "read-back staging", size, kind: BufferKind::Readback, dedicated: false };
        self.read_through(&self.context().buffer(&desc)?, offset, bytes)
    }

    /// Copies in pieces that the other buffer holds, which is the caller's alone.
    fn read_through(&self, staging: &Buffer, offset: u64, bytes: &mut [u8]) -> Result<()> {
        let Some(pointer) = staging.mapped(false) else {
            return Err(Error::Allocator { name: staging.name.clone(), reason: "the host cannot see read-back memory".to_owned() });
        };
        let context = self.context();
        let mut at = offset;
        for chunk in bytes.chunks_mut(staging.size as usize) {
            context.copy(self, at, staging, 0, chunk.len() as u64)?;
            // SAFETY: nobody else uses the staging buffer meanwhile, it maps all its bytes, and the device has finished.
            unsafe { std::ptr::copy_nonoverlapping(pointer, chunk.as_mut_ptr(), chunk.len()) };
            at += chunk.len() as u64;
        }
        Ok(())
    }
}

impl Context {
    /// Copies bytes between two buffers and waits. Both ranges were checked by the caller.
    pub(crate) fn copy(&self, from: &Buffer, from_offset: u64, to: &Buffer, to_offset: u64, size: u64) -> Result<()> {
        if size == 0 {
            return Ok(());
        }
        self.submit("copy", |cmd| {
            let region = vk::BufferCopy { src_offset: from_offset, dst_offset: to_offset, size };
            // SAFETY: the command buffer is recording; both buffers live until the submission is done and hold the ranges.
            unsafe { self.device().cmd_copy_buffer(cmd, from.raw, to.raw, &[region]) };
            Ok(())
        })
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        let memory = self.memory.take();
        self.shared.allocated.fetch_sub(self.counted, Ordering::Relaxed);
        if self.shared.abandoned.load(Ordering::Acquire) {
            std::mem::forget(memory);
            return;
        }
        let device = &self.shared.device;
        // SAFETY: every submission that used the buffer was waited for.
        unsafe { device.destroy_buffer(self.raw, None) };
        match memory {
            Some(Memory::Allocated(allocation)) => {
                if let Some(allocator) = lock(&self.shared.allocator).as_mut() {
                    // The allocator refuses only what it did not allocate.
                    let _ = allocator.free(allocation);
                }
            }
            // SAFETY: the buffer, which alone was bound to it, is gone.
            Some(Memory::OfHost(memory)) => unsafe { memory.free(device) },
            None => {}
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that fails panics")]
mod tests {
    use super::*;

    fn context() -> Context {
        Context::new(&ContextDesc { validation: std::env::var("GRIDWALK_VALIDATE").as_deref() != Ok("0"), ..ContextDesc::default() })
            .unwrap()
    }

    fn refuses(context: &Context, buffer: &Buffer) {
        let desc = BufferDesc { name: "after", size: 16, kind: BufferKind::Device, dedicated: false };
        assert!(matches!(context.buffer(&desc), Err(Error::DeviceLost)));
        assert!(matches!(context.submit("after", |_| Ok(())), Err(Error::DeviceLost)));
        assert!(matches!(buffer.write(0, &[1_u32]), Err(Error::DeviceLost)));
        assert!(matches!(buffer.read::<u32>(0, 1), Err(Error::DeviceLost)));
    }

    /// As after VK_ERROR_DEVICE_LOST: every call says so at once, and all is freed.
    #[test]
    fn after_a_loss_every_call_says_so() {
        let context = context();
        let buffer = context.upload("before", &[1_u32, 2, 3, 4]).unwrap();
        context.shared.lost.store(true, Ordering::Release);
        refuses(&context, &buffer);
        drop(buffer);
        assert_eq!(context.allocated_bytes(), 0);
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
    }

    /// As after a submission that does not come back: nothing is destroyed under it.
    #[test]
    fn after_a_time_out_nothing_is_freed() {
        let context = context();
        let buffer = context.upload("in use", &[1_u32, 2, 3, 4]).unwrap();
        context.shared.lost.store(true, Ordering::Release);
        context.shared.abandoned.store(true, Ordering::Release);
        refuses(&context, &buffer);
        let shared = Arc::downgrade(&context.shared);
        let raw = buffer.raw();
        drop(buffer);
        // Still a buffer of the device: the validation layer would complain of a destroyed one.
        let mut requirements = vk::MemoryRequirements2::default();
        let info = vk::BufferMemoryRequirementsInfo2::default().buffer(raw);
        // SAFETY: the buffer was given up, not destroyed.
        unsafe { context.device().get_buffer_memory_requirements2(&info, &mut requirements) };
        assert!(requirements.memory_requirements.size >= 16);
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
        drop(context);
        assert!(shared.upgrade().is_none());
    }

    /// The way that data takes to memory which the host does not see: on a GPU with its own memory.
    #[test]
    fn data_travels_in_pieces() {
        let context = context();
        let data: Vec<u8> = (0..1000_u32).flat_map(|i| i.wrapping_mul(2_654_435_761).to_le_bytes()).collect();
        for piece in [4, 64, 1024, 3996, 4000, 1 << 20] {
            let buffer = context.upload("pieces", &[0xAB_u8; 4032]).unwrap();
            buffer.write_staged(16, &data, piece).unwrap();
            let mut back = vec![0_u8; data.len()];
            buffer.read_staged(16, &mut back, piece).unwrap();
            assert!(back == data, "pieces of {piece} bytes");
            let whole = buffer.read::<u8>(0, 4032).unwrap();
            assert!(
                whole[16..4016] == data && whole[..16].iter().chain(&whole[4016..]).all(|&byte| byte == 0xAB),
                "pieces of {piece} bytes"
            );
        }
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
    }

    #[test]
    fn large_buffers_of_a_cpu_driver_lie_in_memory_of_the_host() {
        let context = context();
        let make = |name, size, kind| context.buffer(&BufferDesc { name, size, kind, dedicated: true }).unwrap();
        let is_of_host = |buffer: &Buffer| matches!(buffer.memory, Some(Memory::OfHost(_)));
        let size = 2 * host_memory::HUGE_PAGE + 4;
        let large = make("large", size, BufferKind::Device);
        let small = make("small", 4096, BufferKind::Device);
        assert_eq!(is_of_host(&large), context.shared.candidate.imports_host_memory);
        assert!(!is_of_host(&small) && !is_of_host(&make("staging", size, BufferKind::Upload)));
        assert!(!is_of_host(&large) || large.mapped(true).unwrap().addr() % host_memory::HUGE_PAGE as usize == 0);
        // To the last bytes, from the host and from the device.
        large.write(size - 8, &[1_u32, 2]).unwrap();
        small.write(0, &[3_u32]).unwrap();
        context.copy(&small, 0, &large, size - 4, 4).unwrap();
        context.copy(&large, size - 8, &small, 8, 8).unwrap();
        assert_eq!(large.read::<u32>(size - 8, 2).unwrap(), [1, 3]);
        assert_eq!(small.read::<u32>(8, 2).unwrap(), [1, 3]);
        let again: Vec<_> = (0..8).map(|_| make("again", 64 << 20, BufferKind::Device)).collect();
        drop((again, large, small));
        assert_eq!(context.allocated_bytes(), 0);
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
    }

    #[test]
    fn an_error_while_recording_leaves_the_context_usable() {
        let context = context();
        let failed = context.submit("nothing", |_| Err::<(), _>(Error::Interrupted));
        assert!(matches!(failed, Err(Error::Interrupted)));
        let buffer = context.upload("after", &[7_u32]).unwrap();
        context
            .submit("fill", |cmd| {
                // SAFETY: the buffer lives until the submission was waited for.
                unsafe { context.device().cmd_fill_buffer(cmd, buffer.raw(), 0, vk::WHOLE_SIZE, 9) };
                Ok(())
            })
            .unwrap();
        assert_eq!(buffer.read::<u32>(0, 1).unwrap(), [9]);
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
    }

    /// The negative control of all "no message" above and in the other tests.
    #[test]
    fn the_validation_layer_is_heard() {
        let context = Context::new(&ContextDesc { validation: true, ..ContextDesc::default() }).unwrap();
        let buffer = context.upload("small", &[0_u32; 4]).unwrap();
        context
            .submit("a fill that is not aligned", |cmd| {
                // SAFETY: the layer reports the offset that is no multiple of 4; the driver rounds it down, within the buffer.
                unsafe { context.device().cmd_fill_buffer(cmd, buffer.raw(), 2, 4, 0) };
                Ok(())
            })
            .unwrap();
        let messages = context.take_validation_messages();
        assert!(messages.iter().any(|message| message.contains("vkCmdFillBuffer")), "{messages:?}");
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
        // A hazard between two copies: synchronization validation.
        let (a, b) = (context.upload("a", &[0_u32; 64]).unwrap(), context.upload("b", &[0_u32; 64]).unwrap());
        context
            .submit("two copies without a barrier", |cmd| {
                let region = [vk::BufferCopy { src_offset: 0, dst_offset: 0, size: 256 }];
                // SAFETY: both buffers live and hold the region; the missing barrier is what is tested.
                unsafe {
                    context.device().cmd_copy_buffer(cmd, a.raw(), b.raw(), &region);
                    context.device().cmd_copy_buffer(cmd, b.raw(), a.raw(), &region);
                }
                Ok(())
            })
            .unwrap();
        let messages = context.take_validation_messages();
        // "SYNC-HAZARD-READ-AFTER-WRITE", or in newer layers "READ_AFTER_WRITE hazard".
        assert!(messages.iter().any(|message| message.to_lowercase().contains("hazard")), "{messages:?}");
    }
}
