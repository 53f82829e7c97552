//! A device, grids built on it in guarded memory, and rays traced through them. The only module of the tests that records commands.

use std::sync::{Mutex, OnceLock, PoisonError};

use gridwalk::ash::vk;
use gridwalk::kernel::Kernel;
use gridwalk::plan::Item;
use gridwalk::{
    BuildInfo, BuildOptions, Capacity, DeviceDesc, Geometry, Hit, Ray, RayCount, RaySortInfo, Region, Report, Shape, Timestamps, TraceInfo,
    Tracer, cmd_barrier,
};
use gridwalk_core::grid::{BRICK_SIZE, brick_resolution, cell_id, cell_of};
use gridwalk_core::layout::{Brick, GridHeader};
use gridwalk_core::walk::Grid;
use gridwalk_render::{Buffer, BufferDesc, BufferKind, Context, ContextDesc};

/// Triangles as the library takes them.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub positions: Vec<[f32; 3]>,
    pub indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// Three vertices of each triangle, which none shares.
    pub fn from_triangles(triangles: &[[[f32; 3]; 3]]) -> Mesh {
        let positions = triangles.iter().flatten().copied().collect();
        let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh { positions, indices }
    }

    /// The vertices of a triangle.
    pub fn triangle(&self, index: usize) -> [[f32; 3]; 3] {
        self.indices[index].map(|vertex| self.positions[vertex as usize])
    }

    /// Room for the mesh at any density up to 8 or so, in a flat grid.
    pub fn capacity(&self) -> Capacity {
        let triangles = self.indices.len() as u32;
        Capacity { triangles, cells: 16 * triangles + 64, pairs: 16 * triangles + 4096, leaf_cells: 0 }
    }
}

/// A grid's memory, read back: what the CPU twins of the trace kernels walk.
#[derive(Clone, Debug)]
pub struct GridCopy {
    pub header: GridHeader,
    pub bricks: Vec<Brick>,
    pub cells: Vec<[u32; 2]>,
    /// By first rows, as the grid has them.
    pub references: Vec<u32>,
    pub triangles: Vec<[[f32; 4]; 3]>,
}

impl GridCopy {
    pub fn view(&self) -> Grid<'_> {
        Grid { header: &self.header, bricks: &self.bricks, cells: &self.cells, references: &self.references, triangles: &self.triangles }
    }
}

/// What a trace of the closest hits is asked for beside its rays.
#[derive(Clone, Copy, Debug, Default)]
pub struct TraceOptions<'a> {
    /// The number of rays lies in memory, and is this.
    pub indirect: Option<u32>,
    /// Goes on from these hits.
    pub resume: Option<&'a [Hit]>,
    /// Counts steps, tests and cells.
    pub count: bool,
    /// Traces in this order, which may be one of a part of the rays.
    pub order: Option<&'a [u32]>,
}

/// The device of the tests. Validation is on unless `GRIDWALK_VALIDATE=0`; each message fails the test that asks next.
pub struct Gpu {
    pub tracer: Tracer,
    pub context: Context,
}

/// A word that no test writes.
pub const CANARY: u32 = 0xDEAD_BEEF;
const GUARD: u64 = 256;

/// Memory with canary words before and behind it.
pub struct Guarded {
    buffer: Buffer,
    size: u64,
}

impl Guarded {
    pub fn region(&self) -> Region {
        Region { buffer: self.buffer.raw(), offset: GUARD, size: self.size, address: self.buffer.address() + GUARD }
    }

    pub fn read<T: bytemuck::Pod>(&self, offset: u64, count: usize) -> Vec<T> {
        self.buffer.read(GUARD + offset, count).unwrap()
    }

    pub fn write<T: bytemuck::Pod>(&self, offset: u64, data: &[T]) {
        self.buffer.write(GUARD + offset, data).unwrap();
    }

    /// Fails if a word before or behind the memory was written.
    pub fn check(&self) {
        let words = (GUARD / 4) as usize;
        let behind = GUARD + self.size.next_multiple_of(4);
        for (side, offset) in [("before", 0), ("behind", behind)] {
            let guard: Vec<u32> = self.buffer.read(offset, words).unwrap();
            let hit = guard.iter().position(|word| *word != CANARY);
            assert_eq!(hit, None, "{}: a word {side} the region was written: {guard:x?}", self.buffer.name());
        }
    }
}

/// A grid on the device, and the memory around it.
pub struct Built {
    pub info: BuildInfo,
    pub report: Report,
    pub grid: Guarded,
    pub scratch: Guarded,
    pub report_memory: Guarded,
    pub positions: Guarded,
    pub indices: Guarded,
}

impl Built {
    /// The mesh on the device.
    pub fn geometry(&self) -> Geometry {
        Geometry {
            positions: self.positions.region(),
            vertex_count: (self.positions.size / 12) as u32,
            indices: self.indices.region(),
            triangle_count: (self.indices.size / 12) as u32,
        }
    }

    pub fn header(&self) -> GridHeader {
        self.grid.read(0, 1)[0]
    }

    /// Begin and end of each cell's list, or where a split cell's leaf cells are; and behind the cells the leaf cells. Cells of empty bricks,
    /// which hold nothing that counts, are empty here.
    pub fn cells(&self) -> Vec<[u32; 2]> {
        let header = self.header();
        let leaf_cells = if self.info.capacity.leaf_cells > 0 { self.report.leaf_cells.min(self.info.capacity.leaf_cells) } else { 0 };
        let mut cells: Vec<[u32; 2]> = self.grid.read(self.offset(header.cells), (header.cell_count + leaf_cells) as usize);
        let bricks = self.bricks();
        for (id, range) in (0..header.cell_count).zip(&mut cells) {
            let brick = cell_of(id, header.resolution).map(|n| n / BRICK_SIZE);
            if bricks[cell_id(brick, brick_resolution(header.resolution)) as usize].mask == [0, 0] {
                *range = [0, 0];
            }
        }
        cells
    }

    /// The triangles in the lists of all cells, one after another; then in those of all leaf cells.
    pub fn references(&self) -> Vec<u32> {
        self.first_rows().into_iter().map(|row| row / 3).collect()
    }

    /// Likewise, as the grid has them.
    fn first_rows(&self) -> Vec<u32> {
        self.grid.read(self.offset(self.header().references), (self.report.pairs + self.report.leaf_pairs) as usize)
    }

    /// Three rows a triangle, in the grid's frame.
    pub fn triangles(&self) -> Vec<[[f32; 4]; 3]> {
        let header = self.header();
        self.grid.read(self.offset(header.triangles), header.triangle_count as usize)
    }

    /// What a part of the build's memory holds.
    pub fn part<T: bytemuck::Pod>(&self, gpu: &Gpu, buffer: gridwalk::plan::Buffer, count: usize) -> Vec<T> {
        let region = gpu.tracer.build_region(&self.info, buffer);
        let memory =
            [&self.grid, &self.scratch, &self.report_memory].into_iter().find(|memory| memory.region().buffer == region.buffer).unwrap();
        memory.read(region.offset - GUARD, count)
    }

    /// Blocks of cells.
    pub fn bricks(&self) -> Vec<Brick> {
        let header = self.header();
        self.grid.read(self.offset(header.bricks), brick_resolution(header.resolution).iter().product::<u32>() as usize)
    }

    pub fn copy(&self) -> GridCopy {
        GridCopy {
            header: self.header(),
            bricks: self.bricks(),
            cells: self.cells(),
            references: self.first_rows(),
            triangles: self.triangles(),
        }
    }

    /// Lists another triangle wherever this one is listed: a grid that is wrong, for negative controls.
    pub fn forget_triangle(&self, victim: u32, instead: u32) {
        let mut references = self.first_rows();
        references.iter_mut().filter(|row| **row == 3 * victim).for_each(|row| *row = 3 * instead);
        self.grid.write(self.offset(self.header().references), &references);
    }

    pub fn check_guards(&self) {
        for memory in [&self.grid, &self.scratch, &self.report_memory, &self.positions, &self.indices] {
            memory.check();
        }
    }

    fn offset(&self, address: [u32; 2]) -> u64 {
        (u64::from(address[0]) | u64::from(address[1]) << 32) - self.grid.region().address
    }
}

impl Gpu {
    /// The device that all tests of a process share.
    pub fn shared() -> &'static Gpu {
        static GPU: OnceLock<Gpu> = OnceLock::new();
        GPU.get_or_init(|| Gpu::new(None))
    }

    /// The shared device, with kernels cut as asked.
    pub fn with_shape(shape: Shape) -> &'static Gpu {
        static GPUS: Mutex<Vec<(Shape, &'static Gpu)>> = Mutex::new(Vec::new());
        let mut gpus = GPUS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, gpu)) = gpus.iter().find(|(known, _)| *known == shape) {
            return gpu;
        }
        let gpu: &'static Gpu = Box::leak(Box::new(Gpu::on(Gpu::shared().context.clone(), Some(shape))));
        gpus.push((shape, gpu));
        gpu
    }

    /// A device of its own, with kernels cut as asked.
    pub fn new(shape: Option<Shape>) -> Gpu {
        let validation = std::env::var("GRIDWALK_VALIDATE").map_or(true, |value| value != "0");
        let context = Context::new(&ContextDesc { validation, name: "tests", ..ContextDesc::default() }).unwrap();
        Gpu::on(context, shape)
    }

    fn on(context: Context, shape: Option<Shape>) -> Gpu {
        let desc = DeviceDesc {
            instance: context.instance(),
            physical_device: context.physical_device(),
            device: context.device(),
            pipeline_cache: vk::PipelineCache::null(),
            shape,
            debug_utils: context.debug_utils(),
        };
        // SAFETY: the handles are of each other, and the context, declared after the tracer, is dropped after it.
        let tracer = unsafe { Tracer::new(&desc) }.unwrap();
        Gpu { context, tracer }
    }

    /// Fails if the validation layers have said anything since the last call.
    pub fn check_validation(&self) {
        static ONE: Mutex<()> = Mutex::new(());
        let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let messages = self.context.take_validation_messages();
        assert!(messages.is_empty(), "validation messages:\n{}", messages.join("\n"));
    }

    /// Memory filled with canary words, guards included.
    pub fn guarded(&self, name: &str, size: u64) -> Guarded {
        let whole = GUARD + size.next_multiple_of(4) + GUARD;
        let buffer = self.context.buffer(&BufferDesc { name, size: whole, kind: BufferKind::Device, dedicated: false }).unwrap();
        buffer.write(0, &vec![CANARY; (whole / 4) as usize]).unwrap();
        Guarded { buffer, size }
    }

    /// Guarded memory that holds `data`.
    pub fn upload<T: bytemuck::Pod>(&self, name: &str, data: &[T]) -> Guarded {
        let memory = self.guarded(name, (size_of_val(data) as u64).max(4));
        memory.write(0, data);
        memory
    }

    /// Records, submits and waits.
    pub fn submit(&self, record: impl FnOnce(vk::CommandBuffer)) {
        let submitted = self.context.submit("test", |cmd| {
            record(cmd);
            Ok(())
        });
        submitted.unwrap();
    }

    /// Runs one kernel: the addresses of its memory in order of its accesses, then `words`. Checks the guards.
    pub fn launch(&self, kernel: &'static Kernel, variant: u32, memory: &[&Guarded], words: &[u32], groups: [u32; 3]) {
        assert_eq!(memory.len(), kernel.accesses.len(), "{}", kernel.name);
        let mut push: Vec<u8> = memory.iter().flat_map(|memory| memory.region().address.to_ne_bytes()).collect();
        push.extend(words.iter().flat_map(|word| word.to_ne_bytes()));
        assert!(push.len() as u32 <= kernel.push_constant_size.next_multiple_of(8), "{}", kernel.name);
        push.resize(kernel.push_constant_size as usize, 0);
        self.submit(|cmd| {
            // SAFETY: the caller gives memory as large as the kernel needs for these words; it outlives the submission.
            unsafe { self.tracer.cmd_kernel(cmd, kernel, variant, &push, groups) };
        });
        for memory in memory {
            memory.check();
        }
        self.check_validation();
    }

    /// As [`Gpu::launch`], of a map kernel that is not the library's, with workgroups of this size. On the shared device alone, which lives
    /// as long as the pipelines that are kept for the next launch.
    pub fn launch_alone(&self, kernel: &'static Kernel, size: u32, memory: &[&Guarded], words: &[u32], groups: [u32; 3]) {
        assert!(std::ptr::eq(self, Gpu::shared()) && memory.len() == kernel.accesses.len(), "{}", kernel.name);
        let mut push: Vec<u8> = memory.iter().flat_map(|memory| memory.region().address.to_ne_bytes()).collect();
        push.extend(words.iter().flat_map(|word| word.to_ne_bytes()));
        assert!(push.len() as u32 <= kernel.push_constant_size.next_multiple_of(8), "{}", kernel.name);
        push.resize(kernel.push_constant_size as usize, 0);
        let (layout, pipeline) = self.alone(kernel, size);
        if !groups.contains(&0) {
            let device = self.context.device();
            // SAFETY: the caller gives memory as large as the kernel needs for these words; it outlives the submission; the push constants
            // are as long as the layout's range.
            self.submit(|cmd| unsafe {
                device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, pipeline);
                device.cmd_push_constants(cmd, layout, vk::ShaderStageFlags::COMPUTE, 0, &push);
                device.cmd_dispatch(cmd, groups[0], groups[1], groups[2]);
            });
        }
        for memory in memory {
            memory.check();
        }
        self.check_validation();
    }

    fn alone(&self, kernel: &'static Kernel, size: u32) -> (vk::PipelineLayout, vk::Pipeline) {
        type Made = (&'static str, u32, vk::PipelineLayout, vk::Pipeline);
        static MADE: Mutex<Vec<Made>> = Mutex::new(Vec::new());
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((.., layout, pipeline)) = made.iter().find(|(name, of_size, ..)| *name == kernel.name && *of_size == size) {
            return (*layout, *pipeline);
        }
        let device = self.context.device();
        let ranges = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(kernel.push_constant_size)];
        let entries = [vk::SpecializationMapEntry { constant_id: 0, offset: 0, size: 4 }];
        let data = size.to_ne_bytes();
        let constants = vk::SpecializationInfo::default().map_entries(&entries).data(&data);
        // SAFETY: the device lives as long as the process; the SPIR-V is a kernel's, without descriptors, whose constant 0 is its size.
        let (layout, pipeline) = unsafe {
            let layout =
                device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&ranges), None).unwrap();
            let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(kernel.spirv), None).unwrap();
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(c"main")
                .specialization_info(&constants);
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout);
            let pipelines = device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None).unwrap();
            device.destroy_shader_module(module, None);
            (layout, pipelines[0])
        };
        made.push((kernel.name, size, layout, pipeline));
        (layout, pipeline)
    }

    /// Runs one item of a build's plan on the memory as earlier ones left it.
    pub fn run_item(&self, built: &Built, item: &Item) {
        self.submit(|cmd| {
            // SAFETY: all memory of the build lives in `built`, and the submission is waited for.
            unsafe { self.tracer.cmd_build_items(cmd, &built.info, std::slice::from_ref(item)) };
        });
        built.check_guards();
        self.check_validation();
    }

    /// Builds one after another in one submission, with the library's barrier in between; they may share scratch.
    pub fn rebuild_all(&self, grids: &mut [&mut Built]) {
        self.submit(|cmd| {
            for built in grids.iter() {
                // SAFETY: all memory of the builds outlives the submission, which is waited for.
                unsafe {
                    self.tracer.cmd_build(cmd, &built.info).unwrap();
                    cmd_barrier(self.context.device(), cmd, Tracer::BUILD, Tracer::BUILD);
                }
            }
        });
        for built in grids {
            built.report = built.report_memory.read(0, 1)[0];
            built.check_guards();
        }
        self.check_validation();
    }

    /// Why a build is refused.
    pub fn refused(&self, info: &BuildInfo) -> gridwalk::Error {
        let mut error = None;
        self.submit(|cmd| {
            // SAFETY: the memory of `info` outlives the submission; what is refused records nothing.
            error = unsafe { self.tracer.cmd_build(cmd, info) }.err();
        });
        self.check_validation();
        error.unwrap_or_else(|| panic!("not refused: {info:?}"))
    }

    /// Runs a shader that is none of the library's, as so many workgroups.
    pub fn run_module(&self, words: &[u32], push: &[u8], groups: u32) {
        let device = self.context.device();
        // SAFETY: the module is valid, the caller's push constants hold addresses of memory that it may access and that outlives the
        // submission, which is waited for before anything is destroyed.
        unsafe {
            let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(words), None).unwrap();
            let range = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(push.len() as u32)];
            let layout =
                device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&range), None).unwrap();
            let stage = vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::COMPUTE).module(module).name(c"main");
            let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
            let pipeline = device.create_compute_pipelines(vk::PipelineCache::null(), &info, None).unwrap()[0];
            self.submit(|cmd| {
                device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, pipeline);
                device.cmd_push_constants(cmd, layout, vk::ShaderStageFlags::COMPUTE, 0, push);
                device.cmd_dispatch(cmd, groups, 1, 1);
            });
            device.destroy_pipeline(pipeline, None);
            device.destroy_pipeline_layout(layout, None);
            device.destroy_shader_module(module, None);
        }
        self.check_validation();
    }

    /// Why a trace through the grid at an address is refused.
    pub fn refused_trace(&self, grid: vk::DeviceAddress, info: &TraceInfo) -> gridwalk::Error {
        let mut error = None;
        self.submit(|cmd| {
            // SAFETY: what is refused records nothing.
            error = unsafe { self.tracer.cmd_closest_hit(cmd, grid, info) }.err();
        });
        self.check_validation();
        error.unwrap_or_else(|| panic!("not refused: {info:?}"))
    }

    /// Records a build once and submits it several times, with `between` before each but the first.
    pub fn submit_again(&self, built: &mut Built, times: usize, mut between: impl FnMut(&mut Built, usize)) {
        let device = self.context.device();
        // SAFETY: instance and physical device are of each other; the pool, its buffer and all memory outlive the submissions, which are
        // waited for; the family is the one that the context's queue is of.
        let (pool, secondary) = unsafe {
            let families = self.context.instance().get_physical_device_queue_family_properties(self.context.physical_device());
            let computes = |family: &vk::QueueFamilyProperties| family.queue_flags.contains(vk::QueueFlags::COMPUTE);
            let family = families.iter().position(|family| computes(family) && family.timestamp_valid_bits > 0);
            let family = family.or_else(|| families.iter().position(computes)).unwrap() as u32;
            let pool = device.create_command_pool(&vk::CommandPoolCreateInfo::default().queue_family_index(family), None).unwrap();
            let info = vk::CommandBufferAllocateInfo::default()
                .command_pool(pool)
                .level(vk::CommandBufferLevel::SECONDARY)
                .command_buffer_count(1);
            let cmd = device.allocate_command_buffers(&info).unwrap()[0];
            let inheritance = vk::CommandBufferInheritanceInfo::default();
            device.begin_command_buffer(cmd, &vk::CommandBufferBeginInfo::default().inheritance_info(&inheritance)).unwrap();
            self.tracer.cmd_build(cmd, &built.info).unwrap();
            device.end_command_buffer(cmd).unwrap();
            (pool, cmd)
        };
        for time in 0..times {
            if time > 0 {
                between(built, time);
            }
            self.submit(|cmd| {
                // SAFETY: as above.
                unsafe { device.cmd_execute_commands(cmd, &[secondary]) };
            });
            built.report = built.report_memory.read(0, 1)[0];
            built.check_guards();
        }
        // SAFETY: the submissions have ended.
        unsafe { device.destroy_command_pool(pool, None) };
        self.check_validation();
    }

    /// Builds again with timestamps, which are returned; `None` where the device has none.
    pub fn timestamps(&self, built: &mut Built) -> Option<Vec<u64>> {
        if !self.context.has_timestamps() {
            return None;
        }
        const FIRST: u32 = 3;
        let count = self.tracer.build_sizes(&built.info.capacity).unwrap().timestamp_count;
        let device = self.context.device();
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(FIRST + count);
        // SAFETY: the device lives.
        let pool = unsafe { device.create_query_pool(&info, None) }.unwrap();
        built.info.timestamps = Some(Timestamps { pool, first_query: FIRST });
        self.rebuild(built);
        built.info.timestamps = None;
        let leaf_cells = if built.info.second_level { built.info.capacity.leaf_cells } else { 0 };
        let steps = self.tracer.build_steps(&Capacity { leaf_cells, ..built.info.capacity });
        let mut stamps = vec![0u64; steps.len() + 1];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the build reset and wrote these queries, and has ended.
        unsafe {
            device.get_query_pool_results(pool, FIRST, &mut stamps, flags).unwrap();
            device.destroy_query_pool(pool, None);
        }
        Some(stamps)
    }

    /// Memory for a build of a mesh, which is not built yet.
    pub fn prepare(&self, mesh: &Mesh, capacity: Capacity, options: BuildOptions) -> Built {
        let sizes = self.tracer.build_sizes(&capacity).unwrap();
        let positions = self.upload("positions", &mesh.positions);
        let indices = self.upload("indices", &mesh.indices);
        let grid = self.guarded("grid", sizes.grid.size);
        let scratch = self.guarded("scratch", sizes.scratch.size);
        let report_memory = self.guarded("report", sizes.report.size);
        let geometry = Geometry {
            positions: positions.region(),
            vertex_count: mesh.positions.len() as u32,
            indices: indices.region(),
            triangle_count: mesh.indices.len() as u32,
        };
        let info = BuildInfo {
            input: geometry.into(),
            grid: grid.region(),
            scratch: scratch.region(),
            report: report_memory.region(),
            capacity,
            options,
            second_level: true,
            timestamps: None,
        };
        Built { info, report: bytemuck::Zeroable::zeroed(), grid, scratch, report_memory, positions, indices }
    }

    /// Builds, or builds again, and checks the guards.
    pub fn rebuild(&self, built: &mut Built) {
        self.submit(|cmd| {
            // SAFETY: all memory of the build lives in `built`, and the submission is waited for.
            unsafe {
                self.tracer.cmd_build(cmd, &built.info).unwrap();
                cmd_barrier(self.context.device(), cmd, Tracer::BUILD, Tracer::TRACE);
            }
        });
        built.report = built.report_memory.read(0, 1)[0];
        built.check_guards();
        self.check_validation();
    }

    /// A grid over a mesh.
    pub fn build(&self, mesh: &Mesh, capacity: Capacity, options: BuildOptions) -> Built {
        let mut built = self.prepare(mesh, capacity, options);
        self.rebuild(&mut built);
        built
    }

    /// The closest hits of rays.
    pub fn closest(&self, built: &Built, rays: &[Ray]) -> Vec<Hit> {
        self.trace(built, rays, |cmd, grid, info| {
            // SAFETY: see `trace`.
            unsafe { self.tracer.cmd_closest_hit(cmd, grid, info) }
        })
    }

    /// Whether rays hit anything.
    pub fn any(&self, built: &Built, rays: &[Ray]) -> Vec<u32> {
        self.trace(built, rays, |cmd, grid, info| {
            // SAFETY: see `trace`.
            unsafe { self.tracer.cmd_any_hit(cmd, grid, info) }
        })
    }

    /// The closest hits by testing all triangles.
    pub fn brute_force(&self, built: &Built, rays: &[Ray]) -> Vec<Hit> {
        let triangle_count = built.report.triangles;
        self.trace(built, rays, |cmd, grid, info| {
            // SAFETY: see `trace`.
            unsafe { self.tracer.cmd_brute_force(cmd, grid, triangle_count, info) }
        })
    }

    /// The closest hits by a shader that uses the public include.
    pub fn closest_by_include(&self, built: &Built, rays: &[Ray]) -> Vec<Hit> {
        self.trace(built, rays, |cmd, grid, info| {
            // SAFETY: see `trace`.
            unsafe { self.tracer.cmd_closest_candidate(cmd, grid, info) }
        })
    }

    /// The closest hits in guarded memory, with everything that may be asked for. Hits of rays beyond the number in memory keep the canary;
    /// counters are empty unless counted.
    pub fn closest_with(&self, built: &Built, rays: &[Ray], options: &TraceOptions) -> (Vec<Hit>, Vec<[u32; 4]>) {
        let max = rays.len() as u32;
        let ray_memory = self.upload("rays", rays);
        let hits = self.guarded("hits", size_of_val(rays).max(32) as u64 / 2);
        if let Some(existing) = options.resume {
            hits.write(0, existing);
        }
        let counters = self.guarded("counters", rays.len().max(1) as u64 * 16);
        let number = self.upload("ray count", &[options.indirect.unwrap_or(0)]);
        let order = self.upload("order", options.order.unwrap_or(&[]));
        let max = options.order.map_or(max, |order| order.len() as u32);
        let scratch = self.guarded("trace scratch", self.tracer.trace_scratch_size(max).unwrap().size);
        let count = match options.indirect {
            Some(_) => RayCount::Indirect { count: number.region(), max },
            None => RayCount::Direct(max),
        };
        let info = TraceInfo {
            resume: options.resume.is_some(),
            counters: options.count.then(|| counters.region()),
            order: options.order.map(|_| order.region()),
            ..TraceInfo::new(ray_memory.region(), hits.region(), count, scratch.region())
        };
        self.submit(|cmd| {
            // SAFETY: all memory lives until the submission has ended, which `submit` waits for.
            unsafe { self.tracer.cmd_closest_hit(cmd, built.grid.region().address, &info) }.unwrap();
        });
        for memory in [&ray_memory, &hits, &counters, &number, &order, &scratch, &built.grid] {
            memory.check();
        }
        self.check_validation();
        (hits.read(0, rays.len()), if options.count { counters.read(0, rays.len()) } else { Vec::new() })
    }

    /// The order of a sort of rays; with an indirect number, words beyond it keep the canary.
    pub fn sort_rays(&self, built: &Built, rays: &[Ray], indirect: Option<u32>) -> Vec<u32> {
        let max = rays.len() as u32;
        let (ray_memory, order) = (self.upload("rays", rays), self.guarded("order", (4 * rays.len() as u64).max(4)));
        let number = self.upload("ray count", &[indirect.unwrap_or(0)]);
        let scratch = self.guarded("ray sort scratch", self.tracer.ray_sort_scratch_size(max).unwrap().size);
        let count = indirect.map_or(RayCount::Direct(max), |_| RayCount::Indirect { count: number.region(), max });
        let info = RaySortInfo::new(ray_memory.region(), count, order.region(), scratch.region());
        self.submit(|cmd| {
            // SAFETY: as above.
            unsafe { self.tracer.cmd_sort_rays(cmd, built.grid.region().address, &info) }.unwrap();
        });
        for memory in [&ray_memory, &order, &number, &scratch, &built.grid] {
            memory.check();
        }
        self.check_validation();
        order.read(0, rays.len())
    }

    /// Whether rays hit anything, their number being in memory. Results of rays beyond it keep the canary.
    pub fn any_indirect(&self, built: &Built, rays: &[Ray], number: u32) -> Vec<u32> {
        let count = self.upload("ray count", &[number]);
        self.trace(built, rays, |cmd, grid, info| {
            let info = TraceInfo { count: RayCount::Indirect { count: count.region(), max: rays.len() as u32 }, ..*info };
            // SAFETY: see `trace`; the count lives until then too.
            unsafe { self.tracer.cmd_any_hit(cmd, grid, &info) }
        })
    }

    /// Traces with guarded memory that lives until the submission has ended.
    pub fn trace<T: bytemuck::Pod>(
        &self,
        built: &Built,
        rays: &[Ray],
        record: impl FnOnce(vk::CommandBuffer, vk::DeviceAddress, &TraceInfo) -> gridwalk::Result<()>,
    ) -> Vec<T> {
        let count = rays.len() as u32;
        let ray_memory = self.upload("rays", rays);
        let hits = self.guarded("hits", (rays.len() * size_of::<T>()).max(4) as u64);
        let scratch = self.guarded("trace scratch", self.tracer.trace_scratch_size(count).unwrap().size);
        let info = TraceInfo::new(ray_memory.region(), hits.region(), RayCount::Direct(count), scratch.region());
        self.submit(|cmd| record(cmd, built.grid.region().address, &info).unwrap());
        for memory in [&ray_memory, &hits, &scratch, &built.grid] {
            memory.check();
        }
        self.check_validation();
        hits.read(0, rays.len())
    }
}
