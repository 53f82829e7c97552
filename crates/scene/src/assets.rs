//! What the files of a scene share: where they may be opened, and the tables that they add to.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use crate::files::Files;
use crate::load::empty;
use crate::texture::Textures;
use crate::{LoadOptions, Material, Mesh, Result, Scene};

/// The tables of a scene that is being read. A copy goes on reading where the first one stopped, with the same numbers.
#[derive(Clone, Debug)]
pub(crate) struct Assets {
    pub(crate) files: Arc<Files>,
    pub(crate) options: Arc<LoadOptions>,
    pub(crate) textures: Textures,
    /// Entry 0 is the default material.
    materials: Vec<Material>,
    by_name: HashMap<String, Vec<u32>>,
    pub(crate) warnings: Vec<String>,
}

impl Assets {
    /// Files are opened below `folder`; without one (a stream) none is.
    pub(crate) fn new(folder: Option<&Path>, options: &LoadOptions) -> Result<Self> {
        let files = Arc::new(Files::new(folder, options.allow_external_paths)?);
        let options = Arc::new(options.clone());
        let mut assets = Self {
            textures: Textures::new(files.clone(), options.clone()),
            files,
            options,
            materials: Vec::new(),
            by_name: HashMap::new(),
            warnings: Vec::new(),
        };
        assets.material(Material::default());
        Ok(assets)
    }

    /// The number of a material, added to the table unless it holds an equal one.
    pub(crate) fn material(&mut self, material: Material) -> u32 {
        let named = self.by_name.entry(material.name.clone()).or_default();
        if let Some(&known) = named.iter().find(|&&known| self.materials.get(known as usize) == Some(&material)) {
            return known;
        }
        // A material takes bytes of a file that is held in memory: far below 2^32 of them.
        let number = self.materials.len() as u32;
        named.push(number);
        self.materials.push(material);
        number
    }

    /// The materials so far.
    pub(crate) fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// A scene of these meshes with all tables; what is left goes on counting from there.
    pub(crate) fn scene(&mut self, meshes: Vec<Mesh>) -> Scene {
        Scene {
            meshes,
            materials: self.materials.clone(),
            textures: self.textures.take(),
            warnings: std::mem::take(&mut self.warnings),
            ..empty()
        }
    }
}
