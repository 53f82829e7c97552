//! What moves: the tree of nodes with the tracks of one clip, and all that hangs on it.

use std::collections::HashMap;

use gltf::json::Index;
use gltf::json::animation::{Animation, Interpolation, Property, Sampler};
use gltf::json::validation::Checked;

use super::Playing;
use super::affine::{Affine, IDENTITY, from_columns, from_parts, point, product};
use super::document::{Document, absent, named};
use super::track::{Between, Track};
use crate::animation::Course;
use crate::vector::{Vector, add, cross, dot, normalised, scale, sub};
use crate::{Camera, Clip, Light, Pose, Result};

/// Nodes below each other; beyond it a file is broken or hostile.
const DEEPEST: usize = 1024;

/// Everything that is needed to say where things are at a time.
#[derive(Debug)]
pub(crate) struct Rig {
    nodes: Vec<Node>,
    skins: Vec<Skin>,
    /// In the order of the meshes that were read.
    pub(super) meshes: Vec<Hanging>,
    pub(super) cameras: Vec<HangingCamera>,
    pub(super) lights: Vec<HangingLight>,
    /// Seconds of the clip; 0 where nothing moves.
    duration: f64,
    /// From the file's world to the scene's.
    placement: Affine,
    /// Seconds into the clip at time 0.
    start: f64,
    looped: bool,
}

#[derive(Debug)]
struct Node {
    parent: Option<u32>,
    rest: Rest,
    translation: Option<Track>,
    rotation: Option<Track>,
    scale: Option<Track>,
    weights: Option<Track>,
    /// Whether the node or one above it moves.
    moving: bool,
    /// Where the node is, unless it moves.
    world: Affine,
}

#[derive(Debug)]
enum Rest {
    Matrix(Affine),
    Parts { translation: Vector, rotation: [f64; 4], scale: Vector },
}

#[derive(Debug)]
struct Skin {
    joints: Vec<u32>,
    inverse_bind: Vec<Affine>,
}

/// A mesh on a node.
#[derive(Debug)]
pub(super) struct Hanging {
    pub(super) node: u32,
    pub(super) skin: Option<u32>,
    /// One a morph target, where the clip does not say.
    pub(super) weights: Vec<f32>,
}

#[derive(Debug)]
pub(super) struct HangingCamera {
    pub(super) node: u32,
    pub(super) vertical_fov_degrees: f32,
    pub(super) orthographic_height: Option<f32>,
}

#[derive(Debug)]
pub(super) struct HangingLight {
    pub(super) node: u32,
    /// At the origin, towards -z.
    pub(super) light: Light,
}

impl Rig {
    /// The nodes and skins, with the tracks of a clip.
    pub(super) fn new(document: &Document, clip: Option<usize>, playing: &Playing<'_>) -> Result<Rig> {
        let mut nodes = read_nodes(document)?;
        let order = link(document, &mut nodes)?;
        let mut duration = 0.0;
        if let Some(animation) = clip.and_then(|clip| document.root.animations.get(clip).map(|animation| (clip, animation))) {
            duration = read_channels(document, animation.0, animation.1, &mut nodes)?;
        }
        for at in order {
            let Some(node) = nodes.get(at as usize) else { continue };
            let above = node.parent.and_then(|parent| nodes.get(parent as usize));
            let moving = node.is_animated() || above.is_some_and(|above| above.moving);
            let local = node.local(0.0);
            let world = above.map_or(local, |above| product(&above.world, &local));
            if let Some(node) = nodes.get_mut(at as usize) {
                (node.moving, node.world) = (moving, world);
            }
        }
        Ok(Rig {
            skins: read_skins(document)?,
            nodes,
            meshes: Vec::new(),
            cameras: Vec::new(),
            lights: Vec::new(),
            duration,
            placement: playing.placement,
            start: playing.start,
            looped: playing.looped,
        })
    }

    /// Seconds of the clip; 0 where nothing moves.
    pub(crate) fn duration(&self) -> f64 {
        self.duration
    }

    pub(crate) fn course(&self) -> Course {
        let seconds = if self.looped { self.duration } else { (self.duration - self.start).max(0.0) };
        Course { seconds, looped: self.looped, fps: None }
    }

    pub(super) fn joint_count(&self, skin: u32) -> usize {
        self.skins.get(skin as usize).map_or(0, |skin| skin.joints.len())
    }

    /// Whether the mesh stands otherwise at some time than at another.
    pub(super) fn moves(&self, mesh: usize) -> bool {
        let Some(mesh) = self.meshes.get(mesh) else { return false };
        let moving = |node: u32| self.nodes.get(node as usize).is_some_and(|node| node.moving);
        let weights = !mesh.weights.is_empty()
            && self.nodes.get(mesh.node as usize).and_then(|node| node.weights.as_ref()).is_some_and(|track| track.constant().is_none());
        let placed = match mesh.skin.and_then(|skin| self.skins.get(skin as usize)) {
            Some(skin) => skin.joints.iter().any(|&joint| moving(joint)),
            None => moving(mesh.node),
        };
        self.duration > 0.0 && (weights || placed)
    }

    /// Time within the clip. Its end is shown where it is asked for, though it begins anew there.
    fn local_time(&self, time: f64) -> f64 {
        let time = time + self.start;
        let inside = (0.0..=self.duration).contains(&time);
        match self.looped && self.duration > 0.0 {
            _ if inside => time,
            true if time.is_finite() => time.rem_euclid(self.duration),
            _ => time.clamp(0.0, self.duration),
        }
    }

    /// The matrices of a mesh, in double precision.
    pub(super) fn matrices(&self, mesh: usize, time: f64) -> impl Iterator<Item = Affine> {
        let time = self.local_time(time);
        let (node, skin) = match self.meshes.get(mesh) {
            Some(mesh) => (Some(mesh.node), mesh.skin.and_then(|skin| self.skins.get(skin as usize))),
            None => (None, None),
        };
        // A skin says all: the node that a skinned mesh hangs on does not count.
        let own = node.filter(|_| skin.is_none()).map(|node| self.world(node, time));
        let skinned = skin.into_iter().flat_map(move |skin| {
            skin.joints.iter().zip(&skin.inverse_bind).map(move |(&joint, inverse)| product(&self.world(joint, time), inverse))
        });
        own.into_iter().chain(skinned)
    }

    /// The morph weights of a mesh.
    pub(super) fn weights(&self, mesh: usize, time: f64) -> impl Iterator<Item = f64> {
        let time = self.local_time(time);
        let mesh = self.meshes.get(mesh);
        let track = mesh.and_then(|mesh| self.nodes.get(mesh.node as usize)?.weights.as_ref()).map(|track| (track, track.place(time)));
        let rest = mesh.map_or(&[][..], |mesh| &mesh.weights);
        rest.iter().enumerate().map(move |(at, &rest)| match track {
            Some((track, place)) if at < track.width() => track.number(place, at),
            _ => f64::from(rest),
        })
    }

    /// Brings `pose` to that of a mesh at a time, without allocating where it held one of the same mesh before.
    pub(crate) fn pose(&self, mesh: usize, time: f64, pose: &mut Pose) {
        pose.matrices.clear();
        pose.matrices.extend(self.matrices(mesh, time).map(|matrix| matrix.map(|row| row.map(|value| value as f32))));
        pose.weights.clear();
        pose.weights.extend(self.weights(mesh, time).map(|weight| weight as f32));
    }

    /// A camera at a time, by its place among the cameras of the file's nodes.
    pub(crate) fn camera(&self, camera: usize, time: f64) -> Option<Camera> {
        let camera = self.cameras.get(camera)?;
        let (eye, forward, up) = self.sight(camera.node, time);
        // Far enough away that rounding to single precision keeps the direction.
        let distance = eye.iter().fold(1.0_f64, |most, value| most.max(value.abs()));
        Some(Camera {
            eye: eye.map(|value| value as f32),
            target: add(eye, scale(forward, distance)).map(|value| value as f32),
            up: up.map(|value| value as f32),
            vertical_fov_degrees: camera.vertical_fov_degrees,
            orthographic_height: camera.orthographic_height,
        })
    }

    /// A light at a time, by its place among the lights of the file's nodes.
    pub(crate) fn light(&self, light: usize, time: f64) -> Option<Light> {
        let HangingLight { node, light } = self.lights.get(light)?;
        let (at, forward, _) = self.sight(*node, time);
        let (at, forward) = (at.map(|value| value as f32), forward.map(|value| value as f32));
        let mut light = *light;
        match &mut light {
            Light::Point { position, .. } => *position = at,
            Light::Directional { direction, .. } => *direction = forward,
            Light::Spot { position, direction, .. } => (*position, *direction) = (at, forward),
        }
        Some(light)
    }

    /// The cameras' number.
    pub(crate) fn camera_count(&self) -> usize {
        self.cameras.len()
    }

    /// The lights' number.
    pub(crate) fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// Position, direction of sight and up of a node, the last two of length one and at a right angle.
    fn sight(&self, node: u32, time: f64) -> (Vector, Vector, Vector) {
        let world = self.world(node, self.local_time(time));
        let limit = f64::from(f32::MAX) / 4.0;
        let at = point(&world, [0.0; 3]).map(|value| if value.is_finite() { value.clamp(-limit, limit) } else { 0.0 });
        let column = |column: usize| world.map(|row| row[column]);
        let forward = normalised(scale(column(2), -1.0)).unwrap_or([0.0, 0.0, -1.0]);
        let across = |up: Vector| {
            normalised(sub(up, scale(forward, dot(up, forward)))).filter(|_| {
                let side = cross(forward, up);
                dot(side, side) > 1e-12 * dot(up, up)
            })
        };
        let up = across(column(1)).or_else(|| across([0.0, 1.0, 0.0])).or_else(|| across([0.0, 0.0, 1.0])).unwrap_or([1.0, 0.0, 0.0]);
        (at, forward, up)
    }

    /// From a node's space to the scene's.
    fn world(&self, node: u32, time: f64) -> Affine {
        let mut total = IDENTITY;
        let mut at = Some(node);
        while let Some(node) = at.and_then(|at| self.nodes.get(at as usize)) {
            if !node.moving {
                total = product(&node.world, &total);
                break;
            }
            total = product(&node.local(time), &total);
            at = node.parent;
        }
        if self.placement == IDENTITY { total } else { product(&self.placement, &total) }
    }
}

impl Node {
    fn is_animated(&self) -> bool {
        [&self.translation, &self.rotation, &self.scale].into_iter().flatten().any(|track| track.constant().is_none())
    }

    fn local(&self, time: f64) -> Affine {
        match &self.rest {
            Rest::Matrix(matrix) => *matrix,
            Rest::Parts { translation, rotation, scale } => from_parts(
                self.translation.as_ref().map_or(*translation, |track| track.vector(time)),
                self.rotation.as_ref().map_or(*rotation, |track| track.rotation(time)),
                self.scale.as_ref().map_or(*scale, |track| track.vector(time)),
            ),
        }
    }
}

/// The clips of a file: those without a name get one by their number, those of a name that was there get a number behind it.
pub(super) fn read_clips(document: &Document) -> Result<Vec<Clip>> {
    let mut clips: Vec<Clip> = Vec::new();
    let mut used = HashMap::new();
    for (at, animation) in document.root.animations.iter().enumerate() {
        let plain = match animation.name.as_deref() {
            Some(name) if !name.is_empty() => name.to_owned(),
            _ => format!("clip {at}"),
        };
        let name = unique(&mut used, plain);
        let mut duration = 0.0_f64;
        for channel in &animation.channels {
            if let Some(sampler) = animation.samplers.get(channel.sampler.value()) {
                let times = document.floats::<1>(sampler.input.value())?;
                duration = times.iter().flatten().filter(|time| time.is_finite()).fold(duration, |last, &time| last.max(f64::from(time)));
            }
        }
        clips.push(Clip { name, duration });
    }
    Ok(clips)
}

/// The name, with a number behind it where it was there before.
pub(super) fn unique(used: &mut HashMap<String, u32>, name: String) -> String {
    let mut count = used.get(&name).copied().unwrap_or(0);
    loop {
        let result = if count == 0 { name.clone() } else { format!("{name} {}", count + 1) };
        count += 1;
        if !used.contains_key(&result) {
            used.insert(result.clone(), 1);
            used.insert(name, count);
            return result;
        }
    }
}

fn read_nodes(document: &Document) -> Result<Vec<Node>> {
    let root = &document.root;
    root.nodes
        .iter()
        .enumerate()
        .map(|(at, node)| {
            let weird = || document.error(format!("{}: the place is not made of finite numbers", named("node", at, node.name.as_deref())));
            let rest = match &node.matrix {
                Some(matrix) if matrix.iter().all(|value| value.is_finite()) => Rest::Matrix(from_columns(matrix)),
                Some(_) => return Err(weird()),
                None => {
                    let translation = node.translation.unwrap_or_default();
                    let rotation = node.rotation.unwrap_or_default().0;
                    let scale = node.scale.unwrap_or([1.0; 3]);
                    if !translation.iter().chain(&rotation).chain(&scale).all(|value| value.is_finite()) {
                        return Err(weird());
                    }
                    Rest::Parts { translation: translation.map(f64::from), rotation: rotation.map(f64::from), scale: scale.map(f64::from) }
                }
            };
            Ok(Node { parent: None, rest, translation: None, rotation: None, scale: None, weights: None, moving: false, world: IDENTITY })
        })
        .collect()
}

/// Sets the parents and returns all nodes, each after its parent.
fn link(document: &Document, nodes: &mut [Node]) -> Result<Vec<u32>> {
    let root = &document.root;
    let place = |at: usize| named("node", at, root.nodes.get(at).and_then(|node| node.name.as_deref()));
    for (at, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(Index::value) {
            let count = nodes.len();
            let known = nodes
                .get_mut(child)
                .ok_or_else(|| document.error(format!("{} has a child that is not there: {}", place(at), absent("node", child, count))))?;
            if let Some(other) = known.parent.replace(at as u32) {
                return Err(document.error(format!(
                    "{} is a child of {} and of {}; nodes must form a tree",
                    place(child),
                    place(other as usize),
                    place(at)
                )));
            }
        }
    }
    let mut order = Vec::with_capacity(nodes.len());
    let mut open: Vec<(u32, usize)> =
        nodes.iter().enumerate().filter(|(_, node)| node.parent.is_none()).map(|(at, _)| (at as u32, 0)).collect();
    while let Some((at, depth)) = open.pop() {
        if depth > DEEPEST {
            return Err(document.error(format!("{} lies more than {DEEPEST} nodes deep", place(at as usize))));
        }
        order.push(at);
        if let Some(node) = root.nodes.get(at as usize) {
            open.extend(node.children.iter().flatten().map(|child| (child.value() as u32, depth + 1)));
        }
    }
    if order.len() < nodes.len() {
        // Each node has at most one parent, so those that no root leads to are in or below a ring.
        let mut seen = vec![false; nodes.len()];
        for &at in &order {
            seen[at as usize] = true;
        }
        let ring = seen.iter().position(|seen| !seen).unwrap_or(0);
        return Err(document.error(format!("{} is below itself, or below such a node; nodes must form a tree", place(ring))));
    }
    Ok(order)
}

fn read_skins(document: &Document) -> Result<Vec<Skin>> {
    let root = &document.root;
    root.skins
        .iter()
        .enumerate()
        .map(|(at, skin)| {
            let place = named("skin", at, skin.name.as_deref());
            let joints: Vec<u32> = skin.joints.iter().map(|joint| joint.value() as u32).collect();
            if joints.is_empty() {
                return Err(document.error(format!("{place} has no joints")));
            }
            if let Some(&missing) = joints.iter().find(|&&joint| joint as usize >= root.nodes.len()) {
                return Err(document.error(format!("{place}: {}", absent("node", missing as usize, root.nodes.len()))));
            }
            let inverse_bind = match skin.inverse_bind_matrices {
                None => vec![IDENTITY; joints.len()],
                Some(accessor) => {
                    let matrices = document.floats::<16>(accessor.value())?;
                    if matrices.len() < joints.len() {
                        let count = matrices.len();
                        return Err(document.error(format!("{place} has {count} inverse bind matrices for {} joints", joints.len())));
                    }
                    matrices.iter().take(joints.len()).map(from_columns).collect()
                }
            };
            Ok(Skin { joints, inverse_bind })
        })
        .collect()
}

/// Hangs the tracks of a clip on the nodes and returns its last time.
fn read_channels(document: &Document, clip: usize, animation: &Animation, nodes: &mut [Node]) -> Result<f64> {
    let root = &document.root;
    let clip = named("animation", clip, animation.name.as_deref());
    let mut duration = 0.0_f64;
    for (at, channel) in animation.channels.iter().enumerate() {
        let place = format!("{clip}, channel {at}");
        let fail = |message: String| document.error(format!("{place}: {message}"));
        let target = channel.target.node.value();
        let number = channel.sampler.value();
        let sampler = animation.samplers.get(number).ok_or_else(|| fail(absent("sampler", number, animation.samplers.len())))?;
        let source = root.nodes.get(target).ok_or_else(|| fail(absent("node", target, root.nodes.len())))?;
        let Checked::Valid(property) = channel.target.path else {
            document.warn(format!("{place}: moves what glTF 2.0 does not know, and is not used"));
            continue;
        };
        if source.matrix.is_some() && property != Property::MorphTargetWeights {
            document.warn(format!("{place}: {} has a matrix, which cannot be animated", named("node", target, source.name.as_deref())));
            continue;
        }
        let width = match property {
            Property::Translation | Property::Scale => 3,
            Property::Rotation => 4,
            Property::MorphTargetWeights => match target_count(document, target) {
                0 => {
                    document.warn(format!("{place}: there are no morph targets to weight"));
                    continue;
                }
                count => count,
            },
        };
        let track = read_track(document, sampler, property, width, &place)?;
        duration = duration.max(track.1);
        let Some(node) = nodes.get_mut(target) else { continue };
        let slot = match property {
            Property::Translation => &mut node.translation,
            Property::Rotation => &mut node.rotation,
            Property::Scale => &mut node.scale,
            Property::MorphTargetWeights => &mut node.weights,
        };
        if slot.replace(track.0).is_some() {
            document.warn(format!("{place}: moves what another channel moves too; the last one counts"));
        }
    }
    Ok(duration)
}

/// Morph targets of the mesh on a node.
fn target_count(document: &Document, node: usize) -> usize {
    let mesh = document.root.nodes.get(node).and_then(|node| document.root.meshes.get(node.mesh?.value()));
    let counts = mesh.into_iter().flat_map(|mesh| &mesh.primitives).map(|primitive| primitive.targets.as_ref().map_or(0, Vec::len));
    counts.max().unwrap_or(0)
}

/// A track and its last time.
fn read_track(document: &Document, sampler: &Sampler, property: Property, width: usize, place: &str) -> Result<(Track, f64)> {
    let fail = |message: String| document.error(format!("{place}: {message}"));
    let between = match sampler.interpolation {
        Checked::Valid(Interpolation::Step) => Between::Step,
        Checked::Valid(Interpolation::Linear) => Between::Linear,
        Checked::Valid(Interpolation::CubicSpline) => Between::Cubic,
        Checked::Invalid => return Err(fail("the interpolation is none of STEP, LINEAR, CUBICSPLINE".to_owned())),
    };
    let times = document.floats::<1>(sampler.input.value())?.into_flattened();
    let output = sampler.output.value();
    let mut values = match property {
        Property::Translation | Property::Scale => document.floats::<3>(output)?.into_flattened(),
        Property::Rotation => document.floats::<4>(output)?.into_flattened(),
        Property::MorphTargetWeights => document.floats::<1>(output)?.into_flattened(),
    };
    if !values.iter().all(|value| value.is_finite()) {
        document.warn(format!("{place}: values that are not finite count as 0"));
        values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
    }
    let (keys, numbers) = (times.len(), values.len());
    let last = times.last().map_or(0.0, |&time| f64::from(time));
    let track = Track::new(times, values, width, between).ok_or_else(|| {
        fail(format!("{keys} times and {numbers} numbers do not fit together, or the times do not go up from 0; a key needs {width}"))
    })?;
    Ok((track, last))
}
