//! gridwalk in an engine of one's own: its device, its memory, two frames in flight.
//!
//! Each frame a compute shader of the engine deforms a mesh, gridwalk builds a grid over it, and another shader of the engine shades a picture
//! by tracing through the grid with `gridwalk.glsl`: ambient occlusion, and one reflection in the floor. Frame n is shaded while the grid of
//! frame n + 1 is built, on a queue of its own where the device has two. Nothing is shown on a screen: `embed-0.png` and so on are written to
//! the folder named, or to the working folder. What is gridwalk's begins with `requirements::` or `tracer.`; the rest is the engine.
//!
//! ```sh
//! cargo run --release --example embed -- pictures
//! ```

use std::path::{Path, PathBuf};
use std::{env, fs, io::BufWriter, slice};

use anyhow::{Context, Result, bail, ensure};
use ash::vk;
use bytemuck::cast_slice;
use gridwalk::{Access, BuildInfo, BuildOptions, Capacity, DeviceDesc, Geometry, Region, Report, Tracer, cmd_barrier, requirements};
use gridwalk_scene::generate;

const WIDTH: u32 = 320;
const HEIGHT: u32 = 180;
/// When each picture is taken. The last shows the first moment again: it must equal the first picture bit for bit.
const TIMES: [f32; 5] = [0.0, 0.5, 1.0, 1.5, 0.0];

/// The engine's device.
struct Gpu {
    _entry: ash::Entry,
    instance: ash::Instance,
    physical_device: vk::PhysicalDevice,
    device: ash::Device,
    family: u32,
    queues: [vk::Queue; 2],
}

impl Gpu {
    /// The first device that gridwalk can use, with what gridwalk needs enabled beside what the engine itself needs.
    fn new() -> Result<Gpu> {
        // SAFETY: all handles are of each other, and nothing is enabled that was not found.
        unsafe {
            let entry = ash::Entry::load()?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
            let instance = entry.create_instance(&vk::InstanceCreateInfo::default().application_info(&application), None)?;
            let mut reasons = Vec::new();
            for physical_device in instance.enumerate_physical_devices()? {
                let found = requirements::query(&instance, physical_device);
                let families = instance.get_physical_device_queue_family_properties(physical_device);
                let compute = families.iter().position(|family| family.queue_flags.contains(vk::QueueFlags::COMPUTE));
                let (true, Some(family)) = (found.missing.is_empty(), compute) else {
                    reasons.extend(found.missing);
                    continue;
                };
                let count = families[family].queue_count.min(2);
                let family = family as u32;
                let queues =
                    [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0; 2][..count as usize])];
                let mut features = requirements::features();
                features.vulkan_12.timeline_semaphore = vk::TRUE; // the engine's own need
                let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues);
                let info = info.push_next(&mut features.vulkan_12).push_next(&mut features.vulkan_13);
                let device = instance.create_device(physical_device, &info, None)?;
                let queues = [0, count - 1].map(|index| device.get_device_queue(family, index));
                return Ok(Gpu { _entry: entry, instance, physical_device, device, family, queues });
            }
            bail!("no device can serve: {}", reasons.join("; "))
        }
    }

    /// Records a command buffer and submits it; it begins when `wait` has come, and `signal` tells its end.
    fn submit(
        &self,
        queue: usize,
        cmd: vk::CommandBuffer,
        wait: &[(vk::Semaphore, u64)],
        signal: (vk::Semaphore, u64),
        record: impl FnOnce() -> Result<()>,
    ) -> Result<()> {
        let at = |&(semaphore, value): &(vk::Semaphore, u64)| {
            vk::SemaphoreSubmitInfo::default().semaphore(semaphore).value(value).stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
        };
        let (waits, signals) = (wait.iter().map(at).collect::<Vec<_>>(), [at(&signal)]);
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(cmd)];
        let info = vk::SubmitInfo2::default().wait_semaphore_infos(&waits).command_buffer_infos(&commands);
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the device has done with the command buffer, and what is recorded lives until it has done with it again.
        unsafe {
            self.device.begin_command_buffer(cmd, &begin)?;
            record()?;
            self.device.end_command_buffer(cmd)?;
            Ok(self.device.queue_submit2(self.queues[queue], &[info.signal_semaphore_infos(&signals)], vk::Fence::null())?)
        }
    }

    /// A pipeline of a shader of the engine's own.
    fn pipeline(&self, layout: vk::PipelineLayout, spirv: &[u8]) -> Result<vk::Pipeline> {
        let code: Vec<u32> = bytemuck::pod_collect_to_vec(spirv);
        // SAFETY: the SPIR-V comes from the GLSL in `shaders/`, whose push constants fit the layout.
        unsafe {
            let module = self.device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&code), None)?;
            let stage = vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::COMPUTE).module(module).name(c"main");
            let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
            let pipelines = self.device.create_compute_pipelines(vk::PipelineCache::null(), &info, None).map_err(|(_, error)| error)?;
            self.device.destroy_shader_module(module, None);
            Ok(pipelines[0])
        }
    }
}

/// The engine's allocator: one buffer over one allocation, handed out from its front. gridwalk takes regions of buffers and does not ask where
/// they come from: any allocator serves, as long as its memory has device addresses.
struct Arena {
    buffer: vk::Buffer,
    address: vk::DeviceAddress,
    mapped: *mut u8,
    used: u64,
}

impl Arena {
    const SIZE: u64 = 64 << 20;

    fn new(gpu: &Gpu, properties: vk::MemoryPropertyFlags) -> Result<Arena> {
        use vk::BufferUsageFlags as Usage;
        // The usages that `RegionSize::usage` asks for.
        let info = vk::BufferCreateInfo::default().size(Arena::SIZE);
        let info = info.usage(Usage::STORAGE_BUFFER | Usage::SHADER_DEVICE_ADDRESS | Usage::INDIRECT_BUFFER);
        // SAFETY: the device lives and has bufferDeviceAddress enabled.
        unsafe {
            let buffer = gpu.device.create_buffer(&info, None)?;
            let needs = gpu.device.get_buffer_memory_requirements(buffer);
            let types = gpu.instance.get_physical_device_memory_properties(gpu.physical_device);
            let fits =
                |&i: &u32| needs.memory_type_bits & 1 << i != 0 && types.memory_types[i as usize].property_flags.contains(properties);
            let memory_type = (0..types.memory_type_count).find(fits).context("no such memory")?;
            let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
            let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(memory_type).push_next(&mut flags);
            let memory = gpu.device.allocate_memory(&info, None)?;
            gpu.device.bind_buffer_memory(buffer, memory, 0)?;
            let address = gpu.device.get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(buffer));
            let map = || gpu.device.map_memory(memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty());
            let visible = properties.contains(vk::MemoryPropertyFlags::HOST_VISIBLE);
            let mapped = if visible { map()?.cast() } else { std::ptr::null_mut() };
            Ok(Arena { buffer, address, mapped, used: 0 })
        }
    }

    /// What gridwalk wants to be aligned is the device address.
    fn take(&mut self, size: u64) -> Result<Region> {
        let offset = (self.address + self.used).next_multiple_of(gridwalk::REGION_ALIGNMENT) - self.address;
        ensure!(offset + size <= Arena::SIZE, "the arena is full");
        self.used = offset + size;
        Ok(Region { buffer: self.buffer, offset, size, address: self.address + offset })
    }

    fn bytes(&mut self, region: &Region) -> Result<&mut [u8]> {
        ensure!(region.buffer == self.buffer && !self.mapped.is_null(), "the host cannot see it");
        // SAFETY: the region lies in this arena, all of which is mapped; callers have waited for the device.
        Ok(unsafe { slice::from_raw_parts_mut(self.mapped.add(region.offset as usize), region.size as usize) })
    }
}

/// What each frame in flight has of its own. The scratch of builds is shared: the barrier before each build keeps them apart.
struct Slot {
    cmds: [vk::CommandBuffer; 2],
    positions: Region,
    normals: Region,
    grid: Region,
    report: Region,
    picture: Region,
    /// The frame that the device is at, and the value of the timeline that tells its end.
    pending: Option<(usize, u64)>,
}

fn write_png(path: &Path, rgba: &[u8]) -> Result<()> {
    let mut encoder = png::Encoder::new(BufWriter::new(fs::File::create(path)?), WIDTH, HEIGHT);
    encoder.set_color(png::ColorType::Rgba);
    Ok(encoder.write_header()?.write_image_data(rgba)?)
}

fn main() -> Result<()> {
    let folder = env::args_os().nth(1).map_or_else(PathBuf::new, PathBuf::from);
    let gpu = Gpu::new()?;
    let Gpu { instance, physical_device, device, .. } = &gpu;
    // SAFETY: `requirements` are enabled on the device, which is destroyed after the tracer, after all work has ended.
    let tracer = unsafe { Tracer::new(&DeviceDesc::new(instance, *physical_device, device))? };
    let mut memory = Arena::new(&gpu, vk::MemoryPropertyFlags::DEVICE_LOCAL)?;
    let mut host = Arena::new(&gpu, vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT)?;
    let (floor, ball) = (generate::plane([12.0, 12.0], 1), generate::sphere([0.0; 3], 1.0, 96));
    let (floor_vertices, floor_triangles) = (floor.positions.len() as u32, floor.indices.len() as u32);
    let vertices = [floor.positions, ball.positions].concat();
    let triangles = [floor.indices, ball.indices.iter().map(|corners| corners.map(|corner| corner + floor_vertices)).collect()].concat();
    let (vertex_count, triangle_count) = (vertices.len() as u32, triangles.len() as u32);
    let rest = host.take(12 * u64::from(vertex_count))?;
    host.bytes(&rest)?.copy_from_slice(cast_slice(&vertices));
    let indices = host.take(12 * u64::from(triangle_count))?;
    host.bytes(&indices)?.copy_from_slice(cast_slice(&triangles));

    // Pairs (cell, triangle) cannot be known beforehand. Four a triangle are a good guess; this one is too low, to show what then happens.
    let cells = triangle_count * BuildOptions::DEFAULT_DENSITY as u32;
    let mut capacity = Capacity { triangles: triangle_count, cells, pairs: triangle_count, leaf_cells: triangle_count / 2 };
    let mut sizes = tracer.build_sizes(&capacity)?;
    let mut scratch = memory.take(sizes.scratch.size)?;

    // SAFETY: the device lives.
    let (buffers, layout, [built, shaded]) = unsafe {
        let reset = vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER;
        let pool = device.create_command_pool(&vk::CommandPoolCreateInfo::default().queue_family_index(gpu.family).flags(reset), None)?;
        let buffers =
            device.allocate_command_buffers(&vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(4))?;
        let push = [vk::PushConstantRange { stage_flags: vk::ShaderStageFlags::COMPUTE, offset: 0, size: 48 }];
        let layout = device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&push), None)?;
        let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        (buffers, layout, [device.create_semaphore(&info, None)?, device.create_semaphore(&info, None)?])
    };
    let deform = gpu.pipeline(layout, include_bytes!("spirv/embed_deform.spv"))?;
    let shade = gpu.pipeline(layout, include_bytes!("spirv/embed_shade.spv"))?;
    let dispatch = |cmd, pipeline, addresses: &[u64], numbers: &[u32], groups: [u32; 2]| {
        let push = [cast_slice::<_, u8>(addresses), cast_slice(numbers)].concat();
        // SAFETY: `submit` calls this while it records; the push constants are those of the shader, with addresses of living regions.
        unsafe {
            device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, pipeline);
            device.cmd_push_constants(cmd, layout, vk::ShaderStageFlags::COMPUTE, 0, &push);
            device.cmd_dispatch(cmd, groups[0], groups[1], 1);
        }
    };
    let slot = |cmds: &[vk::CommandBuffer]| -> Result<Slot> {
        let (positions, normals) = (memory.take(rest.size)?, memory.take(rest.size)?);
        let (grid, report) = (memory.take(sizes.grid.size)?, host.take(sizes.report.size)?);
        let picture = host.take(u64::from(4 * WIDTH * HEIGHT))?;
        Ok(Slot { cmds: [cmds[0], cmds[1]], positions, normals, grid, report, picture, pending: None })
    };
    let mut slots = buffers.chunks(2).map(slot).collect::<Result<Vec<_>>>()?;

    let (mut next, mut time, mut pictures) = (0, 0, Vec::new());
    for turn in 0.. {
        // Take the slot's last frame out of it.
        if let Some((frame, end)) = slots[turn % 2].pending.take() {
            let wait = vk::SemaphoreWaitInfo::default().semaphores(slice::from_ref(&shaded)).values(slice::from_ref(&end));
            // SAFETY: the semaphore is a timeline of this device.
            unsafe { device.wait_semaphores(&wait, u64::MAX)? };
            let report: Report = bytemuck::pod_read_unaligned(host.bytes(&slots[turn % 2].report)?);
            if report.pairs_overflowed() {
                // The grid lacks triangles: throw the frames in flight away, make room for a third more than was needed, and go back.
                capacity.pairs = report.needed_pairs().context("lower the density")?.saturating_mul(4) / 3;
                eprintln!("frame {frame}: {} pairs did not fit, room for {} now", report.pair_total, capacity.pairs);
                // SAFETY: the device lives.
                unsafe { device.device_wait_idle()? };
                sizes = tracer.build_sizes(&capacity)?;
                scratch = memory.take(sizes.scratch.size)?;
                for slot in &mut slots {
                    (slot.grid, slot.pending) = (memory.take(sizes.grid.size)?, None);
                }
                next = frame;
            } else {
                eprintln!("frame {frame}: {} triangles, {:?} cells", report.triangles, report.resolution);
                ensure!((report.triangles, report.dropped) == (triangle_count, 0), "the mesh has changed");
                let picture = host.bytes(&slots[turn % 2].picture)?;
                write_png(&folder.join(format!("embed-{frame}.png")), picture)?;
                pictures.push(picture.to_vec());
            }
        }
        if next == TIMES.len() {
            if slots.iter().all(|slot| slot.pending.is_none()) { break } else { continue }
        }
        let Slot { cmds: [build_cmd, shade_cmd], positions, normals, grid, report, picture, .. } = slots[turn % 2];
        time += 1;
        // The host has waited for the slot's last frame: its regions are free.
        gpu.submit(0, build_cmd, &[], (built, time), || {
            let numbers = [vertex_count, floor_vertices, TIMES[next].to_bits()];
            dispatch(build_cmd, deform, &[rest.address, positions.address, normals.address], &numbers, [vertex_count.div_ceil(64), 1]);
            let geometry = Geometry { positions, vertex_count, indices, triangle_count };
            let info = BuildInfo::new(geometry, grid, scratch, report, capacity);
            // SAFETY: the regions are of this device, large enough by `build_sizes`, and free; the command buffer is recording.
            unsafe {
                // From the vertices' writer to the build, and from the last build that used the scratch.
                cmd_barrier(device, build_cmd, Access::COMPUTE, Tracer::BUILD);
                tracer.cmd_build(build_cmd, &info)?;
                cmd_barrier(device, build_cmd, Tracer::BUILD, Access::HOST_READ);
            }
            Ok(())
        })?;
        // Between the queues the semaphore does what a barrier from `Tracer::BUILD` to `Tracer::TRACE` does on one.
        gpu.submit(1, shade_cmd, &[(built, time)], (shaded, time), || {
            let addresses = [grid.address, normals.address, indices.address, picture.address];
            dispatch(shade_cmd, shade, &addresses, &[WIDTH, HEIGHT, floor_triangles, 16], [WIDTH.div_ceil(8), HEIGHT.div_ceil(8)]);
            // SAFETY: the command buffer is recording.
            unsafe { cmd_barrier(device, shade_cmd, Tracer::TRACE, Access::HOST_READ) };
            Ok(())
        })?;
        slots[turn % 2].pending = Some((next, time));
        next += 1;
    }

    ensure!(pictures[0] == pictures[4] && pictures[0] != pictures[1], "the same moment gives the same picture, another one another");
    ensure!(host.bytes(&rest)? == cast_slice::<[f32; 3], u8>(&vertices), "only the shaders write, and not here");
    // The device has done with all that was recorded: the tracer may go, and after it the device. (The process frees the engine's own.)
    drop(tracer);
    Ok(())
}
