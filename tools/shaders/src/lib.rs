//! The kernels' sources, what is generated from them, and the manifest that ties the two together.
//!
//! The sources lie below `glsl/`; a crate that owns kernels gets the SPIR-V, a manifest and a kernel table. All that is committed, so that
//! building needs no GLSL compiler; [`manifest::stale`] tells from hashes alone whether it is up to date. The compiler itself is behind
//! the feature `compile`.
#![forbid(unsafe_code)]

#[cfg(feature = "compile")]
pub mod generate;
pub mod manifest;
pub mod published;
pub mod source;
#[cfg(feature = "compile")]
pub mod spirv;
#[cfg(feature = "compile")]
pub mod table;
