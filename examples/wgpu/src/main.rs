//! One Vulkan device shared by gridwalk and wgpu.
//!
//! We make the device and the buffers, with the features and usages that both want, and wgpu takes them over. A WGSL pass of wgpu computes the
//! vertices and the rays, gridwalk builds a grid and traces, another WGSL pass makes a picture of the hits: `wgpu.png`, in the folder named, or
//! in the working folder. There is no copy in between: both see the same memory, wgpu as bindings, gridwalk by address.
//!
//! ```sh
//! cargo run --release -p gridwalk-example-wgpu -- pictures
//! ```
//!
//! **Versions.** `gridwalk::ash` and the ash of `wgpu::hal` must be one: this file gives objects of the one to the other, so that it compiles
//! only if they are.
//!
//! **Synchronization.** gridwalk records into a command encoder of wgpu's, used for nothing else (wgpu wants it so), and the encoders are
//! submitted in order on wgpu's one queue. wgpu knows nothing of what happens in there, so that the barriers before and after are ours; between
//! its own passes it goes on making its own.

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use gridwalk::ash::{self, vk};
use gridwalk::{Access, BuildInfo, Capacity, DeviceDesc, Geometry, RayCount, Region, Report, TraceInfo, Tracer, cmd_barrier, requirements};
use wgpu::hal::{self, api::Vulkan};

const SIDE: u32 = 96;
const WIDTH: u32 = 320;
const HEIGHT: u32 = 200;

/// The one device, as both see it. wgpu owns it: it is destroyed with the last of wgpu's objects.
struct Shared {
    instance: ash::Instance,
    physical_device: vk::PhysicalDevice,
    raw: ash::Device,
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Shared {
    fn new() -> Result<Shared> {
        let flags = wgpu::InstanceFlags::empty();
        // SAFETY: the instance and the device are made as wgpu asks for, with additions of our own, and all handles are of each other.
        unsafe {
            let entry = ash::Entry::load()?;
            let extensions = hal::vulkan::Instance::desired_extensions(&entry, vk::API_VERSION_1_3, flags)?;
            let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
            let info = vk::InstanceCreateInfo::default().application_info(&application).enabled_extension_names(&names);
            let instance = entry.create_instance(&info, None)?;
            let for_wgpu = hal::vulkan::Instance::from_raw(
                entry,
                instance.clone(),
                vk::API_VERSION_1_3,
                0,
                None,
                extensions,
                flags,
                wgpu::MemoryBudgetThresholds::default(),
                false,
                None,
            )?;

            let mut reasons = Vec::new();
            for physical_device in instance.enumerate_physical_devices()? {
                reasons.extend(requirements::query(&instance, physical_device).missing);
                if !reasons.is_empty() {
                    continue;
                }
                let exposed = for_wgpu.expose_adapter(physical_device).context("wgpu cannot use the device")?;
                let (features, limits) = (wgpu::Features::empty(), wgpu::Limits::default());
                let extensions = exposed.adapter.required_device_extensions(features);
                let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
                // wgpu uses the first queue of the first family; all of its devices have compute there.
                let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&[1.0])];
                let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&names);
                // wgpu chains structures of single features, beside which Vulkan forbids those of whole versions that
                // `requirements::features` fills. These two are what gridwalk needs.
                let mut of_wgpu = exposed.adapter.physical_device_features(&extensions, features);
                let mut addresses = vk::PhysicalDeviceBufferDeviceAddressFeatures::default().buffer_device_address(true);
                let mut synchronization = vk::PhysicalDeviceSynchronization2Features::default().synchronization2(true);
                let info = of_wgpu.add_to_device_create(info).push_next(&mut addresses).push_next(&mut synchronization);
                let raw = instance.create_device(physical_device, &info, None)?;

                let hints = wgpu::MemoryHints::default();
                let opened = exposed.adapter.device_from_raw(raw.clone(), None, &extensions, features, &limits, &hints, 0, 0)?;
                let adapter = wgpu::Instance::from_hal::<Vulkan>(for_wgpu);
                let adapter = adapter.create_adapter_from_hal(exposed);
                let (device, queue) = adapter.create_device_from_hal(opened, &wgpu::DeviceDescriptor::default())?;
                return Ok(Shared { instance, physical_device, raw, device, queue });
            }
            bail!("no device can serve: {}", reasons.join("; "))
        }
    }

    /// Memory as gridwalk wants it, with a device address, in a buffer that wgpu can bind and copy, and that it frees.
    fn buffer(&self, label: &str, size: u64) -> Result<(Region, wgpu::Buffer)> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS
            | vk::BufferUsageFlags::INDIRECT_BUFFER
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST;
        let size = size.next_multiple_of(4);
        // SAFETY: the device lives and has bufferDeviceAddress enabled; memory and buffer go over to wgpu, which is told of usages that it has.
        unsafe {
            let buffer = self.raw.create_buffer(&vk::BufferCreateInfo::default().size(size).usage(usage), None)?;
            let needs = self.raw.get_buffer_memory_requirements(buffer);
            let types = self.instance.get_physical_device_memory_properties(self.physical_device);
            let local = vk::MemoryPropertyFlags::DEVICE_LOCAL;
            let fits = |&i: &u32| needs.memory_type_bits & 1 << i != 0 && types.memory_types[i as usize].property_flags.contains(local);
            let memory_type = (0..types.memory_type_count).find(fits).context("no such memory")?;
            let mut flags = vk::MemoryAllocateFlagsInfo::default().flags(vk::MemoryAllocateFlags::DEVICE_ADDRESS);
            let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(memory_type).push_next(&mut flags);
            let memory = self.raw.allocate_memory(&info, None)?;
            self.raw.bind_buffer_memory(buffer, memory, 0)?;
            let address = self.raw.get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(buffer));
            ensure!(address.is_multiple_of(gridwalk::REGION_ALIGNMENT), "{label}: memory of its own begins at an odd address");
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
            let for_wgpu = hal::vulkan::Buffer::from_raw_managed(buffer, memory, 0, size);
            let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
            let shared = self.device.create_buffer_from_hal::<Vulkan>(for_wgpu, &descriptor);
            Ok((Region { buffer, offset: 0, size, address }, shared))
        }
    }
}

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).map_or_else(PathBuf::new, PathBuf::from);
    let shared = Shared::new()?;
    let Shared { instance, physical_device, raw, device, queue } = &shared;
    // SAFETY: what gridwalk requires is enabled; the tracer is dropped at the end, before the device and after all work.
    let tracer = unsafe { Tracer::new(&DeviceDesc::new(instance, *physical_device, raw))? };

    let (vertex_count, triangle_count, ray_count) = ((SIDE + 1) * (SIDE + 1), 2 * SIDE * SIDE, WIDTH * HEIGHT);
    let capacity =
        Capacity { triangles: triangle_count, cells: 8 * triangle_count, pairs: 8 * triangle_count, leaf_cells: triangle_count / 2 };
    let sizes = tracer.build_sizes(&capacity)?;
    let (positions, positions_buffer) = shared.buffer("positions", 12 * u64::from(vertex_count))?;
    let (indices, indices_buffer) = shared.buffer("indices", 12 * u64::from(triangle_count))?;
    let (rays, rays_buffer) = shared.buffer("rays", 32 * u64::from(ray_count))?;
    let (hits, hits_buffer) = shared.buffer("hits", 16 * u64::from(ray_count))?;
    let (grid, _grid_buffer) = shared.buffer("grid", sizes.grid.size)?;
    let (scratch, _scratch_buffer) = shared.buffer("build scratch", sizes.scratch.size)?;
    let (report, report_buffer) = shared.buffer("report", sizes.report.size)?;
    let (trace_scratch, _trace_scratch_buffer) = shared.buffer("trace scratch", tracer.trace_scratch_size(ray_count)?.size)?;

    // From here on plain wgpu: one layout of five storage buffers, three pipelines.
    let picture_size = 4 * u64::from(ray_count);
    let plain =
        |label, size, usage| device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false });
    let picture = plain("picture", picture_size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readback = plain("readback", picture_size + report.size, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let bound = [&positions_buffer, &indices_buffer, &rays_buffer, &hits_buffer, &picture];
    let ty = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: false },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let entries =
        [0, 1, 2, 3, 4].map(|binding| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None });
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
    let entries: Vec<_> =
        (0..).zip(bound).map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }).collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries });
    let layout =
        device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor { bind_group_layouts: &[Some(&layout)], ..Default::default() });
    let module = device.create_shader_module(wgpu::include_wgsl!("passes.wgsl"));
    let constants = [("side", f64::from(SIDE)), ("width", f64::from(WIDTH)), ("height", f64::from(HEIGHT))];
    let dispatch = |encoder: &mut wgpu::CommandEncoder, entry_point, [x, y]: [u32; 2]| {
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        });
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(x.div_ceil(8), y.div_ceil(8), 1);
    };

    let mut before = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    dispatch(&mut before, "vertices", [SIDE + 1, SIDE + 1]);
    dispatch(&mut before, "camera", [WIDTH, HEIGHT]);

    let mut between = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let build = BuildInfo::new(Geometry { positions, vertex_count, indices, triangle_count }, grid, scratch, report, capacity);
    let trace = TraceInfo::new(rays, hits, RayCount::Direct(ray_count), trace_scratch);
    // SAFETY: the command buffer is open until `finish`, of the device's queue, and outside of a pass; the regions are of `build_sizes` and
    // `trace_scratch_size`, and their buffers live until the end of `main`.
    unsafe {
        between.as_hal_mut::<Vulkan, _, Result<()>>(|encoder| {
            let cmd = encoder.context("not a Vulkan encoder")?.raw_handle();
            // wgpu's passes are compute shaders. Their writes to vertices and rays must be seen here,
            cmd_barrier(raw, cmd, Access::COMPUTE, Tracer::BUILD);
            tracer.cmd_build(cmd, &build)?;
            cmd_barrier(raw, cmd, Tracer::BUILD, Tracer::TRACE);
            tracer.cmd_closest_hit(cmd, grid.address, &trace)?;
            // and what is written here by wgpu's later passes, and by its copy of the report.
            cmd_barrier(raw, cmd, Tracer::TRACE, Access::COMPUTE);
            cmd_barrier(raw, cmd, Tracer::BUILD, Access::TRANSFER);
            Ok(())
        })?;
    }

    let mut after = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    dispatch(&mut after, "shade", [WIDTH, HEIGHT]);
    after.copy_buffer_to_buffer(&picture, 0, &readback, 0, picture_size);
    after.copy_buffer_to_buffer(&report_buffer, 0, &readback, picture_size, report.size);
    queue.submit([before.finish(), between.finish(), after.finish()]);

    readback.map_async(wgpu::MapMode::Read, .., |result| {
        if let Err(error) = result {
            eprintln!("{error}")
        }
    });
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let bytes = readback.get_mapped_range(..)?;
    let (pixels, report) = bytes.split_at(picture_size as usize);
    let report: Report = bytemuck::pod_read_unaligned(&report[..size_of::<Report>()]);
    ensure!(!report.pairs_overflowed(), "room for {} pairs is needed; example `embed` shows how to grow", report.pair_total);
    eprintln!("{} triangles in {:?} cells", report.triangles, report.resolution);
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(folder.join("wgpu.png"))?), WIDTH, HEIGHT);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(pixels)?;
    drop(tracer);
    Ok(())
}
