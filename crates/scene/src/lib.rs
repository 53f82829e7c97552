//! Scene files: meshes, materials, textures, lights and cameras.
#![forbid(unsafe_code)]
