//! What a loader may open, and how much of it.

/// Limits and permissions of loading. The default reads only below the scene's own folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadOptions {
    /// Also open files outside the scene's folder (by absolute paths, `..` or symbolic links).
    pub allow_external_paths: bool,
    /// Cap for a mesh file in bytes, unpacked, and for what the numbers of a glTF file take in memory.
    pub max_mesh_bytes: u64,
    /// Cap for an MTL file in bytes.
    pub max_material_bytes: u64,
    /// Cap for a scene file in bytes.
    pub max_description_bytes: u64,
    /// Cap for a picture file in bytes; the pixels of one picture take at most four times as much.
    pub max_texture_bytes: u64,
    /// Cap for the width and the height of a picture.
    pub max_texture_size: u32,
    /// Cap for the pixels of all pictures of a scene together, in bytes.
    pub max_texture_total_bytes: u64,
    /// Memory for meshes of key-frames that may be wanted again, in bytes; 0 reads every file anew.
    pub max_key_cache_bytes: u64,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            allow_external_paths: false,
            max_mesh_bytes: 4 << 30,
            max_material_bytes: 16 << 20,
            max_description_bytes: 16 << 20,
            max_texture_bytes: 256 << 20,
            max_texture_size: 16_384,
            max_texture_total_bytes: 4 << 30,
            max_key_cache_bytes: 256 << 20,
        }
    }
}
