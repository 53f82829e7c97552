//! The driver's own acceleration structure as a rival, asked by ray queries in a compute kernel: `VK_KHR_acceleration_structure` and
//! `VK_KHR_ray_query`, on the device, the triangles and the clock that gridwalk has.

use std::rc::Rc;
use std::sync::Arc;

use anyhow::{Context as _, Result};
use bytemuck::Zeroable;
use gridwalk::ash::khr::acceleration_structure;
use gridwalk::ash::vk;
use gridwalk::{Geometry, Hit};
use gridwalk_render::{Buffer, BufferDesc, BufferKind, Context};

use crate::contender::{Answers, Contender, Query, Set, Tree};
use crate::kernels::RAY_QUERY;
use crate::pipeline::Pipeline;
use crate::push::RayQuery;
use crate::stopwatch::Stopwatch;

/// As the report has it.
pub const NAME: &str = "driver";

/// Milliseconds that a CPU's rays of one set may take a run: its ray queries are a thousand times slower than a GPU's, so that it answers some
/// of the rays only.
const CPU_BUDGET_MS: f64 = 250.0;

/// Rays by which the speed of a CPU's ray queries is told.
const PROBES: usize = 256;

/// The extension's functions and the kernel, on one device.
pub struct Driver {
    context: Context,
    functions: acceleration_structure::Device,
    /// For closest and for any hits.
    pipelines: [Pipeline; 2],
    stopwatch: Stopwatch,
    scratch_alignment: u64,
}

impl Driver {
    /// `None` on a device without ray queries, or if they were not asked for.
    ///
    /// # Errors
    /// What the device reports.
    pub fn open(context: &Context) -> Result<Option<Driver>> {
        if !context.has_ray_query() {
            return Ok(None);
        }
        let mut limits = vk::PhysicalDeviceAccelerationStructurePropertiesKHR::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut limits);
        // SAFETY: the physical device is of this instance, and has the extension, so that it knows the struct.
        unsafe { context.instance().get_physical_device_properties2(context.physical_device(), &mut properties) };
        Ok(Some(Driver {
            context: context.clone(),
            functions: acceleration_structure::Device::new(context.instance(), context.device()),
            pipelines: [Pipeline::new(context, &RAY_QUERY, &[0])?, Pipeline::new(context, &RAY_QUERY, &[1])?],
            stopwatch: Stopwatch::new(context)?,
            scratch_alignment: u64::from(limits.min_acceleration_structure_scratch_offset_alignment).max(1),
        }))
    }
}

/// An acceleration structure with its memory and that of its build.
struct Structure {
    driver: Rc<Driver>,
    raw: vk::AccelerationStructureKHR,
    memory: Buffer,
    scratch: Buffer,
    address: vk::DeviceAddress,
    kind: vk::AccelerationStructureTypeKHR,
    flags: vk::BuildAccelerationStructureFlagsKHR,
    /// Triangles or instances.
    count: u32,
}

impl Structure {
    /// Room for one that is built from `geometry`.
    fn new(
        driver: &Rc<Driver>,
        kind: vk::AccelerationStructureTypeKHR,
        flags: vk::BuildAccelerationStructureFlagsKHR,
        geometry: vk::AccelerationStructureGeometryKHR<'_>,
        count: u32,
    ) -> Result<Structure> {
        let geometries = [geometry];
        let info = build_info(kind, flags, &geometries);
        let mut sizes = vk::AccelerationStructureBuildSizesInfoKHR::default();
        // SAFETY: one geometry, and a number of primitives for it; addresses are not looked at.
        unsafe {
            let on = vk::AccelerationStructureBuildTypeKHR::DEVICE;
            driver.functions.get_acceleration_structure_build_sizes(on, &info, &[count], &mut sizes);
        }
        let buffer = |name, size| driver.context.buffer(&BufferDesc { name, size, kind: BufferKind::Device, dedicated: true });
        let memory = buffer("acceleration structure", sizes.acceleration_structure_size)?;
        let scratch = buffer("acceleration structure scratch", sizes.build_scratch_size + driver.scratch_alignment)?;
        let create =
            vk::AccelerationStructureCreateInfoKHR::default().buffer(memory.raw()).size(sizes.acceleration_structure_size).ty(kind);
        // SAFETY: the buffer is made for structures, as the context has ray queries, and as large as the structure; both live together.
        let raw = unsafe { driver.functions.create_acceleration_structure(&create, None) }?;
        let of = vk::AccelerationStructureDeviceAddressInfoKHR::default().acceleration_structure(raw);
        // SAFETY: the structure was just made on this device.
        let address = unsafe { driver.functions.get_acceleration_structure_device_address(&of) };
        Ok(Structure { driver: Rc::clone(driver), raw, memory, scratch, address, kind, flags, count })
    }

    /// Records a build from nothing, and a barrier behind it.
    ///
    /// # Safety
    /// The command buffer is recording on the structure's device; the addresses of the geometry are those of living buffers that hold what it
    /// says, as many primitives as the structure has room for, and indices below the greatest vertex.
    unsafe fn record(&self, cmd: vk::CommandBuffer, geometry: vk::AccelerationStructureGeometryKHR<'_>) {
        let geometries = [geometry];
        let address = self.scratch.address().next_multiple_of(self.driver.scratch_alignment);
        let info = build_info(self.kind, self.flags, &geometries)
            .dst_acceleration_structure(self.raw)
            .scratch_data(vk::DeviceOrHostAddressKHR { device_address: address });
        let ranges = [vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(self.count)];
        let barrier = vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ACCELERATION_STRUCTURE_BUILD_KHR)
            .src_access_mask(vk::AccessFlags2::ACCELERATION_STRUCTURE_WRITE_KHR)
            .dst_stage_mask(vk::PipelineStageFlags2::ACCELERATION_STRUCTURE_BUILD_KHR | vk::PipelineStageFlags2::COMPUTE_SHADER)
            .dst_access_mask(vk::AccessFlags2::ACCELERATION_STRUCTURE_READ_KHR);
        // SAFETY: the caller's word; structure and scratch are as large as the device asked for, and the scratch's address is aligned as it
        // asked for; no other submission is under way.
        unsafe {
            self.driver.functions.cmd_build_acceleration_structures(cmd, &[info], &[&ranges]);
            let device = self.driver.context.device();
            device.cmd_pipeline_barrier2(cmd, &vk::DependencyInfo::default().memory_barriers(&[barrier]));
        }
    }

    fn bytes(&self) -> u64 {
        self.memory.size() + self.scratch.size()
    }
}

impl Drop for Structure {
    fn drop(&mut self) {
        // SAFETY: every submission was waited for.
        unsafe { self.driver.functions.destroy_acceleration_structure(self.raw, None) };
    }
}

fn build_info<'a>(
    kind: vk::AccelerationStructureTypeKHR,
    flags: vk::BuildAccelerationStructureFlagsKHR,
    geometries: &'a [vk::AccelerationStructureGeometryKHR<'a>; 1],
) -> vk::AccelerationStructureBuildGeometryInfoKHR<'a> {
    vk::AccelerationStructureBuildGeometryInfoKHR::default()
        .ty(kind)
        .flags(flags)
        .mode(vk::BuildAccelerationStructureModeKHR::BUILD)
        .geometries(geometries)
}

/// The triangles' structure, and the one of a single instance of it, through which rays must go.
struct Pair {
    triangles: Structure,
    instances: Structure,
    instance: Buffer,
}

/// The driver as one of the contenders.
pub struct DriverRival {
    driver: Rc<Driver>,
    geometry: Geometry,
    pair: Option<Pair>,
    batches: Vec<Batch>,
}

struct Batch {
    query: Query,
    rays: Buffer,
    hits: Buffer,
    count: usize,
    /// One run of so many is traced; 0 before the speed is known.
    step: usize,
}

impl DriverRival {
    /// The driver with triangles in device memory, which must outlive the rival's builds.
    pub fn new(driver: &Rc<Driver>, geometry: Geometry) -> DriverRival {
        DriverRival { driver: Rc::clone(driver), geometry, pair: None, batches: Vec::new() }
    }

    fn triangles(&self) -> vk::AccelerationStructureGeometryKHR<'static> {
        let Geometry { positions, vertex_count, indices, .. } = self.geometry;
        let data = vk::AccelerationStructureGeometryTrianglesDataKHR::default()
            .vertex_format(vk::Format::R32G32B32_SFLOAT)
            .vertex_data(vk::DeviceOrHostAddressConstKHR { device_address: positions.address })
            .vertex_stride(12)
            .max_vertex(vertex_count.saturating_sub(1))
            .index_type(vk::IndexType::UINT32)
            .index_data(vk::DeviceOrHostAddressConstKHR { device_address: indices.address });
        vk::AccelerationStructureGeometryKHR::default()
            .geometry_type(vk::GeometryTypeKHR::TRIANGLES)
            .flags(vk::GeometryFlagsKHR::OPAQUE)
            .geometry(vk::AccelerationStructureGeometryDataKHR { triangles: data })
    }

    fn instances(address: vk::DeviceAddress) -> vk::AccelerationStructureGeometryKHR<'static> {
        let data =
            vk::AccelerationStructureGeometryInstancesDataKHR::default().data(vk::DeviceOrHostAddressConstKHR { device_address: address });
        vk::AccelerationStructureGeometryKHR::default()
            .geometry_type(vk::GeometryTypeKHR::INSTANCES)
            .geometry(vk::AccelerationStructureGeometryDataKHR { instances: data })
    }

    fn build(&self) -> Result<f64> {
        let Pair { triangles, instances, instance } = self.pair.as_ref().context("no structure was prepared")?;
        self.driver.stopwatch.time("acceleration structure", |cmd| {
            // SAFETY: the command buffer is recording; the scene's buffers hold its triangles, whose indices are below the number of vertices
            // (the readers of scenes check it), and the instance's buffer one instance, of the structure that was built before.
            unsafe {
                triangles.record(cmd, self.triangles());
                instances.record(cmd, DriverRival::instances(instance.address()));
            }
        })
    }

    /// Traces one run of `step`; returns the milliseconds.
    fn run(&self, batch: &Batch, step: usize) -> Result<f64> {
        let structure = self.pair.as_ref().context("no structure was prepared")?.instances.address;
        let pipeline = &self.driver.pipelines[usize::from(batch.query == Query::Any)];
        let answers = u32::try_from(Answers::count(batch.count, step)).context("too many rays")?;
        let stride = u32::try_from(step).context("too many rays")?;
        let most = self.driver.context.rays_per_submission();
        let mut ms = 0.0;
        for first in (0..answers).step_by(most as usize) {
            let count = (answers - first).min(most);
            let (rays, hits) = (batch.rays.address(), batch.hits.address());
            let push = RayQuery { structure, rays, hits, first, count, stride, ..RayQuery::zeroed() };
            ms += self.driver.stopwatch.time("ray query", |cmd| {
                // SAFETY: the command buffer is recording; the buffers hold as many rays, and have room for as many answers; the structure was
                // built by a submission that was waited for.
                unsafe { pipeline.record(cmd, &push, count) }
            })?;
        }
        Ok(ms)
    }
}

impl Contender for DriverRival {
    fn name(&self) -> &'static str {
        NAME
    }

    fn prepare(&mut self, tree: Tree) -> Result<()> {
        self.pair = None;
        let flags = match tree {
            Tree::Fast => vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_BUILD,
            Tree::Best => vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE,
        };
        let (bottom, top) = (vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL, vk::AccelerationStructureTypeKHR::TOP_LEVEL);
        let triangles = Structure::new(&self.driver, bottom, flags, self.triangles(), self.geometry.triangle_count)?;
        // `VkAccelerationStructureInstanceKHR`: three rows of the identity, index 0 with mask 0xFF, no offset and no flag, and the structure.
        let one = 1.0_f32.to_bits();
        let rows = [one, 0, 0, 0, 0, one, 0, 0, 0, 0, one, 0];
        let mut words = [0_u32; 16];
        words[..12].copy_from_slice(&rows);
        words[12] = 0xFF << 24;
        words[14] = triangles.address as u32;
        words[15] = (triangles.address >> 32) as u32;
        let instance = self.driver.context.upload("instance", &words)?;
        let instances = Structure::new(&self.driver, top, flags, DriverRival::instances(instance.address()), 1)?;
        self.pair = Some(Pair { triangles, instances, instance });
        self.build().map(drop)
    }

    fn rebuild(&mut self) -> Result<f64> {
        self.build()
    }

    fn load(&mut self, sets: &[Arc<Set>]) -> Result<()> {
        self.batches.clear();
        let context = &self.driver.context;
        for set in sets {
            let count = set.rays.len();
            let size = (count * size_of::<Hit>()) as u64;
            let hits = context.buffer(&BufferDesc { name: "hits", size, kind: BufferKind::Device, dedicated: false })?;
            let step = usize::from(!context.is_cpu());
            self.batches.push(Batch { query: set.query, rays: context.upload("rays", &set.rays)?, hits, count, step });
        }
        Ok(())
    }

    fn trace(&mut self, set: usize) -> Result<f64> {
        let Some(batch) = self.batches.get(set) else { return Ok(0.0) };
        let mut step = batch.step;
        if step == 0 {
            // Of all of them, lest one part is easier than the rest.
            let probes = batch.count.div_ceil(PROBES).max(1);
            let all_ms = self.run(batch, probes)? * batch.count as f64 / Answers::count(batch.count, probes).max(1) as f64;
            step = ((all_ms / CPU_BUDGET_MS).ceil() as usize).clamp(1, probes);
        }
        let ms = self.run(batch, step)? * batch.count as f64 / Answers::count(batch.count, step).max(1) as f64;
        if let Some(batch) = self.batches.get_mut(set) {
            batch.step = step;
        }
        Ok(ms)
    }

    fn answers(&mut self, set: usize) -> Result<Answers> {
        let Some(batch) = self.batches.get(set) else { return Ok(Answers { hits: Vec::new(), step: 1 }) };
        let step = batch.step.max(1);
        Ok(Answers { hits: batch.hits.read(0, Answers::count(batch.count, step))?, step })
    }

    fn bytes(&self) -> Option<u64> {
        self.pair.as_ref().map(|pair| pair.triangles.bytes() + pair.instances.bytes())
    }

    fn is_sampled(&self) -> bool {
        self.batches.iter().any(|batch| batch.step > 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gridwalk::Ray;
    use gridwalk_render::{ContextDesc, GpuScene};
    use gridwalk_scene::Mesh;

    #[test]
    fn one_triangle() {
        let desc = ContextDesc { ray_query: true, validation: true, ..ContextDesc::default() };
        let context = match Context::new(&desc) {
            Err(gridwalk_render::Error::NoValidationLayer) => Context::new(&ContextDesc { validation: false, ..desc }),
            context => context,
        };
        let context = context.unwrap();
        let Some(driver) = Driver::open(&context).unwrap() else {
            eprintln!("this device has no ray queries: not tested");
            return;
        };
        let positions = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
        let vertices = positions.len();
        let mesh = Mesh {
            positions,
            normals: vec![[0.0, 0.0, 1.0]; vertices],
            uvs: vec![[0.0; 2]; vertices],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = GpuScene::upload(&context, &gridwalk_scene::scene_of_mesh(mesh)).unwrap();
        let mut rival = DriverRival::new(&Rc::new(driver), scene.geometry());
        let ray = |x: f32| Ray { origin: [x, 0.25, 0.0], t_min: 0.0, direction: [0.0, 0.0, 1.0], t_max: f32::INFINITY };
        let rays: Vec<Ray> = [0.5, 2.0].map(ray).repeat(100);
        let sets = [Query::Closest, Query::Any].map(|query| Arc::new(Set { kind: "test", query, rays: rays.clone(), sorts: false }));
        rival.load(&sets).unwrap();
        let hit = Hit { t: 1.0, u: 0.5, v: 0.25, triangle: 0 };
        for tree in [Tree::Fast, Tree::Best] {
            rival.prepare(tree).unwrap();
            assert!(rival.rebuild().unwrap() > 0.0 && rival.bytes().unwrap() > 0);
            for (set, hit) in [(0, hit), (1, Hit { t: 0.0, u: 0.0, v: 0.0, triangle: 0 })] {
                for (step, count) in [(1, 200), (2, 128), (3, 72), (5, 64)] {
                    let expected = [hit, Hit::MISS].repeat(count / 2);
                    rival.batches[set].step = step;
                    assert!(rival.trace(set).unwrap() > 0.0);
                    assert_eq!(rival.answers(set).unwrap(), Answers { hits: expected, step });
                    assert_eq!(rival.is_sampled(), step > 1);
                }
                rival.batches[set].step = 1;
            }
        }
        // As it is, with the speed of a CPU told first.
        rival.load(&sets).unwrap();
        rival.trace(0).unwrap();
        assert_eq!(rival.answers(0).unwrap(), Answers { hits: [hit, Hit::MISS].repeat(100), step: 1 });
        assert_eq!(context.take_validation_messages(), [""; 0]);
    }
}
