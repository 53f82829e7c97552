//! Scene files for gridwalk: OBJ with MTL, PLY, glTF, and `scene.toml`, into triangles, materials, textures, lights and cameras, and how
//! they move.
//!
//! [`open`] reads a path with all that moves in it, [`load`] the same at time 0; [`open_reader`] and [`load_reader`] read a stream;
//! [`generate`] makes meshes without files. Files that a scene names are opened only below the scene's own folder unless [`LoadOptions::allow_external_paths`] says
//! otherwise, and only up to the caps of [`LoadOptions`]. No input makes these functions panic.
//!
//! | path | what is read |
//! |---|---|
//! | `name.obj`, `name.ply` | a mesh; also packed by gzip, as `name.ply.gz` |
//! | `name.%04d.obj`, `name.####.ply` | key-frames, by the numbers in their names |
//! | `name.gltf`, `name.glb` | a scene with all that moves in it |
//! | `name.toml`, or a folder with a `scene.toml` | a scene file |
//!
//! # MTL
//! `Kd`, `Ks`, `Ke`, `Ns`, `Ni`, `illum` (3 and above mirrors) and their maps. `d`, or 1 - `Tr` where there is no `d`, below 1 makes a surface
//! that is seen and lit through, times `map_d`; `Tr 1` alone is taken as solid, which a warning tells, since it mostly means that. With `d 1`
//! a `map_d`, or the alpha of `map_Kd`, is a mask and cut at one half.
//!
//! # glTF
//! glTF 2.0 as `.gltf` (with `data:` uris, or files beside it) and `.glb`. Each primitive of each mesh on a node of the default scene is a
//! mesh. One clip is played, and begins anew at its end: nodes move by `STEP`, `LINEAR` and `CUBICSPLINE` keys, vertices by up to eight
//! joints and any number of morph targets. What no clip moves is put where it stands. Cameras and lights (`KHR_lights_punctual`) hang on
//! nodes and move with them; a candela counts as 1 of radiant intensity and a lux as 1 of irradiance, so that white is white under π lux.
//!
//! Metallic-roughness materials become those of this crate. With base colour c, metallic m, roughness r, gloss g = (1 - r)² and the
//! reflectance f of a dielectric (0.04, or as `KHR_materials_ior` and `KHR_materials_specular` say):
//! - a surface with m g of 0.05 and more mirrors, weighted by c m g + f (1 - m) g; a rough metal mirrors less and scatters the rest;
//! - diffuse is c (1 - m g);
//! - the Blinn-Phong exponent is n = 2 / r⁴ - 2, and a surface that is no mirror has highlights of (c m g + f (1 - m)) (n + 8) / 8, 1 at most;
//! - a texture of metallic and roughness makes diffuse and specular textures, and its mean roughness the exponent;
//! - alpha is cut at `alphaCutoff` for `MASK`; for `BLEND` a surface of opacity a (factor x texture x `COLOR_0`) shows a times itself, its
//!   mirror and highlights included, and 1 - a times what lies behind, and lets 1 - a of all light through; both sides of all are seen;
//! - `KHR_materials_unlit` emits its base colour (factor x texture x `COLOR_0`); `KHR_materials_emissive_strength` multiplies the emission;
//!   emission lights nothing else.
//!
//! Textures of a material are looked up by the coordinates of its first one (base colour, metallic-roughness, emission, normals), with
//! `KHR_texture_transform` put into them; one that wants others is not used, which a warning tells. So are textures that are not repeated,
//! occlusion textures, points and lines. An extension that is not known is told by a warning where it is used, and refused where it is
//! required. Morphed meshes without normals get those of their faces.
//!
//! # Scene files
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
//! turntable = 6.0                          # seconds for a turn about the target and the scene's up; the camera moves to its right
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
//! [[material]]                             # also emission, index_of_refraction, illumination, and maps: diffuse_map = "a.png",
//! name = "steel"                           # specular_map, emission_map, opacity_map, normal_map or bump_map, bump_scale
//! diffuse = 0.1
//! specular = 0.8
//! shininess = 200
//! mirror = true                            # as illumination = 3
//! opacity = 0.4                            # below 1 it is seen and lit through, as glTF's BLEND; so is what has blend = true, by opacity_map
//!
//! [[mesh]]
//! file = "teapot.obj"
//! scale = 2                                # then rotate (degrees about x, y, z), then translate; or matrix, rows of 4 numbers
//! rotate = [0, 45, 0]
//! translate = [0, 1, 0]
//!
//! [[mesh]]
//! file = "fox.glb"                         # all its meshes, moving as its clip says; its cameras and lights are not taken
//! clip = "Run"                             # the first without
//! start = 0.5                              # seconds into the clip at time 0
//! loop = false                             # begins anew at its end without
//!
//! [[mesh]]
//! shape = "sphere"                         # plane, box, quad, torus, knot, soup, bumpy
//! radius = 0.5
//! material = "steel"
//! ```
//!
//! # What moves
//! A mesh may be a sequence of key-frames, files whose faces may be others each time. Between two that have the same faces in the same order
//! the vertices move along straight lines; else each stands until the next one. All other keys of a mesh apply to every key-frame.
//!
//! ```toml
//! [[mesh]]
//! sequence = "elephant.%04d.obj"           # or "elephant.####.obj" (four digits or more), or ["a.obj", "b.ply", "a.obj"]
//! fps = 24                                 # key-frames a second
//! start = 0.5                              # seconds into the sequence at time 0
//! loop = true                              # after the last key-frame comes the first
//! interpolate = true                       # false: each key-frame stands until the next one
//! first = 0                                # numbers; what is not given comes from the files that there are
//! last = 23
//! ```
//!
//! Cameras, lights and meshes may have keys; a mesh of key-frames then moves as a whole, too (its `loop` is the sequence's). What a key does not give is as in the key before it, and in the first key
//! as in the camera, the light or the mesh itself. Before the first key and after the last one nothing moves, unless it loops: then the last
//! key is the end at which everything begins anew, and should be as the first (or a whole turn away).
//!
//! ```toml
//! [animation]                              # without: as long as what takes the longest, at the rate of the fastest sequence, or 24
//! duration = 12.0
//! fps = 30
//!
//! [[camera]]
//! name = "flight"
//! interpolation = "smooth"                 # without corners; or "linear", or "step"
//! loop = true
//!
//! [[camera.key]]
//! time = 0                                 # seconds
//! eye = [0, 1, 5]
//! target = [0, 1, 0]
//!
//! [[camera.key]]
//! time = 3
//! eye = [5, 2, 0]                          # also target, up, fov, orthographic_height
//!
//! [[camera.key]]
//! time = 6
//! eye = [0, 1, 5]
//!
//! [[light]]
//! kind = "point"
//! position = [0, 3, 0]
//!
//! [[light.key]]
//! time = 0
//! intensity = 5
//!
//! [[light.key]]
//! time = 2
//! intensity = 20                           # also position, direction, target, irradiance
//!
//! [[mesh]]
//! file = "wheel.obj"
//! loop = true
//! interpolation = "linear"
//!
//! [[mesh.key]]
//! time = 0
//! rotate = [0, 0, 0]
//!
//! [[mesh.key]]
//! time = 1.5
//! rotate = [0, 0, 360]                     # also translate, scale; angles go from one to the other each by itself
//! ```
//!
//! Intensities, scales and angles of view never leave those of their keys on the way. The whole is cyclic where all that moves loops, each a
//! whole number of times.
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
pub use load::{load, load_reader, open, open_reader, scene_of_mesh};
pub use options::LoadOptions;
pub use types::{Background, Bounds, Camera, Light, Material, Mesh, NamedCamera, RenderDefaults, Scene, TONEMAPS, Texture};
