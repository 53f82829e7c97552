//! Pictures by gridwalk: device, frame loop, shading and image files.

mod context;
mod device;
mod error;
pub mod image;
mod layers;

pub use context::{Buffer, BufferDesc, BufferKind, Context, ContextDesc};
pub use device::{DeviceInfo, DeviceKind, DeviceLimits, DeviceSelector, list_devices};
pub use error::{Error, Result};
pub use layers::{Layer, LayerData, Layers};

pub use gridwalk;
pub use gridwalk_scene;
