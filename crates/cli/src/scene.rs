//! Scenes from the command line.

use gridwalk_render::gridwalk_scene::{LoadOptions, Scene, load, load_reader};

use crate::args::high::Source;
use crate::exit::Result;

/// Loads a scene, and passes its warnings on.
pub fn read(source: &Source, options: &LoadOptions) -> Result<Scene> {
    let scene = match source {
        Source::Stdin => load_reader(&mut std::io::stdin().lock(), None, options)?,
        Source::Path(path) => load(path, options)?,
    };
    for warning in &scene.warnings {
        tracing::warn!("{warning}");
    }
    Ok(scene)
}
