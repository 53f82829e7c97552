//! Vulkan's functions, found through the caller's `vkGetInstanceProcAddr`.

use std::ffi::{CStr, c_void};

use gridwalk::ash::{self, vk};

use crate::error::{Failure, Result};
use crate::types::PFN_vkGetInstanceProcAddr;

/// ash puts a function that ends the process in place of each that is not found, so the first that is missing is an error. The core
/// functions of 1.0 to 1.3 are all there if instance and device were created for 1.3.
fn first(missing: Option<String>, of: &'static str) -> Result<()> {
    match missing {
        Some(function) => Err(Failure::Loader { function, of }),
        None => Ok(()),
    }
}

fn note(missing: &mut Option<String>, name: &CStr, function: vk::PFN_vkVoidFunction) -> *const c_void {
    if function.is_none() {
        missing.get_or_insert_with(|| name.to_string_lossy().into_owned());
    }
    function.map_or(std::ptr::null(), |function| function as *const c_void)
}

/// # Safety
/// The function is Vulkan's, the instance valid.
pub unsafe fn instance(get: PFN_vkGetInstanceProcAddr, instance: vk::Instance) -> Result<ash::Instance> {
    let get = get.0.ok_or(Failure::Null("get_instance_proc_addr"))?;
    if instance == vk::Instance::null() {
        return Err(Failure::Null("instance"));
    }
    let mut missing = None;
    // SAFETY: the caller's contract; names end with a zero byte, and functions have the types that their names stand for.
    let loaded = unsafe { ash::Instance::load_with(|name| note(&mut missing, name, get(instance, name.as_ptr())), instance) };
    first(missing, "instance").map(|()| loaded)
}

/// # Safety
/// The device is valid, and of the instance.
pub unsafe fn device(instance: &ash::Instance, device: vk::Device) -> Result<ash::Device> {
    if device == vk::Device::null() {
        return Err(Failure::Null("device"));
    }
    let get = instance.fp_v1_0().get_device_proc_addr;
    let mut missing = None;
    // SAFETY: as above.
    let loaded = unsafe { ash::Device::load_with(|name| note(&mut missing, name, get(device, name.as_ptr())), device) };
    first(missing, "device").map(|()| loaded)
}

/// # Safety
/// As for [`device`].
pub unsafe fn debug_utils(instance: &ash::Instance, device: &ash::Device) -> Result<ash::ext::debug_utils::Device> {
    let get = instance.fp_v1_0().get_device_proc_addr;
    for name in [c"vkSetDebugUtilsObjectNameEXT", c"vkCmdBeginDebugUtilsLabelEXT", c"vkCmdEndDebugUtilsLabelEXT"] {
        // SAFETY: the caller's contract.
        if unsafe { get(device.handle(), name.as_ptr()) }.is_none() {
            return Err(Failure::Option("debug_utils = VK_TRUE: the instance does not have VK_EXT_debug_utils enabled".to_owned()));
        }
    }
    Ok(ash::ext::debug_utils::Device::new(instance, device))
}
