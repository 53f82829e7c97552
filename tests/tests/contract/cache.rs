//! The caller's pipeline cache.

use std::ffi::{CStr, c_void};
use std::sync::{Mutex, OnceLock};

use gridwalk::ash::{self, vk};
use gridwalk::{DeviceDesc, Tracer};
use gridwalk_tests::foreign::{Foreign, Memory, Placed, Terrain};

/// A cache that begins with some data; `None` where the driver refuses them, which it may.
fn cache(foreign: &Foreign, data: &[u8]) -> Option<vk::PipelineCache> {
    let info = vk::PipelineCacheCreateInfo::default().initial_data(data);
    // SAFETY: the device lives.
    unsafe { foreign.device.create_pipeline_cache(&info, None) }.ok()
}

fn contents(foreign: &Foreign, cache: vk::PipelineCache) -> Vec<u8> {
    // SAFETY: the cache is of the device.
    unsafe { foreign.device.get_pipeline_cache_data(cache) }.unwrap()
}

/// Creates a tracer through a cache, traces with it, and gives what the cache holds then.
fn through(foreign: &Foreign, cache: vk::PipelineCache) -> Vec<u8> {
    let tracer = foreign.tracer(cache);
    let memory = Memory::new(foreign, 2 << 20);
    let placed = Placed::new(&memory, &tracer, Terrain::new(5, 4));
    let commands = foreign.record(|cmd| {
        // SAFETY: what is recorded is submitted once and waited for below, while all of it lives.
        unsafe {
            placed.cmd_build(&tracer, cmd);
            gridwalk::cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::TRACE);
            placed.cmd_trace(&tracer, cmd);
        }
    });
    foreign.submit(&[&commands]);
    placed.check();
    let data = contents(foreign, cache);
    // SAFETY: the tracer's pipelines keep no reference to the cache.
    unsafe { foreign.device.destroy_pipeline_cache(cache, None) };
    data
}

/// `vkCreateComputePipelines` of the device under test, and the caches that it was called with.
static CREATE: OnceLock<vk::PFN_vkCreateComputePipelines> = OnceLock::new();
static CACHES: Mutex<Vec<vk::PipelineCache>> = Mutex::new(Vec::new());

unsafe extern "system" fn create_noting_the_cache(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::ComputePipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    CACHES.lock().unwrap().push(cache);
    // SAFETY: all is passed on to the function that it was meant for.
    unsafe { (CREATE.get().unwrap())(device, cache, count, infos, allocator, pipelines) }
}

/// Whatever a driver keeps in it, each pipeline is made through the cache that the caller gave.
#[test]
fn every_pipeline_is_made_through_the_callers_cache() {
    let foreign = Foreign::new();
    let instance = &foreign.instance;
    let load = |name: &CStr| -> *const c_void {
        // SAFETY: instance and device are of each other, and the function's type is that of its name.
        unsafe {
            let found = instance.get_device_proc_addr(foreign.device.handle(), name.as_ptr());
            if name != c"vkCreateComputePipelines" {
                return found.map_or(std::ptr::null(), |function| function as *const c_void);
            }
            let _ = CREATE.set(std::mem::transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateComputePipelines>(found));
            create_noting_the_cache as *const c_void
        }
    };
    // SAFETY: the handle is of a device, whose functions these are.
    let device = unsafe { ash::Device::load_with(load, foreign.device.handle()) };
    let cache = cache(&foreign, &[]).unwrap();
    let desc = DeviceDesc { pipeline_cache: cache, ..DeviceDesc::new(instance, foreign.physical_device, &device) };
    // SAFETY: the handles are of each other, and the tracer is dropped before the device.
    drop(unsafe { Tracer::new(&desc) }.unwrap());
    let caches = std::mem::take(&mut *CACHES.lock().unwrap());
    assert!(caches.len() > 20 && caches.iter().all(|given| *given == cache), "{caches:?}");
    // SAFETY: the cache is of the device.
    unsafe { foreign.device.destroy_pipeline_cache(cache, None) };
    foreign.check();
}

#[test]
fn the_callers_cache_is_used() {
    let foreign = Foreign::new();
    let empty = cache(&foreign, &[]).unwrap();
    let header = contents(&foreign, empty).len();
    let filled = through(&foreign, empty);
    if filled.len() == header {
        eprintln!("skipped: the driver keeps nothing in pipeline caches");
        return;
    }
    // A second creation finds all that it needs: the cache does not grow.
    let again = through(&foreign, cache(&foreign, &filled).unwrap());
    assert_eq!(again.len(), filled.len());
    foreign.check();
}

#[test]
fn spoilt_cache_data_do_no_harm() {
    let foreign = Foreign::new();
    let good = through(&foreign, cache(&foreign, &[]).unwrap());
    let mut another_device = good.clone();
    another_device[16..32].iter_mut().for_each(|byte| *byte = !*byte);
    let mut another_vendor = good.clone();
    another_vendor[8] ^= 0xFF;
    let truncated = good[..good.len() / 2].to_vec();
    let mut flipped = good.clone();
    flipped.iter_mut().skip(32).step_by(7).for_each(|byte| *byte ^= 0x55);
    let noise: Vec<u8> = (0..4096u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    for (name, data) in [
        ("another device's", another_device),
        ("another vendor's", another_vendor),
        ("truncated", truncated),
        ("flipped", flipped),
        ("noise", noise),
    ] {
        match cache(&foreign, &data) {
            Some(cache) => drop(through(&foreign, cache)),
            None => eprintln!("{name}: refused by the driver"),
        }
    }
    // What the layers say of such data is the caller's affair, and not of interest here.
    foreign.take_messages();
}
