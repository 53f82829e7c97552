//! What can go wrong when recording; what goes wrong on the device is in the build's report.

use ash::vk;

/// Result of this crate's functions.
pub type Result<T> = std::result::Result<T, Error>;

/// Errors of this crate. None of them leaves anything behind, neither on the device nor in a command buffer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A Vulkan call failed.
    #[error("{call} failed: {result}")]
    Vulkan {
        /// The call.
        call: &'static str,
        /// Its result.
        result: vk::Result,
    },
    /// The physical device lacks what the kernels need.
    #[error("the device cannot serve: {}", .missing.join("; "))]
    Unsuitable {
        /// All that is missing.
        missing: Vec<String>,
    },
    /// A chain of features has no place for one that is needed.
    #[error("the chain of features holds no {structure}: is its sType set?")]
    Chain {
        /// The structure that would have it.
        structure: &'static str,
    },
    /// A capacity is beyond what a grid can hold.
    #[error("a capacity of {given} {what} is beyond the limit of {limit}")]
    Capacity {
        /// Triangles, cells, pairs or rays.
        what: &'static str,
        /// What was asked for.
        given: u64,
        /// What is possible.
        limit: u64,
    },
    /// A region needs more memory than the device can give in one buffer.
    #[error("the {region} of {needed} bytes is beyond the device's limit of {limit} bytes a buffer: lower the capacity")]
    DeviceLimit {
        /// Grid, scratch or report.
        region: &'static str,
        /// Bytes.
        needed: u64,
        /// Bytes.
        limit: u64,
    },
    /// A region that was passed cannot be used.
    #[error("the {region} region is unusable: {reason}")]
    Region {
        /// Which one.
        region: &'static str,
        /// Why.
        reason: String,
    },
    /// An option has no meaning.
    #[error("{option} = {value}: {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// What was given.
        value: String,
        /// What is possible.
        expected: &'static str,
    },
}

impl Error {
    pub(crate) fn vulkan(call: &'static str) -> impl FnOnce(vk::Result) -> Error {
        move |result| Error::Vulkan { call, result }
    }
}
