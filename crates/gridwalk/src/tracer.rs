//! The library's face: sizes, and recording of builds and traces.

use std::ffi::CString;

use ash::vk;
use gridwalk_core::GeometryRecord;
use gridwalk_core::geometry::MAX_GEOMETRIES;
use gridwalk_core::kernel::Kernel;
use gridwalk_core::walk;

use crate::error::{Error, Result};
use crate::kernels::*;
use crate::plan::{self, Buffer, BuildInputs, Dispatch, Extras, Item, MAX_PUSH, Query, RayInputs, Source, Step};
use crate::requirements;
use crate::sizes::{
    self, BuildSizes, Capacity, GridLayout, MAX_RAYS, MAX_VERTICES, REGION_ALIGNMENT, REPORT_SIZE, RaySortLayout, RegionSize,
    ScratchLayout, TraceLayout,
};
use crate::sync::{Access, SHADER, cmd_barrier};
use gridwalk_core::shape::Shape;

/// The device that a [`Tracer`] records for.
pub struct DeviceDesc<'a> {
    /// Instance of the device.
    pub instance: &'a ash::Instance,
    /// Physical device of the device.
    pub physical_device: vk::PhysicalDevice,
    /// Device with the features of [`requirements()`] enabled.
    pub device: &'a ash::Device,
    /// Cache for the pipelines, or null.
    pub pipeline_cache: vk::PipelineCache,
    /// How kernels are cut; `None` chooses by the kind of device.
    pub shape: Option<Shape>,
    /// `VK_EXT_debug_utils` of the device, if enabled: names the pipelines and labels every step in the command buffer.
    pub debug_utils: Option<&'a ash::ext::debug_utils::Device>,
}

impl<'a> DeviceDesc<'a> {
    /// No cache, no labels, and kernels cut as suits the kind of device.
    pub fn new(instance: &'a ash::Instance, physical_device: vk::PhysicalDevice, device: &'a ash::Device) -> DeviceDesc<'a> {
        DeviceDesc { instance, physical_device, device, pipeline_cache: vk::PipelineCache::null(), shape: None, debug_utils: None }
    }
}

/// A piece of a buffer of the caller's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Region {
    /// The buffer, with usage `SHADER_DEVICE_ADDRESS`.
    pub buffer: vk::Buffer,
    /// First byte of the region in the buffer.
    pub offset: vk::DeviceSize,
    /// Bytes.
    pub size: vk::DeviceSize,
    /// Device address of the region's first byte.
    pub address: vk::DeviceAddress,
}

impl Region {
    /// No memory.
    pub const NONE: Region = Region { buffer: vk::Buffer::null(), offset: 0, size: 0, address: 0 };

    /// A piece of this region.
    pub const fn part(&self, offset: vk::DeviceSize, size: vk::DeviceSize) -> Region {
        Region { buffer: self.buffer, offset: self.offset + offset, size, address: self.address + offset }
    }
}

/// Indexed triangles in device memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct Geometry {
    /// Three `f32` a vertex, tightly packed.
    pub positions: Region,
    /// Vertices in `positions`, at most [`crate::MAX_VERTICES`]; a triangle with an index beyond is dropped.
    pub vertex_count: u32,
    /// Three `u32` a triangle, tightly packed.
    pub indices: Region,
    /// Triangles in `indices`.
    pub triangle_count: u32,
}

/// What a grid is built of.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Input {
    /// One mesh, tightly packed.
    Mesh(Geometry),
    /// Any number of geometries and instances, as records in device memory.
    Records(Records),
}

/// Geometries that the device reads as records.
#[derive(Clone, Copy, Debug)]
pub struct Records {
    /// [`gridwalk_core::GeometryRecord`]s, written before the build by the host or by a shader. Their triangles are numbered one record after
    /// another; those beyond the capacity are left out and reported ([`gridwalk_core::Report::triangles_overflowed`]).
    pub records: Region,
    /// How many: at most [`crate::MAX_GEOMETRIES`], and at most the capacity of triangles. A record without a triangle is allowed.
    pub count: u32,
}

impl From<Geometry> for Input {
    fn from(geometry: Geometry) -> Input {
        Input::Mesh(geometry)
    }
}

/// Which cells list a triangle (thesis Figure 3.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Overlap {
    /// All that its box overlaps: the faster build, by less than a tenth.
    Box,
    /// Only those that the triangle itself overlaps: fewer tests when tracing, above all with long thin triangles.
    #[default]
    Exact,
}

/// Options of a build.
#[derive(Clone, Copy, Debug)]
pub struct BuildOptions {
    /// Density k of Equation 3-1: cells a triangle.
    pub density: f32,
    /// Cells along each axis, instead of the density.
    pub resolution: Option<[u32; 3]>,
    /// Overlap test.
    pub overlap: Overlap,
}

impl BuildOptions {
    /// Density unless something else is asked for: a rebuild and two million rays together take about the least from 5 to 12.
    pub const DEFAULT_DENSITY: f32 = 7.0;
}

impl Default for BuildOptions {
    fn default() -> Self {
        BuildOptions { density: Self::DEFAULT_DENSITY, resolution: None, overlap: Overlap::default() }
    }
}

/// Where a build writes timestamps: one before its first step and one after each.
#[derive(Clone, Copy, Debug)]
pub struct Timestamps {
    /// Pool of type `TIMESTAMP`.
    pub pool: vk::QueryPool,
    /// First of the queries, which the recording resets.
    pub first_query: u32,
}

/// Arguments of [`Tracer::cmd_build`].
#[derive(Clone, Copy, Debug)]
pub struct BuildInfo {
    /// What is built.
    pub input: Input,
    /// Where the grid goes.
    pub grid: Region,
    /// Memory of the build.
    pub scratch: Region,
    /// Where the [`gridwalk_core::Report`] goes.
    pub report: Region,
    /// What the regions were sized for.
    pub capacity: Capacity,
    /// How it is built.
    pub options: BuildOptions,
    /// Whether cells with far more triangles than others are split, if the capacity has leaf cells. Otherwise the steps of the second level are
    /// not recorded, whose launches take time even where no cell is to be split; the grid is complete and flat, and the report counts the cells
    /// and leaf cells that there would be, so that a scene that moves can have the second level once it needs it. Steps and timestamps are then
    /// those of a capacity without leaf cells.
    pub second_level: bool,
    /// Times of the steps, if wanted; lavapipe takes 0.02 ms for each. [`BuildSizes::timestamp_count`] queries, of which a build resets and
    /// writes one more than it has steps; without `second_level` it has fewer, and waiting for the others never ends.
    pub timestamps: Option<Timestamps>,
}

impl BuildInfo {
    /// A build with the options that stand for themselves. What is set beside is best put around it, since fields may be added:
    /// `BuildInfo { options, ..BuildInfo::new(input, grid, scratch, report, capacity) }`.
    pub fn new(input: impl Into<Input>, grid: Region, scratch: Region, report: Region, capacity: Capacity) -> BuildInfo {
        let options = BuildOptions::default();
        BuildInfo { input: input.into(), grid, scratch, report, capacity, options, second_level: true, timestamps: None }
    }
}

/// How many rays there are.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum RayCount {
    /// As many.
    Direct(u32),
    /// As many as a `u32` in device memory says, at most `max`.
    Indirect {
        /// The number, 4 bytes.
        count: Region,
        /// Bound of the number; rays beyond are not traced.
        max: u32,
    },
}

impl RayCount {
    /// The greatest number of rays.
    pub const fn max(&self) -> u32 {
        match *self {
            RayCount::Direct(count) => count,
            RayCount::Indirect { max, .. } => max,
        }
    }
}

/// Arguments of [`Tracer::cmd_closest_hit`], [`Tracer::cmd_any_hit`], [`Tracer::cmd_count_hits`] and [`Tracer::cmd_nearest_hits`].
#[derive(Clone, Copy, Debug)]
pub struct TraceInfo {
    /// [`gridwalk_core::Ray`]s.
    pub rays: Region,
    /// Closest hit: [`gridwalk_core::Hit`]s. Any hit: a `u32` a ray, 1, 0 or [`gridwalk_core::UNFINISHED`].
    pub hits: Region,
    /// Number of rays.
    pub count: RayCount,
    /// Memory of the trace: [`Tracer::trace_scratch_size`].
    pub scratch: Region,
    /// Closest hit only: go on from the hits that lie in `hits`, which stay unless a closer one is found. So several grids are traced one
    /// after another. A ray that is unfinished stays so.
    pub resume: bool,
    /// Closest hit only: where each ray's numbers of steps, triangle tests and cells that were not empty are written, as `uvec4`.
    pub counters: Option<Region>,
    /// Mask of all rays: a geometry is hit only if its mask shares a bit with it. A ray whose mask is 0xFFFFFFFF hits every geometry. One mesh
    /// without records ([`Input::Mesh`]) has the mask 0xFFFFFFFF.
    pub mask: u32,
    /// A `u32` a ray: a mask of its own, of which only the bits of `mask` count.
    pub masks: Option<Region>,
    /// Triangles that are not hit because of the side that the ray sees.
    pub cull: Cull,
    /// Where the geometry of each hit is written, two `u32` for each: the id of its record, and the triangle's number within it; twice
    /// 0xFFFFFFFF where there is no hit. Of closest hits one a ray, left as it is where [`TraceInfo::resume`] leaves the hit; of any hit one a
    /// ray, of the hit that ended the search; of nearest hits as many a ray as hits. Counts have none.
    pub geometries: Option<Region>,
    /// A `u32` a ray: the indices of the rays in the order in which they are traced. What a ray hits, its mask, its geometry and its
    /// counters lie at its index as ever, bit for bit the same. [`Tracer::cmd_sort_rays`] makes an order in which rays that walk through the
    /// same cells follow one another. [`TraceInfo::count`] is then the number of indices: a part of an order traces a part of the rays, of
    /// which the other regions hold all. The indices are below the number of rays, and differ.
    pub order: Option<Region>,
}

/// Sides of triangles that are not hit. The front is where the vertices go round counterclockwise, seen along the ray; records may exchange
/// front and back, or be exempt ([`gridwalk_core::geometry`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cull {
    /// Both sides are hit.
    #[default]
    None,
    /// Only fronts are hit.
    Back,
    /// Only backs are hit.
    Front,
}

impl TraceInfo {
    /// A trace without options. What is set beside is best put around it, since fields may be added:
    /// `TraceInfo { resume: true, ..TraceInfo::new(rays, hits, count, scratch) }`.
    pub const fn new(rays: Region, hits: Region, count: RayCount, scratch: Region) -> TraceInfo {
        TraceInfo {
            rays,
            hits,
            count,
            scratch,
            resume: false,
            counters: None,
            mask: u32::MAX,
            masks: None,
            cull: Cull::None,
            geometries: None,
            order: None,
        }
    }
}

/// Arguments of [`Tracer::cmd_sort_rays`].
#[derive(Clone, Copy, Debug)]
pub struct RaySortInfo {
    /// [`gridwalk_core::Ray`]s.
    pub rays: Region,
    /// Number of rays.
    pub count: RayCount,
    /// Where the order goes, a `u32` a ray: for [`TraceInfo::order`].
    pub order: Region,
    /// Memory of the sort: [`Tracer::ray_sort_scratch_size`]. Not needed by the traces that follow, whose scratch it may be.
    pub scratch: Region,
}

impl RaySortInfo {
    /// A sort of rays.
    pub const fn new(rays: Region, count: RayCount, order: Region, scratch: Region) -> RaySortInfo {
        RaySortInfo { rays, count, order, scratch }
    }
}

/// Most hits a ray that [`Tracer::cmd_nearest_hits`] finds at once.
pub const MAX_NEAREST: u32 = 64;
// A walk that is given up keeps their number below the place in its cell.
const _: () = assert!(MAX_NEAREST < 1 << gridwalk_core::layout::WALK_FINE);

struct Variant {
    kernel: &'static Kernel,
    name: CString,
    variant: u32,
    pipeline: vk::Pipeline,
}

/// Records builds and traces for one device.
///
/// Creating it makes all pipelines; after that nothing is created, allocated or waited for. All methods take `&self` and may be called on
/// several threads at once, as long as each command buffer is used by one.
pub struct Tracer {
    device: ash::Device,
    layout: vk::PipelineLayout,
    variants: Vec<Variant>,
    shape: Shape,
    max_buffer_size: u64,
    debug_utils: Option<ash::ext::debug_utils::Device>,
}

/// Boolean constants of a kernel that differ between its launches, in order of the bits of a step's variant, and the variants in use.
fn launch_constants(kernel: &'static Kernel) -> (&'static [&'static str], &'static [u32]) {
    match kernel.name {
        "overlap_count" | "overlap_emit_large" | "leaf_count" | "leaf_emit" | "leaf_emit_large" => (&["EXACT"], &[0, plan::EXACT]),
        "closest_hit" => (
            &["CONTINUE", "LAST", "RESUME", "COUNT", "EXTRAS"],
            &[0, 1, 3, 4, 5, 7, 8, 9, 11, 12, 13, 15, 16, 17, 19, 20, 21, 23, 24, 25, 27, 28, 29, 31],
        ),
        "any_hit" => (&["CONTINUE", "LAST", "EXTRAS"], &[0, 1, 3, 4, 5, 7]),
        _ => (&[], &[0]),
    }
}

impl Tracer {
    /// What precedes and follows builds in a barrier.
    pub const BUILD: Access = Access::COMPUTE;

    /// What precedes and follows traces in a barrier.
    pub const TRACE: Access = Access::COMPUTE;

    /// Makes the pipelines.
    ///
    /// # Errors
    /// [`Error::Unsuitable`] names all that the physical device lacks; [`Error::Option`] for a shape that cannot be; [`Error::Vulkan`].
    ///
    /// # Safety
    /// The handles are valid, and of each other. The device has the features of [`requirements()`] enabled and outlives the tracer. All work
    /// that was recorded with the tracer has ended when it is dropped.
    pub unsafe fn new(desc: &DeviceDesc) -> Result<Tracer> {
        // SAFETY: the caller's contract.
        let found = unsafe { requirements::query(desc.instance, desc.physical_device) };
        if !found.missing.is_empty() {
            return Err(Error::Unsuitable { missing: found.missing });
        }
        let shape = desc.shape.unwrap_or_else(|| Shape::of_device(found.is_cpu));
        if !shape.is_valid() {
            return Err(Error::Option { option: "shape", value: format!("{shape:?}"), expected: "sizes within the bounds of its fields" });
        }
        let device = desc.device.clone();
        let range = vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(MAX_PUSH as u32);
        let layout_info = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(std::slice::from_ref(&range));
        // SAFETY: the caller's contract.
        let layout = unsafe { device.create_pipeline_layout(&layout_info, None) }.map_err(Error::vulkan("vkCreatePipelineLayout"))?;
        let mut tracer = Tracer {
            device,
            layout,
            variants: Vec::new(),
            shape,
            max_buffer_size: found.max_buffer_size,
            debug_utils: desc.debug_utils.cloned(),
        };
        for &kernel in ALL {
            // SAFETY: the caller's contract.
            unsafe { tracer.create_variants(kernel, desc.pipeline_cache)? };
        }
        Ok(tracer)
    }

    /// # Safety
    /// As for [`Tracer::new`].
    unsafe fn create_variants(&mut self, kernel: &'static Kernel, cache: vk::PipelineCache) -> Result<()> {
        let module_info = vk::ShaderModuleCreateInfo::default().code(kernel.spirv);
        // SAFETY: the SPIR-V is valid (spirv-val runs in the tests) and needs the checked features alone.
        let module = unsafe { self.device.create_shader_module(&module_info, None) }.map_err(Error::vulkan("vkCreateShaderModule"))?;
        let (constants, variants) = launch_constants(kernel);
        let mut result = Ok(());
        for &variant in variants {
            let mut entries = Vec::new();
            let mut data = Vec::<u32>::new();
            let mut add = |id: u32, value: u32| {
                entries.push(vk::SpecializationMapEntry { constant_id: id, offset: 4 * data.len() as u32, size: 4 });
                data.push(value);
            };
            if let Some(id) = kernel.local_size_ids[0] {
                add(id, self.shape.local_size(kernel));
            }
            for &(id, name, default) in kernel.spec_constants {
                let launch = constants.iter().position(|constant| *constant == name).map(|bit| (variant >> bit) & 1);
                add(id, launch.or_else(|| self.shape.constant(name)).unwrap_or(default));
            }
            let specialization = vk::SpecializationInfo::default().map_entries(&entries).data(bytemuck::cast_slice(&data));
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(c"main")
                .specialization_info(&specialization);
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.layout);
            // SAFETY: as above.
            match unsafe { self.device.create_compute_pipelines(cache, &[info], None) } {
                Ok(pipelines) => {
                    let name = CString::new(kernel.name).unwrap_or_default();
                    for pipeline in pipelines {
                        self.variants.push(Variant { kernel, name: name.clone(), variant, pipeline });
                        if let Some(debug) = &self.debug_utils {
                            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(pipeline).object_name(&name);
                            // SAFETY: the pipeline is of the device. A name that cannot be set is not missed.
                            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
                        }
                    }
                }
                Err((_, error)) => {
                    result = Err(Error::vulkan("vkCreateComputePipelines")(error));
                    break;
                }
            }
        }
        // SAFETY: pipelines keep no reference to the module.
        unsafe { self.device.destroy_shader_module(module, None) };
        result
    }

    /// The device that the tracer records for.
    pub fn device(&self) -> &ash::Device {
        &self.device
    }

    /// How kernels are cut into workgroups.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// What the regions of a build need.
    ///
    /// # Errors
    /// [`Error::Capacity`] beyond the library's limits, [`Error::DeviceLimit`] beyond the device's.
    pub fn build_sizes(&self, capacity: &Capacity) -> Result<BuildSizes> {
        sizes::check_capacity(capacity, &self.shape)?;
        let limit = self.max_buffer_size;
        let grid = GridLayout::new(capacity).size;
        let scratch = ScratchLayout::new(capacity, &self.shape).size;
        let none = vk::BufferUsageFlags::empty();
        Ok(BuildSizes {
            grid: sizes::region_size("grid", grid, limit, none)?,
            scratch: sizes::region_size("scratch", scratch, limit, vk::BufferUsageFlags::INDIRECT_BUFFER)?,
            report: sizes::region_size("report", REPORT_SIZE, limit, none)?,
            timestamp_count: self.build_steps(capacity).len() as u32 + 1,
        })
    }

    /// Name and bytes of every part of a build's grid and scratch regions: where the memory goes.
    pub fn memory_parts(&self, capacity: &Capacity) -> Vec<(&'static str, u64)> {
        sizes::parts(capacity, &self.shape).to_vec()
    }

    /// What the scratch region of a trace needs.
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::DeviceLimit`].
    pub fn trace_scratch_size(&self, max_rays: u32) -> Result<RegionSize> {
        check_rays(max_rays, MAX_RAYS)?;
        sizes::region_size("trace scratch", TraceLayout::new(max_rays).size, self.max_buffer_size, vk::BufferUsageFlags::INDIRECT_BUFFER)
    }

    /// What the scratch region of a sort of rays needs.
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::DeviceLimit`].
    pub fn ray_sort_scratch_size(&self, max_rays: u32) -> Result<RegionSize> {
        check_rays(max_rays, self.shape.most_sorted())?;
        let size = RaySortLayout::new(max_rays, &self.shape).size;
        sizes::region_size("ray sort scratch", size, self.max_buffer_size, vk::BufferUsageFlags::INDIRECT_BUFFER)
    }

    /// The steps of a build, in order of its timestamps: step i runs between timestamps i and i + 1. A build of records runs `geometry_scan`
    /// and `gather_records` in place of the first, `gather`. A build without [`BuildInfo::second_level`] has the steps of a capacity without leaf
    /// cells; it writes as many timestamps less.
    pub fn build_steps(&self, capacity: &Capacity) -> Vec<&'static Kernel> {
        let source = Source::Mesh { triangle_count: 0, vertex_count: 0 };
        let inputs = BuildInputs { source, density: 1.0, resolution: None, exact: false, second_level: true };
        plan::build_plan(capacity, &inputs, &self.shape).steps().map(|step| step.kernel).collect()
    }

    /// Records a build of a grid from nothing.
    ///
    /// Put a barrier before it, from whatever wrote the geometry and from earlier uses of the regions to [`Tracer::BUILD`], and one after it,
    /// from [`Tracer::BUILD`] to [`Tracer::TRACE`] (or to [`Access::HOST_READ`] for the report). The command buffer may be submitted again
    /// after the vertices changed. The compute pipeline and the push constants that were bound before are lost.
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::Region`], [`Error::Option`]; then nothing was recorded.
    ///
    /// # Safety
    /// `cmd` is in the recording state, outside of a render pass, of a queue with compute and of the tracer's device. The regions are of that
    /// device, do not overlap, and live until the command buffer has been executed; scratch's buffer has usage `INDIRECT_BUFFER`. With
    /// timestamps: the queue has them, and the pool holds enough queries from the first on.
    pub unsafe fn cmd_build(&self, cmd: vk::CommandBuffer, info: &BuildInfo) -> Result<()> {
        let BuildInfo { input, capacity, options, .. } = info;
        sizes::check_capacity(capacity, &self.shape)?;
        if !(options.density > 0.0 && options.density.is_finite()) {
            return Err(Error::Option { option: "density", value: options.density.to_string(), expected: "a finite number above 0" });
        }
        if options.resolution.is_some_and(|resolution| resolution.contains(&0)) {
            return Err(Error::Option {
                option: "resolution",
                value: format!("{:?}", options.resolution),
                expected: "at least one cell along each axis",
            });
        }
        let source = check_input(input, capacity)?;
        let grid = GridLayout::new(capacity);
        let scratch = ScratchLayout::new(capacity, &self.shape);
        check_region("grid", &info.grid, grid.size, REGION_ALIGNMENT)?;
        check_region("scratch", &info.scratch, scratch.size, REGION_ALIGNMENT)?;
        check_indirect("scratch", &info.scratch)?;
        check_region("report", &info.report, REPORT_SIZE, REGION_ALIGNMENT)?;
        let inputs = BuildInputs {
            source,
            density: options.density,
            resolution: options.resolution,
            exact: options.overlap == Overlap::Exact,
            second_level: info.second_level,
        };
        let plan = plan::build_plan(capacity, &inputs, &self.shape);
        // SAFETY: the caller's contract; the plan stays inside of the regions that were checked above.
        unsafe { self.record(cmd, plan.items(), |buffer| self.build_region(info, buffer), info.timestamps) };
        Ok(())
    }

    /// Where a build keeps what.
    #[doc(hidden)]
    pub fn build_region(&self, info: &BuildInfo, buffer: Buffer) -> Region {
        let grid = GridLayout::new(&info.capacity);
        let scratch = ScratchLayout::new(&info.capacity, &self.shape);
        let in_grid = |part: sizes::Part| info.grid.part(part.offset, part.size);
        let in_scratch = |part: sizes::Part| info.scratch.part(part.offset, part.size);
        let (positions, indices, records) = match info.input {
            Input::Mesh(geometry) => (geometry.positions, geometry.indices, Region::NONE),
            Input::Records(Records { records, .. }) => (Region::NONE, Region::NONE, records),
        };
        match buffer {
            Buffer::Positions => positions,
            Buffer::Indices => indices,
            Buffer::Records => records,
            Buffer::Report => info.report,
            Buffer::Header => in_grid(grid.header),
            Buffer::Cells => in_grid(grid.cells),
            Buffer::References => in_grid(grid.references),
            Buffer::Triangles => in_grid(grid.triangles),
            Buffer::Bricks => in_grid(grid.bricks),
            Buffer::State => in_scratch(scratch.state),
            Buffer::Arguments => in_scratch(scratch.arguments),
            Buffer::BoundsPartials => in_scratch(scratch.bounds_partials),
            Buffer::Offsets => in_scratch(scratch.offsets),
            Buffer::CellBoxes => in_scratch(scratch.cell_boxes),
            Buffer::ScanPartials => in_scratch(scratch.scan_partials),
            Buffer::KeysA => in_scratch(scratch.keys_a),
            Buffer::KeysB => in_scratch(scratch.keys_b),
            Buffer::ValuesA => in_scratch(scratch.values_a),
            Buffer::Table => in_scratch(scratch.table),
            Buffer::Occupancy => in_scratch(scratch.occupancy),
            Buffer::DistancesX => in_scratch(scratch.distances_x),
            Buffer::DistancesY => in_scratch(scratch.distances_y),
            Buffer::LeafState => in_scratch(scratch.leaf_state),
            Buffer::LeafArguments => in_scratch(scratch.leaf_arguments),
            Buffer::SplitCells => in_scratch(scratch.split_cells),
            Buffer::Rays
            | Buffer::Hits
            | Buffer::RayCount
            | Buffer::TraceState
            | Buffer::Walks
            | Buffer::Counters
            | Buffer::Masks
            | Buffer::Geometries
            | Buffer::Order => Region::NONE,
        }
    }

    /// Records items of a build's plan: for tests that look at what one step did.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_build`], and the items are of a plan for `info`.
    #[doc(hidden)]
    pub unsafe fn cmd_build_items(&self, cmd: vk::CommandBuffer, info: &BuildInfo, items: &[Item]) {
        // SAFETY: the caller's contract.
        unsafe { self.record(cmd, items, |buffer| self.build_region(info, buffer), None) };
    }

    /// Records one launch of a kernel with push constants as they are: for tests of single kernels.
    ///
    /// # Safety
    /// The addresses in `push` are those of memory that the kernel may access; otherwise as for [`Tracer::cmd_build`].
    #[doc(hidden)]
    pub unsafe fn cmd_kernel(&self, cmd: vk::CommandBuffer, kernel: &'static Kernel, variant: u32, push: &[u8], groups: [u32; 3]) {
        let Some(Variant { pipeline, .. }) = self.variant(kernel, variant) else { return };
        // SAFETY: the caller's contract.
        unsafe {
            self.device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, *pipeline);
            self.device.cmd_push_constants(cmd, self.layout, vk::ShaderStageFlags::COMPUTE, 0, push);
            self.device.cmd_dispatch(cmd, groups[0], groups[1], groups[2]);
        }
    }

    fn variant(&self, kernel: &'static Kernel, variant: u32) -> Option<&Variant> {
        let found = self.variants.iter().find(|candidate| std::ptr::eq(candidate.kernel, kernel) && candidate.variant == variant);
        debug_assert!(found.is_some(), "no pipeline of {} {variant}", kernel.name);
        found
    }

    /// Records a search for the closest hit of each ray, in the grid at `grid`, the address of the region it was built in.
    ///
    /// Put a barrier before it, from whatever wrote the rays and from [`Tracer::BUILD`] to [`Tracer::TRACE`], and one after it, from
    /// [`Tracer::TRACE`] to whatever reads the hits. The bound compute pipeline and push constants are lost.
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::Region`]; then nothing was recorded.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_build`]; and `grid` holds a grid when the commands are executed, while no build writes it.
    pub unsafe fn cmd_closest_hit(&self, cmd: vk::CommandBuffer, grid: vk::DeviceAddress, info: &TraceInfo) -> Result<()> {
        let query = Query::Closest { resume: info.resume, count: info.counters.is_some() };
        // SAFETY: the caller's contract.
        unsafe { self.trace(cmd, grid, info, query, 16) }
    }

    /// Records a search for whether each ray hits anything. Barriers as for [`Tracer::cmd_closest_hit`].
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::Region`], [`Error::Option`]; then nothing was recorded.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`].
    pub unsafe fn cmd_any_hit(&self, cmd: vk::CommandBuffer, grid: vk::DeviceAddress, info: &TraceInfo) -> Result<()> {
        if info.resume || info.counters.is_some() {
            return Err(Error::Option { option: "resume, counters", value: "set".into(), expected: "closest hit alone has them" });
        }
        // SAFETY: the caller's contract.
        unsafe { self.trace(cmd, grid, info, Query::Any, 4) }
    }

    /// Records a count of the triangles that each ray hits in its interval, as a `u32` a ray, or [`gridwalk_core::UNFINISHED`]. Barriers as
    /// for [`Tracer::cmd_closest_hit`].
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::Region`], [`Error::Option`]; then nothing was recorded.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`].
    pub unsafe fn cmd_count_hits(&self, cmd: vk::CommandBuffer, grid: vk::DeviceAddress, info: &TraceInfo) -> Result<()> {
        if info.resume || info.counters.is_some() || info.geometries.is_some() {
            return Err(Error::Option {
                option: "resume, counters, geometries",
                value: "set".into(),
                expected: "counts of hits have none",
            });
        }
        // SAFETY: the caller's contract.
        unsafe { self.trace(cmd, grid, info, Query::Count, 4) }
    }

    /// Records a search for the `nearest` nearest hits of each ray, at most [`MAX_NEAREST`]: as many [`gridwalk_core::Hit`]s a ray one after
    /// another, in order of distance and of equal ones in order of triangle, then misses. With [`TraceInfo::resume`] those beyond the last
    /// hit that lies there: so all hits of a ray can be had in portions. Where a walk was given up, the rest is
    /// [`gridwalk_core::UNFINISHED`]. Barriers as for [`Tracer::cmd_closest_hit`].
    ///
    /// # Errors
    /// [`Error::Capacity`], also for more hits in all than a trace has rays; [`Error::Region`], [`Error::Option`]; then nothing was recorded.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`]; and with `resume`, the hits are of this grid and of these rays.
    pub unsafe fn cmd_nearest_hits(&self, cmd: vk::CommandBuffer, grid: vk::DeviceAddress, info: &TraceInfo, nearest: u32) -> Result<()> {
        if !(1..=MAX_NEAREST).contains(&nearest) {
            return Err(Error::Option { option: "nearest", value: nearest.to_string(), expected: "from 1 to 64 hits a ray" });
        }
        if info.counters.is_some() {
            return Err(Error::Option { option: "counters", value: "set".into(), expected: "closest hit alone has them" });
        }
        let hits = u64::from(info.count.max()) * u64::from(nearest);
        if hits > MAX_RAYS.into() {
            return Err(Error::Capacity { what: "hits", given: hits, limit: MAX_RAYS.into() });
        }
        // SAFETY: the caller's contract.
        unsafe { self.trace(cmd, grid, info, Query::Nearest { nearest, resume: info.resume }, 16 * u64::from(nearest)) }
    }

    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`].
    unsafe fn trace(&self, cmd: vk::CommandBuffer, grid: vk::DeviceAddress, info: &TraceInfo, query: Query, hit_size: u64) -> Result<()> {
        let region = self.trace_regions(grid, info, hit_size)?;
        let plan = plan::trace_plan(query, extras(info), &ray_inputs(&info.count, info.order.is_some()));
        // SAFETY: the caller's contract; the plan stays inside of the regions that were checked.
        unsafe { self.record(cmd, plan.items(), region, None) };
        Ok(())
    }

    fn trace_regions(&self, grid: vk::DeviceAddress, info: &TraceInfo, hit_size: u64) -> Result<impl Fn(Buffer) -> Region + use<>> {
        let max = info.count.max();
        check_rays(max, MAX_RAYS)?;
        let layout = TraceLayout::new(max);
        check_address("grid", grid, REGION_ALIGNMENT)?;
        check_region("rays", &info.rays, u64::from(max) * 32, 16)?;
        check_region("hits", &info.hits, u64::from(max) * hit_size, hit_size.min(16))?;
        check_region("trace scratch", &info.scratch, layout.size, REGION_ALIGNMENT)?;
        check_indirect("trace scratch", &info.scratch)?;
        let count = check_count(&info.count)?;
        let counters = info.counters.unwrap_or(Region::NONE);
        if info.counters.is_some() {
            check_region("counters", &counters, u64::from(max) * 16, 16)?;
        }
        let masks = info.masks.unwrap_or(Region::NONE);
        if info.masks.is_some() {
            check_region("masks", &masks, u64::from(max) * 4, 4)?;
        }
        let geometries = info.geometries.unwrap_or(Region::NONE);
        if info.geometries.is_some() {
            // Of each hit of a ray.
            check_region("geometries", &geometries, u64::from(max) * 8 * (hit_size / 16).max(1), 8)?;
        }
        let order = info.order.unwrap_or(Region::NONE);
        if info.order.is_some() {
            check_region("order", &order, u64::from(max) * 4, 4)?;
        }
        let (rays, hits, scratch) = (info.rays, info.hits, info.scratch);
        let header = Region { address: grid, ..Region::NONE };
        Ok(move |buffer| match buffer {
            Buffer::Header => header,
            Buffer::Rays => rays,
            Buffer::Hits => hits,
            Buffer::RayCount => count,
            Buffer::Counters => counters,
            Buffer::Masks => masks,
            Buffer::Geometries => geometries,
            Buffer::Order => order,
            Buffer::TraceState => scratch.part(layout.state.offset, layout.state.size),
            Buffer::Walks => scratch.part(layout.walks.offset, layout.walks.size),
            _ => Region::NONE,
        })
    }

    /// Records a sort of rays: the order in which rays whose walks begin in the same part of the grid and in the same direction follow one
    /// another, for [`TraceInfo::order`]. It is the same for the same rays and grid. It pays for many rays, of which neighbours walk through
    /// different cells; the further they are apart in the order that is given, and the larger the scene, the more.
    ///
    /// Put a barrier before it, as for [`Tracer::cmd_closest_hit`], and one after it, from [`Tracer::TRACE`] to [`Tracer::TRACE`]. The bound
    /// compute pipeline and push constants are lost.
    ///
    /// # Errors
    /// [`Error::Capacity`], [`Error::Region`]; then nothing was recorded.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`].
    pub unsafe fn cmd_sort_rays(&self, cmd: vk::CommandBuffer, grid: vk::DeviceAddress, info: &RaySortInfo) -> Result<()> {
        let region = self.ray_sort_regions(grid, info)?;
        let plan = plan::ray_sort_plan(&ray_inputs(&info.count, false), &self.shape);
        // SAFETY: the caller's contract; the plan stays inside of the regions that were checked.
        unsafe { self.record(cmd, plan.items(), region, None) };
        Ok(())
    }

    fn ray_sort_regions(&self, grid: vk::DeviceAddress, info: &RaySortInfo) -> Result<impl Fn(Buffer) -> Region + use<>> {
        let max = info.count.max();
        check_rays(max, self.shape.most_sorted())?;
        let layout = RaySortLayout::new(max, &self.shape);
        check_address("grid", grid, REGION_ALIGNMENT)?;
        check_region("rays", &info.rays, u64::from(max) * 32, 16)?;
        check_region("order", &info.order, u64::from(max) * 4, 4)?;
        check_region("ray sort scratch", &info.scratch, layout.size, REGION_ALIGNMENT)?;
        check_indirect("ray sort scratch", &info.scratch)?;
        let count = check_count(&info.count)?;
        let (rays, order, scratch) = (info.rays, info.order, info.scratch);
        let header = Region { address: grid, ..Region::NONE };
        let in_scratch = move |part: sizes::Part| scratch.part(part.offset, part.size);
        Ok(move |buffer| match buffer {
            Buffer::Header => header,
            Buffer::Rays => rays,
            Buffer::RayCount => count,
            Buffer::Order => order,
            Buffer::State => in_scratch(layout.state),
            Buffer::Arguments => in_scratch(layout.arguments),
            Buffer::KeysA => in_scratch(layout.keys_a),
            Buffer::KeysB => in_scratch(layout.keys_b),
            Buffer::ValuesA => in_scratch(layout.values_a),
            Buffer::Table => in_scratch(layout.table),
            Buffer::ScanPartials => in_scratch(layout.scan_partials),
            _ => Region::NONE,
        })
    }

    /// Records the closest hits by testing every ray with every triangle of the grid: the oracle that the walk is compared with. Slow.
    ///
    /// # Errors
    /// As for [`Tracer::cmd_closest_hit`]; the number of rays must be direct.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`]; the grid holds `triangle_count` triangles.
    #[doc(hidden)]
    pub unsafe fn cmd_brute_force(
        &self,
        cmd: vk::CommandBuffer,
        grid: vk::DeviceAddress,
        triangle_count: u32,
        info: &TraceInfo,
    ) -> Result<()> {
        let region = self.trace_regions(grid, info, 16)?;
        let mut first = 0;
        loop {
            let step = plan::brute_force_step(info.count.max(), triangle_count, first, &self.shape);
            // SAFETY: the caller's contract.
            unsafe {
                self.record_step(cmd, &step, &region);
                cmd_barrier(&self.device, cmd, SHADER, SHADER);
            }
            first += plan::BRUTE_FORCE_TRIANGLES;
            if first >= triangle_count {
                return Ok(());
            }
        }
    }

    /// Records the closest hits by a shader that uses the public include.
    ///
    /// # Errors
    /// As for [`Tracer::cmd_closest_hit`]; the number of rays must be direct.
    ///
    /// # Safety
    /// As for [`Tracer::cmd_closest_hit`].
    #[doc(hidden)]
    pub unsafe fn cmd_closest_candidate(&self, cmd: vk::CommandBuffer, grid: vk::DeviceAddress, info: &TraceInfo) -> Result<()> {
        let region = self.trace_regions(grid, info, 16)?;
        let step = plan::candidate_step(info.count.max(), extras(info), &self.shape);
        // SAFETY: the caller's contract.
        unsafe { self.record_step(cmd, &step, &region) };
        Ok(())
    }

    /// # Safety
    /// The regions hold what the plan's kernels access; otherwise as for [`Tracer::cmd_build`].
    unsafe fn record(&self, cmd: vk::CommandBuffer, items: &[Item], region: impl Fn(Buffer) -> Region, timestamps: Option<Timestamps>) {
        let mut query = timestamps.map(|timestamps| timestamps.first_query);
        let mut stamp = || {
            if let (Some(timestamps), Some(next)) = (timestamps, query.as_mut()) {
                // SAFETY: the pool holds a query for every step and one more.
                unsafe { self.device.cmd_write_timestamp2(cmd, vk::PipelineStageFlags2::ALL_COMMANDS, timestamps.pool, *next) };
                *next += 1;
            }
        };
        if let Some(timestamps) = timestamps {
            let count = items.iter().filter(|item| is_stamped(item)).count() as u32 + 1;
            // SAFETY: as above.
            unsafe { self.device.cmd_reset_query_pool(cmd, timestamps.pool, timestamps.first_query, count) };
        }
        stamp();
        for item in items {
            match item {
                Item::Step(step) => {
                    // SAFETY: the caller's contract.
                    unsafe { self.record_step(cmd, step, &region) };
                    if is_stamped(item) {
                        stamp();
                    }
                }
                Item::Barrier(barrier) => {
                    let after = match barrier {
                        plan::Barrier::Shader => SHADER,
                        plan::Barrier::ShaderAndIndirect => Access::COMPUTE,
                    };
                    // SAFETY: the caller's contract.
                    unsafe { cmd_barrier(&self.device, cmd, Access::COMPUTE, after) };
                }
            }
        }
    }

    /// # Safety
    /// As for [`Tracer::record`].
    unsafe fn record_step(&self, cmd: vk::CommandBuffer, step: &Step, region: impl Fn(Buffer) -> Region) {
        let Some(variant) = self.variant(step.kernel, step.variant) else { return };
        let push = step.resolve(|buffer| region(buffer).address);
        // SAFETY: the pipeline lives as long as the tracer; the addresses are those of regions that were checked.
        unsafe {
            if let Some(debug) = &self.debug_utils {
                debug.cmd_begin_debug_utils_label(cmd, &vk::DebugUtilsLabelEXT::default().label_name(&variant.name));
            }
            self.device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, variant.pipeline);
            self.device.cmd_push_constants(cmd, self.layout, vk::ShaderStageFlags::COMPUTE, 0, &push);
            match step.dispatch {
                Dispatch::Direct([x, y, z]) => self.device.cmd_dispatch(cmd, x, y, z),
                Dispatch::Indirect(buffer, offset) => {
                    let arguments = region(buffer);
                    self.device.cmd_dispatch_indirect(cmd, arguments.buffer, arguments.offset + offset);
                }
            }
            if let Some(debug) = &self.debug_utils {
                debug.cmd_end_debug_utils_label(cmd);
            }
        }
    }
}

impl Drop for Tracer {
    fn drop(&mut self) {
        // SAFETY: nothing that was recorded is still running, by the contract of `new`.
        unsafe {
            for variant in &self.variants {
                self.device.destroy_pipeline(variant.pipeline, None);
            }
            self.device.destroy_pipeline_layout(self.layout, None);
        }
    }
}

fn extras(info: &TraceInfo) -> Extras {
    let cull = match info.cull {
        Cull::None => 0,
        Cull::Back => walk::CULL_BACK,
        Cull::Front => walk::CULL_FRONT,
    };
    let masks = if info.masks.is_some() { plan::OPTION_MASKS } else { 0 };
    let geometries = if info.geometries.is_some() { plan::OPTION_GEOMETRIES } else { 0 };
    Extras { mask: info.mask, options: cull | masks | geometries }
}

/// What the plan needs to know of the input, if it fits.
fn check_input(input: &Input, capacity: &Capacity) -> Result<Source> {
    let at_most = |what, given: u32, limit: u32| match given > limit {
        true => Err(Error::Capacity { what, given: given.into(), limit: limit.into() }),
        false => Ok(()),
    };
    match *input {
        Input::Mesh(Geometry { positions, vertex_count, indices, triangle_count }) => {
            at_most("triangles", triangle_count, capacity.triangles)?;
            at_most("vertices", vertex_count, MAX_VERTICES)?;
            check_region("positions", &positions, u64::from(vertex_count) * 12, 4)?;
            check_region("indices", &indices, u64::from(triangle_count) * 12, 4)?;
            Ok(Source::Mesh { triangle_count, vertex_count })
        }
        Input::Records(Records { records, count }) => {
            at_most("geometries", count, capacity.triangles.min(MAX_GEOMETRIES))?;
            check_region("records", &records, u64::from(count) * size_of::<GeometryRecord>() as u64, 16)?;
            Ok(Source::Records { record_count: count })
        }
    }
}

/// Whether a timestamp is written behind an item: so that all builds have the same timestamps, finding the first triangles of geometries
/// counts with gathering the triangles.
fn is_stamped(item: &Item) -> bool {
    matches!(item, Item::Step(step) if !std::ptr::eq(step.kernel, &GEOMETRY_SCAN))
}

fn ray_inputs(count: &RayCount, ordered: bool) -> RayInputs {
    RayInputs { max: count.max(), indirect: matches!(count, RayCount::Indirect { .. }), ordered }
}

fn check_rays(max: u32, limit: u32) -> Result<()> {
    let limit = limit.min(MAX_RAYS);
    match max > limit {
        true => Err(Error::Capacity { what: "rays", given: max.into(), limit: limit.into() }),
        false => Ok(()),
    }
}

/// Where the number of rays lies, if it is in memory.
fn check_count(count: &RayCount) -> Result<Region> {
    match *count {
        RayCount::Direct(_) => Ok(Region::NONE),
        RayCount::Indirect { count, .. } => {
            check_region("ray count", &count, 4, 4)?;
            Ok(count)
        }
    }
}

fn check_region(name: &'static str, region: &Region, size: u64, alignment: u64) -> Result<()> {
    if region.size < size {
        return Err(Error::Region { region: name, reason: format!("{} bytes where {size} are needed", region.size) });
    }
    if region.offset.checked_add(region.size).is_none() || region.address.checked_add(region.size).is_none() {
        let Region { offset, size, address, .. } = region;
        let reason = format!("{size} bytes from offset {offset} and address {address:#x} on reach beyond 2^64");
        return Err(Error::Region { region: name, reason });
    }
    if size > 0 { check_address(name, region.address, alignment) } else { Ok(()) }
}

/// Indirect dispatches name their arguments by buffer and offset, everything else by address.
fn check_indirect(name: &'static str, region: &Region) -> Result<()> {
    if region.buffer == vk::Buffer::null() || !region.offset.is_multiple_of(4) {
        return Err(Error::Region {
            region: name,
            reason: format!("no buffer, or an offset of {} that is not a multiple of 4", region.offset),
        });
    }
    Ok(())
}

fn check_address(name: &'static str, address: vk::DeviceAddress, alignment: u64) -> Result<()> {
    if address == 0 || !address.is_multiple_of(alignment) {
        return Err(Error::Region { region: name, reason: format!("address {address:#x} is 0 or not a multiple of {alignment}") });
    }
    Ok(())
}
