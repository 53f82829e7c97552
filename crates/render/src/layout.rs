//! Structures that the shading kernels and the host both read and write; the generated table asserts their layout.

use bytemuck::{Pod, Zeroable};

/// No texture.
pub(crate) const NO_MAP: u32 = u32::MAX;
/// [`Material::flags`]: reflects as a mirror.
pub(crate) const MATERIAL_MIRROR: u32 = 1;
/// [`Material::flags`]: `normal_map` holds heights.
pub(crate) const MATERIAL_HEIGHT_MAP: u32 = 2;
/// [`Material::flags`]: the opacity is a share, not a mask.
pub(crate) const MATERIAL_BLEND: u32 = 4;
/// [`Material::flags`]: the colours of vertices multiply the emission.
pub(crate) const MATERIAL_UNLIT: u32 = 8;

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Material {
    pub(crate) diffuse: [f32; 3],
    pub(crate) shininess: f32,
    pub(crate) specular: [f32; 3],
    pub(crate) flags: u32,
    pub(crate) emission: [f32; 3],
    pub(crate) opacity: f32,
    pub(crate) diffuse_map: u32,
    pub(crate) specular_map: u32,
    pub(crate) emission_map: u32,
    pub(crate) opacity_map: u32,
    pub(crate) normal_map: u32,
    pub(crate) bump_scale: f32,
    pub(crate) number: u32,
    pub(crate) reserved: u32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Texture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) first_texel: u32,
    pub(crate) srgb: u32,
}

/// [`Light::kind`].
pub(crate) const LIGHT_POINT: u32 = 0;
pub(crate) const LIGHT_DIRECTIONAL: u32 = 1;
pub(crate) const LIGHT_SPOT: u32 = 2;

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Light {
    pub(crate) position: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) direction: [f32; 3],
    pub(crate) cos_inner: f32,
    pub(crate) intensity: [f32; 3],
    pub(crate) cos_outer: f32,
}

/// [`Background::kind`].
pub(crate) const BACKGROUND_COLOUR: u32 = 0;
pub(crate) const BACKGROUND_GRADIENT: u32 = 1;
pub(crate) const BACKGROUND_PANORAMA: u32 = 2;

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Background {
    pub(crate) bottom: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) top: [f32; 3],
    pub(crate) rotation: f32,
    pub(crate) up: [f32; 3],
    pub(crate) width: u32,
    pub(crate) front: [f32; 3],
    pub(crate) height: u32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Surround {
    pub(crate) material: u32,
    pub(crate) mesh: u32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SceneTable {
    pub(crate) positions: u64,
    pub(crate) indices: u64,
    pub(crate) normals: u64,
    pub(crate) uvs: u64,
    pub(crate) surrounds: u64,
    pub(crate) colours: u64,
    pub(crate) mesh_starts: u64,
    pub(crate) materials: u64,
    pub(crate) textures: u64,
    pub(crate) texels: u64,
    pub(crate) srgb: u64,
    pub(crate) lights: u64,
    pub(crate) panorama: u64,
    pub(crate) opacities: u64,
    pub(crate) ambient: [f32; 3],
    pub(crate) triangle_count: u32,
    pub(crate) background: Background,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct QueueHeader {
    pub(crate) count: u32,
    pub(crate) groups_x: u32,
    pub(crate) groups_y: u32,
    pub(crate) groups_z: u32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Path {
    pub(crate) weight: [f32; 3],
    pub(crate) slot: u32,
}

/// What a pixel has still to follow, where surfaces are seen through.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Ways {
    pub(crate) level: u32,
    pub(crate) waiting: u32,
    pub(crate) passed: u32,
    pub(crate) reflects: u32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct WaitingRay {
    pub(crate) origin: [f32; 3],
    pub(crate) level: u32,
    pub(crate) direction: [f32; 3],
    pub(crate) reserved0: u32,
    pub(crate) weight: [f32; 3],
    pub(crate) reserved1: u32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Surface {
    pub(crate) start: [f32; 3],
    pub(crate) offset: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) shininess: f32,
    pub(crate) geometric_normal: [f32; 3],
    pub(crate) is_hit: u32,
    pub(crate) diffuse: [f32; 3],
    pub(crate) reserved0: f32,
    pub(crate) specular: [f32; 3],
    pub(crate) reserved1: f32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Film {
    pub(crate) radiance: [f32; 3],
    pub(crate) coverage: f32,
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CameraFrame {
    pub(crate) eye: [f32; 3],
    pub(crate) is_orthographic: u32,
    pub(crate) forward: [f32; 3],
    pub(crate) reserved0: f32,
    pub(crate) right: [f32; 3],
    pub(crate) reserved1: f32,
    pub(crate) up: [f32; 3],
    pub(crate) reserved2: f32,
    pub(crate) size: [u32; 2],
    pub(crate) crop_origin: [u32; 2],
    pub(crate) crop_size: [u32; 2],
    pub(crate) reserved3: [u32; 2],
}

#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FirstHitRecord {
    pub(crate) position: [f32; 3],
    pub(crate) distance: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) u: f32,
    pub(crate) geometric_normal: [f32; 3],
    pub(crate) v: f32,
    pub(crate) albedo: [f32; 3],
    pub(crate) material: u32,
    pub(crate) primitive: u32,
    pub(crate) mesh: u32,
    pub(crate) triangle: u32,
    pub(crate) reserved: u32,
}
