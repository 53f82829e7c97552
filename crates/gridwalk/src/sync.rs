//! Every pipeline stage and access mask of the library.

use ash::vk;

/// Pipeline stages and their accesses: one side of a barrier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// Stages.
    pub stages: vk::PipelineStageFlags2,
    /// Accesses in these stages.
    pub access: vk::AccessFlags2,
}

impl Access {
    /// Compute shaders that read and write memory, and indirect dispatches that read their arguments: all that builds and traces do.
    pub const COMPUTE: Access = Access {
        stages: vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::COMPUTE_SHADER.as_raw() | vk::PipelineStageFlags2::DRAW_INDIRECT.as_raw(),
        ),
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::SHADER_STORAGE_READ.as_raw()
                | vk::AccessFlags2::SHADER_STORAGE_WRITE.as_raw()
                | vk::AccessFlags2::INDIRECT_COMMAND_READ.as_raw(),
        ),
    };

    /// Reads by the host, for the report region after a fence or a timeline semaphore.
    pub const HOST_READ: Access = Access { stages: vk::PipelineStageFlags2::HOST, access: vk::AccessFlags2::HOST_READ };

    /// Copies and fills, reading and writing.
    pub const TRANSFER: Access = Access {
        stages: vk::PipelineStageFlags2::ALL_TRANSFER,
        access: vk::AccessFlags2::from_raw(vk::AccessFlags2::TRANSFER_READ.as_raw() | vk::AccessFlags2::TRANSFER_WRITE.as_raw()),
    };
}

/// The kernels of a plan among themselves.
pub(crate) const SHADER: Access = Access {
    stages: vk::PipelineStageFlags2::COMPUTE_SHADER,
    access: vk::AccessFlags2::from_raw(vk::AccessFlags2::SHADER_STORAGE_READ.as_raw() | vk::AccessFlags2::SHADER_STORAGE_WRITE.as_raw()),
};

/// Records a global memory barrier.
///
/// # Safety
/// `cmd` is in the recording state, outside of a render pass, and of `device`, which has `synchronization2` enabled.
pub unsafe fn cmd_barrier(device: &ash::Device, cmd: vk::CommandBuffer, before: Access, after: Access) {
    let barriers = [vk::MemoryBarrier2::default()
        .src_stage_mask(before.stages)
        .src_access_mask(before.access)
        .dst_stage_mask(after.stages)
        .dst_access_mask(after.access)];
    // SAFETY: the caller's contract; the dependency lives until the call returns.
    unsafe { device.cmd_pipeline_barrier2(cmd, &vk::DependencyInfo::default().memory_barriers(&barriers)) };
}
