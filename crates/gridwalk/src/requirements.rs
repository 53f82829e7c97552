//! What the library needs of a device.

use ash::vk;

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
/// let info = ash::vk::DeviceCreateInfo::default().push_next(&mut features.vulkan_12).push_next(&mut features.vulkan_13);
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
