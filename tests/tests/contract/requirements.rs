//! What is said before there is a device.

use std::ffi::{CStr, c_void};

use gridwalk::ash::{self, vk};
use gridwalk::{Error, requirements};
use gridwalk_tests::foreign::Foreign;

/// A physical device of Vulkan 1.3 that has nothing.
unsafe extern "system" fn poor_properties(_: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceProperties) {
    // SAFETY: Vulkan's contract, here and below.
    unsafe { *found = vk::PhysicalDeviceProperties::default().api_version(vk::API_VERSION_1_3) };
}

unsafe extern "system" fn old_properties(_: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceProperties) {
    // SAFETY: as above.
    unsafe { *found = vk::PhysicalDeviceProperties::default().api_version(vk::API_VERSION_1_1) };
}

unsafe extern "system" fn no_features(_: vk::PhysicalDevice, _: *mut vk::PhysicalDeviceFeatures2<'_>) {}

unsafe extern "system" fn no_properties(_: vk::PhysicalDevice, _: *mut vk::PhysicalDeviceProperties2<'_>) {}

unsafe extern "system" fn other() {
    std::process::abort();
}

fn missing(properties: *const c_void) -> Vec<String> {
    let load = |name: &CStr| match name.to_bytes() {
        b"vkGetPhysicalDeviceProperties" => properties,
        b"vkGetPhysicalDeviceFeatures2" => no_features as *const c_void,
        b"vkGetPhysicalDeviceProperties2" => no_properties as *const c_void,
        _ => other as *const c_void,
    };
    // SAFETY: the functions have the types that their names stand for, and follow no handle.
    let instance = unsafe { ash::Instance::load_with(load, vk::Instance::null()) };
    // SAFETY: as above.
    match unsafe { gridwalk::requirements(&instance, vk::PhysicalDevice::null()) } {
        Err(Error::Unsuitable { missing }) => missing,
        other => panic!("{other:?}"),
    }
}

#[test]
fn all_that_is_missing_is_named_at_once() {
    let poor = missing(poor_properties as *const c_void);
    for name in ["bufferDeviceAddress", "synchronization2", "maxComputeWorkGroupInvocations", "maxComputeSharedMemorySize"] {
        assert!(poor.iter().any(|missing| missing.contains(name)), "{name}: {poor:?}");
    }
    assert_eq!(poor.len(), 7, "{poor:?}");
    // Of an older version nothing else can be asked.
    let old = missing(old_properties as *const c_void);
    assert!(old.len() == 1 && old[0].contains("1.3") && old[0].contains("1.1"), "{old:?}");
}

/// [`Foreign`] is made with what `features` gives; a chain of the caller's own gets the same.
#[test]
fn a_chain_is_filled() {
    let foreign = Foreign::new();
    // SAFETY: the handles are of each other.
    let features = unsafe { gridwalk::requirements(&foreign.instance, foreign.physical_device) }.unwrap();
    let mut vulkan_13 = vk::PhysicalDeviceVulkan13Features::default().maintenance4(true);
    let mut vulkan_12 = vk::PhysicalDeviceVulkan12Features { p_next: (&raw mut vulkan_13).cast(), ..Default::default() };
    // SAFETY: the chain is of two structures that live.
    unsafe { requirements::fill((&raw mut vulkan_12).cast()) }.unwrap();
    let flags = |features: &vk::PhysicalDeviceVulkan12Features| (features.buffer_device_address, features.descriptor_indexing);
    assert_eq!(flags(&vulkan_12), flags(&features.vulkan_12));
    assert_eq!((vulkan_13.synchronization2, vulkan_13.maintenance4), (vk::TRUE, vk::TRUE));
    assert_eq!(features.vulkan_13.synchronization2, vk::TRUE);

    let mut synchronization = vk::PhysicalDeviceSynchronization2Features::default();
    let mut address = vk::PhysicalDeviceBufferDeviceAddressFeatures { p_next: (&raw mut synchronization).cast(), ..Default::default() };
    // SAFETY: as above.
    unsafe { requirements::fill((&raw mut address).cast()) }.unwrap();
    assert_eq!((address.buffer_device_address, synchronization.synchronization2), (vk::TRUE, vk::TRUE));

    for (first, lacks) in [((&raw mut vulkan_13).cast(), "Vulkan12"), (std::ptr::null_mut(), "Vulkan12")] {
        // SAFETY: as above.
        let error = unsafe { requirements::fill(first) }.unwrap_err();
        assert!(matches!(error, Error::Chain { structure } if structure.contains(lacks)), "{error}");
    }
    vulkan_12.p_next = std::ptr::null_mut();
    // SAFETY: as above.
    let error = unsafe { requirements::fill((&raw mut vulkan_12).cast()) }.unwrap_err();
    assert!(error.to_string().contains("VkPhysicalDeviceVulkan13Features"), "{error}");
    // SAFETY: as above.
    let missing = unsafe { requirements::query(&foreign.instance, foreign.physical_device) }.missing;
    assert_eq!(missing, [""; 0]);
}
