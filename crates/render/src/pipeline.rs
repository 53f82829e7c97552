//! Kernels made ready for the device, and the recording of their launches with labels and timestamps.

use crate::{Context, Error, Result, queries::Queries};
use ash::vk;
use bytemuck::Pod;
use gridwalk::{Timestamps, kernel::Kernel};

/// Invocations a workgroup of every map kernel of this crate; `flag_spine` reckons with it too.
pub(crate) const MAP_WORKGROUP: u32 = 64;

/// A kernel with its pipeline.
pub(crate) struct Pipeline {
    context: Context,
    pub(crate) kernel: &'static Kernel,
    layout: vk::PipelineLayout,
    raw: vk::Pipeline,
}

impl Pipeline {
    /// Makes the pipeline of a kernel; `constants` are values of its specialization constants by name, beside those of the device's shape.
    pub(crate) fn new(context: &Context, kernel: &'static Kernel, constants: &[(&str, u32)]) -> Result<Pipeline> {
        let device = context.device();
        let shape = context.shape();
        // Owns what is made from here on.
        let mut pipeline = Pipeline { context: context.clone(), kernel, layout: vk::PipelineLayout::null(), raw: vk::Pipeline::null() };
        let ranges = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(kernel.push_constant_size)];
        let mut entries = Vec::new();
        let mut data = Vec::new();
        for (index, &(id, name, default)) in kernel.spec_constants.iter().enumerate() {
            let given = constants.iter().find(|constant| constant.0 == name).map(|constant| constant.1);
            let value = given.or_else(|| shape.constant(name)).unwrap_or(default);
            entries.push(vk::SpecializationMapEntry { constant_id: id, offset: index as u32 * 4, size: 4 });
            data.extend_from_slice(&value.to_ne_bytes());
        }
        let specialization = vk::SpecializationInfo::default().map_entries(&entries).data(&data);
        let module_info = vk::ShaderModuleCreateInfo::default().code(kernel.spirv);
        // SAFETY: the device lives, every info is complete and outlives its call, the SPIR-V is a kernel of ours with an entry point
        // `main`, no descriptor sets, and push constants and specialization constants as reflection found them.
        unsafe {
            pipeline.layout = device
                .create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&ranges), None)
                .map_err(Error::vulkan("vkCreatePipelineLayout"))?;
            let module = device.create_shader_module(&module_info, None).map_err(Error::vulkan("vkCreateShaderModule"))?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(c"main")
                .specialization_info(&specialization);
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(pipeline.layout);
            let made = device.create_compute_pipelines(context.pipeline_cache(), &[info], None);
            device.destroy_shader_module(module, None);
            let pipelines = made.map_err(|(_, result)| Error::vulkan("vkCreateComputePipelines")(result))?;
            pipeline.raw = pipelines.first().copied().unwrap_or_default();
        }
        context.set_name(pipeline.raw, kernel.name);
        Ok(pipeline)
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        self.context.destroy(|device| {
            // SAFETY: every submission was waited for; null handles may be destroyed.
            unsafe {
                device.destroy_pipeline(self.raw, None);
                device.destroy_pipeline_layout(self.layout, None);
            }
        });
    }
}

/// What one step took, summed over its launches.
#[derive(Clone, Debug, PartialEq)]
pub struct StepTime {
    /// Name of the step: that of its kernel, or of what the library recorded.
    pub name: &'static str,
    /// `map` or `cooperative`: the thesis's split.
    pub kind: &'static str,
    /// Milliseconds on the device.
    pub ms: f64,
    /// How many launches.
    pub count: u32,
}

/// Timestamps around the steps of one submission.
pub(crate) struct Timer {
    queries: Queries,
    open: Vec<(&'static str, &'static str)>,
    times: Vec<StepTime>,
}

/// Steps of one submission that can be timed; those beyond are not.
const TIMED_STEPS: u32 = 1024;

impl Timer {
    pub(crate) fn new(context: &Context) -> Result<Timer> {
        Ok(Timer { queries: Queries::new(context, 2 * TIMED_STEPS)?, open: Vec::new(), times: Vec::new() })
    }

    /// Adds the times of the submission that has just been waited for.
    pub(crate) fn collect(&mut self) -> Result<()> {
        let stamps = self.queries.read(2 * self.open.len() as u32)?;
        for (&(name, kind), pair) in self.open.iter().zip(stamps.chunks_exact(2)) {
            let ms = self.queries.milliseconds(pair[0], pair[1]);
            add_step(&mut self.times, StepTime { name, kind, ms, count: 1 });
        }
        self.open.clear();
        Ok(())
    }

    /// All times so far, in the order of their first launch.
    pub(crate) fn take(&mut self) -> Vec<StepTime> {
        std::mem::take(&mut self.times)
    }
}

/// Adds a step's time to the others of its name.
pub(crate) fn add_step(times: &mut Vec<StepTime>, step: StepTime) {
    match times.iter_mut().find(|other| other.name == step.name) {
        Some(other) => {
            other.ms += step.ms;
            other.count += step.count;
        }
        None => times.push(step),
    }
}

/// Records steps one after another; each sees all that those before have written.
pub(crate) struct Recorder<'a> {
    pub(crate) context: &'a Context,
    pub(crate) cmd: vk::CommandBuffer,
    timer: &'a mut Timer,
}

const STAGES: vk::PipelineStageFlags2 = vk::PipelineStageFlags2::from_raw(
    vk::PipelineStageFlags2::COMPUTE_SHADER.as_raw()
        | vk::PipelineStageFlags2::DRAW_INDIRECT.as_raw()
        | vk::PipelineStageFlags2::ALL_TRANSFER.as_raw(),
);

impl<'a> Recorder<'a> {
    /// Starts to record into a command buffer in recording state (from [`Context::submit`]).
    pub(crate) fn new(context: &'a Context, cmd: vk::CommandBuffer, timer: &'a mut Timer) -> Recorder<'a> {
        timer.open.clear();
        if let Some(Timestamps { pool, .. }) = timer.queries.timestamps() {
            // SAFETY: the command buffer is recording outside of a render pass; the pool is of this device and idle.
            unsafe { context.device().cmd_reset_query_pool(cmd, pool, 0, 2 * TIMED_STEPS) };
        }
        Recorder { context, cmd, timer }
    }

    /// Records a step by a closure that records commands, then a barrier behind it.
    pub(crate) fn step<R>(&mut self, name: &'static str, kind: &'static str, record: impl FnOnce(vk::CommandBuffer) -> R) -> R {
        let device = self.context.device();
        let timed = self.timer.queries.timestamps().filter(|_| self.timer.open.len() < TIMED_STEPS as usize);
        let query = 2 * self.timer.open.len() as u32;
        let stamp = |query| {
            if let Some(Timestamps { pool, .. }) = timed {
                // SAFETY: as above; the query was reset in this command buffer and is written once.
                unsafe { device.cmd_write_timestamp2(self.cmd, vk::PipelineStageFlags2::ALL_COMMANDS, pool, query) };
            }
        };
        stamp(query);
        let result = self.context.label(self.cmd, name, || record(self.cmd));
        let barrier = vk::MemoryBarrier2::default()
            .src_stage_mask(STAGES)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(STAGES)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE);
        // SAFETY: the command buffer is recording outside of a render pass.
        unsafe { device.cmd_pipeline_barrier2(self.cmd, &vk::DependencyInfo::default().memory_barriers(&[barrier])) };
        stamp(query + 1);
        if timed.is_some() {
            self.timer.open.push((name, kind));
        }
        result
    }

    fn kernel<P: Pod>(&mut self, pipeline: &Pipeline, push: &P, dispatch: impl FnOnce(&ash::Device, vk::CommandBuffer)) {
        let kind = pipeline.kernel.kind.name();
        let context = self.context;
        self.step(pipeline.kernel.name, kind, |cmd| {
            let device = context.device();
            let bytes = bytemuck::bytes_of(push);
            let bytes = bytes.get(..pipeline.kernel.push_constant_size as usize).unwrap_or(bytes);
            // SAFETY: the command buffer is recording; pipeline and layout are of this device; the push constants are the kernel's twin,
            // whose layout the generated table asserts; the addresses in them were made from living buffers that hold what the kernel
            // indexes, which its caller answers for.
            unsafe {
                device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, pipeline.raw);
                device.cmd_push_constants(cmd, pipeline.layout, vk::ShaderStageFlags::COMPUTE, 0, bytes);
            }
            dispatch(device, cmd);
        });
    }

    /// Launches a kernel with this many workgroups.
    pub(crate) fn dispatch<P: Pod>(&mut self, pipeline: &Pipeline, push: &P, groups: [u32; 3]) {
        if groups.contains(&0) {
            return;
        }
        // SAFETY: pipeline and push constants are bound; `groups` is within every device's limit of 65,535.
        self.kernel(pipeline, push, |device, cmd| unsafe { device.cmd_dispatch(cmd, groups[0], groups[1], groups[2]) });
    }

    /// Launches a kernel with as many workgroups as a `VkDispatchIndirectCommand` says.
    pub(crate) fn dispatch_indirect<P: Pod>(&mut self, pipeline: &Pipeline, push: &P, buffer: vk::Buffer, offset: u64) {
        // SAFETY: as in `dispatch`; the buffer has indirect usage and holds the command at an offset that is a multiple of 4.
        self.kernel(pipeline, push, |device, cmd| unsafe { device.cmd_dispatch_indirect(cmd, buffer, offset) });
    }
}

/// Workgroups of a map kernel over a queue of `count` rays, as `flag_spine` has them.
pub(crate) fn queue_groups(context: &Context, count: u32) -> [u32; 3] {
    context.shape().deal_workgroups(count, MAP_WORKGROUP)
}

/// Workgroups of a direct dispatch of a map kernel over `count` elements.
pub(crate) fn map_groups(count: u32) -> [u32; 3] {
    gridwalk::split_workgroups(count.div_ceil(MAP_WORKGROUP))
}
