//! Push constants of the kernels; the generated table asserts their layout. Addresses are device addresses.

use bytemuck::{Pod, Zeroable};

/// Of kernel `ray_query`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub struct RayQuery {
    pub structure: u64,
    pub rays: u64,
    pub hits: u64,
    pub first: u32,
    pub count: u32,
    pub stride: u32,
    pub reserved: u32,
}

/// Of kernel `copy`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Copy {
    pub from: u64,
    pub to: u64,
    pub count: u32,
    pub reserved: u32,
}
