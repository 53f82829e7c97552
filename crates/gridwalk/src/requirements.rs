//! What the library needs of a device: asked for, and said, before there is one.

use std::ffi::c_void;

use ash::vk;

use crate::error::{Error, Result};

/// What a device must have enabled, if the physical device can serve: [`query`] and [`features`] in one.
///
/// ```no_run
/// use gridwalk::ash::{self, vk};
///
/// unsafe fn create(instance: &ash::Instance, physical_device: vk::PhysicalDevice) -> Result<ash::Device, Box<dyn std::error::Error>> {
///     let mut features = unsafe { gridwalk::requirements(instance, physical_device)? }; // the error names all that is missing
///     features.vulkan_12.timeline_semaphore = vk::TRUE; // what the engine itself wants, in the same structures
///     let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&[1.0])];
///     let info = features.chain(vk::DeviceCreateInfo::default().queue_create_infos(&queues));
///     Ok(unsafe { instance.create_device(physical_device, &info, None)? })
/// }
/// ```
///
/// # Errors
/// [`Error::Unsuitable`] names all that the physical device lacks.
///
/// # Safety
/// As for [`query`].
pub unsafe fn requirements(instance: &ash::Instance, physical_device: vk::PhysicalDevice) -> Result<Features> {
    // SAFETY: the caller's contract.
    let Found { missing, .. } = unsafe { query(instance, physical_device) };
    if missing.is_empty() { Ok(features()) } else { Err(Error::Unsuitable { missing }) }
}

/// What a physical device offers.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Found {
    /// All that is missing, in words; empty if the device can serve.
    pub missing: Vec<String>,
    /// Whether it runs on CPU cores.
    pub is_cpu: bool,
    /// Largest buffer that the device can have and allocate, bytes.
    pub max_buffer_size: u64,
}

/// Features that the device must have enabled, to be chained into `VkDeviceCreateInfo`.
///
/// ```
/// let mut features = gridwalk::requirements::features();
/// let info = features.chain(gridwalk::ash::vk::DeviceCreateInfo::default());
/// # let _ = info;
/// ```
pub fn features() -> Features {
    Features {
        vulkan_12: vk::PhysicalDeviceVulkan12Features::default().buffer_device_address(true),
        vulkan_13: vk::PhysicalDeviceVulkan13Features::default().synchronization2(true),
    }
}

/// The structures of [`features`].
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Features {
    /// `bufferDeviceAddress`.
    pub vulkan_12: vk::PhysicalDeviceVulkan12Features<'static>,
    /// `synchronization2`.
    pub vulkan_13: vk::PhysicalDeviceVulkan13Features<'static>,
}

impl Features {
    /// Puts the structures before whatever the device's creation has chained already.
    pub fn chain<'a>(&'a mut self, info: vk::DeviceCreateInfo<'a>) -> vk::DeviceCreateInfo<'a> {
        info.push_next(&mut self.vulkan_12).push_next(&mut self.vulkan_13)
    }
}

/// Enables what the library needs in a chain of the caller's own, which leaves all else as it is: in `VkPhysicalDeviceVulkan12Features` and
/// `VkPhysicalDeviceVulkan13Features`, or in the structures of single features, `VkPhysicalDeviceBufferDeviceAddressFeatures` and
/// `VkPhysicalDeviceSynchronization2Features`.
///
/// # Errors
/// [`Error::Chain`] if the chain has no place for a feature; the others are enabled then.
///
/// # Safety
/// `first` is null or the first structure of a chain by `pNext`, which ends, and whose structures are as their `sType` says.
pub unsafe fn fill(first: *mut c_void) -> Result<()> {
    let (mut address, mut synchronization) = (false, false);
    let mut next = first.cast::<vk::BaseOutStructure>();
    // SAFETY: every structure of a chain begins with type and next, and is what its type says.
    unsafe {
        while let Some(structure) = next.as_mut() {
            match structure.s_type {
                vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_2_FEATURES => {
                    (*next.cast::<vk::PhysicalDeviceVulkan12Features>()).buffer_device_address = vk::TRUE;
                    address = true;
                }
                vk::StructureType::PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES => {
                    (*next.cast::<vk::PhysicalDeviceBufferDeviceAddressFeatures>()).buffer_device_address = vk::TRUE;
                    address = true;
                }
                vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_3_FEATURES => {
                    (*next.cast::<vk::PhysicalDeviceVulkan13Features>()).synchronization2 = vk::TRUE;
                    synchronization = true;
                }
                vk::StructureType::PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES => {
                    (*next.cast::<vk::PhysicalDeviceSynchronization2Features>()).synchronization2 = vk::TRUE;
                    synchronization = true;
                }
                _ => {}
            }
            next = (*next).p_next;
        }
    }
    match (address, synchronization) {
        (false, _) => Err(Error::Chain { structure: "VkPhysicalDeviceVulkan12Features" }),
        (_, false) => Err(Error::Chain { structure: "VkPhysicalDeviceVulkan13Features" }),
        _ => Ok(()),
    }
}

/// Looks at a physical device.
///
/// # Safety
/// The handles are valid and of each other; the instance was created for Vulkan 1.3 or later.
pub unsafe fn query(instance: &ash::Instance, physical_device: vk::PhysicalDevice) -> Found {
    // SAFETY: the caller's contract.
    let properties = unsafe { instance.get_physical_device_properties(physical_device) };
    let mut missing = Vec::new();
    if properties.api_version < vk::API_VERSION_1_3 {
        missing.push(format!(
            "Vulkan 1.3 (it has {}.{})",
            vk::api_version_major(properties.api_version),
            vk::api_version_minor(properties.api_version)
        ));
        return Found { missing, is_cpu: properties.device_type == vk::PhysicalDeviceType::CPU, max_buffer_size: 0 };
    }
    let mut vulkan_12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut vulkan_13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut vulkan_12).push_next(&mut vulkan_13);
    // SAFETY: as above; the chain lives until the call returns.
    unsafe { instance.get_physical_device_features2(physical_device, &mut features) };
    if vulkan_12.buffer_device_address == vk::FALSE {
        missing.push("feature bufferDeviceAddress".into());
    }
    if vulkan_13.synchronization2 == vk::FALSE {
        missing.push("feature synchronization2".into());
    }
    let limits = &properties.limits;
    let mut at_least = |name: &str, found: u32, needed: u32| {
        if found < needed {
            missing.push(format!("{name} of {needed} (it has {found})"));
        }
    };
    at_least("maxComputeWorkGroupInvocations", limits.max_compute_work_group_invocations, 256);
    at_least("maxComputeWorkGroupSize[0]", limits.max_compute_work_group_size[0], 256);
    at_least("maxComputeSharedMemorySize", limits.max_compute_shared_memory_size, 16_384);
    at_least("maxComputeWorkGroupCount[0]", limits.max_compute_work_group_count[0], 65_535);
    at_least("maxComputeWorkGroupCount[1]", limits.max_compute_work_group_count[1], 65_535);
    let mut vulkan_11 = vk::PhysicalDeviceVulkan11Properties::default();
    let mut maintenance_4 = vk::PhysicalDeviceMaintenance4Properties::default();
    let mut properties_2 = vk::PhysicalDeviceProperties2::default().push_next(&mut vulkan_11).push_next(&mut maintenance_4);
    // SAFETY: as above; both structures are part of Vulkan 1.3.
    unsafe { instance.get_physical_device_properties2(physical_device, &mut properties_2) };
    Found {
        missing,
        is_cpu: properties.device_type == vk::PhysicalDeviceType::CPU,
        max_buffer_size: vulkan_11.max_memory_allocation_size.min(maintenance_4.max_buffer_size),
    }
}
