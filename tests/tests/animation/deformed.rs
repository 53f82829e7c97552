//! Skins, morph targets and moving nodes, from a glTF file made here to the device.

use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::twin::morph::morph;
use gridwalk_core::twin::motion::{ActiveTarget, Influence, NO_DELTAS};
use gridwalk_core::twin::skin::skin;
use gridwalk_scene::{Deformed, Motion, Pose};
use serde_json::{Value, json};

use super::*;

const RINGS: usize = 24;
const SIDES: usize = 16;

/// A tube along y from -1 to 1 whose upper half a joint at the origin bends, by a share that grows from 0 to 1; a target blows it up.
struct Tube {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    deltas: Vec<[f32; 3]>,
    /// Of the bending joint.
    shares: Vec<f32>,
    indices: Vec<u32>,
}

fn tube() -> Tube {
    let mut tube = Tube { positions: vec![], normals: vec![], deltas: vec![], shares: vec![], indices: vec![] };
    for ring in 0..RINGS {
        let y = 2.0 * ring as f32 / (RINGS - 1) as f32 - 1.0;
        for side in 0..SIDES {
            let (sin, cos) = (side as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
            tube.positions.push([0.4 * cos, y, 0.4 * sin]);
            tube.normals.push([cos, 0.0, sin]);
            tube.deltas.push([0.5 * cos * (1.0 - y * y), 0.0, 0.5 * sin * (1.0 - y * y)]);
            tube.shares.push((y + 0.5).clamp(0.0, 1.0));
            if ring + 1 < RINGS {
                let (a, b) = (ring * SIDES + side, ring * SIDES + (side + 1) % SIDES);
                let quad = [a, a + SIDES, b, b, a + SIDES, b + SIDES];
                tube.indices.extend(quad.map(|vertex| vertex as u32));
            }
        }
    }
    tube
}

/// Bytes of a glTF file, and the views and accessors over them.
#[derive(Default)]
struct Bytes {
    data: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Bytes {
    fn add<T: bytemuck::Pod>(&mut self, values: &[T], component: u32, kind: &str, count: usize) -> usize {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        self.views.push(json!({ "buffer": 0, "byteOffset": self.data.len(), "byteLength": bytes.len() }));
        self.data.extend(bytes);
        self.accessors.push(json!({ "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, values: &[[f32; N]], kind: &str) -> usize {
        let accessor = self.add(values.as_flattened(), 5126, kind, values.len());
        if kind == "VEC3" {
            for (bound, pick) in [("min", f32::min as fn(f32, f32) -> f32), ("max", f32::max)] {
                let found: Vec<f32> = (0..3).map(|axis| values.iter().map(|value| value[axis]).reduce(pick).unwrap()).collect();
                self.accessors[accessor][bound] = json!(found);
            }
        }
        accessor
    }
}

/// The tube bends by a quarter turn about z within a second and blows up, then falls back; beside it a node moves a box of one triangle.
pub(super) fn file() -> tempfile::TempDir {
    let tube = tube();
    let mut bytes = Bytes::default();
    let positions = bytes.floats(&tube.positions, "VEC3");
    let normals = bytes.floats(&tube.normals, "VEC3");
    let deltas = bytes.floats(&tube.deltas, "VEC3");
    let joints: Vec<[u16; 4]> = vec![[0, 1, 0, 0]; tube.positions.len()];
    let joints = bytes.add(joints.as_flattened(), 5123, "VEC4", tube.positions.len());
    let weights: Vec<[f32; 4]> = tube.shares.iter().map(|share| [1.0 - share, *share, 0.0, 0.0]).collect();
    let weights = bytes.floats(&weights, "VEC4");
    let indices = bytes.add(&tube.indices, 5125, "SCALAR", tube.indices.len());
    let matrix = |y: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, y, 0.0, 1.0_f32];
    let inverse = bytes.floats(&[matrix(1.0), matrix(0.0)], "MAT4");
    let times = bytes.floats(&[[0.0], [1.0], [2.0]], "SCALAR");
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = bytes.floats(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, half, half], [0.0, 0.0, 0.0, 1.0]], "VEC4");
    let blows = bytes.floats(&[[0.0], [1.0], [0.0]], "SCALAR");
    let corner = bytes.floats(&[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]], "VEC3");
    let ways = bytes.floats(&[[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]], "VEC3");
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1, 3] }],
        "nodes": [
            { "mesh": 0, "skin": 0 },
            { "translation": [0.0, -1.0, 0.0], "children": [2] },
            { "translation": [0.0, 1.0, 0.0] },
            { "mesh": 1, "translation": [1.0, 0.0, 0.0] },
        ],
        "meshes": [
            { "primitives": [{
                "attributes": { "POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights },
                "indices": indices,
                "targets": [{ "POSITION": deltas }],
            }] },
            { "primitives": [{ "attributes": { "POSITION": corner } }] },
        ],
        "skins": [{ "joints": [1, 2], "inverseBindMatrices": inverse }],
        "animations": [{
            "samplers": [
                { "input": times, "output": turns },
                { "input": times, "output": blows },
                { "input": times, "output": ways },
            ],
            "channels": [
                { "sampler": 0, "target": { "node": 2, "path": "rotation" } },
                { "sampler": 1, "target": { "node": 0, "path": "weights" } },
                { "sampler": 2, "target": { "node": 3, "path": "translation" } },
            ],
        }],
        "buffers": [{ "byteLength": bytes.data.len(), "uri": "a.bin" }],
        "bufferViews": bytes.views,
        "accessors": bytes.accessors,
    });
    folder(&[("a.gltf".to_owned(), serde_json::to_vec(&json).unwrap()), ("a.bin".to_owned(), bytes.data)])
}

/// Where the file says that the tube's vertices are.
fn expected(tube: &Tube, time: f64) -> Vec<[f64; 3]> {
    let part = 1.0 - (time - 1.0).abs();
    // Slerp between two turns about one axis is linear in the angle.
    let (sin, cos) = (part * std::f64::consts::FRAC_PI_2).sin_cos();
    (0..tube.positions.len())
        .map(|i| {
            let p: [f64; 3] = std::array::from_fn(|axis| f64::from(tube.positions[i][axis]) + part * f64::from(tube.deltas[i][axis]));
            let turned = [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], p[2]];
            let share = f64::from(tube.shares[i]);
            std::array::from_fn(|axis| (1.0 - share) * p[axis] + share * turned[axis])
        })
        .collect()
}

fn deformed(animation: &Animation, mesh: usize) -> &Deformed {
    match &animation.motions[mesh] {
        Motion::Deformed(deformed) => deformed,
        other => panic!("{other:?}"),
    }
}

/// What the kernels' twins make of a pose.
fn by_twins(source: &Deformed, pose: &Pose) -> Vec<[f32; 3]> {
    let count = source.positions.len() as u32;
    let groups = split_workgroups(count, 64);
    let mut deltas: Vec<f32> = Vec::new();
    let mut targets = Vec::new();
    for (target, &weight) in source.targets.iter().zip(&pose.weights) {
        let mut place = |values: &[[f32; 3]]| {
            let begin = deltas.len() as u32;
            deltas.extend(values.as_flattened());
            if values.is_empty() { NO_DELTAS } else { begin }
        };
        let (positions, normals) = (place(&target.positions), place(&target.normals));
        if weight != 0.0 {
            targets.push(ActiveTarget { positions, normals, weight, reserved: 0 });
        }
    }
    let mut bases = [source.positions.as_flattened().to_vec(), source.normals.as_flattened().to_vec()];
    if !targets.is_empty() {
        let [positions, normals] = bases.clone();
        let [to_positions, to_normals] = &mut bases;
        morph(64, groups, &positions, &normals, &deltas, &targets, to_positions, to_normals, count);
    }
    let influences: Vec<Influence> =
        source.influences.iter().map(|influence| Influence { joint: influence.joint, weight: influence.weight }).collect();
    let each = if influences.is_empty() { 0 } else { source.influences_each };
    let (mut positions, mut normals) = (vec![0.0; 3 * count as usize], vec![0.0; 3 * count as usize]);
    let [base_positions, base_normals] = &bases;
    skin(64, groups, base_positions, base_normals, &influences, &pose.matrices, &mut positions, &mut normals, count, each);
    positions.as_chunks::<3>().0.to_vec()
}

#[test]
fn a_skinned_and_morphed_mesh_is_where_the_file_says() {
    let folder = file();
    let path = folder.path().join("a.gltf");
    let moving = animation(&path);
    let tube = tube();
    let mut run = play(&path);
    let mut pose = Pose::default();
    let mut moved = 0.0_f64;
    for time in [0.0, 0.25, 1.0, 0.6180339887, 1.5, 2.0, 0.125] {
        seek(&mut run, time, &[]);
        let found = run.scene().read_positions().unwrap();
        // The file's vertices may come in another order, but each is there: compare by the base.
        let source = deformed(&moving, 0);
        assert_eq!(source.positions, tube.positions, "the reader keeps the order of indexed vertices");
        for (i, expected) in expected(&tube, time).iter().enumerate() {
            for axis in 0..3 {
                let error = (f64::from(found[i][axis]) - expected[axis]).abs();
                assert!(error < 1e-6, "vertex {i} at {time}: {:?}, expected {expected:?}", found[i]);
                moved = moved.max((f64::from(tube.positions[i][axis]) - expected[axis]).abs());
            }
        }
        // And bit for bit where the twins put it.
        moving.pose(0, time, &mut pose);
        let twins = by_twins(source, &pose);
        assert_eq!(found[..twins.len()], twins[..], "at {time}");
        let corner = found[twins.len()..][0];
        let up = (1.0 - (time - 1.0).abs()) as f32;
        assert!((corner[0] - 1.0).abs() < 1e-6 && (corner[1] - up).abs() < 1e-6, "{corner:?} at {time}");
    }
    // Negative control: it is not the base that is compared.
    assert!(moved > 1.0, "{moved}");
}

#[test]
fn a_pose_that_stays_is_not_built_again_and_every_frame_is_the_one_rendered_alone() {
    let folder = file();
    let path = folder.path().join("a.gltf");
    let mut run = play(&path);
    let times: Vec<f64> = (0..9).map(|frame| f64::from(frame) * 0.25).collect();
    let pictures: Vec<Layers> = times
        .iter()
        .map(|&time| {
            let stats = seek(&mut run, time, &[]);
            assert!(stats.rebuilt && stats.deform_steps.iter().any(|step| step.name == "skin"), "{stats:?}");
            shoot_player(&run)
        })
        .collect();
    for frame in [8, 1, 4] {
        let mut alone = play(&path);
        seek(&mut alone, times[frame], &[]);
        assert_same_picture(&format!("frame {frame}"), &pictures[frame], &shoot_player(&alone));
    }
    assert!(differ(&pictures[1], &pictures[2]));
    seek(&mut run, 50.0, &[]);
    assert!(!seek(&mut run, 60.0, &[]).rebuilt, "beyond the end nothing moves");
}
