//! The include in shaders of the user's own, as it is published, where no two neighbours do the same: in GLSL and in Slang, against the twins.
//! CI runs this with subgroups of 4, 8 and 16.

use gridwalk::{BuildOptions, Hit, MISS, Ray};
use gridwalk_core::twin::closest_candidate::{
    GridwalkCandidates, gridwalk_candidates_filtered, gridwalk_closest_hit, gridwalk_commit, gridwalk_committed, gridwalk_next,
};
use gridwalk_core::walk::{CULL_BACK, Filter, Grid};
use gridwalk_tests::gpu::{CANARY, Gpu};
use rayon::prelude::*;

use super::filters::scene;
use super::rays;

/// Rounds of a ray at most.
const ROUNDS: usize = 5;

/// What a round writes: t, two weights or the hit's geometry, and the triangle.
type Words = [u32; 4];

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
}

/// Candidates one after another, to each of which is said whether it is committed and whether it is the last.
fn committed(grid: &Grid, mut candidates: GridwalkCandidates, mut judge: impl FnMut(&Hit) -> (bool, bool)) -> Hit {
    while gridwalk_next(grid, &mut candidates) {
        let (commit, last) = judge(&candidates.hit);
        if commit {
            gridwalk_commit(&mut candidates);
        }
        if last {
            break;
        }
    }
    gridwalk_committed(&candidates)
}

/// One invocation of `tests/shaders/divergent.comp`.
fn invocation(grid: &Grid, index: u32, mut ray: Ray, geometry: &impl Fn(u32) -> [u32; 2]) -> [Words; ROUNDS] {
    let mut written = [[CANARY; 4]; ROUNDS];
    if index % 7 == 6 {
        return written;
    }
    let all = Filter::default();
    let is_opaque = |hit: &Hit| index.wrapping_add(hit.triangle) & 3 != 0;
    for round in 0..=index % 5 {
        let hit = match (index + round) & 3 {
            0 => gridwalk_closest_hit(grid, &ray),
            1 => committed(grid, gridwalk_candidates_filtered(grid, &ray, all), |_| (true, true)),
            2 => committed(grid, gridwalk_candidates_filtered(grid, &ray, all), |hit| (is_opaque(hit), false)),
            _ => {
                let mut seen = 0;
                committed(grid, gridwalk_candidates_filtered(grid, &ray, Filter { mask: 11, cull: CULL_BACK }), |hit| {
                    seen += 1;
                    (is_opaque(hit), seen == 3)
                })
            }
        };
        let beside = if hit.is_hit() && round % 2 == 1 { geometry(hit.triangle) } else { [hit.u, hit.v].map(f32::to_bits) };
        written[round as usize] = [hit.t.to_bits(), beside[0], beside[1], hit.triangle];
        if !hit.is_hit() {
            break;
        }
        ray.t_min = hit.t + 0.0009765625;
    }
    written
}

type Same = fn(&[Words; ROUNDS], &[Words; ROUNDS]) -> bool;

fn same_triangles(a: &[Words; ROUNDS], b: &[Words; ROUNDS]) -> bool {
    a.iter().zip(b).all(|(a, b)| a[3] == b[3])
}

/// The invocations that differ.
fn differences(found: &[[Words; ROUNDS]], expected: &[[Words; ROUNDS]], same: Same) -> Vec<usize> {
    assert_eq!(found.len(), expected.len());
    (0..found.len()).filter(|index| !same(&found[*index], &expected[*index])).collect()
}

fn check(module: &[u8]) {
    let gpu = Gpu::shared();
    let scene = scene(gpu);
    let built = scene.build(gpu, BuildOptions { density: 4.0, ..BuildOptions::default() });
    let copy = built.copy();
    let grid = copy.view();
    let mut rays = rays::random_rays(&scene.flattened(), 3_000, 95);
    rays.extend(rays::invalid_rays());
    let memory = gpu.upload("rays", &rays);
    let hits = gpu.guarded("hits", (rays.len() * size_of::<[Words; ROUNDS]>()) as u64);
    let address = |region: gridwalk::Region| region.address.to_ne_bytes();
    let mut push = [address(built.grid.region()), address(memory.region()), address(hits.region())].concat();
    push.extend((rays.len() as u32).to_ne_bytes());
    gpu.run_module(&words(module), &push, (rays.len() as u32).div_ceil(64));
    [&built.grid, &memory, &hits].into_iter().for_each(|memory| memory.check());
    let found: Vec<[Words; ROUNDS]> = hits.read(0, rays.len());

    let first: Vec<u32> = scene.records.iter().scan(0, |sum, record| Some(std::mem::replace(sum, *sum + record.triangle_count))).collect();
    let geometry = |triangle: u32| {
        let record = first.partition_point(|first| *first <= triangle) - 1;
        [scene.records[record].id, triangle - first[record]]
    };
    let mut expected: Vec<[Words; ROUNDS]> =
        rays.par_iter().enumerate().map(|(index, ray)| invocation(&grid, index as u32, *ray, &geometry)).collect();
    let rounds = |kind: usize| {
        let of = |index: usize| (0..ROUNDS).filter(move |round| (index + round) % 4 == kind);
        let hit = |words: &Words| words[3] < MISS - 1 && *words != [CANARY; 4];
        (0..rays.len()).map(|index| of(index).filter(|round| hit(&expected[index][*round])).count()).sum::<usize>()
    };
    let counts = [0, 1, 2, 3].map(rounds);
    assert!(counts.iter().all(|count| *count > 200), "hits of each kind of query: {counts:?}");

    // A GPU rounds divisions in its own way: there most invocations hit the same triangles.
    let (same, allowed): (Same, usize) = if gpu.context.is_cpu() { (|a, b| a == b, 0) } else { (same_triangles, rays.len() / 50) };
    let different = differences(&found, &expected, same);
    let shown: Vec<_> = different.iter().take(3).map(|index| (index, found[*index], expected[*index])).collect();
    assert!(different.len() <= allowed, "{} of {} invocations differ: {shown:x?}", different.len(), rays.len());
    // A control: another triangle in one round.
    expected[41][0][3] ^= 1;
    assert!(differences(&found, &expected, same).contains(&41));
}

#[test]
fn the_include_in_divergent_code() {
    check(include_bytes!("../../spirv/divergent.spv"));
}

#[test]
fn the_include_in_slang() {
    check(include_bytes!("../../slang/divergent.spv"));
}
