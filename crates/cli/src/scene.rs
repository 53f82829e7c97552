//! Scenes from the command line.

use gridwalk_render::gridwalk_scene::{self, Animation, AnimationOptions, LoadOptions, Scene, load, load_reader, open_reader};

use crate::args::high::Source;
use crate::exit::Result;

/// Loads a scene as it is at time 0, and passes its warnings on.
pub fn read(source: &Source, options: &LoadOptions) -> Result<Scene> {
    let scene = match source {
        Source::Stdin => load_reader(&mut std::io::stdin().lock(), None, options)?,
        Source::Path(path) => load(path, options)?,
    };
    warn(&scene);
    Ok(scene)
}

/// Loads a scene with all that moves in it, and passes its warnings on.
pub fn open(source: &Source, options: &LoadOptions, clip: Option<&str>) -> Result<Animation> {
    let mut wanted = AnimationOptions::default();
    wanted.clip = clip.map(str::to_owned);
    let animation = match source {
        Source::Stdin => open_reader(&mut std::io::stdin().lock(), None, options, &wanted)?,
        Source::Path(path) => gridwalk_scene::open(path, options, &wanted)?,
    };
    warn(&animation.scene);
    Ok(animation)
}

fn warn(scene: &Scene) {
    for warning in &scene.warnings {
        tracing::warn!("{warning}");
    }
}
