//! The benchmark's own kernels, made ready for the device.

use anyhow::Result;
use bytemuck::{Pod, bytes_of};
use gridwalk::Shape;
use gridwalk::ash::vk;
use gridwalk::kernel::Kernel;
use gridwalk_render::Context;

/// A kernel with its pipeline.
pub struct Pipeline {
    context: Context,
    kernel: &'static Kernel,
    layout: vk::PipelineLayout,
    raw: vk::Pipeline,
}

impl Pipeline {
    /// Makes the pipeline of a kernel, with values for its specialization constants in their order. The context has enabled what the kernel asks
    /// for.
    ///
    /// # Errors
    /// What the device reports.
    pub fn new(context: &Context, kernel: &'static Kernel, constants: &[u32]) -> Result<Pipeline> {
        let device = context.device();
        // Destroys what is made from here on.
        let mut pipeline = Pipeline { context: context.clone(), kernel, layout: vk::PipelineLayout::null(), raw: vk::Pipeline::null() };
        let entries: Vec<vk::SpecializationMapEntry> = (0..)
            .zip(kernel.spec_constants.iter().zip(constants))
            .map(|(index, ((id, _, _), _))| vk::SpecializationMapEntry { constant_id: *id, offset: 4 * index, size: 4 })
            .collect();
        let specialization = vk::SpecializationInfo::default().map_entries(&entries).data(bytemuck::cast_slice(constants));
        let ranges = [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::COMPUTE).size(kernel.push_constant_size)];
        // SAFETY: the device lives; every info is complete and outlives its call; the SPIR-V is the kernel's, with an entry point `main`, no
        // descriptor sets, and push constants and specialization constants as reflection found them.
        unsafe {
            pipeline.layout =
                device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&ranges), None)?;
            let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(kernel.spirv), None)?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(c"main")
                .specialization_info(&specialization);
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(pipeline.layout);
            let made = device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None);
            device.destroy_shader_module(module, None);
            pipeline.raw = made.map_err(|(_, error)| error)?.first().copied().unwrap_or_default();
        }
        Ok(pipeline)
    }

    /// Records a launch over so many elements.
    ///
    /// # Safety
    /// The command buffer is recording on the pipeline's device; `push` is the twin of the kernel's push constants, and its addresses are those of
    /// living buffers that hold what the kernel indexes.
    pub unsafe fn record(&self, cmd: vk::CommandBuffer, push: &impl Pod, count: u32) {
        let device = self.context.device();
        let bytes = bytes_of(push);
        let bytes = bytes.get(..self.kernel.push_constant_size as usize).unwrap_or(bytes);
        let [x, y, z] = Shape::of_device(self.context.is_cpu()).deal_workgroups(count, self.kernel.local_size[0]);
        // SAFETY: the caller's word; the number of workgroups is within every device's limit.
        unsafe {
            device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, self.raw);
            device.cmd_push_constants(cmd, self.layout, vk::ShaderStageFlags::COMPUTE, 0, bytes);
            device.cmd_dispatch(cmd, x, y, z);
        }
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        let device = self.context.device();
        // SAFETY: every submission was waited for; null handles may be destroyed.
        unsafe {
            device.destroy_pipeline(self.raw, None);
            device.destroy_pipeline_layout(self.layout, None);
        }
    }
}
