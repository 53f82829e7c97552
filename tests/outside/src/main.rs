//! Builds a grid and traces rays with gridwalk, on a device and in memory of its own, and checks every hit.

use std::error::Error;

use gridwalk::ash::{self, vk};
use gridwalk::{
    Access, BuildInfo, Capacity, DeviceDesc, Geometry, Hit, Ray, RayCount, Region, Report, TraceInfo, Tracer, cmd_barrier, requirements,
};

/// Squares along each side of the terrain.
const SIDE: u32 = 40;

/// Height of the terrain at the corners of its squares: whole numbers, so that what is expected is easily said.
fn height(x: u32, y: u32) -> f32 {
    ((7 * x + 3 * y) % 5) as f32
}

/// Two triangles a square: the half where x is greater than y in the square, then the other.
fn terrain() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let corner = |x: u32, y: u32| y * (SIDE + 1) + x;
    let positions = (0..=SIDE).flat_map(|y| (0..=SIDE).map(move |x| [x as f32, y as f32, height(x, y)])).collect();
    let squares = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let indices = squares.flat_map(|(x, y)| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    (positions, indices.collect())
}

/// A ray straight down into each triangle, and one beside the terrain. With each: its triangle, and t, which is 10 less the terrain's height.
fn rays() -> (Vec<Ray>, Vec<(u32, f32)>) {
    let down = |x: f32, y: f32| Ray { origin: [x, y, 10.0], t_min: 0.0, direction: [0.0, 0.0, -1.0], t_max: f32::INFINITY };
    let mut rays = vec![down(-1.0, 2.0)];
    let mut expected = vec![(gridwalk::MISS, f32::INFINITY)];
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let [a, b, c, d] = [height(x, y), height(x + 1, y), height(x + 1, y + 1), height(x, y + 1)];
        let square = 2 * (y * SIDE + x);
        rays.push(down(x as f32 + 0.75, y as f32 + 0.25));
        expected.push((square, 10.0 - (0.25 * a + 0.5 * b + 0.25 * c)));
        rays.push(down(x as f32 + 0.25, y as f32 + 0.75));
        expected.push((square + 1, 10.0 - (0.25 * a + 0.25 * c + 0.5 * d)));
    }
    (rays, expected)
}

/// One buffer for everything, mapped, from which regions are cut one after another.
struct Memory {
    buffer: vk::Buffer,
    memory: vk::DeviceMemory,
    address: vk::DeviceAddress,
    mapped: *mut u8,
    used: u64,
}

impl Memory {
    const SIZE: u64 = 16 << 20;

    fn new(instance: &ash::Instance, physical_device: vk::PhysicalDevice, device: &ash::Device) -> Result<Memory, Box<dyn Error>> {
        use vk::{BufferUsageFlags as Usage, MemoryPropertyFlags as Property};
        let usage = Usage::STORAGE_BUFFER | Usage::SHADER_DEVICE_ADDRESS | Usage::INDIRECT_BUFFER;
        let host = Property::HOST_VISIBLE | Property::HOST_COHERENT;
        // SAFETY: all handles are of this device; the buffer is bound once, to memory as large as it asks for.
        unsafe {
            let buffer = device.create_buffer(&vk::BufferCreateInfo::default().size(Memory::SIZE).usage(usage), None)?;
            let needs = device.get_buffer_memory_requirements(buffer);
            let types = instance.get_physical_device_memory_properties(physical_device);
            let fits =
                |index: &u32| needs.memory_type_bits >> index & 1 == 1 && types.memory_types[*index as usize].property_flags.contains(host);
            let memory_type = (0..types.memory_type_count).find(fits).ok_or("no memory that the host sees")?;
            let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
            let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(memory_type).push_next(&mut flags);
            let memory = device.allocate_memory(&info, None)?;
            device.bind_buffer_memory(buffer, memory, 0)?;
            let address = device.get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(buffer));
            let mapped = device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty())?.cast::<u8>();
            Ok(Memory { buffer, memory, address, mapped, used: 0 })
        }
    }

    fn region(&mut self, size: u64) -> Region {
        let address = (self.address + self.used).next_multiple_of(gridwalk::REGION_ALIGNMENT);
        let offset = address - self.address;
        assert!(offset + size <= Memory::SIZE, "{size} bytes are more than this program has left");
        self.used = offset + size;
        Region { buffer: self.buffer, offset, size, address }
    }

    fn upload<T: bytemuck::NoUninit>(&mut self, data: &[T]) -> Region {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let region = self.region(bytes.len() as u64);
        // SAFETY: the region lies inside of the mapped buffer, and nothing runs on the device.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.mapped.add(region.offset as usize), bytes.len()) };
        region
    }

    fn read<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(&self, region: &Region, count: usize) -> Vec<T> {
        let mut data = vec![T::zeroed(); count];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut data);
        assert!(bytes.len() as u64 <= region.size);
        // SAFETY: as for `upload`.
        unsafe { std::ptr::copy_nonoverlapping(self.mapped.add(region.offset as usize), bytes.as_mut_ptr(), bytes.len()) };
        data
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    // SAFETY: every handle is of the instance or the device that is made here, and destroyed after the work that uses it has ended.
    unsafe {
        let entry = ash::Entry::load()?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
        let instance = entry.create_instance(&vk::InstanceCreateInfo::default().application_info(&application), None)?;
        let mut reasons = Vec::new();
        let physical_device = instance.enumerate_physical_devices()?.into_iter().find(|candidate| {
            let missing = requirements::query(&instance, *candidate).missing;
            reasons.extend(missing.iter().cloned());
            missing.is_empty()
        });
        let physical_device = physical_device.ok_or_else(|| format!("no device can serve: {reasons:?}"))?;
        let families = instance.get_physical_device_queue_family_properties(physical_device);
        let family = families.iter().position(|family| family.queue_flags.contains(vk::QueueFlags::COMPUTE)).ok_or("no queue computes")?;
        let queue_info = [vk::DeviceQueueCreateInfo::default().queue_family_index(family as u32).queue_priorities(&[1.0])];
        let mut features = requirements::features();
        let info = vk::DeviceCreateInfo::default().queue_create_infos(&queue_info);
        let info = info.push_next(&mut features.vulkan_12).push_next(&mut features.vulkan_13);
        let device = instance.create_device(physical_device, &info, None)?;
        let queue = device.get_device_queue(family as u32, 0);
        let pool = device.create_command_pool(&vk::CommandPoolCreateInfo::default().queue_family_index(family as u32), None)?;
        let cmd_info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        let cmd = device.allocate_command_buffers(&cmd_info)?[0];
        let mut memory = Memory::new(&instance, physical_device, &device)?;
        let tracer = Tracer::new(&DeviceDesc::new(&instance, physical_device, &device))?;

        let (positions, indices) = terrain();
        let (rays, expected) = rays();
        let (vertex_count, triangle_count, ray_count) = (positions.len() as u32, indices.len() as u32, rays.len() as u32);
        let capacity = Capacity { triangles: triangle_count, cells: 16 * triangle_count, pairs: 64 * triangle_count, leaf_cells: 0 };
        let sizes = tracer.build_sizes(&capacity)?;
        let geometry = Geometry {
            positions: memory.upload(&positions),
            vertex_count,
            indices: memory.upload(&indices),
            triangle_count,
            ..Geometry::default()
        };
        let mut room = |size: gridwalk::RegionSize| memory.region(size.size);
        let build = BuildInfo::new(geometry, room(sizes.grid), room(sizes.scratch), room(sizes.report), capacity);
        let scratch = room(tracer.trace_scratch_size(ray_count)?);
        let hits = memory.region(16 * u64::from(ray_count));
        let trace = TraceInfo::new(memory.upload(&rays), hits, RayCount::Direct(ray_count), scratch);

        // What the host wrote before the submission is visible to it without a barrier.
        let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        device.begin_command_buffer(cmd, &once)?;
        tracer.cmd_build(cmd, &build)?;
        cmd_barrier(&device, cmd, Tracer::BUILD, Tracer::TRACE);
        tracer.cmd_closest_hit(cmd, build.grid.address, &trace)?;
        cmd_barrier(&device, cmd, Tracer::TRACE, Access::HOST_READ);
        device.end_command_buffer(cmd)?;
        let fence = device.create_fence(&vk::FenceCreateInfo::default(), None)?;
        device.queue_submit(queue, &[vk::SubmitInfo::default().command_buffers(&[cmd])], fence)?;
        device.wait_for_fences(&[fence], true, u64::MAX)?;

        let report = memory.read::<Report>(&build.report, 1)[0];
        if report.overflow != 0 {
            return Err(format!("the grid overflowed: {report:?}").into());
        }
        let hits: Vec<Hit> = memory.read(&trace.hits, rays.len());
        for ((hit, ray), &(triangle, t)) in hits.iter().zip(&rays).zip(&expected) {
            // Heights are quarters: no bit of them is lost, but the hit's t is rounded.
            let near = hit.t == t || (hit.t - t).abs() < 1e-5;
            if hit.triangle != triangle || !near {
                return Err(format!("{ray:?}: {hit:?} where triangle {triangle} at {t} is expected").into());
            }
        }
        println!("{} rays through {triangle_count} triangles: all as expected", hits.len());

        drop(tracer);
        device.destroy_fence(fence, None);
        device.destroy_command_pool(pool, None);
        device.destroy_buffer(memory.buffer, None);
        device.free_memory(memory.memory, None);
        device.destroy_device(None);
        instance.destroy_instance(None);
    }
    Ok(())
}
