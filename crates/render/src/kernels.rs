//! The kernels of this crate: SPIR-V and what reflection found in it. Made by `cargo tool shaders`; edit the GLSL instead.

use gridwalk::kernel::{Access, Kernel, Kind};

/// SPIR-V as words: files hold it as little-endian bytes.
const fn words<const N: usize>(bytes: &[u8]) -> [u32; N] {
    let (chunks, rest) = bytes.as_chunks::<4>();
    assert!(chunks.len() == N && rest.is_empty());
    let mut words = [0; N];
    let mut i = 0;
    while i < N {
        words[i] = u32::from_le_bytes(chunks[i]);
        i += 1;
    }
    words
}

macro_rules! spirv {
    ($path:literal) => {{
        const BYTES: &[u8] = include_bytes!($path);
        const WORDS: [u32; BYTES.len() / 4] = words(BYTES);
        &WORDS
    }};
}

/// Kernel `camera_rays`, from `glsl/render/map/camera_rays.comp`.
pub static CAMERA_RAYS: Kernel = Kernel {
    name: "camera_rays",
    kind: Kind::Map,
    spirv: spirv!("../spirv/camera_rays.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[("camera", Access::Read), ("rays", Access::Write), ("paths", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `first_hit`, from `glsl/render/map/first_hit.comp`.
pub static FIRST_HIT: Kernel = Kernel {
    name: "first_hit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/first_hit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[
        ("scene", Access::Read),
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("hits", Access::Read),
        ("records", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `flag_downsweep`, from `glsl/render/cooperative/flag_downsweep.comp`.
pub static FLAG_DOWNSWEEP: Kernel = Kernel {
    name: "flag_downsweep",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/flag_downsweep.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [None, None, None],
    push_constant_size: 32,
    accesses: &[("queue", Access::Read), ("flags", Access::Read), ("sums", Access::Read), ("offsets", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `flag_reduce`, from `glsl/render/cooperative/flag_reduce.comp`.
pub static FLAG_REDUCE: Kernel = Kernel {
    name: "flag_reduce",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/flag_reduce.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [None, None, None],
    push_constant_size: 24,
    accesses: &[("queue", Access::Read), ("flags", Access::Read), ("sums", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `flag_spine`, from `glsl/render/cooperative/flag_spine.comp`.
pub static FLAG_SPINE: Kernel = Kernel {
    name: "flag_spine",
    kind: Kind::Cooperative,
    spirv: spirv!("../spirv/flag_spine.spv"),
    local_size: [256, 1, 1],
    local_size_ids: [None, None, None],
    push_constant_size: 24,
    accesses: &[("queue", Access::Read), ("sums", Access::ReadWrite), ("next", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `interpolate`, from `glsl/render/map/interpolate.comp`.
pub static INTERPOLATE: Kernel = Kernel {
    name: "interpolate",
    kind: Kind::Map,
    spirv: spirv!("../spirv/interpolate.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 80,
    accesses: &[
        ("first_positions", Access::Read),
        ("first_normals", Access::Read),
        ("first_uvs", Access::Read),
        ("second_positions", Access::Read),
        ("second_normals", Access::Read),
        ("second_uvs", Access::Read),
        ("positions", Access::Write),
        ("normals", Access::Write),
        ("uvs", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `interpolate_colours`, from `glsl/render/map/interpolate_colours.comp`.
pub static INTERPOLATE_COLOURS: Kernel = Kernel {
    name: "interpolate_colours",
    kind: Kind::Map,
    spirv: spirv!("../spirv/interpolate_colours.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[("first_colours", Access::Read), ("second_colours", Access::Read), ("colours", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `light_add`, from `glsl/render/map/light_add.comp`.
pub static LIGHT_ADD: Kernel = Kernel {
    name: "light_add",
    kind: Kind::Map,
    spirv: spirv!("../spirv/light_add.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[
        ("queue", Access::Read),
        ("paths", Access::Read),
        ("occluded", Access::Read),
        ("film", Access::ReadWrite),
        ("unfinished", Access::ReadWrite),
    ],
    spec_constants: &[(1, "BLEND", 0), (20, "STRANDS", 1)],
};

/// Kernel `light_count`, from `glsl/render/map/light_count.comp`.
pub static LIGHT_COUNT: Kernel = Kernel {
    name: "light_count",
    kind: Kind::Map,
    spirv: spirv!("../spirv/light_count.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("scene", Access::Read),
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("surfaces", Access::Read),
        ("shadows", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `light_emit`, from `glsl/render/map/light_emit.comp`.
pub static LIGHT_EMIT: Kernel = Kernel {
    name: "light_emit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/light_emit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 80,
    accesses: &[
        ("scene", Access::Read),
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("surfaces", Access::Read),
        ("paths", Access::Read),
        ("shadows", Access::Read),
        ("offsets", Access::Read),
        ("shadow_rays", Access::Write),
        ("shadow_paths", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `light_pass`, from `glsl/render/map/light_pass.comp`.
pub static LIGHT_PASS: Kernel = Kernel {
    name: "light_pass",
    kind: Kind::Map,
    spirv: spirv!("../spirv/light_pass.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("grid", Access::Read),
        ("scene", Access::Read),
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("passed", Access::Write),
        ("walks", Access::ReadWrite),
    ],
    spec_constants: &[
        (1, "CONTINUE", 0),
        (2, "LAST", 0),
        (3, "RESUME", 0),
        (4, "COUNT", 0),
        (5, "EXTRAS", 0),
        (6, "BY_TWO", 0),
        (20, "STRANDS", 1),
    ],
};

/// Kernel `masked_any_hit`, from `glsl/render/map/masked_any_hit.comp`.
pub static MASKED_ANY_HIT: Kernel = Kernel {
    name: "masked_any_hit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/masked_any_hit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("grid", Access::Read),
        ("scene", Access::Read),
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("occluded", Access::Write),
        ("walks", Access::ReadWrite),
    ],
    spec_constants: &[
        (1, "CONTINUE", 0),
        (2, "LAST", 0),
        (3, "RESUME", 0),
        (4, "COUNT", 0),
        (5, "EXTRAS", 0),
        (6, "BY_TWO", 0),
        (20, "STRANDS", 1),
    ],
};

/// Kernel `masked_closest_hit`, from `glsl/render/map/masked_closest_hit.comp`.
pub static MASKED_CLOSEST_HIT: Kernel = Kernel {
    name: "masked_closest_hit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/masked_closest_hit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[
        ("grid", Access::Read),
        ("scene", Access::Read),
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("hits", Access::Write),
        ("walks", Access::ReadWrite),
    ],
    spec_constants: &[
        (1, "CONTINUE", 0),
        (2, "LAST", 0),
        (3, "RESUME", 0),
        (4, "COUNT", 0),
        (5, "EXTRAS", 0),
        (6, "BY_TWO", 0),
        (20, "STRANDS", 1),
    ],
};

/// Kernel `morph`, from `glsl/render/map/morph.comp`.
pub static MORPH: Kernel = Kernel {
    name: "morph",
    kind: Kind::Map,
    spirv: spirv!("../spirv/morph.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 56,
    accesses: &[
        ("base_positions", Access::Read),
        ("base_normals", Access::Read),
        ("deltas", Access::Read),
        ("targets", Access::Read),
        ("positions", Access::Write),
        ("normals", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `place`, from `glsl/render/map/place.comp`.
pub static PLACE: Kernel = Kernel {
    name: "place",
    kind: Kind::Map,
    spirv: spirv!("../spirv/place.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 48,
    accesses: &[("mesh_indices", Access::Read), ("mesh_materials", Access::Read), ("indices", Access::Write), ("surrounds", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `reflect_emit`, from `glsl/render/map/reflect_emit.comp`.
pub static REFLECT_EMIT: Kernel = Kernel {
    name: "reflect_emit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/reflect_emit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 64,
    accesses: &[
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("surfaces", Access::Read),
        ("paths", Access::Read),
        ("reflects", Access::Read),
        ("offsets", Access::Read),
        ("next_rays", Access::Write),
        ("next_paths", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `shade`, from `glsl/render/map/shade.comp`.
pub static SHADE: Kernel = Kernel {
    name: "shade",
    kind: Kind::Map,
    spirv: spirv!("../spirv/shade.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 104,
    accesses: &[
        ("scene", Access::Read),
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("hits", Access::Read),
        ("paths", Access::Read),
        ("film", Access::ReadWrite),
        ("surfaces", Access::Write),
        ("reflects", Access::Write),
        ("unfinished", Access::ReadWrite),
        ("ways", Access::ReadWrite),
        ("waiting", Access::Write),
    ],
    spec_constants: &[(1, "BLEND", 0), (20, "STRANDS", 1)],
};

/// Kernel `skin`, from `glsl/render/map/skin.comp`.
pub static SKIN: Kernel = Kernel {
    name: "skin",
    kind: Kind::Map,
    spirv: spirv!("../spirv/skin.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 56,
    accesses: &[
        ("base_positions", Access::Read),
        ("base_normals", Access::Read),
        ("influences", Access::Read),
        ("matrices", Access::Read),
        ("positions", Access::Write),
        ("normals", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `ways_emit`, from `glsl/render/map/ways_emit.comp`.
pub static WAYS_EMIT: Kernel = Kernel {
    name: "ways_emit",
    kind: Kind::Map,
    spirv: spirv!("../spirv/ways_emit.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 88,
    accesses: &[
        ("queue", Access::Read),
        ("rays", Access::Read),
        ("surfaces", Access::Read),
        ("paths", Access::Read),
        ("flags", Access::Read),
        ("offsets", Access::Read),
        ("ways", Access::ReadWrite),
        ("waiting", Access::Read),
        ("next_rays", Access::Write),
        ("next_paths", Access::Write),
    ],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Every kernel of this crate, in order of name.
pub static ALL: &[&Kernel] = &[
    &CAMERA_RAYS,
    &FIRST_HIT,
    &FLAG_DOWNSWEEP,
    &FLAG_REDUCE,
    &FLAG_SPINE,
    &INTERPOLATE,
    &INTERPOLATE_COLOURS,
    &LIGHT_ADD,
    &LIGHT_COUNT,
    &LIGHT_EMIT,
    &LIGHT_PASS,
    &MASKED_ANY_HIT,
    &MASKED_CLOSEST_HIT,
    &MORPH,
    &PLACE,
    &REFLECT_EMIT,
    &SHADE,
    &SKIN,
    &WAYS_EMIT,
];

/// Bytes of a field, found by a function that takes it.
const fn size<T, F>(_: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

// The host's structures lie in memory as the kernels read them.
const _: () = {
    use gridwalk::gridwalk_core::twin::motion::ActiveTarget as Host;
    assert!(core::mem::offset_of!(Host, positions) == 0);
    assert!(size(|host: &Host| &host.positions) == 4);
    assert!(core::mem::offset_of!(Host, normals) == 4);
    assert!(size(|host: &Host| &host.normals) == 4);
    assert!(core::mem::offset_of!(Host, weight) == 8);
    assert!(size(|host: &Host| &host.weight) == 4);
    assert!(core::mem::offset_of!(Host, reserved) == 12);
    assert!(size(|host: &Host| &host.reserved) == 4);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use crate::layout::Background as Host;
    assert!(core::mem::offset_of!(Host, bottom) == 0);
    assert!(size(|host: &Host| &host.bottom) == 12);
    assert!(core::mem::offset_of!(Host, kind) == 12);
    assert!(size(|host: &Host| &host.kind) == 4);
    assert!(core::mem::offset_of!(Host, top) == 16);
    assert!(size(|host: &Host| &host.top) == 12);
    assert!(core::mem::offset_of!(Host, rotation) == 28);
    assert!(size(|host: &Host| &host.rotation) == 4);
    assert!(core::mem::offset_of!(Host, up) == 32);
    assert!(size(|host: &Host| &host.up) == 12);
    assert!(core::mem::offset_of!(Host, width) == 44);
    assert!(size(|host: &Host| &host.width) == 4);
    assert!(core::mem::offset_of!(Host, front) == 48);
    assert!(size(|host: &Host| &host.front) == 12);
    assert!(core::mem::offset_of!(Host, height) == 60);
    assert!(size(|host: &Host| &host.height) == 4);
};
const _: () = {
    use crate::layout::CameraFrame as Host;
    assert!(core::mem::offset_of!(Host, eye) == 0);
    assert!(size(|host: &Host| &host.eye) == 12);
    assert!(core::mem::offset_of!(Host, is_orthographic) == 12);
    assert!(size(|host: &Host| &host.is_orthographic) == 4);
    assert!(core::mem::offset_of!(Host, forward) == 16);
    assert!(size(|host: &Host| &host.forward) == 12);
    assert!(core::mem::offset_of!(Host, reserved0) == 28);
    assert!(size(|host: &Host| &host.reserved0) == 4);
    assert!(core::mem::offset_of!(Host, right) == 32);
    assert!(size(|host: &Host| &host.right) == 12);
    assert!(core::mem::offset_of!(Host, reserved1) == 44);
    assert!(size(|host: &Host| &host.reserved1) == 4);
    assert!(core::mem::offset_of!(Host, up) == 48);
    assert!(size(|host: &Host| &host.up) == 12);
    assert!(core::mem::offset_of!(Host, reserved2) == 60);
    assert!(size(|host: &Host| &host.reserved2) == 4);
    assert!(core::mem::offset_of!(Host, size) == 64);
    assert!(size(|host: &Host| &host.size) == 8);
    assert!(core::mem::offset_of!(Host, crop_origin) == 72);
    assert!(size(|host: &Host| &host.crop_origin) == 8);
    assert!(core::mem::offset_of!(Host, crop_size) == 80);
    assert!(size(|host: &Host| &host.crop_size) == 8);
    assert!(core::mem::offset_of!(Host, reserved3) == 88);
    assert!(size(|host: &Host| &host.reserved3) == 8);
};
const _: () = {
    use crate::push::CameraRays as Host;
    assert!(core::mem::offset_of!(Host, camera) == 0);
    assert!(size(|host: &Host| &host.camera) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, paths) == 16);
    assert!(size(|host: &Host| &host.paths) == 8);
    assert!(core::mem::offset_of!(Host, first_pixel) == 24);
    assert!(size(|host: &Host| &host.first_pixel) == 4);
    assert!(core::mem::offset_of!(Host, pixel_count) == 28);
    assert!(size(|host: &Host| &host.pixel_count) == 4);
    assert!(core::mem::offset_of!(Host, sample_offset) == 32);
    assert!(size(|host: &Host| &host.sample_offset) == 8);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::layout::Film as Host;
    assert!(core::mem::offset_of!(Host, radiance) == 0);
    assert!(size(|host: &Host| &host.radiance) == 12);
    assert!(core::mem::offset_of!(Host, coverage) == 12);
    assert!(size(|host: &Host| &host.coverage) == 4);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use crate::push::FirstHit as Host;
    assert!(core::mem::offset_of!(Host, scene) == 0);
    assert!(size(|host: &Host| &host.scene) == 8);
    assert!(core::mem::offset_of!(Host, queue) == 8);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 16);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 24);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, records) == 32);
    assert!(size(|host: &Host| &host.records) == 8);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::layout::FirstHitRecord as Host;
    assert!(core::mem::offset_of!(Host, position) == 0);
    assert!(size(|host: &Host| &host.position) == 12);
    assert!(core::mem::offset_of!(Host, distance) == 12);
    assert!(size(|host: &Host| &host.distance) == 4);
    assert!(core::mem::offset_of!(Host, normal) == 16);
    assert!(size(|host: &Host| &host.normal) == 12);
    assert!(core::mem::offset_of!(Host, u) == 28);
    assert!(size(|host: &Host| &host.u) == 4);
    assert!(core::mem::offset_of!(Host, geometric_normal) == 32);
    assert!(size(|host: &Host| &host.geometric_normal) == 12);
    assert!(core::mem::offset_of!(Host, v) == 44);
    assert!(size(|host: &Host| &host.v) == 4);
    assert!(core::mem::offset_of!(Host, albedo) == 48);
    assert!(size(|host: &Host| &host.albedo) == 12);
    assert!(core::mem::offset_of!(Host, material) == 60);
    assert!(size(|host: &Host| &host.material) == 4);
    assert!(core::mem::offset_of!(Host, primitive) == 64);
    assert!(size(|host: &Host| &host.primitive) == 4);
    assert!(core::mem::offset_of!(Host, mesh) == 68);
    assert!(size(|host: &Host| &host.mesh) == 4);
    assert!(core::mem::offset_of!(Host, triangle) == 72);
    assert!(size(|host: &Host| &host.triangle) == 4);
    assert!(core::mem::offset_of!(Host, reserved) == 76);
    assert!(size(|host: &Host| &host.reserved) == 4);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::push::FlagDownsweep as Host;
    assert!(core::mem::offset_of!(Host, queue) == 0);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, flags) == 8);
    assert!(size(|host: &Host| &host.flags) == 8);
    assert!(core::mem::offset_of!(Host, sums) == 16);
    assert!(size(|host: &Host| &host.sums) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 24);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use crate::push::FlagReduce as Host;
    assert!(core::mem::offset_of!(Host, queue) == 0);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, flags) == 8);
    assert!(size(|host: &Host| &host.flags) == 8);
    assert!(core::mem::offset_of!(Host, sums) == 16);
    assert!(size(|host: &Host| &host.sums) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::FlagSpine as Host;
    assert!(core::mem::offset_of!(Host, queue) == 0);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, sums) == 8);
    assert!(size(|host: &Host| &host.sums) == 8);
    assert!(core::mem::offset_of!(Host, next) == 16);
    assert!(size(|host: &Host| &host.next) == 8);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use gridwalk::Hit as Host;
    assert!(core::mem::offset_of!(Host, t) == 0);
    assert!(size(|host: &Host| &host.t) == 4);
    assert!(core::mem::offset_of!(Host, u) == 4);
    assert!(size(|host: &Host| &host.u) == 4);
    assert!(core::mem::offset_of!(Host, v) == 8);
    assert!(size(|host: &Host| &host.v) == 4);
    assert!(core::mem::offset_of!(Host, triangle) == 12);
    assert!(size(|host: &Host| &host.triangle) == 4);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use gridwalk::gridwalk_core::twin::motion::Influence as Host;
    assert!(core::mem::offset_of!(Host, joint) == 0);
    assert!(size(|host: &Host| &host.joint) == 4);
    assert!(core::mem::offset_of!(Host, weight) == 4);
    assert!(size(|host: &Host| &host.weight) == 4);
    assert!(size_of::<Host>() == 8);
};
const _: () = {
    use crate::push::Interpolate as Host;
    assert!(core::mem::offset_of!(Host, first_positions) == 0);
    assert!(size(|host: &Host| &host.first_positions) == 8);
    assert!(core::mem::offset_of!(Host, first_normals) == 8);
    assert!(size(|host: &Host| &host.first_normals) == 8);
    assert!(core::mem::offset_of!(Host, first_uvs) == 16);
    assert!(size(|host: &Host| &host.first_uvs) == 8);
    assert!(core::mem::offset_of!(Host, second_positions) == 24);
    assert!(size(|host: &Host| &host.second_positions) == 8);
    assert!(core::mem::offset_of!(Host, second_normals) == 32);
    assert!(size(|host: &Host| &host.second_normals) == 8);
    assert!(core::mem::offset_of!(Host, second_uvs) == 40);
    assert!(size(|host: &Host| &host.second_uvs) == 8);
    assert!(core::mem::offset_of!(Host, positions) == 48);
    assert!(size(|host: &Host| &host.positions) == 8);
    assert!(core::mem::offset_of!(Host, normals) == 56);
    assert!(size(|host: &Host| &host.normals) == 8);
    assert!(core::mem::offset_of!(Host, uvs) == 64);
    assert!(size(|host: &Host| &host.uvs) == 8);
    assert!(core::mem::offset_of!(Host, vertex_count) == 72);
    assert!(size(|host: &Host| &host.vertex_count) == 4);
    assert!(core::mem::offset_of!(Host, weight) == 76);
    assert!(size(|host: &Host| &host.weight) == 4);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::push::InterpolateColours as Host;
    assert!(core::mem::offset_of!(Host, first_colours) == 0);
    assert!(size(|host: &Host| &host.first_colours) == 8);
    assert!(core::mem::offset_of!(Host, second_colours) == 8);
    assert!(size(|host: &Host| &host.second_colours) == 8);
    assert!(core::mem::offset_of!(Host, colours) == 16);
    assert!(size(|host: &Host| &host.colours) == 8);
    assert!(core::mem::offset_of!(Host, word_count) == 24);
    assert!(size(|host: &Host| &host.word_count) == 4);
    assert!(core::mem::offset_of!(Host, weight) == 28);
    assert!(size(|host: &Host| &host.weight) == 4);
    assert!(core::mem::offset_of!(Host, has_colours) == 32);
    assert!(size(|host: &Host| &host.has_colours) == 4);
    assert!(core::mem::offset_of!(Host, padding) == 36);
    assert!(size(|host: &Host| &host.padding) == 4);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::layout::Light as Host;
    assert!(core::mem::offset_of!(Host, position) == 0);
    assert!(size(|host: &Host| &host.position) == 12);
    assert!(core::mem::offset_of!(Host, kind) == 12);
    assert!(size(|host: &Host| &host.kind) == 4);
    assert!(core::mem::offset_of!(Host, direction) == 16);
    assert!(size(|host: &Host| &host.direction) == 12);
    assert!(core::mem::offset_of!(Host, cos_inner) == 28);
    assert!(size(|host: &Host| &host.cos_inner) == 4);
    assert!(core::mem::offset_of!(Host, intensity) == 32);
    assert!(size(|host: &Host| &host.intensity) == 12);
    assert!(core::mem::offset_of!(Host, cos_outer) == 44);
    assert!(size(|host: &Host| &host.cos_outer) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::push::LightAdd as Host;
    assert!(core::mem::offset_of!(Host, queue) == 0);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, paths) == 8);
    assert!(size(|host: &Host| &host.paths) == 8);
    assert!(core::mem::offset_of!(Host, occluded) == 16);
    assert!(size(|host: &Host| &host.occluded) == 8);
    assert!(core::mem::offset_of!(Host, film) == 24);
    assert!(size(|host: &Host| &host.film) == 8);
    assert!(core::mem::offset_of!(Host, unfinished) == 32);
    assert!(size(|host: &Host| &host.unfinished) == 8);
    assert!(size_of::<Host>() == 40);
};
const _: () = {
    use crate::push::LightCount as Host;
    assert!(core::mem::offset_of!(Host, scene) == 0);
    assert!(size(|host: &Host| &host.scene) == 8);
    assert!(core::mem::offset_of!(Host, queue) == 8);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 16);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, surfaces) == 24);
    assert!(size(|host: &Host| &host.surfaces) == 8);
    assert!(core::mem::offset_of!(Host, shadows) == 32);
    assert!(size(|host: &Host| &host.shadows) == 8);
    assert!(core::mem::offset_of!(Host, light) == 40);
    assert!(size(|host: &Host| &host.light) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::push::LightEmit as Host;
    assert!(core::mem::offset_of!(Host, scene) == 0);
    assert!(size(|host: &Host| &host.scene) == 8);
    assert!(core::mem::offset_of!(Host, queue) == 8);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 16);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, surfaces) == 24);
    assert!(size(|host: &Host| &host.surfaces) == 8);
    assert!(core::mem::offset_of!(Host, paths) == 32);
    assert!(size(|host: &Host| &host.paths) == 8);
    assert!(core::mem::offset_of!(Host, shadows) == 40);
    assert!(size(|host: &Host| &host.shadows) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 48);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, shadow_rays) == 56);
    assert!(size(|host: &Host| &host.shadow_rays) == 8);
    assert!(core::mem::offset_of!(Host, shadow_paths) == 64);
    assert!(size(|host: &Host| &host.shadow_paths) == 8);
    assert!(core::mem::offset_of!(Host, light) == 72);
    assert!(size(|host: &Host| &host.light) == 4);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::push::LightPass as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, scene) == 8);
    assert!(size(|host: &Host| &host.scene) == 8);
    assert!(core::mem::offset_of!(Host, queue) == 16);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 24);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, passed) == 32);
    assert!(size(|host: &Host| &host.passed) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 40);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::push::MaskedAnyHit as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, scene) == 8);
    assert!(size(|host: &Host| &host.scene) == 8);
    assert!(core::mem::offset_of!(Host, queue) == 16);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 24);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, occluded) == 32);
    assert!(size(|host: &Host| &host.occluded) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 40);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::push::MaskedClosestHit as Host;
    assert!(core::mem::offset_of!(Host, grid) == 0);
    assert!(size(|host: &Host| &host.grid) == 8);
    assert!(core::mem::offset_of!(Host, scene) == 8);
    assert!(size(|host: &Host| &host.scene) == 8);
    assert!(core::mem::offset_of!(Host, queue) == 16);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 24);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 32);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, walks) == 40);
    assert!(size(|host: &Host| &host.walks) == 8);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::layout::Material as Host;
    assert!(core::mem::offset_of!(Host, diffuse) == 0);
    assert!(size(|host: &Host| &host.diffuse) == 12);
    assert!(core::mem::offset_of!(Host, shininess) == 12);
    assert!(size(|host: &Host| &host.shininess) == 4);
    assert!(core::mem::offset_of!(Host, specular) == 16);
    assert!(size(|host: &Host| &host.specular) == 12);
    assert!(core::mem::offset_of!(Host, flags) == 28);
    assert!(size(|host: &Host| &host.flags) == 4);
    assert!(core::mem::offset_of!(Host, emission) == 32);
    assert!(size(|host: &Host| &host.emission) == 12);
    assert!(core::mem::offset_of!(Host, opacity) == 44);
    assert!(size(|host: &Host| &host.opacity) == 4);
    assert!(core::mem::offset_of!(Host, diffuse_map) == 48);
    assert!(size(|host: &Host| &host.diffuse_map) == 4);
    assert!(core::mem::offset_of!(Host, specular_map) == 52);
    assert!(size(|host: &Host| &host.specular_map) == 4);
    assert!(core::mem::offset_of!(Host, emission_map) == 56);
    assert!(size(|host: &Host| &host.emission_map) == 4);
    assert!(core::mem::offset_of!(Host, opacity_map) == 60);
    assert!(size(|host: &Host| &host.opacity_map) == 4);
    assert!(core::mem::offset_of!(Host, normal_map) == 64);
    assert!(size(|host: &Host| &host.normal_map) == 4);
    assert!(core::mem::offset_of!(Host, bump_scale) == 68);
    assert!(size(|host: &Host| &host.bump_scale) == 4);
    assert!(core::mem::offset_of!(Host, number) == 72);
    assert!(size(|host: &Host| &host.number) == 4);
    assert!(core::mem::offset_of!(Host, reserved) == 76);
    assert!(size(|host: &Host| &host.reserved) == 4);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::push::Morph as Host;
    assert!(core::mem::offset_of!(Host, base_positions) == 0);
    assert!(size(|host: &Host| &host.base_positions) == 8);
    assert!(core::mem::offset_of!(Host, base_normals) == 8);
    assert!(size(|host: &Host| &host.base_normals) == 8);
    assert!(core::mem::offset_of!(Host, deltas) == 16);
    assert!(size(|host: &Host| &host.deltas) == 8);
    assert!(core::mem::offset_of!(Host, targets) == 24);
    assert!(size(|host: &Host| &host.targets) == 8);
    assert!(core::mem::offset_of!(Host, positions) == 32);
    assert!(size(|host: &Host| &host.positions) == 8);
    assert!(core::mem::offset_of!(Host, normals) == 40);
    assert!(size(|host: &Host| &host.normals) == 8);
    assert!(core::mem::offset_of!(Host, vertex_count) == 48);
    assert!(size(|host: &Host| &host.vertex_count) == 4);
    assert!(core::mem::offset_of!(Host, target_count) == 52);
    assert!(size(|host: &Host| &host.target_count) == 4);
    assert!(size_of::<Host>() == 56);
};
const _: () = {
    use crate::layout::Path as Host;
    assert!(core::mem::offset_of!(Host, weight) == 0);
    assert!(size(|host: &Host| &host.weight) == 12);
    assert!(core::mem::offset_of!(Host, slot) == 12);
    assert!(size(|host: &Host| &host.slot) == 4);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use crate::push::Place as Host;
    assert!(core::mem::offset_of!(Host, mesh_indices) == 0);
    assert!(size(|host: &Host| &host.mesh_indices) == 8);
    assert!(core::mem::offset_of!(Host, mesh_materials) == 8);
    assert!(size(|host: &Host| &host.mesh_materials) == 8);
    assert!(core::mem::offset_of!(Host, indices) == 16);
    assert!(size(|host: &Host| &host.indices) == 8);
    assert!(core::mem::offset_of!(Host, surrounds) == 24);
    assert!(size(|host: &Host| &host.surrounds) == 8);
    assert!(core::mem::offset_of!(Host, triangle_count) == 32);
    assert!(size(|host: &Host| &host.triangle_count) == 4);
    assert!(core::mem::offset_of!(Host, first_triangle) == 36);
    assert!(size(|host: &Host| &host.first_triangle) == 4);
    assert!(core::mem::offset_of!(Host, first_vertex) == 40);
    assert!(size(|host: &Host| &host.first_vertex) == 4);
    assert!(core::mem::offset_of!(Host, mesh) == 44);
    assert!(size(|host: &Host| &host.mesh) == 4);
    assert!(size_of::<Host>() == 48);
};
const _: () = {
    use crate::layout::QueueHeader as Host;
    assert!(core::mem::offset_of!(Host, count) == 0);
    assert!(size(|host: &Host| &host.count) == 4);
    assert!(core::mem::offset_of!(Host, groups_x) == 4);
    assert!(size(|host: &Host| &host.groups_x) == 4);
    assert!(core::mem::offset_of!(Host, groups_y) == 8);
    assert!(size(|host: &Host| &host.groups_y) == 4);
    assert!(core::mem::offset_of!(Host, groups_z) == 12);
    assert!(size(|host: &Host| &host.groups_z) == 4);
};
const _: () = {
    use gridwalk::Ray as Host;
    assert!(core::mem::offset_of!(Host, origin) == 0);
    assert!(size(|host: &Host| &host.origin) == 12);
    assert!(core::mem::offset_of!(Host, t_min) == 12);
    assert!(size(|host: &Host| &host.t_min) == 4);
    assert!(core::mem::offset_of!(Host, direction) == 16);
    assert!(size(|host: &Host| &host.direction) == 12);
    assert!(core::mem::offset_of!(Host, t_max) == 28);
    assert!(size(|host: &Host| &host.t_max) == 4);
    assert!(size_of::<Host>() == 32);
};
const _: () = {
    use crate::push::ReflectEmit as Host;
    assert!(core::mem::offset_of!(Host, queue) == 0);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, surfaces) == 16);
    assert!(size(|host: &Host| &host.surfaces) == 8);
    assert!(core::mem::offset_of!(Host, paths) == 24);
    assert!(size(|host: &Host| &host.paths) == 8);
    assert!(core::mem::offset_of!(Host, reflects) == 32);
    assert!(size(|host: &Host| &host.reflects) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 40);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, next_rays) == 48);
    assert!(size(|host: &Host| &host.next_rays) == 8);
    assert!(core::mem::offset_of!(Host, next_paths) == 56);
    assert!(size(|host: &Host| &host.next_paths) == 8);
    assert!(size_of::<Host>() == 64);
};
const _: () = {
    use crate::layout::SceneTable as Host;
    assert!(core::mem::offset_of!(Host, positions) == 0);
    assert!(size(|host: &Host| &host.positions) == 8);
    assert!(core::mem::offset_of!(Host, indices) == 8);
    assert!(size(|host: &Host| &host.indices) == 8);
    assert!(core::mem::offset_of!(Host, normals) == 16);
    assert!(size(|host: &Host| &host.normals) == 8);
    assert!(core::mem::offset_of!(Host, uvs) == 24);
    assert!(size(|host: &Host| &host.uvs) == 8);
    assert!(core::mem::offset_of!(Host, surrounds) == 32);
    assert!(size(|host: &Host| &host.surrounds) == 8);
    assert!(core::mem::offset_of!(Host, colours) == 40);
    assert!(size(|host: &Host| &host.colours) == 8);
    assert!(core::mem::offset_of!(Host, mesh_starts) == 48);
    assert!(size(|host: &Host| &host.mesh_starts) == 8);
    assert!(core::mem::offset_of!(Host, materials) == 56);
    assert!(size(|host: &Host| &host.materials) == 8);
    assert!(core::mem::offset_of!(Host, textures) == 64);
    assert!(size(|host: &Host| &host.textures) == 8);
    assert!(core::mem::offset_of!(Host, texels) == 72);
    assert!(size(|host: &Host| &host.texels) == 8);
    assert!(core::mem::offset_of!(Host, srgb) == 80);
    assert!(size(|host: &Host| &host.srgb) == 8);
    assert!(core::mem::offset_of!(Host, lights) == 88);
    assert!(size(|host: &Host| &host.lights) == 8);
    assert!(core::mem::offset_of!(Host, panorama) == 96);
    assert!(size(|host: &Host| &host.panorama) == 8);
    assert!(core::mem::offset_of!(Host, opacities) == 104);
    assert!(size(|host: &Host| &host.opacities) == 8);
    assert!(core::mem::offset_of!(Host, ambient) == 112);
    assert!(size(|host: &Host| &host.ambient) == 12);
    assert!(core::mem::offset_of!(Host, triangle_count) == 124);
    assert!(size(|host: &Host| &host.triangle_count) == 4);
    assert!(core::mem::offset_of!(Host, background) == 128);
    assert!(size(|host: &Host| &host.background) == 64);
};
const _: () = {
    use crate::push::Shade as Host;
    assert!(core::mem::offset_of!(Host, scene) == 0);
    assert!(size(|host: &Host| &host.scene) == 8);
    assert!(core::mem::offset_of!(Host, queue) == 8);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 16);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 24);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, paths) == 32);
    assert!(size(|host: &Host| &host.paths) == 8);
    assert!(core::mem::offset_of!(Host, film) == 40);
    assert!(size(|host: &Host| &host.film) == 8);
    assert!(core::mem::offset_of!(Host, surfaces) == 48);
    assert!(size(|host: &Host| &host.surfaces) == 8);
    assert!(core::mem::offset_of!(Host, reflects) == 56);
    assert!(size(|host: &Host| &host.reflects) == 8);
    assert!(core::mem::offset_of!(Host, unfinished) == 64);
    assert!(size(|host: &Host| &host.unfinished) == 8);
    assert!(core::mem::offset_of!(Host, ways) == 72);
    assert!(size(|host: &Host| &host.ways) == 8);
    assert!(core::mem::offset_of!(Host, waiting) == 80);
    assert!(size(|host: &Host| &host.waiting) == 8);
    assert!(core::mem::offset_of!(Host, flags) == 88);
    assert!(size(|host: &Host| &host.flags) == 4);
    assert!(core::mem::offset_of!(Host, depth) == 92);
    assert!(size(|host: &Host| &host.depth) == 4);
    assert!(core::mem::offset_of!(Host, capacity) == 96);
    assert!(size(|host: &Host| &host.capacity) == 4);
    assert!(size_of::<Host>() == 104);
};
const _: () = {
    use crate::push::Skin as Host;
    assert!(core::mem::offset_of!(Host, base_positions) == 0);
    assert!(size(|host: &Host| &host.base_positions) == 8);
    assert!(core::mem::offset_of!(Host, base_normals) == 8);
    assert!(size(|host: &Host| &host.base_normals) == 8);
    assert!(core::mem::offset_of!(Host, influences) == 16);
    assert!(size(|host: &Host| &host.influences) == 8);
    assert!(core::mem::offset_of!(Host, matrices) == 24);
    assert!(size(|host: &Host| &host.matrices) == 8);
    assert!(core::mem::offset_of!(Host, positions) == 32);
    assert!(size(|host: &Host| &host.positions) == 8);
    assert!(core::mem::offset_of!(Host, normals) == 40);
    assert!(size(|host: &Host| &host.normals) == 8);
    assert!(core::mem::offset_of!(Host, vertex_count) == 48);
    assert!(size(|host: &Host| &host.vertex_count) == 4);
    assert!(core::mem::offset_of!(Host, influences_each) == 52);
    assert!(size(|host: &Host| &host.influences_each) == 4);
    assert!(size_of::<Host>() == 56);
};
const _: () = {
    use crate::layout::Surface as Host;
    assert!(core::mem::offset_of!(Host, start) == 0);
    assert!(size(|host: &Host| &host.start) == 12);
    assert!(core::mem::offset_of!(Host, offset) == 12);
    assert!(size(|host: &Host| &host.offset) == 4);
    assert!(core::mem::offset_of!(Host, normal) == 16);
    assert!(size(|host: &Host| &host.normal) == 12);
    assert!(core::mem::offset_of!(Host, shininess) == 28);
    assert!(size(|host: &Host| &host.shininess) == 4);
    assert!(core::mem::offset_of!(Host, geometric_normal) == 32);
    assert!(size(|host: &Host| &host.geometric_normal) == 12);
    assert!(core::mem::offset_of!(Host, is_hit) == 44);
    assert!(size(|host: &Host| &host.is_hit) == 4);
    assert!(core::mem::offset_of!(Host, diffuse) == 48);
    assert!(size(|host: &Host| &host.diffuse) == 12);
    assert!(core::mem::offset_of!(Host, reserved0) == 60);
    assert!(size(|host: &Host| &host.reserved0) == 4);
    assert!(core::mem::offset_of!(Host, specular) == 64);
    assert!(size(|host: &Host| &host.specular) == 12);
    assert!(core::mem::offset_of!(Host, reserved1) == 76);
    assert!(size(|host: &Host| &host.reserved1) == 4);
    assert!(size_of::<Host>() == 80);
};
const _: () = {
    use crate::layout::Surround as Host;
    assert!(core::mem::offset_of!(Host, material) == 0);
    assert!(size(|host: &Host| &host.material) == 4);
    assert!(core::mem::offset_of!(Host, mesh) == 4);
    assert!(size(|host: &Host| &host.mesh) == 4);
    assert!(size_of::<Host>() == 8);
};
const _: () = {
    use crate::layout::Texture as Host;
    assert!(core::mem::offset_of!(Host, width) == 0);
    assert!(size(|host: &Host| &host.width) == 4);
    assert!(core::mem::offset_of!(Host, height) == 4);
    assert!(size(|host: &Host| &host.height) == 4);
    assert!(core::mem::offset_of!(Host, first_texel) == 8);
    assert!(size(|host: &Host| &host.first_texel) == 4);
    assert!(core::mem::offset_of!(Host, srgb) == 12);
    assert!(size(|host: &Host| &host.srgb) == 4);
    assert!(size_of::<Host>() == 16);
};
const _: () = {
    use crate::push::WaysEmit as Host;
    assert!(core::mem::offset_of!(Host, queue) == 0);
    assert!(size(|host: &Host| &host.queue) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, surfaces) == 16);
    assert!(size(|host: &Host| &host.surfaces) == 8);
    assert!(core::mem::offset_of!(Host, paths) == 24);
    assert!(size(|host: &Host| &host.paths) == 8);
    assert!(core::mem::offset_of!(Host, flags) == 32);
    assert!(size(|host: &Host| &host.flags) == 8);
    assert!(core::mem::offset_of!(Host, offsets) == 40);
    assert!(size(|host: &Host| &host.offsets) == 8);
    assert!(core::mem::offset_of!(Host, ways) == 48);
    assert!(size(|host: &Host| &host.ways) == 8);
    assert!(core::mem::offset_of!(Host, waiting) == 56);
    assert!(size(|host: &Host| &host.waiting) == 8);
    assert!(core::mem::offset_of!(Host, next_rays) == 64);
    assert!(size(|host: &Host| &host.next_rays) == 8);
    assert!(core::mem::offset_of!(Host, next_paths) == 72);
    assert!(size(|host: &Host| &host.next_paths) == 8);
    assert!(core::mem::offset_of!(Host, capacity) == 80);
    assert!(size(|host: &Host| &host.capacity) == 4);
    assert!(size_of::<Host>() == 88);
};
