//! Memory of the host as memory of the device.
//!
//! On a CPU driver both are one. What such a driver allocates lies in small pages, though (Mesa 25's is a file in memory, which Linux keeps
//! out of huge pages unless told otherwise), and rays through a large scene wait for the translation of its addresses. So large buffers
//! there lie in memory of our own, for which the kernel is asked for huge pages.

use crate::{Error, Result, device::Candidate};
use ash::{ext, vk};
use memmap2::{MmapMut, MmapRaw};
use std::mem::ManuallyDrop;

/// Bytes of a huge page, which the memory begins and ends with: those of x86-64, and of AArch64 with pages of 4 KiB.
pub(crate) const HUGE_PAGE: u64 = 2 << 20;

/// What kind of memory it is to Vulkan.
pub(crate) const HANDLE_TYPE: vk::ExternalMemoryHandleTypeFlags = vk::ExternalMemoryHandleTypeFlags::HOST_ALLOCATION_EXT;

/// Smallest buffer that is worth pages of its own.
const LEAST_BYTES: u64 = 2 * HUGE_PAGE;

/// Imports memory of the host.
pub(crate) struct Importer {
    device: ash::Device,
    functions: ext::external_memory_host::Device,
    types: vk::PhysicalDeviceMemoryProperties,
}

/// Imported memory. Nothing but [`HostMemory::free`] frees and unmaps it: the device may be using it.
pub(crate) struct HostMemory {
    raw: vk::DeviceMemory,
    properties: vk::MemoryPropertyFlags,
    pages: ManuallyDrop<MmapRaw>,
    begin: usize,
}

impl Importer {
    /// `None` where the device cannot import memory of the host, or would gain nothing by it.
    pub(crate) fn new(instance: &ash::Instance, device: &ash::Device, candidate: &Candidate) -> Option<Importer> {
        candidate.imports_host_memory.then(|| Importer {
            device: device.clone(),
            functions: ext::external_memory_host::Device::new(instance, device),
            // SAFETY: the handle comes from this instance.
            types: unsafe { instance.get_physical_device_memory_properties(candidate.handle) },
        })
    }

    /// Bytes that a buffer of this size would take, if it is to lie in such memory.
    pub(crate) fn bytes_for(&self, size: u64) -> Option<u64> {
        if size < LEAST_BYTES { None } else { size.checked_next_multiple_of(HUGE_PAGE) }
    }

    /// Memory for a buffer of [`HANDLE_TYPE`]; `out_of_memory` tells that there is not enough.
    pub(crate) fn allocate(
        &self,
        requirements: &vk::MemoryRequirements,
        name: &str,
        out_of_memory: impl Fn() -> Error,
    ) -> Result<HostMemory> {
        let size = requirements.size.next_multiple_of(HUGE_PAGE);
        // Room to begin with a huge page wherever the mapping lies.
        let length = size.checked_add(HUGE_PAGE).and_then(|length| usize::try_from(length).ok()).ok_or_else(&out_of_memory)?;
        let pages = MmapRaw::from(MmapMut::map_anon(length).map_err(|_| out_of_memory())?);
        let begin = pages.as_ptr().align_offset(HUGE_PAGE as usize);
        // A help: where the kernel has no huge pages, or has them switched off, small ones do.
        #[cfg(target_os = "linux")]
        let _ = pages.advise_range(memmap2::Advice::HugePage, begin, size as usize);
        // SAFETY: `begin` is below a huge page, which the mapping is longer than `size` by.
        let pointer = unsafe { pages.as_mut_ptr().add(begin) };

        let mut admitted = vk::MemoryHostPointerPropertiesEXT::default();
        let properties_of = self.functions.fp().get_memory_host_pointer_properties_ext;
        // SAFETY: the extension is enabled on this device, and the pointer begins `size` bytes of a mapping of ours.
        unsafe { properties_of(self.device.handle(), HANDLE_TYPE, pointer.cast(), &mut admitted) }
            .result()
            .map_err(Error::vulkan("vkGetMemoryHostPointerPropertiesEXT"))?;
        let bits = admitted.memory_type_bits & requirements.memory_type_bits;
        let Some((memory_type, properties)) = (0..)
            .zip(self.types.memory_types_as_slice())
            .find(|(index, _)| bits >> index & 1 == 1)
            .map(|(index, kind)| (index, kind.property_flags))
        else {
            return Err(Error::Allocator { name: name.to_owned(), reason: "no type of memory takes memory of the host".to_owned() });
        };
        let mut import = vk::ImportMemoryHostPointerInfoEXT::default().handle_type(HANDLE_TYPE).host_pointer(pointer.cast());
        let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
        let info = vk::MemoryAllocateInfo::default()
            .allocation_size(size)
            .memory_type_index(memory_type)
            .push_next(&mut import)
            .push_next(&mut flags);
        // SAFETY: pointer and size are multiples of a huge page, and so of the alignment that the device asks for; the memory is mapped until
        // after the import is freed.
        let raw = unsafe { self.device.allocate_memory(&info, None) }.map_err(|result| match result {
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => out_of_memory(),
            result => Error::vulkan("vkAllocateMemory")(result),
        })?;
        Ok(HostMemory { raw, properties, pages: ManuallyDrop::new(pages), begin })
    }
}

impl HostMemory {
    /// The Vulkan object.
    pub(crate) fn raw(&self) -> vk::DeviceMemory {
        self.raw
    }

    /// Of its type of memory.
    pub(crate) fn properties(&self) -> vk::MemoryPropertyFlags {
        self.properties
    }

    /// The first byte.
    pub(crate) fn pointer(&self) -> *mut u8 {
        self.pages.as_mut_ptr().wrapping_add(self.begin)
    }

    /// Frees the memory.
    ///
    /// # Safety
    /// The device, which it was imported by, lives and uses it no more; buffers that were bound to it are destroyed.
    pub(crate) unsafe fn free(self, device: &ash::Device) {
        // SAFETY: the caller's contract.
        unsafe { device.free_memory(self.raw, None) };
        drop(ManuallyDrop::into_inner(self.pages));
    }
}
