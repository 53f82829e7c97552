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

/// Kernel `copy`, from `tools/bench/shaders/copy.comp`.
pub static COPY: Kernel = Kernel {
    name: "copy",
    kind: Kind::Map,
    spirv: spirv!("../spirv/copy.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 24,
    accesses: &[("from", Access::Read), ("to", Access::Write)],
    spec_constants: &[(20, "STRANDS", 1)],
};

/// Kernel `ray_query`, from `tools/bench/shaders/ray_query.comp`.
pub static RAY_QUERY: Kernel = Kernel {
    name: "ray_query",
    kind: Kind::Map,
    spirv: spirv!("../spirv/ray_query.spv"),
    local_size: [64, 1, 1],
    local_size_ids: [Some(0), None, None],
    push_constant_size: 40,
    accesses: &[("rays", Access::Read), ("hits", Access::Write)],
    spec_constants: &[(1, "ANY", 0), (20, "STRANDS", 1)],
};

/// Every kernel of this crate, in order of name.
pub static ALL: &[&Kernel] = &[&COPY, &RAY_QUERY];

/// Bytes of a field, found by a function that takes it.
const fn size<T, F>(_: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

// The host's structures lie in memory as the kernels read them.
const _: () = {
    use crate::push::Copy as Host;
    assert!(core::mem::offset_of!(Host, from) == 0);
    assert!(size(|host: &Host| &host.from) == 8);
    assert!(core::mem::offset_of!(Host, to) == 8);
    assert!(size(|host: &Host| &host.to) == 8);
    assert!(core::mem::offset_of!(Host, count) == 16);
    assert!(size(|host: &Host| &host.count) == 4);
    assert!(size_of::<Host>() == 24);
};
const _: () = {
    use crate::push::RayQuery as Host;
    assert!(core::mem::offset_of!(Host, structure) == 0);
    assert!(size(|host: &Host| &host.structure) == 8);
    assert!(core::mem::offset_of!(Host, rays) == 8);
    assert!(size(|host: &Host| &host.rays) == 8);
    assert!(core::mem::offset_of!(Host, hits) == 16);
    assert!(size(|host: &Host| &host.hits) == 8);
    assert!(core::mem::offset_of!(Host, first) == 24);
    assert!(size(|host: &Host| &host.first) == 4);
    assert!(core::mem::offset_of!(Host, count) == 28);
    assert!(size(|host: &Host| &host.count) == 4);
    assert!(core::mem::offset_of!(Host, stride) == 32);
    assert!(size(|host: &Host| &host.stride) == 4);
    assert!(size_of::<Host>() == 40);
};
