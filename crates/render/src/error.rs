//! What can go wrong.

use ash::vk;

/// Result of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a scene and its picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The Vulkan loader cannot be loaded, or makes no instance.
    #[error(
        "no Vulkan on this machine: {reason}; install a driver, or Mesa's lavapipe (Debian: mesa-vulkan-drivers libvulkan1), which needs no GPU"
    )]
    NoVulkan {
        /// What the loader said.
        reason: String,
    },
    /// There is no device that can serve.
    #[error("no Vulkan device can serve{}", list(.reasons))]
    NoDevice {
        /// Every device with all that it lacks.
        reasons: Vec<String>,
    },
    /// No device is the one asked for.
    #[error("no Vulkan device matches \"{selector}\"; there are{}", list(.devices))]
    NoSuchDevice {
        /// What was asked for.
        selector: String,
        /// The devices there are.
        devices: Vec<String>,
    },
    /// The validation layer was asked for and is not installed.
    #[error("the Khronos validation layer is not installed (Debian: vulkan-validationlayers)")]
    NoValidationLayer,
    /// The validation layer complained.
    #[error("{} validation messages{}", .messages.len(), list(.messages))]
    Validation {
        /// What it said.
        messages: Vec<String>,
    },
    /// An allocation is larger than what the device has or allows.
    #[error("not enough device memory for {name}: it needs {} MiB, {} MiB are to be had", mib(*.needed), mib(*.available))]
    OutOfDeviceMemory {
        /// Name of the buffer.
        name: String,
        /// Bytes asked for.
        needed: u64,
        /// Bytes that could still be allocated in one piece.
        available: u64,
    },
    /// The driver ran out of host memory.
    #[error("not enough host memory")]
    OutOfHostMemory,
    /// The device was lost; nothing further can be done with this context.
    #[error("the device was lost (a driver reset or a crash); make a new context")]
    DeviceLost,
    /// A submission did not come back in time; nothing further can be done with this context.
    #[error("{label} did not finish within {seconds} s; the device is given up")]
    Timeout {
        /// What was submitted.
        label: String,
        /// The limit.
        seconds: u64,
    },
    /// Another failure of a Vulkan call.
    #[error("{call} failed: {result}")]
    Vulkan {
        /// The call.
        call: &'static str,
        /// What it returned.
        result: vk::Result,
    },
    /// The allocator failed for another reason than memory.
    #[error("cannot allocate {name}: {reason}")]
    Allocator {
        /// Name of the buffer.
        name: String,
        /// What the allocator said.
        reason: String,
    },
    /// A buffer was read or written beyond its end.
    #[error("{name} holds {size} bytes; bytes {begin} to {end} are beyond it")]
    OutOfRange {
        /// Name of the buffer.
        name: String,
        /// Its size in bytes.
        size: u64,
        /// First byte asked for.
        begin: u64,
        /// End of the bytes asked for.
        end: u64,
    },
    /// The library refused what it was asked to record.
    #[error(transparent)]
    Gridwalk(#[from] gridwalk::Error),
    /// The grid does not fit into what the device has or the library can hold.
    #[error("the grid needs {pairs} pairs of a cell and a triangle, more than can be held: lower the density or the resolution")]
    TooDense {
        /// Pairs that the build counted; 4294967295 stands for that many or more.
        pairs: u32,
    },
    /// A scene cannot be brought to the device.
    #[error("the scene cannot be used: {reason}")]
    Scene {
        /// What is wrong with it.
        reason: String,
    },
    /// A setting has no meaning.
    #[error("{setting} = {value}: {expected}")]
    Setting {
        /// Its name.
        setting: &'static str,
        /// What was given.
        value: String,
        /// What is possible.
        expected: &'static str,
    },
    /// A key-frame cannot be read.
    #[error(transparent)]
    KeyFrame(#[from] gridwalk_scene::Error),
    /// The progress callback asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// A layer does not fit the picture.
    #[error("layer {name}: {reason}")]
    Layer {
        /// Name of the layer.
        name: String,
        /// What is wrong.
        reason: String,
    },
}

impl Error {
    /// A closure for `map_err` that tells the failures with a meaning from the others.
    pub(crate) fn vulkan(call: &'static str) -> impl Fn(vk::Result) -> Error {
        move |result| match result {
            vk::Result::ERROR_DEVICE_LOST => Error::DeviceLost,
            vk::Result::ERROR_OUT_OF_HOST_MEMORY => Error::OutOfHostMemory,
            result => Error::Vulkan { call, result },
        }
    }
}

fn list(lines: &[String]) -> String {
    if lines.is_empty() { ": there is none".to_owned() } else { lines.iter().map(|line| format!("\n  {line}")).collect() }
}

fn mib(bytes: u64) -> String {
    format!("{:.1}", bytes as f64 / (1024.0 * 1024.0))
}
