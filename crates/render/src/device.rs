//! Vulkan instance and devices: what there is, what it lacks, which one to take.

use crate::{Error, Result, host_memory};
use ash::{ext, khr, vk};
use std::{
    ffi::{CStr, c_void},
    fmt,
    str::FromStr,
    sync::{Arc, Mutex},
};

/// Which device to take.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceSelector {
    /// The best that can serve: a discrete GPU before an integrated one before a virtual one before a CPU.
    #[default]
    Best,
    /// By its place in [`list_devices`].
    Index(usize),
    /// By a part of its name, whatever the case.
    Name(String),
    /// By its UUID.
    Uuid([u8; 16]),
    /// The first that runs on the CPU.
    Cpu,
}

impl FromStr for DeviceSelector {
    type Err = std::convert::Infallible;

    /// `cpu`, `best`, an index, a UUID, or else a part of a name.
    fn from_str(text: &str) -> Result<DeviceSelector, Self::Err> {
        if text.is_empty() || text.eq_ignore_ascii_case("best") {
            return Ok(DeviceSelector::Best);
        }
        if text.eq_ignore_ascii_case("cpu") {
            return Ok(DeviceSelector::Cpu);
        }
        if let Ok(index) = text.parse() {
            return Ok(DeviceSelector::Index(index));
        }
        Ok(parse_uuid(text).map_or_else(|| DeviceSelector::Name(text.to_owned()), DeviceSelector::Uuid))
    }
}

impl fmt::Display for DeviceSelector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DeviceSelector::Best => f.write_str("best"),
            DeviceSelector::Index(index) => write!(f, "{index}"),
            DeviceSelector::Name(name) => f.write_str(name),
            DeviceSelector::Uuid(uuid) => f.write_str(&format_uuid(uuid)),
            DeviceSelector::Cpu => f.write_str("cpu"),
        }
    }
}

fn parse_uuid(text: &str) -> Option<[u8; 16]> {
    let digits: Vec<u8> = text.bytes().filter(|&byte| byte != b'-').collect();
    if digits.len() != 32 {
        return None;
    }
    let mut uuid = [0; 16];
    for (byte, pair) in uuid.iter_mut().zip(digits.chunks_exact(2)) {
        *byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
    }
    Some(uuid)
}

fn format_uuid(uuid: &[u8; 16]) -> String {
    let mut text = String::with_capacity(36);
    for (index, byte) in uuid.iter().enumerate() {
        if matches!(index, 4 | 6 | 8 | 10) {
            text.push('-');
        }
        text.push_str(&format!("{byte:02x}"));
    }
    text
}

/// What a device is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeviceKind {
    /// A GPU with its own memory.
    Discrete,
    /// A GPU that shares the memory of the CPU.
    Integrated,
    /// A GPU lent by a hypervisor.
    Virtual,
    /// None of these.
    Other,
    /// The CPU: a software driver.
    Cpu,
}

impl DeviceKind {
    fn new(device_type: vk::PhysicalDeviceType) -> DeviceKind {
        match device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::Discrete,
            vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::Integrated,
            vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::Virtual,
            vk::PhysicalDeviceType::CPU => DeviceKind::Cpu,
            _ => DeviceKind::Other,
        }
    }

    /// Name for people.
    pub const fn name(self) -> &'static str {
        match self {
            DeviceKind::Discrete => "discrete GPU",
            DeviceKind::Integrated => "integrated GPU",
            DeviceKind::Virtual => "virtual GPU",
            DeviceKind::Other => "other",
            DeviceKind::Cpu => "CPU",
        }
    }
}

/// The limits of a device that bound a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceLimits {
    /// Bytes of the largest buffer.
    pub max_buffer_bytes: u64,
    /// Bytes of the largest single allocation.
    pub max_allocation_bytes: u64,
    /// Bytes of the largest heap of device memory.
    pub heap_bytes: u64,
    /// Bytes of shared memory of a workgroup.
    pub shared_memory_bytes: u32,
    /// Invocations of a workgroup.
    pub workgroup_invocations: u32,
    /// Workgroups along each axis of a dispatch.
    pub workgroup_count: [u32; 3],
    /// Bytes of push constants.
    pub push_constant_bytes: u32,
    /// Invocations of a subgroup.
    pub subgroup_size: u32,
    /// Nanoseconds of one tick of a timestamp; 0 when the queue has none.
    pub timestamp_period_ns: f32,
    /// Bits of a timestamp; 0 when the queue has none.
    pub timestamp_bits: u32,
}

/// A Vulkan device, and what it lacks to serve.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceInfo {
    /// Its place in [`list_devices`], and the number that [`DeviceSelector::Index`] takes.
    pub index: usize,
    /// Name, as the driver tells it.
    pub name: String,
    /// What it is made of.
    pub kind: DeviceKind,
    /// Name of the driver.
    pub driver_name: String,
    /// The driver's version and what it was built with, as it tells it.
    pub driver_info: String,
    /// The driver's version as a number, in its maker's own encoding.
    pub driver_version: u32,
    /// Major, minor and patch of the Vulkan version.
    pub api_version: [u32; 3],
    /// Identifies the device over restarts; zero below Vulkan 1.1.
    pub uuid: [u8; 16],
    /// PCI vendor.
    pub vendor_id: u32,
    /// PCI device.
    pub device_id: u32,
    /// Limits.
    pub limits: DeviceLimits,
    /// Everything that it lacks; empty when it can serve.
    pub unsuitable: Vec<String>,
}

impl DeviceInfo {
    /// The UUID as text.
    pub fn uuid_text(&self) -> String {
        format_uuid(&self.uuid)
    }

    /// Whether the device can serve.
    pub fn is_suitable(&self) -> bool {
        self.unsuitable.is_empty()
    }

    fn line(&self) -> String {
        let lacks = if self.unsuitable.is_empty() { String::new() } else { format!(": lacks {}", self.unsuitable.join(", ")) };
        format!("{} {} ({}){lacks}", self.index, self.name, self.kind.name())
    }
}

/// Lists all Vulkan devices, with the reasons why one cannot serve.
///
/// # Errors
/// [`Error::NoVulkan`] without a loader or a driver.
pub fn list_devices() -> Result<Vec<DeviceInfo>> {
    let instance = Instance::new(false)?;
    Ok(instance.candidates()?.into_iter().map(|candidate| candidate.info).collect())
}

/// Messages of the validation layer, shared with the callback that receives them.
#[derive(Default)]
pub(crate) struct Messages(pub(crate) Mutex<Vec<String>>);

/// A physical device that was looked at.
pub(crate) struct Candidate {
    pub(crate) handle: vk::PhysicalDevice,
    pub(crate) info: DeviceInfo,
    pub(crate) queue_family: u32,
    /// Of a queue for copies beside the other: a family for copies alone, else `queue_family` if it has two queues.
    pub(crate) copy_family: Option<u32>,
    pub(crate) copy_timestamp_bits: u32,
    pub(crate) has_host_query_reset: bool,
    /// Extensions to enable: those that must be when they are there, the memory budget, and the import of memory of the host.
    pub(crate) extensions: Vec<&'static CStr>,
    pub(crate) has_budget: bool,
    /// Whether it offers acceleration structures and ray queries of its own.
    pub(crate) has_ray_query: bool,
    /// Whether large buffers are to lie in memory of the host.
    pub(crate) imports_host_memory: bool,
}

/// Usage of every buffer.
pub(crate) fn buffer_usage(has_ray_query: bool) -> vk::BufferUsageFlags {
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER
        | vk::BufferUsageFlags::TRANSFER_SRC
        | vk::BufferUsageFlags::TRANSFER_DST
        | vk::BufferUsageFlags::INDIRECT_BUFFER
        | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
    let structures =
        vk::BufferUsageFlags::ACCELERATION_STRUCTURE_STORAGE_KHR | vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;
    if has_ray_query { usage | structures } else { usage }
}

/// What acceleration structures and ray queries of a device need to be enabled.
pub(crate) const RAY_QUERY_EXTENSIONS: [&CStr; 3] =
    [khr::deferred_host_operations::NAME, khr::acceleration_structure::NAME, khr::ray_query::NAME];

/// The Vulkan instance; destroyed with it are the messenger and, last, the loader.
pub(crate) struct Instance {
    pub(crate) raw: ash::Instance,
    pub(crate) debug: Option<ext::debug_utils::Instance>,
    messenger: vk::DebugUtilsMessengerEXT,
    /// Not a box: its pointer, which the messenger has, would not outlive a move.
    pub(crate) messages: Arc<Messages>,
    /// Keeps the loader's library mapped for as long as its functions may be called.
    _entry: ash::Entry,
}

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

impl Instance {
    pub(crate) fn new(validation: bool) -> Result<Instance> {
        // SAFETY: loading the Vulkan loader runs its initialisers, which is what any Vulkan program asks for.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| Error::NoVulkan { reason: error.to_string() })?;
        let failed = |result: vk::Result| match result {
            vk::Result::ERROR_OUT_OF_HOST_MEMORY => Error::OutOfHostMemory,
            vk::Result::ERROR_INCOMPATIBLE_DRIVER => Error::NoVulkan { reason: "the loader finds no driver".to_owned() },
            result => Error::NoVulkan { reason: result.to_string() },
        };
        // SAFETY: the entry is loaded; the call has no other precondition.
        let loader_version = unsafe { entry.try_enumerate_instance_version() }.map_err(failed)?.unwrap_or(vk::API_VERSION_1_0);
        if loader_version < vk::API_VERSION_1_1 {
            return Err(Error::NoVulkan { reason: "the loader knows Vulkan 1.0 alone".to_owned() });
        }
        // SAFETY: as above.
        let available = unsafe { entry.enumerate_instance_extension_properties(None) }.map_err(failed)?;
        let has = |name: &CStr| available.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name));

        let mut layers = Vec::new();
        let mut has_features = false;
        let mut has_debug = has(ext::debug_utils::NAME);
        if validation {
            // SAFETY: as above.
            let installed = unsafe { entry.enumerate_instance_layer_properties() }.map_err(failed)?;
            if !installed.iter().any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER)) {
                return Err(Error::NoValidationLayer);
            }
            layers.push(VALIDATION_LAYER.as_ptr());
            // SAFETY: as above; the layer's name ends in a zero.
            let of_layer = unsafe { entry.enumerate_instance_extension_properties(Some(VALIDATION_LAYER)) }.map_err(failed)?;
            let layer_has = |name: &CStr| of_layer.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name));
            has_features = layer_has(ext::validation_features::NAME);
            has_debug |= layer_has(ext::debug_utils::NAME);
        }
        let mut extensions = Vec::new();
        let mut flags = vk::InstanceCreateFlags::empty();
        if has_debug {
            extensions.push(ext::debug_utils::NAME.as_ptr());
        }
        if has_features {
            extensions.push(ext::validation_features::NAME.as_ptr());
        }
        if has(khr::portability_enumeration::NAME) {
            extensions.push(khr::portability_enumeration::NAME.as_ptr());
            flags |= vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR;
        }

        let messages = Arc::<Messages>::default();
        let application =
            vk::ApplicationInfo::default().application_name(c"gridwalk").engine_name(c"gridwalk").api_version(vk::API_VERSION_1_3);
        let enables = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enables);
        // The callback's pointer stays valid for the life of the instance: what it points to does not move, and is dropped after it.
        let mut messenger_info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING)
            .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE)
            .pfn_user_callback(Some(collect))
            .user_data(Arc::as_ptr(&messages).cast_mut().cast::<c_void>());
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .flags(flags)
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extensions);
        if has_features {
            info = info.push_next(&mut features);
        }
        if validation && has_debug {
            info = info.push_next(&mut messenger_info);
        }
        // SAFETY: every pointer of the info outlives the call; layers and extensions were enumerated above.
        let raw = unsafe { entry.create_instance(&info, None) }.map_err(failed)?;
        let debug = has_debug.then(|| ext::debug_utils::Instance::new(&entry, &raw));
        let mut instance = Instance { raw, debug, messenger: vk::DebugUtilsMessengerEXT::null(), messages, _entry: entry };
        if let (true, Some(debug)) = (validation, &instance.debug) {
            messenger_info.p_next = std::ptr::null();
            // SAFETY: the instance enables debug_utils; the info is complete.
            instance.messenger = unsafe { debug.create_debug_utils_messenger(&messenger_info, None) }
                .map_err(Error::vulkan("vkCreateDebugUtilsMessengerEXT"))?;
        }
        Ok(instance)
    }

    pub(crate) fn candidates(&self) -> Result<Vec<Candidate>> {
        // SAFETY: the instance lives.
        let handles = unsafe { self.raw.enumerate_physical_devices() }.map_err(Error::vulkan("vkEnumeratePhysicalDevices"))?;
        handles.into_iter().enumerate().map(|(index, handle)| self.candidate(index, handle)).collect()
    }

    fn candidate(&self, index: usize, handle: vk::PhysicalDevice) -> Result<Candidate> {
        // SAFETY: the handle comes from this instance, which was made for Vulkan 1.3.
        let mut unsuitable = unsafe { gridwalk::requirements::query(&self.raw, handle) }.missing;
        // SAFETY: the handle comes from this instance.
        let core = unsafe { self.raw.get_physical_device_properties(handle) };
        let api =
            [vk::api_version_major(core.api_version), vk::api_version_minor(core.api_version), vk::api_version_patch(core.api_version)];
        let mut vulkan11 = vk::PhysicalDeviceVulkan11Properties::default();
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Properties::default();
        let mut vulkan13 = vk::PhysicalDeviceVulkan13Properties::default();
        if core.api_version >= vk::API_VERSION_1_3 {
            let mut properties =
                vk::PhysicalDeviceProperties2::default().push_next(&mut vulkan11).push_next(&mut vulkan12).push_next(&mut vulkan13);
            // SAFETY: the handle comes from this instance; the device knows Vulkan 1.3 and so every struct of the chain.
            unsafe { self.raw.get_physical_device_properties2(handle, &mut properties) };
        }
        let mut vulkan12_features = vk::PhysicalDeviceVulkan12Features::default();
        if core.api_version >= vk::API_VERSION_1_3 {
            let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut vulkan12_features);
            // SAFETY: as above.
            unsafe { self.raw.get_physical_device_features2(handle, &mut features) };
        }
        // SAFETY: the handle comes from this instance.
        let families = unsafe { self.raw.get_physical_device_queue_family_properties(handle) };
        let computes = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
        let family = families
            .iter()
            .position(|family| computes(family) && family.timestamp_valid_bits > 0)
            .or_else(|| families.iter().position(computes));
        let timestamp_bits = family.and_then(|family| families.get(family)).map_or(0, |family| family.timestamp_valid_bits);
        let copy_family = families
            .iter()
            .enumerate()
            .filter(|(_, family)| {
                let other = vk::QueueFlags::COMPUTE | vk::QueueFlags::GRAPHICS;
                family.queue_flags.contains(vk::QueueFlags::TRANSFER) && !family.queue_flags.intersects(other)
            })
            // Video queues can copy too; the engine made for it can do the least else.
            .min_by_key(|(_, family)| family.queue_flags.as_raw().count_ones())
            .map(|(index, _)| index)
            .or_else(|| family.filter(|&family| families.get(family).is_some_and(|family| family.queue_count > 1)));
        let copy_timestamp_bits =
            copy_family.or(family).and_then(|index| families.get(index)).map_or(0, |family| family.timestamp_valid_bits);
        if family.is_none() {
            unsuitable.push("a queue for compute".to_owned());
        }

        // SAFETY: the handle comes from this instance.
        let offered = unsafe { self.raw.enumerate_device_extension_properties(handle) }
            .map_err(Error::vulkan("vkEnumerateDeviceExtensionProperties"))?;
        let has = |name: &CStr| offered.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name));
        let has_budget = has(ext::memory_budget::NAME);
        let mut has_ray_query = RAY_QUERY_EXTENSIONS.into_iter().all(has);
        if has_ray_query {
            let mut structures = vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default();
            let mut queries = vk::PhysicalDeviceRayQueryFeaturesKHR::default();
            let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut structures).push_next(&mut queries);
            // SAFETY: the handle comes from this instance; the device has the extensions, so it knows both structs.
            unsafe { self.raw.get_physical_device_features2(handle, &mut features) };
            has_ray_query = structures.acceleration_structure == vk::TRUE && queries.ray_query == vk::TRUE;
        }
        let kind = DeviceKind::new(core.device_type);
        let imports_host_memory = cfg!(target_os = "linux")
            && kind == DeviceKind::Cpu
            && has(ext::external_memory_host::NAME)
            && self.can_import_host_memory(handle, has_ray_query);
        let mut extensions = Vec::new();
        if imports_host_memory {
            extensions.push(ext::external_memory_host::NAME);
        }
        if has_budget {
            extensions.push(ext::memory_budget::NAME);
        }
        if has(khr::portability_subset::NAME) {
            extensions.push(khr::portability_subset::NAME);
        }

        // SAFETY: the handle comes from this instance.
        let memory = unsafe { self.raw.get_physical_device_memory_properties(handle) };
        let heap_bytes = memory
            .memory_heaps_as_slice()
            .iter()
            .filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL))
            .map(|heap| heap.size)
            .max()
            .unwrap_or(0);
        let text = |text: Result<&CStr, _>| text.map(|text: &CStr| text.to_string_lossy().into_owned()).unwrap_or_default();
        let info = DeviceInfo {
            index,
            name: text(core.device_name_as_c_str().map_err(drop)),
            kind,
            driver_name: text(vulkan12.driver_name_as_c_str().map_err(drop)),
            driver_info: text(vulkan12.driver_info_as_c_str().map_err(drop)),
            driver_version: core.driver_version,
            api_version: api,
            uuid: vulkan11.device_uuid,
            vendor_id: core.vendor_id,
            device_id: core.device_id,
            limits: DeviceLimits {
                max_buffer_bytes: vulkan13.max_buffer_size,
                max_allocation_bytes: vulkan11.max_memory_allocation_size,
                heap_bytes,
                shared_memory_bytes: core.limits.max_compute_shared_memory_size,
                workgroup_invocations: core.limits.max_compute_work_group_invocations,
                workgroup_count: core.limits.max_compute_work_group_count,
                push_constant_bytes: core.limits.max_push_constants_size,
                subgroup_size: vulkan11.subgroup_size,
                timestamp_bits,
                timestamp_period_ns: if timestamp_bits > 0 { core.limits.timestamp_period } else { 0.0 },
            },
            unsuitable,
        };
        Ok(Candidate {
            handle,
            info,
            queue_family: family.and_then(|family| u32::try_from(family).ok()).unwrap_or(0),
            copy_family: copy_family.and_then(|family| u32::try_from(family).ok()),
            copy_timestamp_bits,
            has_host_query_reset: core.api_version >= vk::API_VERSION_1_3 && vulkan12_features.host_query_reset == vk::TRUE,
            extensions,
            has_budget,
            has_ray_query,
            imports_host_memory,
        })
    }

    /// Whether storage buffers may lie in memory of the host that begins and ends with huge pages.
    fn can_import_host_memory(&self, handle: vk::PhysicalDevice, has_ray_query: bool) -> bool {
        let mut limits = vk::PhysicalDeviceExternalMemoryHostPropertiesEXT::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut limits);
        let info = vk::PhysicalDeviceExternalBufferInfo::default().usage(buffer_usage(has_ray_query)).handle_type(host_memory::HANDLE_TYPE);
        let mut buffers = vk::ExternalBufferProperties::default();
        // SAFETY: the handle comes from this instance; the device has the extension, so it knows struct and type.
        unsafe {
            self.raw.get_physical_device_properties2(handle, &mut properties);
            self.raw.get_physical_device_external_buffer_properties(handle, &info, &mut buffers);
        }
        let buffers = buffers.external_memory_properties;
        buffers.external_memory_features.contains(vk::ExternalMemoryFeatureFlags::IMPORTABLE)
            && buffers.compatible_handle_types.contains(host_memory::HANDLE_TYPE)
            && limits.min_imported_host_pointer_alignment <= host_memory::HUGE_PAGE
    }

    /// The device that the selector names; only `Best` and `Cpu` pass over those that cannot serve.
    pub(crate) fn select(&self, selector: &DeviceSelector) -> Result<Candidate> {
        let mut candidates = self.candidates()?;
        let lines: Vec<String> = candidates.iter().map(|candidate| candidate.info.line()).collect();
        let position = |matches: &dyn Fn(&DeviceInfo) -> bool| {
            let suitable = candidates.iter().position(|candidate| matches(&candidate.info) && candidate.info.is_suitable());
            suitable.or_else(|| candidates.iter().position(|candidate| matches(&candidate.info)))
        };
        let found = match selector {
            DeviceSelector::Best => candidates
                .iter()
                .enumerate()
                .filter(|(_, candidate)| candidate.info.is_suitable())
                .min_by_key(|(_, candidate)| candidate.info.kind)
                .map(|(index, _)| index),
            DeviceSelector::Index(index) => position(&|info| info.index == *index),
            DeviceSelector::Name(name) => {
                let name = name.to_lowercase();
                position(&|info| info.name.to_lowercase().contains(&name))
            }
            DeviceSelector::Uuid(uuid) => position(&|info| info.uuid == *uuid),
            DeviceSelector::Cpu => position(&|info| info.kind == DeviceKind::Cpu),
        };
        let Some(found) = found else {
            return Err(if *selector == DeviceSelector::Best {
                Error::NoDevice { reasons: lines }
            } else {
                Error::NoSuchDevice { selector: selector.to_string(), devices: lines }
            });
        };
        let candidate = candidates.swap_remove(found);
        if candidate.info.is_suitable() { Ok(candidate) } else { Err(Error::NoDevice { reasons: vec![candidate.info.line()] }) }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: whoever owns the instance has destroyed the device made from it (`Shared` drops it first); the messenger is null or
        // belongs to this instance.
        unsafe {
            if let (Some(debug), false) = (&self.debug, self.messenger == vk::DebugUtilsMessengerEXT::null()) {
                debug.destroy_debug_utils_messenger(self.messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}

/// Receives the messages of the validation layer.
///
/// # Safety
/// Called by the loader alone, with the `Messages` of the instance as user data.
unsafe extern "system" fn collect(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the loader passes a valid message, and the user data is the shared `Messages`, which outlives the instance.
    let (text, messages) = unsafe {
        let text = (*data).message_as_c_str().map_or_else(String::new, |text| text.to_string_lossy().into_owned());
        (text, &*user.cast_const().cast::<Messages>())
    };
    let mut messages = messages.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    messages.push(format!("{severity:?}: {text}"));
    vk::FALSE
}
