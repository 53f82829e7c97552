//! Push constants of the kernels; the generated table asserts their layout. Addresses are device addresses.

use bytemuck::{Pod, Zeroable};

/// Of kernel `flag_downsweep`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FlagDownsweep {
    pub(crate) queue: u64,
    pub(crate) flags: u64,
    pub(crate) sums: u64,
    pub(crate) offsets: u64,
}

/// Of kernel `flag_reduce`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FlagReduce {
    pub(crate) queue: u64,
    pub(crate) flags: u64,
    pub(crate) sums: u64,
}

/// Of kernel `flag_spine`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FlagSpine {
    pub(crate) queue: u64,
    pub(crate) sums: u64,
    pub(crate) next: u64,
}

/// Of kernel `camera_rays`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CameraRays {
    pub(crate) camera: u64,
    pub(crate) rays: u64,
    pub(crate) paths: u64,
    pub(crate) first_pixel: u32,
    pub(crate) pixel_count: u32,
    pub(crate) sample_offset: [f32; 2],
}

/// Of kernel `first_hit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FirstHit {
    pub(crate) scene: u64,
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) records: u64,
}

/// Of kernel `light_add`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightAdd {
    pub(crate) queue: u64,
    pub(crate) paths: u64,
    pub(crate) occluded: u64,
    pub(crate) film: u64,
    pub(crate) unfinished: u64,
}

/// Of kernel `light_count`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightCount {
    pub(crate) scene: u64,
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) surfaces: u64,
    pub(crate) shadows: u64,
    pub(crate) light: u32,
    pub(crate) padding: u32,
}

/// Of kernel `light_emit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightEmit {
    pub(crate) scene: u64,
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) surfaces: u64,
    pub(crate) paths: u64,
    pub(crate) shadows: u64,
    pub(crate) offsets: u64,
    pub(crate) shadow_rays: u64,
    pub(crate) shadow_paths: u64,
    pub(crate) light: u32,
    pub(crate) padding: u32,
}

/// Of kernel `light_pass`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightPass {
    pub(crate) grid: u64,
    pub(crate) scene: u64,
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) passed: u64,
    pub(crate) walks: u64,
}

/// Of kernel `masked_any_hit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct MaskedAnyHit {
    pub(crate) grid: u64,
    pub(crate) scene: u64,
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) occluded: u64,
    pub(crate) walks: u64,
}

/// Of kernel `masked_closest_hit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct MaskedClosestHit {
    pub(crate) grid: u64,
    pub(crate) scene: u64,
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) walks: u64,
}

/// Of kernel `reflect_emit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ReflectEmit {
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) surfaces: u64,
    pub(crate) paths: u64,
    pub(crate) reflects: u64,
    pub(crate) offsets: u64,
    pub(crate) next_rays: u64,
    pub(crate) next_paths: u64,
}

/// Of kernel `shade`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Shade {
    pub(crate) scene: u64,
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    pub(crate) paths: u64,
    pub(crate) film: u64,
    pub(crate) surfaces: u64,
    pub(crate) reflects: u64,
    pub(crate) unfinished: u64,
    pub(crate) ways: u64,
    pub(crate) waiting: u64,
    pub(crate) flags: u32,
    pub(crate) depth: u32,
    pub(crate) capacity: u32,
    pub(crate) padding: u32,
}

/// Of kernel `ways_emit`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct WaysEmit {
    pub(crate) queue: u64,
    pub(crate) rays: u64,
    pub(crate) surfaces: u64,
    pub(crate) paths: u64,
    pub(crate) flags: u64,
    pub(crate) offsets: u64,
    pub(crate) ways: u64,
    pub(crate) waiting: u64,
    pub(crate) next_rays: u64,
    pub(crate) next_paths: u64,
    pub(crate) capacity: u32,
    pub(crate) padding: u32,
}

/// Of kernel `interpolate`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Interpolate {
    pub(crate) first_positions: u64,
    pub(crate) first_normals: u64,
    pub(crate) first_uvs: u64,
    pub(crate) second_positions: u64,
    pub(crate) second_normals: u64,
    pub(crate) second_uvs: u64,
    pub(crate) positions: u64,
    pub(crate) normals: u64,
    pub(crate) uvs: u64,
    pub(crate) vertex_count: u32,
    pub(crate) weight: f32,
}

/// Of kernel `interpolate_colours`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct InterpolateColours {
    pub(crate) first_colours: u64,
    pub(crate) second_colours: u64,
    pub(crate) colours: u64,
    pub(crate) word_count: u32,
    pub(crate) weight: f32,
    pub(crate) has_colours: u32,
    pub(crate) padding: u32,
}

/// Of kernel `morph`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Morph {
    pub(crate) base_positions: u64,
    pub(crate) base_normals: u64,
    pub(crate) deltas: u64,
    pub(crate) targets: u64,
    pub(crate) positions: u64,
    pub(crate) normals: u64,
    pub(crate) vertex_count: u32,
    pub(crate) target_count: u32,
}

/// Of kernel `skin`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Skin {
    pub(crate) base_positions: u64,
    pub(crate) base_normals: u64,
    pub(crate) influences: u64,
    pub(crate) matrices: u64,
    pub(crate) positions: u64,
    pub(crate) normals: u64,
    pub(crate) vertex_count: u32,
    pub(crate) influences_each: u32,
}

/// Of kernel `place`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Place {
    pub(crate) mesh_indices: u64,
    pub(crate) mesh_materials: u64,
    pub(crate) indices: u64,
    pub(crate) surrounds: u64,
    pub(crate) triangle_count: u32,
    pub(crate) first_triangle: u32,
    pub(crate) first_vertex: u32,
    pub(crate) mesh: u32,
}
