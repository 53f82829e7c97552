//! A scene that moves: what stays is a [`Scene`], what moves is told mesh by mesh, camera by camera, light by light, for any time.
//!
//! Times are in seconds from the beginning of the animation. The same time gives the same answer whatever was asked before, so a frame
//! rendered alone equals the frame of a run.

use std::sync::{Arc, OnceLock};

use crate::curve::Curve;
use crate::gltf::Rig;
use crate::key_reader::KeyReader;
use crate::moving::{CameraCurve, LightCurve, PlacedCurve, Turntable};
use crate::sequence::Sequence;
use crate::transform::Edit;
use crate::vector::normalised;
use crate::{Bounds, Camera, Framing, Light, Material, Mesh, Result, Scene, Texture};

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
    /// Seconds, of that which takes the longest; 0 for a scene that stands still.
    pub duration: f64,
    /// Frames a second that the files were made for: the most that any of them asks for.
    pub fps: f64,
    /// Whether the end goes over into the beginning: the frame at `duration` is then that at 0. So it is where all that moves loops, each
    /// a whole number of times.
    pub cyclic: bool,
    pub(crate) tracks: Tracks,
    /// As it was when the scene was read; `None` where nothing has key-frames.
    pub(crate) keys: Option<KeyReader>,
    /// Of all that is shown, once it was asked for.
    bounds: OnceLock<Option<Bounds>>,
}

/// How everything moves: an entry for each mesh, camera and light of the scene, in its order; what has none stands still.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracks {
    pub(crate) meshes: Vec<MeshTrack>,
    pub(crate) cameras: Vec<CameraTrack>,
    pub(crate) lights: Vec<LightTrack>,
}

/// How a mesh moves.
#[derive(Clone, Debug, Default)]
pub(crate) enum MeshTrack {
    #[default]
    Still,
    Keys(KeyTrack),
    Rig(RigTrack),
    Placed(PlacedCurve),
}

/// How a camera moves.
#[derive(Clone, Debug, Default)]
pub(crate) enum CameraTrack {
    #[default]
    Still,
    Rig(RigTrack),
    Keys(CameraCurve),
    /// The scene's camera is where it begins.
    Turntable(Turntable),
}

/// How a light moves.
#[derive(Clone, Debug, Default)]
pub(crate) enum LightTrack {
    #[default]
    Still,
    Rig(RigTrack),
    Keys(LightCurve),
}

/// A mesh's course through a sequence of files.
#[derive(Clone, Debug)]
pub(crate) struct KeyTrack {
    pub(crate) sequence: Arc<Sequence>,
    /// Key-frames a second, finite and above 0.
    pub(crate) fps: f64,
    /// Seconds into the sequence at time 0.
    pub(crate) start: f64,
    pub(crate) looped: bool,
    /// Without, a key-frame stands until the next one.
    pub(crate) interpolate: bool,
    /// What is done to each key-frame.
    pub(crate) edit: Edit,
    /// Moves the mesh as a whole.
    pub(crate) placed: Option<PlacedCurve>,
}

/// A mesh, a camera or a light of a glTF file.
#[derive(Clone, Debug)]
pub(crate) struct RigTrack {
    pub(crate) rig: Arc<Rig>,
    /// Among those of its kind.
    pub(crate) number: usize,
}

impl RigTrack {
    /// What tells how a mesh of a rig moves.
    pub(crate) fn mesh(rig: &Arc<Rig>, number: usize, deformed: Option<Box<Deformed>>) -> (MeshTrack, Motion) {
        match deformed {
            Some(deformed) => (MeshTrack::Rig(Self { rig: rig.clone(), number }), Motion::Deformed(deformed)),
            None => (MeshTrack::Still, Motion::Still),
        }
    }
}

/// How long something moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Course {
    /// Until it stands still, or begins anew.
    pub(crate) seconds: f64,
    pub(crate) looped: bool,
    /// What its file was made for, if it says so.
    pub(crate) fps: Option<f64>,
}

impl Course {
    /// That of a scene file's keys.
    pub(crate) fn of<const N: usize>(curve: &Curve<N>) -> Self {
        Self { seconds: curve.seconds(), looped: curve.looped(), fps: None }
    }
}

/// How far from a key-frame, as a part of the way to the next one, a time still counts as the key-frame's: far above what is lost by
/// computing a frame's time, far below what is seen.
const SNAP: f64 = 1e-6;

impl KeyTrack {
    pub(crate) fn at(&self, time: f64) -> KeyPair {
        let count = self.sequence.key_count();
        let keys = f64::from(count);
        let place = (time + self.start) * self.fps;
        let place = if place.is_finite() { place } else { 0.0 };
        let nearest = place.round();
        let place = if (place - nearest).abs() < SNAP { nearest } else { place };
        let place = if self.looped { place.rem_euclid(keys) } else { place.clamp(0.0, keys - 1.0) };
        let first = place.floor();
        let weight = if self.interpolate { (place - first) as f32 } else { 0.0 };
        // Of a negative place next to 0 the remainder may round to the divisor.
        let first = if first >= keys { 0 } else { first as u32 };
        let second = if weight == 0.0 { first } else { (first + 1) % count };
        KeyPair { first, second, weight }
    }

    pub(crate) fn course(&self) -> Course {
        let keys = f64::from(self.sequence.key_count());
        let seconds = if self.looped { keys / self.fps } else { ((keys - 1.0) / self.fps - self.start).max(0.0) };
        Course { seconds, looped: self.looped, fps: Some(self.fps) }
    }
}

/// Brings a key-frame nearer to the next one, where the two have the same triangles.
pub(crate) fn blend(first: &mut Mesh, second: &Mesh, weight: f32) {
    if weight == 0.0 || first.indices != second.indices || first.positions.len() != second.positions.len() {
        return;
    }
    let towards = |from: f32, to: f32| from + (to - from) * weight;
    let values = first.positions.as_flattened_mut().iter_mut().zip(second.positions.as_flattened());
    values.chain(first.uvs.as_flattened_mut().iter_mut().zip(second.uvs.as_flattened())).for_each(|(from, to)| *from = towards(*from, *to));
    if first.colours.len() == second.colours.len() {
        let colours = first.colours.as_flattened_mut().iter_mut().zip(second.colours.as_flattened());
        colours.for_each(|(from, to)| *from = towards(*from, *to));
    }
    for (from, to) in first.normals.iter_mut().zip(&second.normals) {
        let sum = std::array::from_fn(|axis| f64::from(towards(from[axis], to[axis])));
        if let Some(normal) = normalised(sum) {
            *from = normal.map(|value| value as f32);
        }
    }
}

/// How a mesh moves.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum Motion {
    /// Not at all: [`Scene::meshes`] holds it.
    #[default]
    Still,
    /// By key-frames, each a mesh of its own: [`Animation::keys_at`], [`KeyReader::read`]; some as a whole, too: [`Animation::pose`].
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

/// A key-frame as read from its file, in world space, or before the matrix of [`Animation::pose`] where its mesh has one.
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
        Animation {
            scene,
            motions,
            clips: Vec::new(),
            duration: 0.0,
            fps: DEFAULT_FPS,
            cyclic: false,
            tracks: Tracks::default(),
            keys: None,
            bounds: OnceLock::new(),
        }
    }

    /// Sets duration, rate and whether the end goes over into the beginning, from all that moves. What is given goes before it.
    pub(crate) fn set_course(&mut self, courses: &[Course], seconds: Option<f64>, fps: Option<f64>) {
        // What has one key does not move.
        let courses: Vec<&Course> = courses.iter().filter(|course| course.seconds > 0.0).collect();
        let longest = courses.iter().fold(0.0_f64, |longest, course| longest.max(course.seconds));
        self.duration = seconds.unwrap_or(longest);
        let fastest = courses.iter().filter_map(|course| course.fps).reduce(f64::max);
        self.fps = fps.or(fastest).unwrap_or(DEFAULT_FPS);
        let whole = |times: f64| times > 0.5 && (times - times.round()).abs() < SNAP;
        self.cyclic = self.duration > 0.0
            && !courses.is_empty()
            && courses.iter().all(|course| course.looped && whole(self.duration / course.seconds));
    }

    /// Frames from the beginning to the end at a rate; 1 or more.
    pub fn frame_count(&self, fps: f64) -> u64 {
        let frames = self.duration * fps;
        // A frame that rounding puts a little behind the end is still one.
        let count = if self.cyclic { frames.round() } else { (frames + 1e-6).floor() + 1.0 };
        count.max(1.0) as u64
    }

    /// The key-frames of a mesh at a time. For meshes without key-frames the answer has no meaning.
    pub fn keys_at(&self, mesh: usize, time: f64) -> KeyPair {
        match self.tracks.meshes.get(mesh) {
            Some(MeshTrack::Keys(track)) => track.at(time),
            _ => KeyPair::default(),
        }
    }

    /// Number of key-frames of a mesh; 0 for one that has none.
    pub fn key_count(&self, mesh: usize) -> u32 {
        match self.tracks.meshes.get(mesh) {
            Some(MeshTrack::Keys(track)) => track.sequence.key_count(),
            _ => 0,
        }
    }

    /// Brings `pose` to that of a deformed mesh at a time, without allocating where it held one of the same mesh before. For a mesh of
    /// key-frames that moves as a whole, too, it holds the one matrix that takes it from its own space to the world; for others it becomes
    /// empty.
    pub fn pose(&self, mesh: usize, time: f64, pose: &mut Pose) {
        match self.tracks.meshes.get(mesh) {
            Some(MeshTrack::Rig(track)) => track.rig.pose(track.number, time, pose),
            Some(MeshTrack::Placed(curve) | MeshTrack::Keys(KeyTrack { placed: Some(curve), .. })) => curve.pose(time, pose),
            _ => {
                pose.matrices.clear();
                pose.weights.clear();
            }
        }
    }

    /// As [`Scene::camera`], at a time. Without cameras in the scene it is that of [`Animation::frame`], so that it stands still.
    pub fn camera(&self, name: Option<&str>, time: f64) -> Option<Camera> {
        let number = self.scene.camera_number(name);
        match number.and_then(|number| self.tracks.cameras.get(number)) {
            Some(CameraTrack::Rig(track)) => track.rig.camera(track.number, time),
            Some(CameraTrack::Keys(curve)) => Some(curve.at(time)),
            Some(CameraTrack::Turntable(turntable)) => self.scene.camera(name).map(|camera| turntable.at(&camera, time)),
            Some(CameraTrack::Still) => self.scene.camera(name),
            None if name.is_none() && number.is_none() => Some(self.frame(&Framing { up: self.scene.up, ..Framing::default() })),
            None => self.scene.camera(name),
        }
    }

    /// Whether the file says what a camera looks at. One of glTF has a direction alone, and its target is some point on the way.
    pub fn has_target(&self, name: Option<&str>) -> bool {
        let track = self.scene.camera_number(name).and_then(|number| self.tracks.cameras.get(number));
        !matches!(track, Some(CameraTrack::Rig(_)))
    }

    /// As [`Scene::frame`], one camera for every frame. What is deformed, or moves as a whole, is shown wherever it comes in the course of
    /// the animation, as far as up to 32 times of it tell (fewer for many vertices); key-frames count as they are at time 0. The box is
    /// computed when it is first asked for, and kept.
    pub fn frame(&self, framing: &Framing) -> Camera {
        let bounds = self.bounds.get_or_init(|| self.scene.bounds().into_iter().chain(self.later_bounds()).reduce(Bounds::union));
        crate::frame_camera(&bounds.unwrap_or(Bounds::UNIT), framing)
    }

    /// The box of the deformed meshes after time 0.
    fn later_bounds(&self) -> Option<Bounds> {
        let deformed = || {
            self.motions.iter().zip(&self.scene.meshes).enumerate().filter_map(|(at, (motion, mesh))| match motion {
                Motion::Deformed(deformed) => Some((at, deformed, mesh)),
                _ => None,
            })
        };
        let work = deformed().map(|(_, deformed, _)| deformed.work()).fold(0, usize::saturating_add);
        if work == 0 || self.duration <= 0.0 {
            return None;
        }
        let times = (BOUNDS_WORK / work).clamp(2, 32);
        let (mut pose, mut positions) = (Pose::default(), Vec::new());
        let mut bounds = None;
        for (at, deformed, mesh) in deformed() {
            for step in 1..=times {
                self.pose(at, self.duration * step as f64 / times as f64, &mut pose);
                positions.clear();
                positions.extend((0..deformed.positions.len()).map(|vertex| deformed.position(vertex, &pose)));
                bounds = bounds.into_iter().chain(mesh.bounds_at(&positions)).reduce(Bounds::union);
            }
        }
        bounds
    }

    /// The lights at a time: always as many as [`Scene::lights`], each of the same kind.
    pub fn lights(&self, time: f64) -> Vec<Light> {
        let light = |(number, light): (usize, &Light)| match self.tracks.lights.get(number) {
            Some(LightTrack::Rig(track)) => track.rig.light(track.number, time).unwrap_or(*light),
            Some(LightTrack::Keys(curve)) => curve.at(light, time),
            Some(LightTrack::Still) | None => *light,
        };
        self.scene.lights.iter().enumerate().map(light).collect()
    }

    /// A reader of key-frames, for a thread of its own. Each has a table of materials and textures of its own, which begins as the scene's.
    ///
    /// # Errors
    /// None so far.
    pub fn reader(&self) -> Result<KeyReader> {
        Ok(self.keys.clone().unwrap_or_default())
    }
}

impl Deformed {
    /// Steps of [`Deformed::position`] for all vertices.
    fn work(&self) -> usize {
        self.positions.len().saturating_mul(1 + self.influences_each as usize + self.targets.len())
    }

    /// Where a vertex is in a pose.
    fn position(&self, vertex: usize, pose: &Pose) -> [f32; 3] {
        let mut at = self.positions.get(vertex).copied().unwrap_or([f32::NAN; 3]);
        for (target, weight) in self.targets.iter().zip(&pose.weights) {
            if let Some(offset) = target.positions.get(vertex) {
                at = std::array::from_fn(|axis| at[axis] + offset[axis] * weight);
            }
        }
        let moved = |joint: usize| {
            let matrix = pose.matrices.get(joint).copied().unwrap_or([[f32::NAN; 4]; 3]);
            matrix.map(|row| row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3])
        };
        let each = self.influences_each as usize;
        match self.influences.get(vertex * each..(vertex + 1) * each) {
            Some(own) if each > 0 => own.iter().fold([0.0; 3], |sum, influence| {
                let part = moved(influence.joint as usize);
                std::array::from_fn(|axis| sum[axis] + part[axis] * influence.weight)
            }),
            _ => moved(0),
        }
    }
}

/// What the box of an animation may cost, in steps of a few nanoseconds.
const BOUNDS_WORK: usize = 1 << 24;

/// Frames a second where no file says.
pub const DEFAULT_FPS: f64 = 24.0;
