//! A scene that moves: what stays is a [`Scene`], what moves is told mesh by mesh, camera by camera, light by light, for any time.
//!
//! Times are in seconds from the beginning of the animation. The same time gives the same answer whatever was asked before, so a frame
//! rendered alone equals the frame of a run.

use crate::{Camera, Light, Material, Mesh, Result, Scene, Texture};

/// What of an animation is wanted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct AnimationOptions {
    /// The clip to play, by name; the first without.
    pub clip: Option<String>,
}

/// A clip that a file names.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Clip {
    /// Unique within the animation.
    pub name: String,
    /// Seconds.
    pub duration: f64,
}

/// A scene with time.
#[derive(Debug)]
pub struct Animation {
    /// The scene at time 0, in world space.
    pub scene: Scene,
    /// How each mesh of the scene moves, in the order of [`Scene::meshes`].
    pub motions: Vec<Motion>,
    /// The clips that the files name; empty where there is but one course of time.
    pub clips: Vec<Clip>,
    /// Seconds; 0 for a scene that stands still.
    pub duration: f64,
    /// Frames a second that the files were made for.
    pub fps: f64,
    /// Whether the end goes over into the beginning: the frame at `duration` is then that at 0.
    pub cyclic: bool,
}

/// How a mesh moves.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum Motion {
    /// Not at all: [`Scene::meshes`] holds it.
    #[default]
    Still,
    /// By key-frames, each a mesh of its own: [`Animation::keys_at`], [`KeyReader::read`].
    Keys,
    /// By morph targets, a skin, or a moving node: [`Animation::pose`].
    Deformed(Box<Deformed>),
}

/// The key-frames that a mesh is made of at some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KeyPair {
    /// The key-frame at or before the time.
    pub first: u32,
    /// The one after it; `first` where `weight` is 0.
    pub second: u32,
    /// Part of `second`, from 0 to below 1. The two are blended where their triangles have the same indices; else `first` alone counts.
    pub weight: f32,
}

/// A key-frame as read from its file, in world space.
#[derive(Clone, Debug, Default)]
pub struct KeyFrame {
    /// The mesh. Its materials count over those of the scene and all that were added by this reader so far, this key-frame's included.
    pub mesh: Mesh,
    /// Materials that no key-frame before had; their maps count over the textures likewise.
    pub added_materials: Vec<Material>,
    /// Textures that no key-frame before had.
    pub added_textures: Vec<Texture>,
    /// What was odd about the file.
    pub warnings: Vec<String>,
    /// Milliseconds of reading the file's bytes; 0 when they were still at hand.
    pub read_ms: f64,
    /// Milliseconds of making the mesh of them.
    pub parse_ms: f64,
}

/// Reads key-frames; made by [`Animation::reader`] for a thread of its own.
#[derive(Debug)]
pub struct KeyReader {}

/// A mesh that is bent by morph targets, a skin or a node: first the targets, weighted, are added to the base, then each vertex is moved
/// by the blend of its joints' matrices.
#[derive(Clone, Debug, Default)]
pub struct Deformed {
    /// Positions before all motion, one a vertex of the mesh.
    pub positions: Vec<[f32; 3]>,
    /// Normals before all motion, of length one.
    pub normals: Vec<[f32; 3]>,
    /// Targets, in the order of [`Pose::weights`].
    pub targets: Vec<MorphTarget>,
    /// Which matrices move a vertex; empty: the first one moves all.
    pub influences: Vec<Influence>,
    /// Influences of each vertex; `influences` holds so many times the vertices.
    pub influences_each: u32,
    /// Matrices of a pose, 1 or more; each joint of an influence is below it.
    pub matrix_count: u32,
}

/// What a morph target adds at weight 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// One a vertex, or empty for none.
    pub positions: Vec<[f32; 3]>,
    /// One a vertex, or empty for none.
    pub normals: Vec<[f32; 3]>,
}

/// A joint's part in a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influence {
    /// Number of a matrix.
    pub joint: u32,
    /// The weights of a vertex sum to 1.
    pub weight: f32,
}

/// A deformed mesh at some time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Three rows of four numbers each, from the mesh's own space to the world's: [`Deformed::matrix_count`] of them.
    pub matrices: Vec<[[f32; 4]; 3]>,
    /// One a morph target.
    pub weights: Vec<f32>,
}

impl Animation {
    /// A scene that stands still.
    pub fn still(scene: Scene) -> Animation {
        let motions = vec![Motion::Still; scene.meshes.len()];
        Animation { scene, motions, clips: Vec::new(), duration: 0.0, fps: DEFAULT_FPS, cyclic: false }
    }

    /// Frames from the beginning to the end at a rate; 1 or more.
    pub fn frame_count(&self, fps: f64) -> u64 {
        let frames = self.duration * fps;
        // A frame that rounding puts a little behind the end is still one.
        let count = if self.cyclic { frames.round() } else { (frames + 1e-6).floor() + 1.0 };
        count.max(1.0) as u64
    }

    /// The key-frames of a mesh at a time. For meshes without key-frames the answer has no meaning.
    pub fn keys_at(&self, _mesh: usize, _time: f64) -> KeyPair {
        KeyPair::default()
    }

    /// Brings `pose` to that of a deformed mesh at a time, without allocating where it held one of the same mesh before.
    pub fn pose(&self, _mesh: usize, _time: f64, _pose: &mut Pose) {}

    /// As [`Scene::camera`], at a time.
    pub fn camera(&self, name: Option<&str>, _time: f64) -> Option<Camera> {
        self.scene.camera(name)
    }

    /// The lights at a time: always as many as [`Scene::lights`], each of the same kind.
    pub fn lights(&self, _time: f64) -> Vec<Light> {
        self.scene.lights.clone()
    }

    /// A reader of key-frames, for a thread of its own.
    ///
    /// # Errors
    /// A folder that is there no more.
    pub fn reader(&self) -> Result<KeyReader> {
        Ok(KeyReader {})
    }
}

impl KeyReader {
    /// Reads a key-frame of a mesh.
    ///
    /// # Errors
    /// A file that is missing or broken, by name.
    pub fn read(&mut self, _mesh: usize, _key: u32) -> Result<KeyFrame> {
        Ok(KeyFrame::default())
    }
}

/// Frames a second where no file says.
pub const DEFAULT_FPS: f64 = 24.0;
