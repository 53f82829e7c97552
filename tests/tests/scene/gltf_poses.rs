//! Where the vertices of an animated glTF file are, against a second evaluation in double precision that reads the file by itself.
//!
//! Files of our own are made from seeds. With `GRIDWALK_GLTF` set to a folder, every .glb and .gltf below it is compared too.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use gridwalk_scene::generate::Random;
use gridwalk_scene::{Animation, AnimationOptions, Bounds, Camera, Framing, LoadOptions, Motion, Pose, frame_camera, open};
use serde_json::{Value, json};

use super::gltf::{I16, Maker, U8, U16};

type Matrix = [[f64; 4]; 4];

/// A file as this test reads it.
struct File {
    json: Value,
    buffers: Vec<Vec<u8>>,
}

/// The elements of an accessor.
type Numbers = Vec<Vec<f64>>;

/// One corner: position and normal in world space.
type Corner = ([f64; 3], Option<[f64; 3]>);

impl File {
    fn read(path: &Path) -> File {
        let bytes = std::fs::read(path).unwrap();
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let (json, chunk): (Value, &[u8]) = if bytes.starts_with(b"glTF") {
            let end = 20 + word(12);
            (serde_json::from_slice(&bytes[20..end]).unwrap(), &bytes[end + 8..])
        } else {
            (serde_json::from_slice(&bytes).unwrap(), &[])
        };
        let buffers = json["buffers"].as_array().unwrap().iter().map(|buffer| match buffer["uri"].as_str() {
            None => chunk.to_vec(),
            Some(uri) => match uri.split_once(";base64,") {
                Some((_, text)) => unbase64(text),
                None => std::fs::read(path.with_file_name(uri)).unwrap(),
            },
        });
        let buffers = buffers.collect();
        File { json, buffers }
    }

    fn view(&self, view: &Value) -> &[u8] {
        let view = &self.json["bufferViews"][number(view)];
        let offset = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        &self.buffers[number(&view["buffer"])][offset..offset + number(&view["byteLength"])]
    }

    /// The elements of an accessor.
    fn numbers(&self, accessor: &Value) -> Vec<Vec<f64>> {
        let accessor = &self.json["accessors"][number(accessor)];
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let (component, count) = (number(&accessor["componentType"]), number(&accessor["count"]));
        let normalised = accessor["normalized"].as_bool().unwrap_or(false);
        let size = match component {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let value = |bytes: &[u8]| -> f64 {
            let (value, largest) = match component {
                5120 => (f64::from(bytes[0] as i8), 127.0),
                5121 => (f64::from(bytes[0]), 255.0),
                5122 => (f64::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
                5123 => (f64::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
                5125 => (f64::from(u32::from_le_bytes(bytes[..4].try_into().unwrap())), 1.0),
                _ => (f64::from(f32::from_le_bytes(bytes[..4].try_into().unwrap())), 1.0),
            };
            if normalised { f64::max(value / largest, -1.0) } else { value }
        };
        let element = |bytes: &[u8]| (0..width).map(|at| value(&bytes[at * size..])).collect::<Vec<f64>>();
        let mut elements = match accessor.get("bufferView") {
            Some(view) => {
                let stride = self.json["bufferViews"][number(view)]["byteStride"].as_u64().unwrap_or((width * size) as u64) as usize;
                let bytes = &self.view(view)[accessor["byteOffset"].as_u64().unwrap_or(0) as usize..];
                (0..count).map(|at| element(&bytes[at * stride..])).collect()
            }
            None => vec![vec![0.0; width]; count],
        };
        if let Some(sparse) = accessor.get("sparse") {
            let indices = self.view(&sparse["indices"]["bufferView"]);
            let values = self.view(&sparse["values"]["bufferView"]);
            for at in 0..number(&sparse["count"]) {
                let index = u16::from_le_bytes([indices[2 * at], indices[2 * at + 1]]);
                elements[index as usize] = element(&values[at * width * size..]);
            }
        }
        elements
    }

    /// The value of a channel of the clip, if there is one.
    fn channel(&self, clip: usize, node: usize, path: &str, width: usize, time: f64) -> Option<Vec<f64>> {
        let animation = self.json.get("animations")?.get(clip)?;
        let target = |channel: &&Value| channel["target"]["node"] == json!(node) && channel["target"]["path"] == path;
        let channel = animation["channels"].as_array()?.iter().rfind(target)?;
        let sampler = &animation["samplers"][number(&channel["sampler"])];
        let times: Vec<f64> = self.numbers(&sampler["input"]).concat();
        let flat = self.numbers(&sampler["output"]).concat();
        let interpolation = sampler["interpolation"].as_str().unwrap_or("LINEAR");
        let each = if interpolation == "CUBICSPLINE" { 3 } else { 1 };
        let part = |key: usize, which: usize| {
            let at = (key * each + if each == 3 { which } else { 0 }) * width;
            flat[at..at + width].to_vec()
        };
        let last = times.len() - 1;
        if time <= times[0] || time >= times[last] {
            return Some(part(if time <= times[0] { 0 } else { last }, 1));
        }
        let key = (0..last).rev().find(|&key| times[key] <= time).unwrap();
        let (span, s) = (times[key + 1] - times[key], (time - times[key]) / (times[key + 1] - times[key]));
        let (a, b) = (part(key, 1), part(key + 1, 1));
        Some(match interpolation {
            "STEP" => a,
            "CUBICSPLINE" => {
                let (leave, arrive) = (part(key, 2), part(key + 1, 0));
                // In the Bézier form of the same cubic.
                let value = |at: usize| {
                    let (p, q) = (a[at] + span * leave[at] / 3.0, b[at] - span * arrive[at] / 3.0);
                    let r = 1.0 - s;
                    r * r * r * a[at] + 3.0 * r * r * s * p + 3.0 * r * s * s * q + s * s * s * b[at]
                };
                (0..width).map(value).collect()
            }
            _ if path == "rotation" => {
                let (a, b) = (unit(a), unit(b));
                let cosine: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
                let b: Vec<f64> = if cosine < 0.0 { b.iter().map(|b| -b).collect() } else { b };
                // Turned from a towards the part of b at a right angle to it.
                let cosine = cosine.abs().min(1.0);
                let right: Vec<f64> = a.iter().zip(&b).map(|(a, b)| b - a * cosine).collect();
                let sine = right.iter().map(|value| value * value).sum::<f64>().sqrt();
                let angle = sine.atan2(cosine) * s;
                let right = if sine > 1e-12 { right.iter().map(|value| value / sine).collect() } else { vec![0.0; 4] };
                a.iter().zip(right).map(|(a, right)| a * angle.cos() + right * angle.sin()).collect()
            }
            _ => a.iter().zip(&b).map(|(a, b)| a * (1.0 - s) + b * s).collect(),
        })
    }

    fn duration(&self, clip: usize) -> f64 {
        let Some(animation) = self.json.get("animations").and_then(|animations| animations.get(clip)) else { return 0.0 };
        let channels = animation["channels"].as_array().unwrap();
        let inputs = channels.iter().map(|channel| &animation["samplers"][number(&channel["sampler"])]["input"]);
        inputs.flat_map(|input| self.numbers(input).concat()).fold(0.0, f64::max)
    }

    fn local(&self, clip: usize, at: usize, time: f64) -> Matrix {
        let node = &self.json["nodes"][at];
        if let Some(matrix) = node.get("matrix") {
            let flat = floats(matrix);
            return std::array::from_fn(|row| std::array::from_fn(|column| flat[4 * column + row]));
        }
        let part = |path: &str, default: &[f64]| {
            let rest = node.get(path).map_or(default.to_vec(), floats);
            self.channel(clip, at, path, default.len(), time).unwrap_or(rest)
        };
        let (t, q, s) = (part("translation", &[0.0; 3]), unit(part("rotation", &[0.0, 0.0, 0.0, 1.0])), part("scale", &[1.0; 3]));
        // Each axis is turned by the quaternion: v + 2 w (q x v) + 2 q x (q x v).
        let axis = |axis: usize| {
            let mut v = [0.0; 3];
            v[axis] = 1.0;
            let first = cross([q[0], q[1], q[2]], v);
            let second = cross([q[0], q[1], q[2]], first);
            std::array::from_fn::<f64, 3, _>(|row| (v[row] + 2.0 * q[3] * first[row] + 2.0 * second[row]) * s[axis])
        };
        let axes = [axis(0), axis(1), axis(2)];
        let mut matrix = [[0.0; 4]; 4];
        for row in 0..3 {
            for column in 0..3 {
                matrix[row][column] = axes[column][row];
            }
            matrix[row][3] = t[row];
        }
        matrix[3][3] = 1.0;
        matrix
    }

    fn world(&self, clip: usize, at: usize, time: f64) -> Matrix {
        let local = self.local(clip, at, time);
        let nodes = self.json["nodes"].as_array().unwrap();
        let parent = nodes.iter().position(|node| node["children"].as_array().is_some_and(|children| children.contains(&json!(at))));
        parent.map_or(local, |parent| product(&self.world(clip, parent, time), &local))
    }

    /// All nodes of the scene, parents first.
    fn order(&self) -> Vec<usize> {
        let mut open: Vec<usize> =
            self.json["scenes"][number(&self.json["scene"])]["nodes"].as_array().unwrap().iter().rev().map(number).collect();
        let mut order = Vec::new();
        while let Some(at) = open.pop() {
            order.push(at);
            open.extend(self.json["nodes"][at]["children"].as_array().into_iter().flatten().rev().map(number));
        }
        order
    }

    /// The corners of all triangles of each primitive of each mesh on a node.
    fn corners(&self, clip: usize, time: f64) -> Vec<Vec<Corner>> {
        let mut all = Vec::new();
        let mut read: HashMap<usize, Vec<Vec<f64>>> = HashMap::new();
        for at in self.order() {
            let node = &self.json["nodes"][at];
            let Some(mesh) = node.get("mesh").map(|mesh| &self.json["meshes"][number(mesh)]) else { continue };
            let skin = node.get("skin").map(|skin| &self.json["skins"][number(skin)]);
            let matrices: Vec<Matrix> = match skin {
                None => vec![self.world(clip, at, time)],
                Some(skin) => {
                    let inverse = skin.get("inverseBindMatrices").map(|accessor| self.numbers(accessor));
                    let joints = skin["joints"].as_array().unwrap();
                    let matrix = |(number_of, joint): (usize, &Value)| {
                        let world = self.world(clip, number(joint), time);
                        match &inverse {
                            Some(inverse) => {
                                let flat = &inverse[number_of];
                                product(&world, &std::array::from_fn(|row| std::array::from_fn(|column| flat[4 * column + row])))
                            }
                            None => world,
                        }
                    };
                    joints.iter().enumerate().map(matrix).collect()
                }
            };
            for primitive in mesh["primitives"].as_array().unwrap() {
                let mut get = |accessor: &Value| read.entry(number(accessor)).or_insert_with(|| self.numbers(accessor)).clone();
                let attributes = &primitive["attributes"];
                let positions = get(&attributes["POSITION"]);
                let normals = attributes.get("NORMAL").map(&mut get);
                let targets: Vec<(Option<Numbers>, Option<Numbers>)> = primitive["targets"]
                    .as_array()
                    .into_iter()
                    .flatten()
                    .map(|target| (target.get("POSITION").map(&mut get), target.get("NORMAL").map(&mut get)))
                    .collect();
                let rest = node.get("weights").or(mesh.get("weights")).map_or(vec![0.0; targets.len()], floats);
                let weights = self.channel(clip, at, "weights", targets.len(), time).unwrap_or(rest);
                let bound: Vec<_> = (0..2)
                    .filter(|_| skin.is_some())
                    .filter_map(|set| {
                        let joints = attributes.get(format!("JOINTS_{set}"))?;
                        Some((get(joints), get(&attributes[format!("WEIGHTS_{set}")])))
                    })
                    .collect();
                let indices = primitive.get("indices").map_or((0..positions.len()).collect(), |indices| {
                    get(indices).concat().into_iter().map(|index| index as usize).collect::<Vec<_>>()
                });
                let corner = |&vertex: &usize| -> Corner {
                    let mut position = positions[vertex].clone();
                    let mut normal = normals.as_ref().map(|normals| normals[vertex].clone());
                    for ((shift, turn), weight) in targets.iter().zip(&weights) {
                        for axis in 0..3 {
                            position[axis] += weight * shift.as_ref().map_or(0.0, |shift| shift[vertex][axis]);
                            if let Some(normal) = &mut normal {
                                normal[axis] += weight * turn.as_ref().map_or(0.0, |turn| turn[vertex][axis]);
                            }
                        }
                    }
                    let mut matrix = if bound.is_empty() { matrices[0] } else { [[0.0; 4]; 4] };
                    let total: f64 = bound.iter().flat_map(|(_, weights)| &weights[vertex]).sum();
                    for (joints, weights) in &bound {
                        for (joint, weight) in joints[vertex].iter().zip(&weights[vertex]) {
                            for row in 0..4 {
                                for column in 0..4 {
                                    matrix[row][column] += matrices[*joint as usize][row][column] * weight / total;
                                }
                            }
                        }
                    }
                    let moved = |row: usize| (0..3).map(|axis| matrix[row][axis] * position[axis]).sum::<f64>() + matrix[row][3];
                    (std::array::from_fn(moved), normal.and_then(|normal| turned(&matrix, &normal)))
                };
                all.push(indices.iter().map(corner).collect());
            }
        }
        all
    }
}

fn number(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

fn floats(value: &Value) -> Vec<f64> {
    // Numbers count as single precision, as they do for every reader of glTF.
    value.as_array().unwrap().iter().map(|value| f64::from(value.as_f64().unwrap() as f32)).collect()
}

fn unit(values: Vec<f64>) -> Vec<f64> {
    let length = values.iter().map(|value| value * value).sum::<f64>().sqrt();
    values.iter().map(|value| value / length).collect()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| (0..4).map(|at| a[row][at] * b[at][column]).sum()))
}

/// By the inverse of the transpose, of length one; `None` where the matrix flattens.
fn turned(matrix: &Matrix, normal: &[f64]) -> Option<[f64; 3]> {
    let rows: [[f64; 3]; 3] = std::array::from_fn(|row| std::array::from_fn(|column| matrix[row][column]));
    let cofactors = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])];
    let determinant: f64 = (0..3).map(|at| rows[0][at] * cofactors[0][at]).sum();
    if determinant.abs() < 1e-12 {
        return None;
    }
    let value = cofactors.map(|row| (0..3).map(|at| row[at] * normal[at]).sum::<f64>() / determinant);
    let length = value.iter().map(|value| value * value).sum::<f64>().sqrt();
    (length > 1e-9).then(|| value.map(|value| value / length))
}

fn unbase64(text: &str) -> Vec<u8> {
    let digit = |byte: u8| match byte {
        b'A'..=b'Z' => byte - b'A',
        b'a'..=b'z' => byte - b'a' + 26,
        b'0'..=b'9' => byte - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u8> = text.bytes().filter(|&byte| byte != b'=').map(digit).collect();
    let words = digits.chunks(4).flat_map(|digits| {
        let word = (0..4).fold(0_u32, |word, at| word << 6 | u32::from(digits.get(at).copied().unwrap_or(0)));
        word.to_be_bytes()[1..digits.len()].to_vec()
    });
    words.collect()
}

/// The corners of a mesh of an animation at a time: what a device is given, applied in double precision.
fn posed(animation: &Animation, mesh: usize, time: f64) -> Vec<Corner> {
    let scene = &animation.scene.meshes[mesh];
    let order = scene.indices.as_flattened().iter().map(|&at| at as usize);
    let Motion::Deformed(deformed) = &animation.motions[mesh] else {
        return order.map(|at| (scene.positions[at].map(f64::from), Some(scene.normals[at].map(f64::from)))).collect();
    };
    let mut pose = Pose::default();
    animation.pose(mesh, time, &mut pose);
    assert_eq!((pose.matrices.len(), pose.weights.len()), (deformed.matrix_count as usize, deformed.targets.len()));
    let each = deformed.influences_each as usize;
    assert_eq!(deformed.influences.len(), each * deformed.positions.len());
    let corner = |at: usize| {
        let (mut position, mut normal) = (deformed.positions[at].map(f64::from), deformed.normals[at].map(f64::from));
        for (target, &weight) in deformed.targets.iter().zip(&pose.weights) {
            for axis in 0..3 {
                position[axis] += target.positions.get(at).map_or(0.0, |shift| f64::from(shift[axis] * weight));
                normal[axis] += target.normals.get(at).map_or(0.0, |turn| f64::from(turn[axis] * weight));
            }
        }
        let mut matrix = [[0.0; 4]; 4];
        if each == 0 {
            matrix[..3].copy_from_slice(&pose.matrices[0].map(|row| row.map(f64::from)));
        }
        let own = &deformed.influences[at * each..(at + 1) * each];
        assert!(each == 0 || (own.iter().map(|influence| influence.weight).sum::<f32>() - 1.0).abs() < 1e-5);
        for influence in own {
            let joint = &pose.matrices[influence.joint as usize];
            for (sum, value) in matrix.as_flattened_mut().iter_mut().zip(joint.as_flattened()) {
                *sum += f64::from(value * influence.weight);
            }
        }
        let moved = |row: usize| (0..3).map(|axis| matrix[row][axis] * position[axis]).sum::<f64>() + matrix[row][3];
        (std::array::from_fn(moved), turned(&matrix, &normal))
    };
    order.map(corner).collect()
}

/// The largest distance of positions by the extent of the mesh, and of normals; corners of triangles may be turned around.
fn difference(ours: &[Corner], theirs: &[Corner]) -> [f64; 2] {
    assert_eq!(ours.len(), theirs.len());
    let extent = theirs.iter().flat_map(|corner| corner.0).fold(1e-3_f64, |most, value| most.max(value.abs()));
    let distance = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    let compare = |order: [usize; 3]| {
        let mut most = [0.0_f64; 2];
        for (at, (position, normal)) in theirs.iter().enumerate() {
            let (our_position, our_normal) = &ours[at / 3 * 3 + order[at % 3]];
            most[0] = most[0].max(distance(our_position, position) / extent);
            if let (Some(ours), Some(normal)) = (our_normal, normal) {
                most[1] = most[1].max(distance(ours, normal));
            }
        }
        most
    };
    let (straight, turned) = (compare([0, 1, 2]), compare([0, 2, 1]));
    if straight[0] <= turned[0] { straight } else { turned }
}

fn open_clip(path: &Path, clip: Option<String>) -> Animation {
    let mut options = AnimationOptions::default();
    options.clip = clip;
    open(path, &LoadOptions::default(), &options).unwrap()
}

/// Compares all clips of a file at several times; returns how far the positions and the normals are apart at most.
fn compare(path: &Path, times: &[f64]) -> [f64; 2] {
    let file = File::read(path);
    let mut most = [0.0_f64; 2];
    let clips = open_clip(path, None).clips;
    for clip in 0..clips.len().max(1) {
        let animation = open_clip(path, clips.get(clip).map(|clip| clip.name.clone()));
        assert_eq!(animation.duration, file.duration(clip));
        for &part in times {
            let time = part * animation.duration;
            let local = if part > 1.0 { time.rem_euclid(animation.duration) } else { time };
            let corners = file.corners(clip, local);
            assert_eq!(corners.len(), animation.scene.meshes.len());
            for (mesh, theirs) in corners.iter().enumerate() {
                let found = difference(&posed(&animation, mesh, time), theirs);
                most = [most[0].max(found[0]), most[1].max(found[1])];
                if part == 0.0 {
                    // The scene holds the same pose.
                    let scene = &animation.scene.meshes[mesh];
                    let ours: Vec<Corner> =
                        scene.indices.as_flattened().iter().map(|&at| (scene.positions[at as usize].map(f64::from), None)).collect();
                    most[0] = most[0].max(difference(&ours, theirs)[0]);
                }
            }
        }
    }
    most
}

const TIMES: [f64; 7] = [0.0, 0.13, 0.5, 0.77, 1.0, 1.31, 5.9];

/// A tree of nodes with meshes of all kinds, animated in all ways.
fn random_file(random: &mut Random) -> Maker {
    let mut maker = Maker::new();
    let mut value = |low: f64, high: f64| (low + (high - low) * random.next_u64() as f64 / 18_446_744_073_709_551_616.0) as f32;
    let mut values = |count: usize, low: f64, high: f64| (0..count).map(|_| value(low, high)).collect::<Vec<f32>>();
    let node_count = 7;
    for at in 0..node_count {
        let parts = values(10, -1.0, 1.0);
        let mut scale: Vec<f32> = values(3, 0.5, 1.5);
        if at == 3 {
            scale[0] = -scale[0];
        }
        let node = match at {
            1 => json!({ "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 2, 0, parts[0], parts[1], parts[2], 1] }),
            _ => json!({ "translation": parts[..3], "rotation": parts[3..7], "scale": scale }),
        };
        maker.push("nodes", node);
    }
    maker.json["nodes"][0]["children"] = json!([1, 2]);
    maker.json["nodes"][1]["children"] = json!([3]);
    maker.json["nodes"][2]["children"] = json!([4, 5]);
    maker.json["scenes"][0]["nodes"] = json!([0, 6]);

    let count = 9;
    for kind in 0..4 {
        let positions = maker.floats(&values(3 * count, -1.0, 1.0), "VEC3");
        let normals: Vec<f32> = values(3 * count, -1.0, 1.0)
            .chunks(3)
            .flat_map(|normal| unit(normal.iter().map(|&value| f64::from(value)).collect()))
            .map(|value| value as f32)
            .collect();
        let normals = maker.floats(&normals, "VEC3");
        let mut primitive = json!({ "attributes": { "POSITION": positions, "NORMAL": normals } });
        primitive["indices"] = json!(maker.indices(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 2, 4, 6]));
        let mut node = json!(null);
        if kind % 2 == 1 {
            let first = maker.floats(&values(3 * count, -0.5, 0.5), "VEC3");
            let turn = maker.floats(&values(3 * count, -0.2, 0.2), "VEC3");
            // The second target moves two vertices only.
            let indices = maker.view(&[1, 0, 4, 0]);
            let offsets: Vec<u8> = values(6, -0.5, 0.5).iter().flat_map(|value| value.to_le_bytes()).collect();
            let offsets = maker.view(&offsets);
            let second = maker.push(
                "accessors",
                json!({ "componentType": 5126, "count": count, "type": "VEC3", "sparse": {
                    "count": 2, "indices": { "bufferView": indices, "componentType": U16 }, "values": { "bufferView": offsets }
                } }),
            );
            primitive["targets"] = json!([{ "POSITION": first, "NORMAL": turn }, { "POSITION": second }]);
            node = json!({ "weights": values(2, 0.0, 1.0) });
        }
        if kind >= 2 {
            let sets = kind - 1;
            for set in 0..sets {
                let joints: Vec<u8> = values(4 * count, 0.0, 3.0).iter().map(|&joint| joint as u8).collect();
                primitive["attributes"][format!("JOINTS_{set}")] = json!(maker.accessor(&joints, U8, "VEC4", count));
                let weights = if set == 0 {
                    // Shorts that do not sum to one.
                    let bytes: Vec<u8> = values(4 * count, 1.0, 30000.0).iter().flat_map(|&weight| (weight as u16).to_le_bytes()).collect();
                    let accessor = maker.accessor(&bytes, U16, "VEC4", count);
                    maker.json["accessors"][accessor]["normalized"] = json!(true);
                    accessor
                } else {
                    maker.floats(&values(4 * count, 0.0, 1.0), "VEC4")
                };
                primitive["attributes"][format!("WEIGHTS_{set}")] = json!(weights);
            }
        }
        let mesh = maker.push("meshes", json!({ "primitives": [primitive] }));
        let holder = &mut maker.json["nodes"][3 + kind];
        holder["mesh"] = json!(mesh);
        if kind % 2 == 1 {
            holder["weights"] = node["weights"].clone();
        }
        if kind >= 2 {
            holder["skin"] = json!(kind - 2);
        }
    }
    // Inverse bind matrices: anything affine.
    let matrices: Vec<f32> = (0..3)
        .flat_map(|_| {
            let part = values(12, -1.0, 1.0);
            let mut matrix: Vec<f32> = part.chunks(3).flat_map(|column| [column[0], column[1], column[2], 0.0]).collect();
            matrix[15] = 1.0;
            (0..3).for_each(|at| matrix[5 * at] += 2.0);
            matrix
        })
        .collect();
    let matrices = maker.floats(&matrices, "MAT4");
    maker.json["skins"] = json!([{ "joints": [2, 3, 1], "inverseBindMatrices": matrices }, { "joints": [0, 4, 3] }]);

    let kinds = ["LINEAR", "STEP", "CUBICSPLINE"];
    let channels = [
        (0, "rotation", 4),
        (0, "translation", 3),
        (2, "rotation", 4),
        (2, "scale", 3),
        (3, "rotation", 4),
        (4, "weights", 2),
        (4, "translation", 3),
        (6, "weights", 2),
    ];
    for (next, (node, path, width)) in channels.into_iter().enumerate() {
        let interpolation = kinds[(next + values(1, 0.0, 3.0)[0] as usize) % 3];
        let each = if interpolation == "CUBICSPLINE" { 3 } else { 1 };
        let mut times = values(5, 0.0, 2.0);
        times.sort_by(f32::total_cmp);
        maker.animate(node, path, interpolation, &times, &values(5 * width * each, -1.0, 1.0));
    }
    maker
}

#[test]
fn random_files_are_posed_as_computed_in_double_precision() {
    for seed in 0..60 {
        let maker = random_file(&mut Random::new(seed));
        let folder = maker.write();
        let [positions, normals] = compare(&folder.path().join("a.glb"), &TIMES);
        assert!(positions < 1e-5 && normals < 2e-3, "seed {seed}: positions are {positions} apart, normals {normals}");
    }
}

/// The comparison sees a wrong time, a wrong weight and a wrong matrix.
#[test]
fn control_what_is_wrong_is_found() {
    let maker = random_file(&mut Random::new(1));
    let folder = maker.write();
    let path = folder.path().join("a.glb");
    let animation = open_clip(&path, None);
    let mut file = File::read(&path);
    let at = |file: &File, time: f64| {
        let corners = file.corners(0, time);
        (0..corners.len()).map(|mesh| difference(&posed(&animation, mesh, 0.5), &corners[mesh])[0]).collect::<Vec<_>>()
    };
    assert!(at(&file, 0.5).iter().all(|&found| found < 1e-5));
    assert!(at(&file, 0.51).iter().all(|&found| found > 1e-5), "{:?}", at(&file, 0.51));
    // Joint 0 of both skins becomes another node: only the skinned meshes differ.
    file.json["skins"][0]["joints"][0] = json!(5);
    file.json["skins"][1]["joints"][0] = json!(5);
    let found = at(&file, 0.5);
    assert_eq!(found.iter().filter(|&&found| found > 1e-3).count(), 2, "{found:?}");
}

#[test]
fn real_files_are_posed_as_computed_in_double_precision() {
    let Some(folder) = std::env::var_os("GRIDWALK_GLTF").map(PathBuf::from) else {
        eprintln!("skipped: set GRIDWALK_GLTF to a folder with glTF files");
        return;
    };
    let mut open = vec![folder];
    let mut count = 0;
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
            continue;
        }
        if !path.extension().is_some_and(|ending| ending == "glb" || ending == "gltf") {
            continue;
        }
        let [positions, normals] = compare(&path, &TIMES[..5]);
        eprintln!("{}: positions {positions:.1e}, normals {normals:.1e}", path.display());
        assert!(positions < 1e-5 && normals < 2e-3, "{}: positions are {positions} apart, normals {normals}", path.display());
        count += 1;
    }
    assert!(count > 0, "no file in GRIDWALK_GLTF");
}

#[test]
fn what_the_clip_does_not_move_stands_still() {
    let still = |maker: &Maker| maker.animation().motions.iter().map(|motion| matches!(motion, Motion::Still)).collect::<Vec<_>>();
    // Two triangles, of which one hangs below a moving node.
    let mut maker = Maker::triangle();
    maker.json["nodes"] = json!([{ "mesh": 0 }, { "children": [2] }, { "mesh": 0 }]);
    maker.json["scenes"][0]["nodes"] = json!([0, 1]);
    maker.animate(1, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    assert_eq!(still(&maker), [true, false]);
    // Keys that are all the same are no motion, but count against the node's own place.
    let mut maker = Maker::triangle();
    maker.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[5.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    assert_eq!(still(&maker), [true]);
    assert_eq!(maker.only_mesh().positions[0], [5.0, 0.0, 0.0]);
    // One key is none either.
    let mut maker = Maker::triangle();
    maker.animate(0, "scale", "LINEAR", &[0.5], &[2.0, 2.0, 2.0]);
    assert_eq!(still(&maker), [true]);
    assert_eq!(maker.only_mesh().positions[1], [2.0, 0.0, 0.0]);
}

#[test]
fn weights_without_a_sum_bind_to_the_first_joint() {
    let mut maker = Maker::triangle();
    let joints = maker.accessor(&[0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0].map(|joint: u16| joint.to_le_bytes()).concat(), U16, "VEC4", 3);
    let weights = maker.floats(&[0.0, 0.0, 0.0, 0.0, 0.25, 0.0, 0.25, 0.0, f32::NAN, 0.0, 1.0, 0.0], "VEC4");
    maker.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(joints);
    maker.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(weights);
    maker.json["nodes"] =
        json!([{ "mesh": 0, "skin": 0, "translation": [99, 0, 0] }, { "translation": [0, 0, 1] }, { "translation": [0, 0, 2] }]);
    maker.json["skins"] = json!([{ "joints": [1, 2] }]);
    let mesh = maker.only_mesh();
    assert_eq!(mesh.positions, [[0.0, 0.0, 1.0], [1.0, 0.0, 1.5], [0.0, 1.0, 2.0]], "the node of a skinned mesh does not count");
    maker.json["skins"] = json!([{ "joints": [1] }]);
    assert_eq!(maker.message(), "mesh 0, primitive 0: joint 1 is not below the 1 of skin 0");
    maker.json["skins"] = json!([{ "joints": [1, 9] }]);
    assert_eq!(maker.message(), "skin 0: there is no node 9, only 3 of them");
    let matrices = maker.floats(&[0.0; 16], "MAT4");
    maker.json["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": matrices }]);
    assert_eq!(maker.message(), "skin 0 has 1 inverse bind matrices for 2 joints");
    // Signed joints are none.
    maker.json["skins"] = json!([{ "joints": [1, 2] }]);
    maker.json["accessors"][joints]["componentType"] = json!(I16);
    assert!(maker.message().contains("must hold unsigned integers"));
}

#[test]
fn cameras_and_lights_move_with_their_nodes() {
    let mut maker = Maker::triangle();
    maker.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 }, "name": "eye" }]);
    maker.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "intensity": 2, "spot": {} }] } });
    maker.json["nodes"] = json!([
        { "mesh": 0 }, { "children": [2] },
        { "camera": 0, "translation": [0, 0, 4], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
    ]);
    maker.json["scenes"][0]["nodes"] = json!([0, 1]);
    let half = 0.5_f32.sqrt();
    maker.animate(1, "rotation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half]);
    let animation = maker.animation();
    assert!(matches!(animation.motions[0], Motion::Still));
    for (time, angle) in [(0.0, 0.0_f32), (1.0, 45.0), (2.0, 90.0), (3.0, 45.0), (4.5, 22.5 / 2.0 * 2.0)] {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let camera = animation.camera(Some("eye"), time).unwrap();
        let lights = animation.lights(time);
        let gridwalk_scene::Light::Spot { position, direction, .. } = lights[0] else { panic!("{lights:?}") };
        for (found, expected) in [
            (camera.eye, [4.0 * sine, 0.0, 4.0 * cosine]),
            (position, [4.0 * sine, 0.0, 4.0 * cosine]),
            (direction, [-sine, 0.0, -cosine]),
            (camera.up, [0.0, 1.0, 0.0]),
        ] {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{time}: {found:?} is not {expected:?}");
        }
    }
    assert_eq!(animation.scene.camera(Some("eye")), animation.camera(Some("eye"), 0.0));
    assert_eq!(animation.scene.lights, animation.lights(0.0));
    assert!(animation.camera(Some("ear"), 0.0).is_none());
    assert!(!animation.has_target(None) && !animation.has_target(Some("eye")));
}

#[test]
fn the_automatic_camera_shows_the_whole_clip() {
    let framing = Framing { azimuth: 20.0, ..Framing::default() };
    for seed in 0..8 {
        let folder = random_file(&mut Random::new(seed)).write();
        let animation = open_clip(&folder.path().join("a.glb"), None);
        let mut bounds = animation.scene.bounds().unwrap();
        for step in 1..=32 {
            let time = animation.duration * f64::from(step) / 32.0;
            for (position, _) in (0..animation.motions.len()).flat_map(|mesh| posed(&animation, mesh, time)) {
                let point = position.map(|value| value as f32);
                bounds = bounds.union(Bounds { min: point, max: point });
            }
        }
        let (found, expected) = (animation.frame(&framing), frame_camera(&bounds, &framing));
        let apart = |a: Camera, b: Camera| (0..3).map(|i| (a.eye[i] - b.eye[i]).abs() + (a.target[i] - b.target[i]).abs()).sum::<f32>();
        let size = apart(expected, Camera { eye: expected.target, ..expected });
        assert!(apart(found, expected) < 1e-4 * size, "{seed}: {found:?} is not {expected:?}");
        // Negative control: the first frame alone is framed from elsewhere.
        assert!(apart(animation.scene.frame(&framing), expected) > 1e-2 * size, "{seed}");
    }
}

#[test]
fn a_pose_is_filled_in_place() {
    let folder = random_file(&mut Random::new(5)).write();
    let animation = open_clip(&folder.path().join("a.glb"), None);
    for mesh in 0..animation.motions.len() {
        let mut pose = Pose::default();
        animation.pose(mesh, 0.3, &mut pose);
        let (first, places) = (pose.clone(), (pose.matrices.as_ptr(), pose.weights.as_ptr()));
        animation.pose(mesh, 1.1, &mut pose);
        assert_ne!(pose, first);
        animation.pose(mesh, 0.3, &mut pose);
        assert_eq!((&pose, (pose.matrices.as_ptr(), pose.weights.as_ptr())), (&first, places));
    }
}
