//! A device and memory as an engine has them: made by hand, with the features that the library asks for and nothing else, and one buffer
//! from which every region is cut. Nothing of gridwalk-render is in here.

use std::cell::RefCell;
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex};

use gridwalk::ash::{self, ext, khr, vk};
use gridwalk::{BuildInfo, Capacity, DeviceDesc, Geometry, Hit, MISS, Ray, RayCount, Region, Report, TraceInfo, Tracer, requirements};

type Messages = Mutex<Vec<String>>;

/// Whether the validation layers are on.
pub fn is_validated() -> bool {
    std::env::var("GRIDWALK_VALIDATE").map_or(true, |value| value != "0")
}

/// An instance, a device and a queue that computes; under synchronization validation, unless `GRIDWALK_VALIDATE=0`.
pub struct Foreign {
    pub instance: ash::Instance,
    pub physical_device: vk::PhysicalDevice,
    pub device: ash::Device,
    queue: Mutex<vk::Queue>,
    family: u32,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Arc<Messages>,
    _entry: ash::Entry,
}

impl Foreign {
    pub fn new() -> Foreign {
        const LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";
        let messages = Arc::<Messages>::default();
        // SAFETY: every handle is of the entry, the instance or the device that is made here; what the infos point to outlives the calls.
        unsafe {
            let entry = ash::Entry::load().unwrap();
            let layers = if is_validated() { vec![LAYER.as_ptr()] } else { Vec::new() };
            let mut extensions = if is_validated() { vec![ext::debug_utils::NAME.as_ptr()] } else { Vec::new() };
            let mut features = vk::ValidationFeaturesEXT::default();
            let enables = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
            if is_validated() {
                extensions.push(ext::validation_features::NAME.as_ptr());
                features = features.enabled_validation_features(&enables);
            }
            // Where devices are listed only to those who ask for not quite conformant ones: MoltenVK.
            let mut flags = vk::InstanceCreateFlags::empty();
            let offered = entry.enumerate_instance_extension_properties(None).unwrap();
            if offered.iter().any(|extension| extension.extension_name_as_c_str() == Ok(khr::portability_enumeration::NAME)) {
                extensions.push(khr::portability_enumeration::NAME.as_ptr());
                flags = vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR;
            }
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
            let info = vk::InstanceCreateInfo::default()
                .flags(flags)
                .application_info(&application)
                .enabled_layer_names(&layers)
                .enabled_extension_names(&extensions);
            let info = if is_validated() { info.push_next(&mut features) } else { info };
            let instance = entry.create_instance(&info, None).unwrap();
            let messenger = is_validated().then(|| {
                let debug = ext::debug_utils::Instance::new(&entry, &instance);
                let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
                    .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING)
                    .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE)
                    .pfn_user_callback(Some(collect))
                    .user_data(Arc::as_ptr(&messages).cast_mut().cast::<c_void>());
                let messenger = debug.create_debug_utils_messenger(&info, None).unwrap();
                (debug, messenger)
            });
            let all = instance.enumerate_physical_devices().unwrap();
            let serves = |device: &vk::PhysicalDevice| requirements::query(&instance, *device).missing.is_empty();
            let physical_device = all.into_iter().find(serves).expect("a device that can serve");
            let families = instance.get_physical_device_queue_family_properties(physical_device);
            let family = families.iter().position(|family| family.queue_flags.contains(vk::QueueFlags::COMPUTE)).unwrap() as u32;
            let queue_info = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
            let offered = instance.enumerate_device_extension_properties(physical_device).unwrap();
            let subset = offered.iter().any(|extension| extension.extension_name_as_c_str() == Ok(khr::portability_subset::NAME));
            let extensions = if subset { vec![khr::portability_subset::NAME.as_ptr()] } else { Vec::new() };
            let mut features = requirements::features();
            let info = vk::DeviceCreateInfo::default().queue_create_infos(&queue_info).enabled_extension_names(&extensions);
            let info = features.chain(info);
            let device = instance.create_device(physical_device, &info, None).unwrap();
            let queue = Mutex::new(device.get_device_queue(family, 0));
            Foreign { instance, physical_device, device, queue, family, messenger, messages, _entry: entry }
        }
    }

    /// A tracer for the device.
    pub fn tracer(&self, pipeline_cache: vk::PipelineCache) -> Tracer {
        let desc = DeviceDesc { pipeline_cache, ..DeviceDesc::new(&self.instance, self.physical_device, &self.device) };
        // SAFETY: the handles are of each other; every test drops its tracer before the device, after it has waited for all work.
        unsafe { Tracer::new(&desc) }.unwrap()
    }

    /// What the layers have said since the last call.
    pub fn take_messages(&self) -> Vec<String> {
        std::mem::take(&mut self.messages.lock().unwrap())
    }

    /// Fails if the layers have said anything.
    pub fn check(&self) {
        let messages = self.take_messages();
        assert!(messages.is_empty(), "validation messages:\n{}", messages.join("\n"));
    }

    /// Records a command buffer that may be submitted more than once, in a pool of its own.
    pub fn record(&self, record: impl FnOnce(vk::CommandBuffer)) -> Commands<'_> {
        // SAFETY: the device lives as long as what is returned, and the pool is used by one thread.
        unsafe {
            let pool = vk::CommandPoolCreateInfo::default().queue_family_index(self.family);
            let pool = self.device.create_command_pool(&pool, None).unwrap();
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let cmd = self.device.allocate_command_buffers(&info).unwrap()[0];
            self.device.begin_command_buffer(cmd, &vk::CommandBufferBeginInfo::default()).unwrap();
            record(cmd);
            self.device.end_command_buffer(cmd).unwrap();
            Commands { foreign: self, pool, cmd }
        }
    }

    /// Submits command buffers, in one submission, and waits.
    pub fn submit(&self, commands: &[&Commands]) {
        let buffers: Vec<_> = commands.iter().map(|commands| commands.cmd).collect();
        let queue = self.queue.lock().unwrap();
        // SAFETY: the command buffers are complete, of this device, and not running: every submission is waited for.
        unsafe {
            self.device.queue_submit(*queue, &[vk::SubmitInfo::default().command_buffers(&buffers)], vk::Fence::null()).unwrap();
            self.device.queue_wait_idle(*queue).unwrap();
        }
    }

    /// Destroys the device and everything else, and gives what the layers said, of what was left on the device too.
    pub fn close(self) -> Vec<String> {
        let messages = Arc::clone(&self.messages);
        drop(self);
        std::mem::take(&mut messages.lock().unwrap())
    }
}

impl Default for Foreign {
    fn default() -> Self {
        Foreign::new()
    }
}

impl Drop for Foreign {
    fn drop(&mut self) {
        // SAFETY: what borrows from the device has been dropped, and every submission was waited for.
        unsafe {
            self.device.destroy_device(None);
            if let Some((debug, messenger)) = &self.messenger {
                debug.destroy_debug_utils_messenger(*messenger, None);
            }
            self.instance.destroy_instance(None);
        }
    }
}

/// Called by the layers, with the messages of the instance as user data.
unsafe extern "system" fn collect(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layers pass a valid message; the messages outlive the instance.
    let (text, messages) = unsafe {
        let text = (*data).message_as_c_str().map_or_else(String::new, |text| text.to_string_lossy().into_owned());
        (text, &*user.cast_const().cast::<Messages>())
    };
    messages.lock().unwrap().push(text);
    vk::FALSE
}

/// A command buffer in a pool of its own.
pub struct Commands<'a> {
    foreign: &'a Foreign,
    pool: vk::CommandPool,
    cmd: vk::CommandBuffer,
}

impl Drop for Commands<'_> {
    fn drop(&mut self) {
        // SAFETY: every submission was waited for.
        unsafe { self.foreign.device.destroy_command_pool(self.pool, None) };
    }
}

/// What memory holds that nothing was written to: not a finite float, and far beyond any index.
pub const POISON: u32 = 0xFFA5_5AA5;

/// One buffer in memory that the host sees, full of poison. Regions begin at odd multiples of their alignment, with a gap between them.
pub struct Memory<'a> {
    foreign: &'a Foreign,
    buffer: vk::Buffer,
    memory: vk::DeviceMemory,
    address: vk::DeviceAddress,
    mapped: *mut u8,
    size: u64,
    regions: RefCell<Vec<Region>>,
}

impl<'a> Memory<'a> {
    pub fn new(foreign: &'a Foreign, size: u64) -> Memory<'a> {
        use vk::BufferUsageFlags as Usage;
        let usage = Usage::STORAGE_BUFFER | Usage::SHADER_DEVICE_ADDRESS | Usage::INDIRECT_BUFFER | Usage::TRANSFER_DST;
        Memory::with_usage(foreign, size, usage)
    }

    /// With these usage flags and no others.
    pub fn with_usage(foreign: &'a Foreign, size: u64, usage: vk::BufferUsageFlags) -> Memory<'a> {
        use vk::MemoryPropertyFlags as Property;
        let (device, host) = (&foreign.device, Property::HOST_VISIBLE | Property::HOST_COHERENT);
        // SAFETY: the buffer is bound once, to memory as large as it asks for, which stays mapped until it is freed.
        unsafe {
            let buffer = device.create_buffer(&vk::BufferCreateInfo::default().size(size).usage(usage), None).unwrap();
            let needs = device.get_buffer_memory_requirements(buffer);
            let types = foreign.instance.get_physical_device_memory_properties(foreign.physical_device);
            let fits = |i: &u32| needs.memory_type_bits >> i & 1 == 1 && types.memory_types[*i as usize].property_flags.contains(host);
            let memory_type = (0..types.memory_type_count).find(fits).unwrap();
            let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
            let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(memory_type).push_next(&mut flags);
            let memory = device.allocate_memory(&info, None).unwrap();
            device.bind_buffer_memory(buffer, memory, 0).unwrap();
            let address = device.get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(buffer));
            let mapped = device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty()).unwrap().cast::<u8>();
            let all = Memory { foreign, buffer, memory, address, mapped, size, regions: RefCell::default() };
            all.poison(&all.whole());
            all
        }
    }

    fn whole(&self) -> Region {
        Region { buffer: self.buffer, offset: 0, size: self.size / 4 * 4, address: self.address }
    }

    /// A piece of the buffer.
    pub fn region(&self, size: u64) -> Region {
        let mut regions = self.regions.borrow_mut();
        let end = regions.last().map_or(0, |last| last.offset + last.size);
        let mut address = (self.address + end + 4).next_multiple_of(gridwalk::REGION_ALIGNMENT);
        if (address / gridwalk::REGION_ALIGNMENT).is_multiple_of(2) {
            address += gridwalk::REGION_ALIGNMENT;
        }
        let region = Region { buffer: self.buffer, offset: address - self.address, size, address };
        assert!(region.offset + size < self.size, "the memory is too small");
        regions.push(region);
        region
    }

    pub fn upload<T: bytemuck::NoUninit>(&self, data: &[T]) -> Region {
        let region = self.region(size_of_val(data) as u64);
        self.write(&region, data);
        region
    }

    pub fn write<T: bytemuck::NoUninit>(&self, region: &Region, data: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        assert!(bytes.len() as u64 <= region.size);
        // SAFETY: the region lies in the mapped buffer, and no submission runs.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.mapped.add(region.offset as usize), bytes.len()) };
    }

    pub fn read<T: bytemuck::Pod>(&self, region: &Region, count: usize) -> Vec<T> {
        let mut data = vec![T::zeroed(); count];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut data);
        assert!(bytes.len() as u64 <= region.size);
        // SAFETY: as for `write`.
        unsafe { std::ptr::copy_nonoverlapping(self.mapped.add(region.offset as usize), bytes.as_mut_ptr(), bytes.len()) };
        data
    }

    /// Makes a region as if nothing had been written to it.
    pub fn poison(&self, region: &Region) {
        self.write(region, &vec![POISON; (region.size / 4) as usize]);
    }

    /// Fails if a word between the regions was written.
    pub fn check_gaps(&self) {
        let words: Vec<u32> = self.read(&self.whole(), (self.size / 4) as usize);
        let mut from = 0;
        for region in self.regions.borrow().iter() {
            let gap = &words[from..(region.offset / 4) as usize];
            assert!(gap.iter().all(|word| *word == POISON), "written before the region at {}", region.offset);
            from = (region.offset + region.size).div_ceil(4) as usize;
        }
        assert!(words[from..].iter().all(|word| *word == POISON), "written behind the last region");
    }
}

impl Drop for Memory<'_> {
    fn drop(&mut self) {
        // SAFETY: every submission was waited for.
        unsafe {
            self.foreign.device.destroy_buffer(self.buffer, None);
            self.foreign.device.free_memory(self.memory, None);
        }
    }
}

/// A terrain of `side` by `side` squares, and rays down into each of its triangles, whose hits are known without any ray tracer.
pub struct Terrain {
    pub positions: Vec<[f32; 3]>,
    pub indices: Vec<[u32; 3]>,
    pub rays: Vec<Ray>,
    expected: Vec<(u32, f32)>,
}

impl Terrain {
    pub fn new(side: u32, seed: u32) -> Terrain {
        let height = |x: u32, y: u32| (((7 + seed) * x + 3 * y + seed) % 5) as f32;
        let corner = |x: u32, y: u32| y * (side + 1) + x;
        let positions = (0..=side).flat_map(|y| (0..=side).map(move |x| [x as f32, y as f32, height(x, y)])).collect();
        let down = |x: f32, y: f32| Ray { origin: [x, y, 10.0], t_min: 0.0, direction: [0.0, 0.0, -1.0], t_max: f32::INFINITY };
        let (mut indices, mut rays, mut expected) = (Vec::new(), vec![down(-1.0, 0.5)], vec![(MISS, f32::INFINITY)]);
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            let [ha, hb, hc, hd] = [height(x, y), height(x + 1, y), height(x + 1, y + 1), height(x, y + 1)];
            expected.push((indices.len() as u32, 10.0 - (0.25 * ha + 0.5 * hb + 0.25 * hc)));
            rays.push(down(x as f32 + 0.75, y as f32 + 0.25));
            indices.push([a, b, c]);
            expected.push((indices.len() as u32, 10.0 - (0.25 * ha + 0.25 * hc + 0.5 * hd)));
            rays.push(down(x as f32 + 0.25, y as f32 + 0.75));
            indices.push([a, c, d]);
        }
        Terrain { positions, indices, rays, expected }
    }

    /// How many of the hits are not as expected.
    pub fn wrong(&self, hits: &[Hit]) -> usize {
        assert_eq!(hits.len(), self.expected.len());
        let same = |hit: &Hit, (triangle, t): (u32, f32)| hit.triangle == triangle && (hit.t == t || (hit.t - t).abs() < 1e-5);
        hits.iter().zip(&self.expected).filter(|(hit, expected)| !same(hit, **expected)).count()
    }
}

/// A terrain in foreign memory: what a build and a trace of it are recorded with.
pub struct Placed<'a> {
    pub terrain: Terrain,
    pub build: BuildInfo,
    pub trace: TraceInfo,
    memory: &'a Memory<'a>,
}

impl<'a> Placed<'a> {
    pub fn new(memory: &'a Memory<'a>, tracer: &Tracer, terrain: Terrain) -> Placed<'a> {
        let (triangles, rays) = (terrain.indices.len() as u32, terrain.rays.len() as u32);
        let capacity = Capacity { triangles, cells: 16 * triangles, pairs: 128 * triangles, leaf_cells: 0 };
        let sizes = tracer.build_sizes(&capacity).unwrap();
        let geometry = Geometry {
            positions: memory.upload(&terrain.positions),
            vertex_count: terrain.positions.len() as u32,
            indices: memory.upload(&terrain.indices),
            triangle_count: triangles,
        };
        let room = |size: gridwalk::RegionSize| memory.region(size.size);
        let build = BuildInfo::new(geometry, room(sizes.grid), room(sizes.scratch), room(sizes.report), capacity);
        let scratch = room(tracer.trace_scratch_size(rays).unwrap());
        let hits = memory.region(16 * u64::from(rays));
        let trace = TraceInfo::new(memory.upload(&terrain.rays), hits, RayCount::Direct(rays), scratch);
        Placed { terrain, build, trace, memory }
    }

    /// Records the build.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_build`]; the memory lives until the commands have been executed.
    pub unsafe fn cmd_build(&self, tracer: &Tracer, cmd: vk::CommandBuffer) {
        // SAFETY: the caller's contract.
        unsafe { tracer.cmd_build(cmd, &self.build) }.unwrap();
    }

    /// Records the trace.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`]; the memory lives until the commands have been executed.
    pub unsafe fn cmd_trace(&self, tracer: &Tracer, cmd: vk::CommandBuffer) {
        // SAFETY: the caller's contract.
        unsafe { tracer.cmd_closest_hit(cmd, self.build.grid.address, &self.trace) }.unwrap();
    }

    pub fn report(&self) -> Report {
        self.memory.read(&self.build.report, 1)[0]
    }

    /// Fails unless the hits in memory are the expected ones.
    pub fn check(&self) {
        let hits: Vec<Hit> = self.memory.read(&self.trace.hits, self.terrain.rays.len());
        assert_eq!((self.report().overflow, self.terrain.wrong(&hits)), (0, 0), "of {} rays", hits.len());
    }
}
