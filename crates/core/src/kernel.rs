//! What the shader tool knows of a compiled kernel. The tables themselves are generated, one in each crate that owns kernels.

/// Whether the invocations of a kernel work alone or exchange data: the thesis's split between GLSL and CUDA (section 3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// One invocation, one element: no shared memory, no barrier, no subgroup operation, no atomic.
    Map,
    /// Invocations of a workgroup exchange data through shared memory.
    Cooperative,
}

impl Kind {
    /// The name used in statistics and in the folders of the shader sources.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::Map => "map",
            Kind::Cooperative => "cooperative",
        }
    }
}

/// How a kernel uses the memory behind one buffer reference, by the `readonly` and `writeonly` qualifiers of its source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// Declared `readonly`.
    Read,
    /// Declared `writeonly`.
    Write,
    /// Declared with neither.
    ReadWrite,
}

impl Access {
    /// Whether the kernel may read.
    pub const fn reads(self) -> bool {
        matches!(self, Access::Read | Access::ReadWrite)
    }

    /// Whether the kernel may write.
    pub const fn writes(self) -> bool {
        matches!(self, Access::Write | Access::ReadWrite)
    }
}

/// A compiled kernel and what reflection found in it.
#[derive(Debug)]
pub struct Kernel {
    /// File name of the source without its extension; also the label of its launches.
    pub name: &'static str,
    /// By the folder of its source.
    pub kind: Kind,
    /// SPIR-V words.
    pub spirv: &'static [u32],
    /// Invocations a workgroup, unless overridden through `local_size_ids`.
    pub local_size: [u32; 3],
    /// Specialization constants that override `local_size`.
    pub local_size_ids: [Option<u32>; 3],
    /// Bytes of the push-constant block; 0 without one.
    pub push_constant_size: u32,
    /// Every buffer reference of the push-constant block, in order of declaration.
    pub accesses: &'static [(&'static str, Access)],
    /// Identifier, name and default (as bits) of every specialization constant but the workgroup size.
    pub spec_constants: &'static [(u32, &'static str, u32)],
}
