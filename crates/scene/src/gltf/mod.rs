//! glTF 2.0 and GLB: static and animated scenes.
//!
//! Each primitive of each mesh on a node becomes a mesh of the scene. One that the chosen clip does not move is put where it stands;
//! one that it moves keeps its own space, and [`Rig`] says its matrices and morph weights at a time.

mod accessor;
mod affine;
mod document;
mod material;
mod rig;
mod shape;
mod track;

use std::collections::HashMap;
use std::path::Path;

use gltf::json::Index;
use gltf::json::camera;
use gltf::json::extensions::scene::khr_lights_punctual;
use gltf::json::validation::Checked;

use crate::assets::Assets;
use crate::{Clip, Deformed, Error, Light, Mesh, NamedCamera, Result};

use document::{Document, absent, named};
use material::Materials;
pub(crate) use rig::Rig;
use rig::{Hanging, HangingCamera, HangingLight, unique};
use shape::Shape;

/// The most triangles of one file, instances counted: as many as a grid holds.
const MOST_TRIANGLES: u64 = 1 << 26;

/// A file as read. Materials and textures went into the assets.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// At time 0, in world space.
    pub(crate) meshes: Vec<Mesh>,
    /// How a mesh moves; `None` for one that stands still.
    pub(crate) deformed: Vec<Option<Box<Deformed>>>,
    /// One a camera of the rig, at time 0.
    pub(crate) cameras: Vec<NamedCamera>,
    /// One a light of the rig, at time 0.
    pub(crate) lights: Vec<Light>,
    /// All clips of the file.
    pub(crate) clips: Vec<Clip>,
    pub(crate) rig: Rig,
}

/// How a file is played in a scene.
#[derive(Clone, Debug)]
pub(crate) struct Playing<'a> {
    /// By name; the first without.
    pub(crate) clip: Option<&'a str>,
    /// Where the file's world is in the scene's.
    pub(crate) placement: affine::Affine,
    /// Seconds into the clip at time 0; finite.
    pub(crate) start: f64,
    /// Whether the clip begins anew at its end.
    pub(crate) looped: bool,
}

impl Default for Playing<'_> {
    fn default() -> Self {
        Self { clip: None, placement: affine::IDENTITY, start: 0.0, looped: true }
    }
}

/// Reads a file's bytes. `folder` is where files that it names are looked for.
pub(crate) fn read(assets: &mut Assets, bytes: &[u8], file: &str, folder: Option<&Path>, playing: &Playing<'_>) -> Result<Loaded> {
    let document = Document::open(bytes, file, folder, &assets.files.clone(), &assets.options.clone())?;
    let loaded = build(&document, assets, playing);
    assets.warnings.append(&mut document.take_warnings());
    loaded
}

fn build(document: &Document, assets: &mut Assets, playing: &Playing<'_>) -> Result<Loaded> {
    let clips = rig::read_clips(document)?;
    let chosen = match playing.clip {
        Some(name) => Some(clips.iter().position(|clip| clip.name == name).ok_or_else(|| no_clip(name, &clips))?),
        None => (!clips.is_empty()).then_some(0),
    };
    let mut rig = Rig::new(document, chosen, playing)?;
    let mut cameras = Vec::new();
    let mut names = HashMap::new();
    let mut builder = Builder {
        document,
        materials: Materials::new(document, assets),
        shapes: HashMap::new(),
        meshes: Vec::new(),
        deformed: Vec::new(),
        triangles: 0,
    };
    for node in visited(document)? {
        builder.node(node, &mut rig)?;
        if let Some((camera, name)) = camera_of(document, node)? {
            rig.cameras.push(camera);
            cameras.push(unique(&mut names, name));
        }
        if let Some(light) = light_of(document, node)? {
            rig.lights.push(light);
        }
    }
    let Builder { meshes, deformed, .. } = builder;
    if meshes.is_empty() {
        document.warn("holds no triangles");
    }
    let cameras =
        cameras.into_iter().enumerate().filter_map(|(at, name)| Some(NamedCamera { name, camera: rig.camera(at, 0.0)? })).collect();
    let lights = (0..rig.light_count()).filter_map(|at| rig.light(at, 0.0)).collect();
    Ok(Loaded { meshes, deformed, cameras, lights, clips, rig })
}

fn no_clip(name: &str, clips: &[Clip]) -> Error {
    Error::UnknownClip { clip: name.to_owned(), known: clips.iter().map(|clip| clip.name.clone()).collect() }
}

/// The nodes of the scene that is shown, each after its parent, in the order of the file.
fn visited(document: &Document) -> Result<Vec<usize>> {
    let root = &document.root;
    let count = root.nodes.len();
    if root.scenes.len() > 1 {
        document.warn(format!("has {} scenes; only the default one is read", root.scenes.len()));
    }
    let first: Vec<usize> = match root.scene.map_or(0, |scene| scene.value()) {
        at if at < root.scenes.len() => root.scenes.get(at).map(|scene| scene.nodes.iter().map(Index::value).collect()).unwrap_or_default(),
        at if root.scene.is_some() => return Err(document.error(absent("scene", at, root.scenes.len()))),
        // A file without scenes is a library of parts: all of them are shown.
        _ => {
            let mut below = vec![false; count];
            for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
                if let Some(below) = below.get_mut(child.value()) {
                    *below = true;
                }
            }
            (0..count).filter(|&at| !below.get(at).copied().unwrap_or(true)).collect()
        }
    };
    let mut seen = vec![false; count];
    let mut open: Vec<usize> = first.into_iter().rev().collect();
    let mut order = Vec::new();
    while let Some(at) = open.pop() {
        let Some(seen) = seen.get_mut(at) else { return Err(document.error(absent("node", at, count))) };
        // The scene may name a node and its child.
        if !std::mem::replace(seen, true) {
            order.push(at);
            open.extend(root.nodes.get(at).into_iter().flat_map(|node| node.children.iter().flatten().rev().map(Index::value)));
        }
    }
    Ok(order)
}

struct Builder<'a> {
    document: &'a Document,
    materials: Materials<'a>,
    shapes: HashMap<(usize, usize), Option<(Shape, u32)>>,
    meshes: Vec<Mesh>,
    deformed: Vec<Option<Box<Deformed>>>,
    triangles: u64,
}

impl Builder<'_> {
    /// The meshes on a node.
    fn node(&mut self, at: usize, rig: &mut Rig) -> Result<()> {
        let document = self.document;
        let root = &document.root;
        let Some(node) = root.nodes.get(at) else { return Ok(()) };
        let Some(number) = node.mesh.map(|mesh| mesh.value()) else { return Ok(()) };
        let node_place = named("node", at, node.name.as_deref());
        let mesh = root
            .meshes
            .get(number)
            .ok_or_else(|| document.error(format!("{node_place}: {}", absent("mesh", number, root.meshes.len()))))?;
        let skin = node.skin.map(|skin| skin.value());
        if let Some(missing) = skin.filter(|&skin| skin >= root.skins.len()) {
            return Err(document.error(format!("{node_place}: {}", absent("skin", missing, root.skins.len()))));
        }
        let mesh_place = named("mesh", number, mesh.name.as_deref());
        let name = name_of(node.name.as_deref(), mesh.name.as_deref(), at);
        for (part, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("{mesh_place}, primitive {part}");
            if let std::collections::hash_map::Entry::Vacant(entry) = self.shapes.entry((number, part)) {
                let material = self.materials.get(primitive.material.map(|material| material.value()))?;
                let shape = shape::read(document, primitive, &material, &place)?;
                entry.insert(shape.map(|shape| (shape, material.number)));
            }
            let Some(Some((shape, material))) = self.shapes.get(&(number, part)) else { continue };
            let material = *material;
            self.triangles = self.triangles.saturating_add(shape.indices.len() as u64);
            if self.triangles > MOST_TRIANGLES {
                return Err(document.error(format!("has more than {MOST_TRIANGLES} triangles, those of repeated meshes counted")));
            }
            // The copy here, the posed one and their triangles.
            document.charge(shape.positions.len(), shape.bytes_each().saturating_mul(2))?;
            document.charge(shape.indices.len(), 2 * size_of::<[u32; 4]>())?;
            let mut shape = shape.clone();
            let skin = skin.filter(|_| shape.each > 0);
            match skin {
                Some(skin) => {
                    let joints = rig.joint_count(skin as u32);
                    let most = shape.influences.iter().map(|influence| influence.joint).max().unwrap_or(0);
                    if most as usize >= joints {
                        return Err(document.error(format!("{place}: joint {most} is not below the {joints} of skin {skin}")));
                    }
                }
                None => (shape.influences, shape.each) = (Vec::new(), 0),
            }
            let given = node.weights.as_ref().or(mesh.weights.as_ref());
            let weight = |at: usize| given.and_then(|weights| weights.get(at)).copied().filter(|weight| weight.is_finite()).unwrap_or(0.0);
            rig.meshes.push(Hanging {
                node: at as u32,
                skin: skin.map(|skin| skin as u32),
                weights: (0..shape.targets.len()).map(weight).collect(),
            });
            let name = if mesh.primitives.len() > 1 { format!("{name}#{part}") } else { name.clone() };
            self.push(shape, material, name, rig);
        }
        Ok(())
    }

    /// Poses the mesh that was hung on the rig last, at time 0.
    fn push(&mut self, shape: Shape, material: u32, name: String, rig: &Rig) {
        let number = self.meshes.len();
        let weights: Vec<f64> = rig.weights(number, 0.0).collect();
        let matrices: Vec<affine::Affine> = rig.matrices(number, 0.0).collect();
        let (positions, normals, mirrored) = shape::deformed(&shape, &weights, &matrices);
        let Shape { positions: base, normals: base_normals, uvs, colours, opacities, mut indices, targets, influences, each } = shape;
        if mirrored {
            indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let uvs = if uvs.is_empty() { vec![[0.0; 2]; positions.len()] } else { uvs };
        let materials = vec![material; indices.len()];
        self.meshes.push(Mesh { name, positions, normals, uvs, colours, opacities, indices, materials });
        self.deformed.push(rig.moves(number).then(|| {
            Box::new(Deformed {
                positions: base,
                normals: base_normals,
                targets,
                influences,
                influences_each: each,
                matrix_count: matrices.len() as u32,
            })
        }));
    }
}

/// The node's name, and the mesh's where that is another one.
fn name_of(node: Option<&str>, mesh: Option<&str>, at: usize) -> String {
    let given = |name: Option<&str>| name.filter(|name| !name.is_empty()).map(str::to_owned);
    match (given(node), given(mesh)) {
        (Some(node), Some(mesh)) if node != mesh => format!("{node}/{mesh}"),
        (Some(name), _) | (None, Some(name)) => name,
        (None, None) => format!("node {at}"),
    }
}

/// The camera on a node, and its name.
fn camera_of(document: &Document, at: usize) -> Result<Option<(HangingCamera, String)>> {
    let root = &document.root;
    let Some(node) = root.nodes.get(at) else { return Ok(None) };
    let Some(number) = node.camera.map(|camera| camera.value()) else { return Ok(None) };
    let place = named("camera", number, root.cameras.get(number).and_then(|camera| camera.name.as_deref()));
    let Some(camera) = root.cameras.get(number) else {
        return Err(document.error(format!(
            "{}: {}",
            named("node", at, node.name.as_deref()),
            absent("camera", number, root.cameras.len())
        )));
    };
    let odd = |what: &str| document.warn(format!("{place}: the {what} makes no sense; the camera is not read"));
    let lens = match (camera.type_, &camera.perspective, &camera.orthographic) {
        (Checked::Valid(camera::Type::Perspective), Some(lens), _) => {
            let degrees = lens.yfov.to_degrees();
            if !(degrees > 0.0 && degrees < 180.0) {
                odd("yfov");
                return Ok(None);
            }
            (degrees.clamp(0.01, 179.0), None)
        }
        (Checked::Valid(camera::Type::Orthographic), _, Some(lens)) => {
            let height = lens.ymag.abs() * 2.0;
            if !(height > 0.0 && height.is_finite()) {
                odd("ymag");
                return Ok(None);
            }
            (crate::Framing::default().vertical_fov_degrees, Some(height))
        }
        _ => {
            odd("type");
            return Ok(None);
        }
    };
    let given = |name: &Option<String>| name.clone().filter(|name| !name.is_empty());
    let name = given(&camera.name).or_else(|| given(&node.name)).unwrap_or_else(|| format!("camera {number}"));
    Ok(Some((HangingCamera { node: at as u32, vertical_fov_degrees: lens.0, orthographic_height: lens.1 }, name)))
}

/// The light on a node. A candela counts as 1 of radiant intensity and a lux as 1 of irradiance, as in most viewers: what is white under
/// π lux is seen as white.
fn light_of(document: &Document, at: usize) -> Result<Option<HangingLight>> {
    let root = &document.root;
    let Some(node) = root.nodes.get(at) else { return Ok(None) };
    let number = node.extensions.as_ref().and_then(|extensions| Some(extensions.khr_lights_punctual.as_ref()?.light.value()));
    let Some(number) = number else { return Ok(None) };
    let lights = root.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref()).map_or(&[][..], |all| &all.lights);
    let Some(light) = lights.get(number) else {
        return Err(document.error(format!("{}: {}", named("node", at, node.name.as_deref()), absent("light", number, lights.len()))));
    };
    let place = named("light", number, light.name.as_deref());
    let value = light.color.map(|part| part * light.intensity).map(|part| if part.is_finite() { part.max(0.0) } else { 0.0 });
    if light.range.is_some() {
        document.warn("the range of lights is not used: they reach as far as they do");
    }
    let (position, direction) = ([0.0; 3], [0.0, 0.0, -1.0]);
    let light = match light.type_ {
        Checked::Valid(khr_lights_punctual::Type::Directional) => Light::Directional { direction, irradiance: value },
        Checked::Valid(khr_lights_punctual::Type::Point) => Light::Point { position, intensity: value },
        Checked::Valid(khr_lights_punctual::Type::Spot) => {
            let (inner, outer) =
                light.spot.as_ref().map_or((0.0, std::f32::consts::FRAC_PI_4), |spot| (spot.inner_cone_angle, spot.outer_cone_angle));
            let degrees = |angle: f32, most: f32| if angle.is_finite() { angle.to_degrees().clamp(0.0, most) } else { most };
            let outer_degrees = degrees(outer, 90.0).max(0.01);
            Light::Spot { position, direction, intensity: value, inner_degrees: degrees(inner, outer_degrees), outer_degrees }
        }
        Checked::Invalid => {
            document.warn(format!("{place}: the type is none of directional, point, spot; it is not read"));
            return Ok(None);
        }
    };
    // Files from Blender count in physical units by default, 683 to our 1.
    let brightest = value.iter().copied().fold(0.0, f32::max);
    if brightest > 300.0 && matches!(light, Light::Directional { .. }) {
        document.warn(format!("{place} has {brightest} lux, which turns all white at exposure 0; try --exposure -9"));
    }
    Ok(Some(HangingLight { node: at as u32, light }))
}
