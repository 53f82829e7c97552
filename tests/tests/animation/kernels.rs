//! The kernels that move vertices against their twins.

use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::twin::interpolate::{KeyVertices, interpolate};
use gridwalk_core::twin::interpolate_colours::interpolate_colours;
use gridwalk_core::twin::morph::morph;
use gridwalk_core::twin::motion::{ActiveTarget, Influence, NO_DELTAS};
use gridwalk_core::twin::place::place;
use gridwalk_core::twin::skin::skin;
use gridwalk_render::kernels::{INTERPOLATE, INTERPOLATE_COLOURS, MORPH, PLACE, SKIN};
use gridwalk_tests::gpu::{CANARY, Gpu, Guarded};
use gridwalk_tests::random::Random;

use crate::kernels::{assert_same, many_groups, sizes};

/// Workgroup size and number of elements: around every edge, beyond 65,535 workgroups, a million.
fn cases() -> Vec<(u32, u32)> {
    let edges = sizes(64).into_iter().map(|count| (64, count));
    edges.chain(many_groups(4).map(|count| (4, count))).chain([(64, (1 << 20) + 1)]).collect()
}

fn floats(random: &mut Random, count: u32) -> Vec<f32> {
    (0..count).map(|_| random.range(-2.0, 2.0)).collect()
}

/// Vectors of length one, a few of them zero.
fn normals(random: &mut Random, count: u32) -> Vec<f32> {
    (0..count).flat_map(|_| if random.below(16) == 0 { [0.0; 3] } else { random.direction() }).collect()
}

/// Words of every kind, NaNs with payloads, denormals and both zeros among them.
fn words(random: &mut Random, count: u32) -> Vec<u32> {
    (0..count)
        .map(|i| match i % 5 {
            0 => 0x7FC0_1234,
            1 => 0x0000_0007,
            2 => 0x8000_0000,
            _ => random.bits() as u32,
        })
        .collect()
}

fn upload<T: bytemuck::Pod>(name: &str, data: &[T]) -> Guarded {
    Gpu::shared().upload(name, data)
}

fn empty(words: u32) -> Guarded {
    Gpu::shared().guarded("out", u64::from(words).max(1) * 4)
}

/// Bits of numbers that a division and a root have made: those that the twin has, but where the device rounds both in its own way.
#[track_caller]
fn assert_near(what: &str, device: &[u32], twin: &[u32]) {
    let exact = Gpu::shared().context.is_cpu();
    let far = |(device, twin): (&u32, &u32)| {
        let (a, b) = (f32::from_bits(*device), f32::from_bits(*twin));
        device != twin && (exact || (a - b).abs().is_nan() || (a - b).abs() > 1e-6)
    };
    assert_eq!(device.len(), twin.len(), "{what}");
    if let Some(at) = device.iter().zip(twin).position(far) {
        panic!("{what}: word {at} is {:e}, the twin's {:e}", f32::from_bits(device[at]), f32::from_bits(twin[at]));
    }
}

#[test]
fn interpolate_is_its_twin() {
    for (size, count) in cases() {
        for (case, weight) in [0.0_f32, 0.3, 0.999].into_iter().enumerate() {
            let mut random = Random::new(u64::from(count) * 4 + case as u64);
            let random = &mut random;
            let exact = weight == 0.0;
            let mut key = || -> [Vec<u32>; 3] {
                if exact {
                    return [3, 3, 2].map(|each| words(random, each * count));
                }
                let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect();
                [bits(floats(random, 3 * count)), bits(normals(random, count)), bits(floats(random, 2 * count))]
            };
            let (mut first, second) = (key(), key());
            // Some vertices stand still.
            for (a, b) in first.iter_mut().zip(&second) {
                a.iter_mut().zip(b).step_by(7).for_each(|(a, b)| *a = *b);
            }
            let memory: Vec<Guarded> = first.iter().chain(&second).map(|words| upload("key", words)).collect();
            let out = [empty(3 * count), empty(3 * count), empty(2 * count)];
            let all: Vec<&Guarded> = memory.iter().chain(&out).collect();
            let groups = split_workgroups(count, size);
            Gpu::shared().launch_alone(&INTERPOLATE, size, &all, &[count, weight.to_bits()], groups);
            let from = KeyVertices { positions: &first[0], normals: &first[1], uvs: &first[2] };
            let to = KeyVertices { positions: &second[0], normals: &second[1], uvs: &second[2] };
            let mut twin = [3, 3, 2].map(|each| vec![CANARY; (each * count) as usize]);
            let [positions, normals, uvs] = &mut twin;
            interpolate(size, groups, from, to, positions, normals, uvs, count, weight);
            let what = format!("{count} vertices at {weight}");
            assert_same(&what, &out[0].read::<u32>(0, twin[0].len()), &twin[0]);
            assert_near(&what, &out[1].read::<u32>(0, twin[1].len()), &twin[1]);
            assert_same(&what, &out[2].read::<u32>(0, twin[2].len()), &twin[2]);
            if exact {
                assert_eq!(twin, first);
            } else if count > 100 {
                let still = (0..twin[0].len()).step_by(7).all(|i| twin[0][i] == second[0][i]);
                assert!(still && twin[0] != second[0] && twin[0] != first[0], "{what}: what is equal stays, the rest does not");
            }
        }
    }
}

#[test]
fn interpolate_colours_is_its_twin() {
    for (size, count) in cases() {
        let mut random = Random::new(count.into());
        let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect::<Vec<u32>>();
        let (first, second) = (bits(floats(&mut random, count)), bits(floats(&mut random, count)));
        let (a, b) = (upload("first", &first), upload("second", &second));
        for (weight, has_colours) in [(0.0_f32, true), (0.7, true), (0.7, false)] {
            let out = empty(count);
            let groups = split_workgroups(count, size);
            let push = [count, weight.to_bits(), u32::from(has_colours)];
            Gpu::shared().launch_alone(&INTERPOLATE_COLOURS, size, &[&a, &b, &out], &push, groups);
            let mut twin = vec![CANARY; count as usize];
            interpolate_colours(size, groups, has_colours.then_some(&first), &second, &mut twin, count, weight);
            assert_same(&format!("{count} words at {weight}, {has_colours}"), &out.read::<u32>(0, twin.len()), &twin);
        }
    }
}

#[test]
fn morph_is_its_twin() {
    for (size, count) in cases() {
        for target_count in [0_u32, 1, 3] {
            let mut random = Random::new(u64::from(count) * 4 + u64::from(target_count));
            let random = &mut random;
            let (positions, normals) = (floats(random, 3 * count), normals(random, count));
            // One moves normals alone, one positions alone.
            let deltas = floats(random, 3 * count * 4);
            let begin = |place: u32| place * 3 * count;
            let of = |i: u32, random: &mut Random| ActiveTarget {
                positions: if i == 1 { NO_DELTAS } else { begin(i) },
                normals: if i == 2 { NO_DELTAS } else { begin(3 - i) },
                weight: random.range(-1.0, 1.0),
                reserved: 0,
            };
            let targets: Vec<ActiveTarget> = (0..target_count).map(|i| of(i, random)).collect();
            let memory =
                [upload("positions", &positions), upload("normals", &normals), upload("deltas", &deltas), upload("targets", &targets)];
            let out = [empty(3 * count), empty(3 * count)];
            let all: Vec<&Guarded> = memory.iter().chain(&out).collect();
            let groups = split_workgroups(count, size);
            Gpu::shared().launch_alone(&MORPH, size, &all, &[count, target_count], groups);
            let mut twin = [vec![0.0_f32; positions.len()], vec![0.0; positions.len()]];
            let [to_positions, to_normals] = &mut twin;
            morph(size, groups, &positions, &normals, &deltas, &targets, to_positions, to_normals, count);
            for (out, twin) in out.iter().zip(&twin) {
                assert_same(&format!("{count} vertices, {target_count} targets"), &out.read::<f32>(0, twin.len()), twin);
            }
            assert!(target_count == 0 || count == 0 || twin[0] != positions, "nothing was moved");
        }
    }
}

/// Turns, scales of both signs, shears and moves.
fn matrix(random: &mut Random) -> [[f32; 4]; 3] {
    std::array::from_fn(|_| std::array::from_fn(|_| random.range(-2.0, 2.0)))
}

#[test]
fn skin_is_its_twin() {
    for (size, count) in cases() {
        for each in [0_u32, 1, 4, 7] {
            if each == 7 && count > 100_000 {
                continue;
            }
            let mut random = Random::new(u64::from(count) * 8 + u64::from(each));
            let random = &mut random;
            let joints = 1 + random.below(40);
            let matrices: Vec<[[f32; 4]; 3]> = (0..joints).map(|_| matrix(random)).collect();
            let influences: Vec<Influence> =
                (0..count * each).map(|_| Influence { joint: random.below(joints), weight: random.unit() }).collect();
            let (positions, normals) = (floats(random, 3 * count), normals(random, count));
            let memory = [
                upload("positions", &positions),
                upload("normals", &normals),
                upload("influences", &influences),
                upload("pose", &matrices),
            ];
            let out = [empty(3 * count), empty(3 * count)];
            let all: Vec<&Guarded> = memory.iter().chain(&out).collect();
            let groups = split_workgroups(count, size);
            Gpu::shared().launch_alone(&SKIN, size, &all, &[count, each], groups);
            let mut twin = [vec![0.0_f32; positions.len()], vec![0.0; positions.len()]];
            let [to_positions, to_normals] = &mut twin;
            skin(size, groups, &positions, &normals, &influences, &matrices, to_positions, to_normals, count, each);
            let what = format!("{count} vertices, {each} influences each");
            assert_same(&what, &out[0].read::<f32>(0, twin[0].len()), &twin[0]);
            let bits: Vec<u32> = twin[1].iter().map(|value| value.to_bits()).collect();
            assert_near(&what, &out[1].read::<u32>(0, bits.len()), &bits);
            for (i, (after, before)) in twin[1].as_chunks::<3>().0.iter().zip(normals.as_chunks::<3>().0).enumerate() {
                let length = after.iter().map(|value| value * value).sum::<f32>().sqrt();
                let expected = if *before == [0.0; 3] { 0.0 } else { 1.0 };
                assert!((length - expected).abs() < 1e-5, "{what}: normal {i} is {after:?} of {before:?}");
            }
        }
    }
}

/// A normal stays at a right angle to what it was at a right angle to, on its side of the surface, even in a mirror.
#[test]
fn normals_follow_the_surface() {
    let mut random = Random::new(77);
    let count = 2000;
    let normals: Vec<[f32; 3]> = (0..count).map(|_| random.direction()).collect();
    let matrices: Vec<[[f32; 4]; 3]> = (0..count).map(|_| matrix(&mut random)).collect();
    let influences: Vec<Influence> = (0..count).map(|joint| Influence { joint, weight: 1.0 }).collect();
    let memory =
        [upload("p", &vec![[0.0_f32; 3]; count as usize]), upload("n", &normals), upload("i", &influences), upload("m", &matrices)];
    let out = [empty(3 * count), empty(3 * count)];
    let all: Vec<&Guarded> = memory.iter().chain(&out).collect();
    Gpu::shared().launch_alone(&SKIN, 64, &all, &[count, 1], split_workgroups(count, 64));
    let found = out[1].read::<[f32; 3]>(0, count as usize);
    for i in 0..count as usize {
        let rows = matrices[i].map(|row| [0, 1, 2].map(|axis| f64::from(row[axis])));
        let turned = |v: [f64; 3]| rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (n, after) = (normals[i].map(f64::from), found[i].map(f64::from));
        // A vector along the surface, and one out of it.
        let along = [n[1] - n[2], n[2] - n[0], n[0] - n[1]];
        let moved = turned(along);
        let size = dot(moved, moved).sqrt();
        let determinant: f64 = dot(
            rows[0],
            [
                rows[1][1] * rows[2][2] - rows[1][2] * rows[2][1],
                rows[1][2] * rows[2][0] - rows[1][0] * rows[2][2],
                rows[1][0] * rows[2][1] - rows[1][1] * rows[2][0],
            ],
        );
        if determinant.abs() < 0.5 {
            continue;
        }
        assert!(dot(after, moved).abs() <= 1e-4 * size, "matrix {i}: {after:?}");
        assert!(dot(after, turned(n)) > 0.0, "matrix {i}: the normal has changed its side");
    }
}

#[test]
fn place_is_its_twin() {
    for (size, count) in cases() {
        let mut random = Random::new(count.into());
        let indices: Vec<[u32; 3]> = (0..count).map(|_| std::array::from_fn(|_| random.below(1 << 20))).collect();
        let materials: Vec<u32> = (0..count).map(|_| random.below(100)).collect();
        let (first, vertex, mesh) = (random.below(50), random.below(1 << 20), random.below(9));
        let room = first + count + 3;
        let memory = [upload("indices", &indices), upload("materials", &materials)];
        let out = [empty(3 * room), empty(2 * room)];
        let groups = split_workgroups(count, size);
        Gpu::shared().launch_alone(&PLACE, size, &[&memory[0], &memory[1], &out[0], &out[1]], &[count, first, vertex, mesh], groups);
        let (mut to, mut surrounds) = (vec![[CANARY; 3]; room as usize], vec![[CANARY; 2]; room as usize]);
        place(size, groups, &indices, &materials, &mut to, &mut surrounds, count, first, vertex, mesh);
        assert_same(&format!("{count} triangles"), &out[0].read::<[u32; 3]>(0, to.len()), &to);
        assert_same(&format!("{count} triangles"), &out[1].read::<[u32; 2]>(0, surrounds.len()), &surrounds);
    }
}

/// Negative control: a word that is wrong is seen.
#[test]
#[should_panic(expected = "word 5")]
fn a_wrong_word_is_seen() {
    let twin: Vec<u32> = (0..9).map(|i| (i as f32).to_bits()).collect();
    let mut device = twin.clone();
    device[5] = 5.1_f32.to_bits();
    assert_near("control", &device, &twin);
}
