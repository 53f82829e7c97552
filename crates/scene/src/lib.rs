//! Scene files for gridwalk: OBJ with MTL, glTF, and `scene.toml`, into triangles, materials, textures, lights and cameras.
//!
//! [`load`] reads a path, [`load_reader`] an OBJ stream, [`generate`] makes meshes without files. Files that a scene names are opened only
//! below the scene's own folder unless [`LoadOptions::allow_external_paths`] says otherwise, and only up to the caps of [`LoadOptions`]. No
//! input makes these functions panic.
//!
//! The scene file is TOML. All keys are optional but those that its errors ask for:
//!
//! ```toml
//! up = [0, 1, 0]
//! ambient = 0.1                            # a colour: grey, [r, g, b] in linear light, or "#rrggbb" in sRGB
//!
//! [render]
//! size = [800, 600]
//! spp = 4
//! depth = 4
//! exposure = 0.0                           # stops
//! tonemap = "none"                         # none, reinhard, aces, agx, neutral
//! density = 4.0                            # of the grid
//! camera = "front"
//!
//! [background]                             # one of: colour; bottom and top; image (EXR, HDR, PNG, JPEG) with scale and rotation
//! bottom = 0.3
//! top = [0.6, 0.7, 0.9]
//!
//! [[camera]]
//! name = "front"
//! eye = [0, 1, 5]                          # without eye and target: azimuth, elevation, zoom from the automatic view
//! target = [0, 1, 0]
//! fov = 40                                 # or orthographic_height
//!
//! [[light]]
//! kind = "directional"                     # irradiance, direction
//! direction = [-1, -2, -1]
//! irradiance = 2.5
//!
//! [[light]]
//! kind = "spot"                            # or "point": intensity, position; a spot also direction or target, inner, outer (degrees)
//! position = [0, 4, 0]
//! target = [0, 0, 0]
//! outer = 30
//! intensity = [20, 18, 15]
//!
//! [[material]]                             # also emission, opacity, index_of_refraction, illumination, and maps: diffuse_map = "a.png",
//! name = "steel"                           # specular_map, emission_map, opacity_map, normal_map or bump_map, bump_scale
//! diffuse = 0.1
//! specular = 0.8
//! shininess = 200
//! mirror = true                            # as illumination = 3
//!
//! [[mesh]]
//! file = "teapot.obj"
//! scale = 2                                # then rotate (degrees about x, y, z), then translate; or matrix, rows of 4 numbers
//! rotate = [0, 45, 0]
//! translate = [0, 1, 0]
//!
//! [[mesh]]
//! shape = "sphere"                         # plane, box, quad, torus, knot, soup, bumpy
//! radius = 0.5
//! material = "steel"
//! ```
#![forbid(unsafe_code)]

mod animation;
mod assets;
mod curve;
mod description;
mod error;
mod files;
mod frame;
pub mod generate;
mod gltf;
mod key_reader;
mod lines;
mod load;
mod mesh_file;
mod moving;
mod mtl;
mod normals;
mod obj;
mod obj_scene;
mod options;
mod panorama;
mod ply;
mod sequence;
mod suggest;
mod texture;
mod transform;
mod triangulate;
mod types;
mod vector;

pub use animation::{Animation, AnimationOptions, Clip, DEFAULT_FPS, Deformed, Influence, KeyFrame, KeyPair, MorphTarget, Motion, Pose};
pub use error::{Error, Place, Result};
pub use frame::{Framing, frame_camera};
pub use key_reader::KeyReader;
pub use load::{load, load_reader, open, scene_of_mesh};
pub use options::LoadOptions;
pub use types::{Background, Bounds, Camera, Light, Material, Mesh, NamedCamera, RenderDefaults, Scene, TONEMAPS, Texture};
