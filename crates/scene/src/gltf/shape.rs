//! A mesh primitive: its vertices and triangles in its own space.

use std::collections::HashMap;

use gltf::json;
use gltf::json::material::AlphaMode;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::affine::{self, Affine};
use super::document::Document;
use super::material::Made;
use crate::vector::{Vector, add, cross, normalised, sub};
use crate::{Influence, MorphTarget, Result};

/// A primitive as read: lists of vertices have the length of `positions`, or are empty where it says so.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Empty where the file has none.
    pub(super) uvs: Vec<[f32; 2]>,
    /// Empty where there are none.
    pub(super) colours: Vec<[f32; 3]>,
    /// Empty where there are none, or the material does not blend.
    pub(super) opacities: Vec<f32>,
    pub(super) indices: Vec<[u32; 3]>,
    pub(super) targets: Vec<MorphTarget>,
    /// `each` a vertex; empty where nothing binds it to joints.
    pub(super) influences: Vec<Influence>,
    pub(super) each: u32,
}

/// Sets of joints and weights that are read, four influences each.
const JOINT_SETS: u32 = 2;

/// Reads a primitive; `None` where it has no triangles. `place` names it in messages.
pub(super) fn read(document: &Document, primitive: &Primitive, material: &Made, place: &str) -> Result<Option<Shape>> {
    let fail = |message: String| document.error(format!("{place}: {message}"));
    let attribute = |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(json::Index::value);
    let mode = match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
        Checked::Valid(mode) => {
            let kind = if mode == Mode::Points { "points" } else { "lines" };
            document.warn(format!("{place}: {kind} are not shown"));
            return Ok(None);
        }
        Checked::Invalid => return Err(fail("the mode is none of glTF".to_owned())),
    };
    let Some(positions) = attribute(Semantic::Positions) else {
        document.warn(format!("{place}: there are no positions, so it is not shown"));
        return Ok(None);
    };
    let positions = document.floats::<3>(positions)?;
    let count = positions.len();
    let vertex_count = u32::try_from(count).map_err(|_| fail(format!("{count} vertices are too many")))?;
    let corners = match primitive.indices {
        Some(indices) => document.integers::<1>(indices.value())?.into_flattened(),
        None => {
            document.charge(count, 4)?;
            (0..vertex_count).collect()
        }
    };
    if let Some(bad) = corners.iter().find(|&&corner| corner >= vertex_count) {
        return Err(fail(format!("the index {bad} is not below the {count} vertices")));
    }
    document.charge(corners.len(), 12)?;
    let triangles = triangles(mode, &corners);
    if mode == Mode::Triangles && corners.len() % 3 != 0 {
        document.warn(format!("{place}: {} indices are no whole number of triangles; the last ones are left out", corners.len()));
    }
    if triangles.is_empty() {
        document.warn(format!("{place}: there are no triangles"));
        return Ok(None);
    }

    let same_count = |what: &str, found: usize| {
        if found == count { Ok(()) } else { Err(fail(format!("{found} {what} for {count} positions"))) }
    };
    let normals = match attribute(Semantic::Normals) {
        Some(accessor) => Some(document.floats::<3>(accessor)?),
        None => None,
    };
    same_count("normals", normals.as_ref().map_or(count, Vec::len))?;

    let set = material.coordinates.map_or(0, |coordinates| coordinates.set);
    let mut uvs = match attribute(Semantic::TexCoords(set)) {
        Some(accessor) => document.floats::<2>(accessor)?,
        None => {
            if material.coordinates.is_some() {
                document.warn(format!("{place}: there is no TEXCOORD_{set} for the textures of {}", material.name));
            }
            Vec::new()
        }
    };
    if !uvs.is_empty() {
        same_count("texture coordinates", uvs.len())?;
        let coordinates = material.coordinates.unwrap_or_default();
        uvs.iter_mut().for_each(|uv| *uv = coordinates.apply(*uv));
        let inside = |value: &f32| (-1e-3..=1.0 + 1e-3).contains(value);
        if material.clamped && !uvs.as_flattened().iter().all(inside) {
            document.warn(format!("{place}: the textures of {} are repeated; other wrapping is not supported", material.name));
        }
    }
    let mut opacities = Vec::new();
    let colours = match attribute(Semantic::Colors(0)) {
        Some(accessor) if document.width(accessor) == Some(4) => {
            let colours = document.floats::<4>(accessor)?;
            let opacity = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
            if colours.iter().any(|[.., alpha]| opacity(*alpha) < 1.0) {
                match material.alpha {
                    AlphaMode::Opaque => {}
                    AlphaMode::Mask => document.warn(format!("{place}: the alpha of its vertices' colours is not cut by alphaMode MASK")),
                    AlphaMode::Blend => opacities = colours.iter().map(|[.., alpha]| opacity(*alpha)).collect(),
                }
            }
            colours.into_iter().map(|[red, green, blue, _]| [red, green, blue]).collect()
        }
        Some(accessor) => document.floats::<3>(accessor)?,
        None => Vec::new(),
    };
    same_count("colours", if colours.is_empty() { count } else { colours.len() })?;
    let colours: Vec<[f32; 3]> =
        colours.into_iter().map(|colour| colour.map(|value| if value.is_finite() { value.max(0.0) } else { 0.0 })).collect();

    let mut targets = Vec::new();
    for (at, target) in primitive.targets.iter().flatten().enumerate() {
        let part = |accessor: Option<json::Index<json::Accessor>>, what: &str| -> Result<Vec<[f32; 3]>> {
            let values = accessor.map_or_else(|| Ok(Vec::new()), |accessor| document.floats::<3>(accessor.value()))?;
            if !values.is_empty() {
                same_count(&format!("{what} of morph target {at}"), values.len())?;
            }
            Ok(values)
        };
        targets.push(MorphTarget { positions: part(target.positions, "positions")?, normals: part(target.normals, "normals")? });
    }

    let (influences, each) = read_influences(document, primitive, count, &fail)?;
    let raw =
        Shape { positions, normals: normals.unwrap_or_default(), uvs, colours, opacities, indices: triangles, targets, influences, each };
    Ok(Some(if raw.normals.is_empty() { flat(document, &raw)? } else { smooth(document, raw)? }))
}

fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .filter_map(|(at, corner)| match corner {
                // Repeated corners end one strip and begin the next.
                &[a, b, c] if a != b && b != c && c != a => Some(if at % 2 == 0 { [a, b, c] } else { [b, a, c] }),
                _ => None,
            })
            .collect(),
        Mode::TriangleFan => match corners.split_first() {
            Some((&centre, rest)) => rest.windows(2).map(|pair| [centre, pair[0], pair[1]]).collect(),
            None => Vec::new(),
        },
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}

/// Joints and weights, the heaviest first, the weights summing to 1; as many a vertex as the vertex with most needs.
fn read_influences(
    document: &Document,
    primitive: &Primitive,
    count: usize,
    fail: &dyn Fn(String) -> crate::Error,
) -> Result<(Vec<Influence>, u32)> {
    let attribute = |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(json::Index::value);
    let mut sets = Vec::new();
    for set in 0..JOINT_SETS {
        let (Some(joints), Some(weights)) = (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set))) else { break };
        let (joints, weights) = (document.integers::<4>(joints)?, document.floats::<4>(weights)?);
        if joints.len() != count || weights.len() != count {
            return Err(fail(format!("{} joints and {} weights for {count} positions", joints.len(), weights.len())));
        }
        sets.push((joints, weights));
    }
    if attribute(Semantic::Joints(JOINT_SETS)).is_some() {
        document.warn(format!("joints beyond JOINTS_{} are not used", JOINT_SETS - 1));
    }
    if sets.is_empty() {
        return Ok((Vec::new(), 0));
    }
    let room = sets.len() * 4;
    document.charge(count, room * size_of::<Influence>())?;
    let mut all = Vec::with_capacity(count * room);
    let mut each = 1;
    for vertex in 0..count {
        let start = all.len();
        for (joints, weights) in &sets {
            all.extend(
                joints[vertex]
                    .into_iter()
                    .zip(weights[vertex])
                    .map(|(joint, weight)| Influence { joint, weight: if weight.is_finite() { weight.max(0.0) } else { 0.0 } }),
            );
        }
        let own = all.get_mut(start..).unwrap_or_default();
        let sum: f64 = own.iter().map(|influence| f64::from(influence.weight)).sum();
        if sum > 0.0 {
            own.iter_mut().for_each(|influence| influence.weight = (f64::from(influence.weight) / sum) as f32);
        } else if let Some(first) = own.first_mut() {
            first.weight = 1.0;
        }
        own.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        each = each.max(own.iter().filter(|influence| influence.weight > 0.0).count());
        // What a weight of 0 names need not be there.
        own.iter_mut().filter(|influence| influence.weight == 0.0).for_each(|influence| influence.joint = 0);
    }
    let kept = all.chunks_exact(room).flat_map(|own| own.iter().copied().take(each)).collect();
    Ok((kept, each as u32))
}

/// Each triangle with vertices and a normal of its own, as glTF wants where a file has no normals.
fn flat(document: &Document, raw: &Shape) -> Result<Shape> {
    let order: Vec<u32> = raw.indices.as_flattened().to_vec();
    let count = u32::try_from(order.len()).map_err(|_| document.error(format!("{} corners are too many", order.len())))?;
    let mut shape = gathered(document, raw, &order)?;
    shape.indices = (0..count).collect::<Vec<u32>>().as_chunks::<3>().0.to_vec();
    shape.normals = flat_normals(&shape.positions);
    // The normals of the bent triangles, as far as they differ: right at weight 0 and at 1.
    for target in shape.targets.iter_mut().filter(|target| !target.positions.is_empty()) {
        let bent: Vec<[f32; 3]> = shape
            .positions
            .iter()
            .zip(&target.positions)
            .map(|(base, offset)| std::array::from_fn(|axis| base[axis] + offset[axis]))
            .collect();
        let bent = flat_normals(&bent);
        target.normals = bent.iter().zip(&shape.normals).map(|(bent, base)| std::array::from_fn(|axis| bent[axis] - base[axis])).collect();
    }
    Ok(shape)
}

/// Three vertices a triangle.
fn flat_normals(positions: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let (triangles, _) = positions.as_chunks::<3>();
    let normal = |triangle: &[[f32; 3]; 3]| {
        let [a, b, c] = triangle.map(|corner| corner.map(f64::from));
        unit(cross(sub(b, a), sub(c, a)))
    };
    triangles.iter().flat_map(|triangle| [normal(triangle); 3]).collect()
}

/// Without the vertices that no triangle has: primitives often share one long list.
fn smooth(document: &Document, mut raw: Shape) -> Result<Shape> {
    const UNUSED: u32 = u32::MAX;
    let mut places = vec![UNUSED; raw.positions.len()];
    for &corner in raw.indices.as_flattened() {
        if let Some(place) = places.get_mut(corner as usize) {
            *place = 0;
        }
    }
    let mut order = Vec::new();
    for (at, place) in places.iter_mut().enumerate().filter(|(_, place)| **place != UNUSED) {
        *place = order.len() as u32;
        order.push(at as u32);
    }
    let indices = std::mem::take(&mut raw.indices);
    let mut shape = if order.len() == raw.positions.len() { raw } else { gathered(document, &raw, &order)? };
    shape.indices = indices.into_iter().map(|triangle| triangle.map(|corner| places.get(corner as usize).copied().unwrap_or(0))).collect();
    for normal in &mut shape.normals {
        *normal = unit(normal.map(f64::from));
    }
    Ok(shape)
}

/// The vertices `order` of a shape, in this order. Triangles are not taken along.
fn gathered(document: &Document, raw: &Shape, order: &[u32]) -> Result<Shape> {
    document.charge(order.len(), raw.bytes_each())?;
    Ok(Shape {
        positions: pick(&raw.positions, order, 1),
        normals: pick(&raw.normals, order, 1),
        uvs: pick(&raw.uvs, order, 1),
        colours: pick(&raw.colours, order, 1),
        opacities: pick(&raw.opacities, order, 1),
        indices: Vec::new(),
        targets: raw
            .targets
            .iter()
            .map(|target| MorphTarget { positions: pick(&target.positions, order, 1), normals: pick(&target.normals, order, 1) })
            .collect(),
        influences: pick(&raw.influences, order, raw.each as usize),
        each: raw.each,
    })
}

/// Values of `each` elements a vertex; an empty list stays empty.
fn pick<T: Copy>(values: &[T], order: &[u32], each: usize) -> Vec<T> {
    if values.is_empty() {
        return Vec::new();
    }
    order.iter().flat_map(|&at| values.get(at as usize * each..(at as usize + 1) * each).unwrap_or_default()).copied().collect()
}

impl Shape {
    /// Bytes of a vertex with all that belongs to it.
    pub(super) fn bytes_each(&self) -> usize {
        let influences = self.each as usize * size_of::<Influence>();
        size_of::<[f32; 12]>() + influences + self.targets.len().saturating_mul(size_of::<[f32; 6]>())
    }
}

/// A vertex of triangles without area has no normal of its own: any will do, since no ray hits there.
fn unit(normal: Vector) -> [f32; 3] {
    normalised(normal).unwrap_or([0.0, 1.0, 0.0]).map(|value| value as f32)
}

/// Positions and normals after targets and matrices, and whether the matrices mirror.
pub(super) fn deformed(shape: &Shape, weights: &[f64], matrices: &[Affine]) -> (Vec<[f32; 3]>, Vec<[f32; 3]>, bool) {
    let bent = |base: &[[f32; 3]], at: usize, part: fn(&MorphTarget) -> &Vec<[f32; 3]>| -> Vector {
        let mut value = base.get(at).copied().unwrap_or_default().map(f64::from);
        for (target, &weight) in shape.targets.iter().zip(weights) {
            if let Some(offset) = part(target).get(at).filter(|_| weight != 0.0) {
                value = add(value, offset.map(|offset| f64::from(offset) * weight));
            }
        }
        value
    };
    let single = matrices.first().copied().unwrap_or(affine::IDENTITY);
    let each = shape.each as usize;
    let mut balance = 0.0;
    let mut signs: HashMap<u32, f64> = HashMap::new();
    let mut sign = |joint: u32, matrix: &Affine| *signs.entry(joint).or_insert_with(|| affine::determinant(matrix).signum());
    let mut positions = Vec::with_capacity(shape.positions.len());
    let mut normals = Vec::with_capacity(shape.positions.len());
    for at in 0..shape.positions.len() {
        let matrix = match shape.influences.get(at * each..(at + 1) * each) {
            Some(own) if each > 0 => own.iter().fold([[0.0; 4]; 3], |sum, influence| {
                let matrix = matrices.get(influence.joint as usize).copied().unwrap_or(affine::IDENTITY);
                balance += sign(influence.joint, &matrix) * f64::from(influence.weight);
                affine::add_scaled(&sum, &matrix, f64::from(influence.weight))
            }),
            _ => single,
        };
        positions.push(affine::point(&matrix, bent(&shape.positions, at, |target| &target.positions)).map(|value| value as f32));
        let base = bent(&shape.normals, at, |target| &target.normals);
        normals.push(match normalised(affine::normal(&matrix, base)) {
            Some(normal) => normal.map(|value| value as f32),
            None => unit(base),
        });
    }
    let mirrored = if each > 0 { balance < 0.0 } else { affine::determinant(&single) < 0.0 };
    (positions, normals, mirrored)
}
