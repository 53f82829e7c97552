//! What a recording leaves bound.

use gridwalk::ash::vk;
use gridwalk::{Tracer, cmd_barrier};
use gridwalk_tests::foreign::{Foreign, Memory, POISON, Placed, Terrain};

/// Writes 42 to the one word of the buffer at set 0, binding 0. As assembled by spirv-as of:
///
/// ```text
/// %block = OpTypeStruct %uint                         ; BufferBlock, member 0 at offset 0
/// %buffer = OpVariable %pointer_block Uniform         ; DescriptorSet 0, Binding 0
/// %target = OpAccessChain %pointer_uint %buffer %zero
/// OpStore %target %value
/// ```
#[rustfmt::skip]
const STORE: [u32; 86] = [
    0x0723_0203, 0x10000, 0x70000, 13, 0, 0x20011, 1, 0x3000e, 0, 1, 0x5000f, 5, 1, 0x6e69_616d, 0, 0x60010, 1, 17, 1, 1, 1, 0x30047, 2, 3,
    0x50048, 2, 0, 35, 0, 0x40047, 3, 34, 0, 0x40047, 3, 33, 0, 0x20013, 4, 0x40015, 5, 32, 0, 0x4002b, 5, 6, 0, 0x4002b, 5, 7, 42,
    0x3001e, 2, 5, 0x40020, 8, 2, 2, 0x40020, 9, 2, 5, 0x4003b, 8, 3, 2, 0x30021, 10, 4, 0x50036, 4, 1, 0, 10, 0x200f8, 11, 0x50041, 9, 12,
    3, 6, 0x3003e, 12, 7, 0x100fd, 0x10038,
];

/// The caller's pipeline must be bound again, its descriptor sets need not be.
#[test]
fn descriptor_sets_stay_bound() {
    let foreign = Foreign::new();
    {
        let device = &foreign.device;
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let placed = Placed::new(&memory, &tracer, Terrain::new(8, 3));
        // Descriptors of storage buffers begin at multiples of at most 256 bytes.
        let word = memory.region(1024);
        let aligned = word.part(word.offset.next_multiple_of(256) - word.offset, 4);
        // SAFETY: all handles are of this device; the submission is waited for before anything is destroyed.
        unsafe {
            let binding = [vk::DescriptorSetLayoutBinding::default()
                .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)];
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&binding);
            let set_layout = [device.create_descriptor_set_layout(&info, None).unwrap()];
            let layout = device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layout), None).unwrap();
            let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&STORE), None).unwrap();
            let stage = vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::COMPUTE).module(module).name(c"main");
            let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
            let pipeline = device.create_compute_pipelines(vk::PipelineCache::null(), &info, None).unwrap()[0];
            let size = [vk::DescriptorPoolSize::default().ty(vk::DescriptorType::STORAGE_BUFFER).descriptor_count(1)];
            let pool = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&size);
            let pool = device.create_descriptor_pool(&pool, None).unwrap();
            let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&set_layout);
            let set = device.allocate_descriptor_sets(&info).unwrap();
            let buffer = [vk::DescriptorBufferInfo::default().buffer(aligned.buffer).offset(aligned.offset).range(aligned.size)];
            let write = vk::WriteDescriptorSet::default().dst_set(set[0]).descriptor_type(vk::DescriptorType::STORAGE_BUFFER);
            device.update_descriptor_sets(&[write.buffer_info(&buffer)], &[]);

            let commands = foreign.record(|cmd| {
                device.cmd_bind_descriptor_sets(cmd, vk::PipelineBindPoint::COMPUTE, layout, 0, &set, &[]);
                placed.cmd_build(&tracer, cmd);
                cmd_barrier(device, cmd, Tracer::BUILD, Tracer::TRACE);
                placed.cmd_trace(&tracer, cmd);
                device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::COMPUTE, pipeline);
                device.cmd_dispatch(cmd, 1, 1, 1);
            });
            foreign.submit(&[&commands]);
            drop(commands);
            device.destroy_descriptor_pool(pool, None);
            device.destroy_pipeline(pipeline, None);
            device.destroy_shader_module(module, None);
            device.destroy_pipeline_layout(layout, None);
            device.destroy_descriptor_set_layout(set_layout[0], None);
        }
        placed.check();
        assert_eq!(memory.read::<u32>(&aligned.part(0, 4), 1), [42]);
        assert_ne!(POISON, 42);
    }
    assert_eq!(foreign.close(), [""; 0]);
}
