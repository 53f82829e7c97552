//! Scenes that move, on the device: the scene and the grid of one time after another.

mod stats;

use crate::{BuildSettings, Context, Error, GpuScene, Grid, GridBuilder, Result};
use gridwalk_scene::{Animation, KeyReader, Motion, Scene};

pub use stats::SeekStats;

/// How an animation is to be played.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlayerOptions {
    /// How the grids are to be built.
    pub build: BuildSettings,
    /// Bytes of the memory through which key-frames travel to the device; larger ones go through in pieces.
    pub staging_bytes: u64,
}

impl Default for PlayerOptions {
    fn default() -> Self {
        PlayerOptions { build: BuildSettings::default(), staging_bytes: 32 << 20 }
    }
}

/// An animation in device memory, with the grid over what is to be seen at one time.
#[derive(Debug)]
pub struct Player {
    context: Context,
    animation: Animation,
    now: Scene,
    reader: KeyReader,
    scene: GpuScene,
    grid: Grid,
}

impl Player {
    /// Brings an animation to the device, as it is at time 0.
    ///
    /// # Errors
    /// Those of [`GpuScene::upload`], of [`GridBuilder::build`] and of [`Animation::reader`].
    pub fn new(context: &Context, animation: Animation, options: &PlayerOptions) -> Result<Player> {
        let reader = animation.reader()?;
        let scene = GpuScene::upload(context, &animation.scene)?;
        let grid = GridBuilder::new(context)?.build(&scene, &options.build)?;
        Ok(Player { context: context.clone(), now: animation.scene.clone(), animation, reader, scene, grid })
    }

    /// Brings scene and grid to a time in seconds. `upcoming` are the times of the next frames, soonest first, whose key-frames are read
    /// ahead. The grid is built only when the geometry differs from that of the last time.
    ///
    /// # Errors
    /// [`Error::KeyFrame`] for a key-frame that is missing or broken, at the time that needs it; [`Error::Setting`] for a time that is not
    /// a number; those of [`GpuScene::upload`] and of [`Grid::rebuild`]. Other times can be sought afterwards.
    pub fn seek(&mut self, time: f64, _upcoming: &[f64]) -> Result<SeekStats> {
        if !time.is_finite() {
            return Err(Error::Setting { setting: "time", value: time.to_string(), expected: "a finite number of seconds" });
        }
        for (index, (mesh, motion)) in self.now.meshes.iter_mut().zip(&self.animation.motions).enumerate() {
            if matches!(motion, Motion::Keys) {
                *mesh = self.reader.read(index, self.animation.keys_at(index, time).first)?.mesh;
            }
        }
        self.now.lights = self.animation.lights(time);
        self.scene = GpuScene::upload(&self.context, &self.now)?;
        self.grid.rebuild(&self.scene)?;
        Ok(SeekStats { rebuilt: true, ..SeekStats::new(self.grid.stats()) })
    }

    /// Builds the grid again from nothing, to measure.
    ///
    /// # Errors
    /// As [`Grid::rebuild`].
    pub fn rebuild(&mut self) -> Result<()> {
        self.grid.rebuild(&self.scene)
    }

    /// The animation.
    pub fn animation(&self) -> &Animation {
        &self.animation
    }

    /// The scene at the time that was last sought; at time 0 before.
    pub fn scene(&self) -> &GpuScene {
        &self.scene
    }

    /// The grid over [`Player::scene`].
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
}
