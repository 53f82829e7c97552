//! Plans as data: every barrier is needed, and none is missing.

use gridwalk::hazard::{HazardKind, find_hazard, find_hazard_in};
use gridwalk::plan::{
    Barrier, BuildInputs, CONTINUATIONS, Dispatch, Extras, Item, Plan, Query, RayInputs, Source, build_plan, ray_sort_plan, trace_plan,
};
use gridwalk::{Capacity, Shape};
use gridwalk_core::twin::ray_keys::RAY_KEY_BITS;

use crate::kernels::{ODD, TINY};

const SHAPES: [Shape; 4] = [Shape::CPU, Shape::GPU, ODD, TINY];

fn builds() -> Vec<(String, Plan)> {
    let mut plans = Vec::new();
    for shape in SHAPES {
        // Every number of digits.
        for bits in 0..=28 {
            let mesh = |triangle_count| Source::Mesh { triangle_count, vertex_count: 3 };
            let records = Source::Records { record_count: 7 };
            for (leaf_cells, second_level) in [(0, true), (1 << bits, false), (1 << bits, true)] {
                for (source, exact) in [(mesh(0), false), (mesh(1), true), (mesh(1_000_000), false), (records, true)] {
                    let capacity = Capacity { triangles: 1_000_000, cells: 1 << bits, pairs: 1_000, leaf_cells };
                    let inputs = BuildInputs { source, density: 8.0, resolution: None, exact, second_level };
                    plans.push((
                        format!("2^{bits} cells, {leaf_cells} leaf cells, {inputs:?}, {shape:?}"),
                        build_plan(&capacity, &inputs, &shape),
                    ));
                }
            }
        }
    }
    plans
}

fn traces() -> Vec<(String, Plan)> {
    let closest = [(false, false), (true, false), (false, true), (true, true)];
    let queries = closest.map(|(resume, count)| Query::Closest { resume, count }).into_iter().chain([
        Query::Any,
        Query::Count,
        Query::Nearest { nearest: 4, resume: true },
    ]);
    queries
        .flat_map(|query| {
            [(false, false), (true, true)].map(|(indirect, ordered)| {
                let rays = RayInputs { max: 1_000, indirect, ordered };
                (format!("{query:?}, {rays:?}"), trace_plan(query, Extras::NONE, &rays))
            })
        })
        .collect()
}

fn sorts() -> Vec<(String, Plan)> {
    let plan = |(shape, indirect)| {
        let rays = RayInputs { max: 1_000, indirect, ordered: false };
        (format!("sort, {rays:?}, {shape:?}"), ray_sort_plan(&rays, &shape))
    };
    SHAPES.into_iter().flat_map(|shape| [(shape, false), (shape, true)]).map(plan).collect()
}

fn barriers(plan: &Plan) -> impl Iterator<Item = (usize, Barrier)> + '_ {
    plan.items().iter().enumerate().filter_map(|(at, item)| match item {
        Item::Barrier(barrier) => Some((at, *barrier)),
        Item::Step(_) => None,
    })
}

fn without(plan: &Plan, at: usize) -> Vec<Item> {
    plan.items().iter().enumerate().filter(|(index, _)| *index != at).map(|(_, item)| *item).collect()
}

#[test]
fn plans_have_no_hazard() {
    let (builds, traces) = (builds(), traces());
    for (name, build) in &builds {
        assert_eq!(find_hazard([build]), None, "{name}");
    }
    for (name, trace) in &traces {
        for (_, build) in &builds[..4] {
            assert_eq!(find_hazard([build, trace, build]), None, "{name}");
        }
    }
    for (name, sort) in &sorts() {
        for (_, trace) in &traces {
            assert_eq!(find_hazard([sort, trace, sort]), None, "{name}");
        }
    }
}

#[test]
fn every_barrier_is_needed() {
    for (name, plan) in builds().into_iter().chain(traces()).chain(sorts()) {
        assert!(barriers(&plan).count() > 3, "{name}");
        for (at, barrier) in barriers(&plan) {
            assert!(find_hazard_in(&without(&plan, at)).is_some(), "{name}: the barrier at {at} is idle");
            if barrier == Barrier::ShaderAndIndirect {
                let mut items = plan.items().to_vec();
                items[at] = Item::Barrier(Barrier::Shader);
                let hazard = find_hazard_in(&items);
                assert_eq!(hazard.map(|hazard| hazard.kind), Some(HazardKind::StaleArguments), "{name}: the barrier at {at}");
            }
        }
    }
}

/// The caller's barriers: each suffices; and without it some build or trace of the kind races with what came before, if they share a grid or
/// scratch. Not all do: many begin with steps after which a barrier of their own comes. That is no promise; the contract asks for all.
#[test]
fn the_callers_barriers_are_needed() {
    let (builds, traces) = (builds(), traces());
    let [(_, mesh), (_, records)] = &builds[2..4] else { panic!("two builds") };
    for (name, trace) in &traces {
        for (what, first, second, needed) in [
            ("trace, build", trace, mesh, true),
            ("trace, build of records", trace, records, false),
            ("build, build", mesh, mesh, false),
            ("builds of records", records, records, true),
            ("build, trace", mesh, trace, false),
            ("trace, trace", trace, trace, true),
        ] {
            let hazard = |barrier: Option<Barrier>| {
                let between = barrier.map(Item::Barrier);
                find_hazard_in(&first.items().iter().copied().chain(between).chain(second.items().iter().copied()).collect::<Vec<_>>())
            };
            assert_eq!(hazard(Some(Barrier::ShaderAndIndirect)), None, "{name}: {what}");
            assert_eq!(hazard(None).is_some(), needed, "{name}: {what}, without a barrier");
        }
    }
    // An order is read where it was written.
    let (_, ordered) = &traces[1];
    for (name, sort) in &sorts() {
        let walk =
            ordered.items().iter().copied().find(|item| matches!(item, Item::Step(step) if step.kernel.name == "closest_hit")).unwrap();
        let behind = |between: Option<Barrier>| {
            find_hazard_in(&sort.items().iter().copied().chain(between.map(Item::Barrier)).chain([walk]).collect::<Vec<_>>())
        };
        assert_eq!(behind(Some(Barrier::Shader)), None, "{name}");
        assert_eq!(behind(None).map(|hazard| hazard.kind), Some(HazardKind::ReadAfterWrite), "{name}");
    }
    let (_, build) = &builds[2];
    // A walk right behind a build, as a shader of the caller's is.
    let (_, trace) = &traces[0];
    let walk = trace.items().iter().copied().find(|item| matches!(item, Item::Step(step) if step.kernel.name == "closest_hit")).unwrap();
    let behind = |between: Option<Item>| find_hazard_in(&build.items().iter().copied().chain(between).chain([walk]).collect::<Vec<_>>());
    assert_eq!(behind(None).map(|hazard| hazard.kind), Some(HazardKind::ReadAfterWrite));
    assert_eq!(behind(Some(Item::Barrier(Barrier::ShaderAndIndirect))), None);
}

/// The walk sees each kind of hazard, where it is.
#[test]
fn hazards_are_named() {
    let (_, plan) = &builds()[0];
    let steps: Vec<Item> = plan.items().iter().copied().filter(|item| matches!(item, Item::Step(_))).collect();
    let hazard = find_hazard_in(&steps).unwrap();
    assert_eq!((hazard.item, hazard.kernel, hazard.kind), (1, "configure", HazardKind::ReadAfterWrite));
    // The same step twice writes twice.
    let hazard = find_hazard_in(&[steps[0], steps[0]]).unwrap();
    assert_eq!((hazard.item, hazard.kind), (1, HazardKind::WriteAfterWrite));
    // Its reader before its writer.
    let hazard = find_hazard_in(&[steps[2], steps[1]]).unwrap();
    assert_eq!((hazard.item, hazard.kernel, hazard.kind), (1, "configure", HazardKind::WriteAfterRead));
}

/// Digits of the capacity decide how many passes are recorded; indirect steps take their arguments from the build's.
#[test]
fn plans_have_the_passes_of_their_capacity() {
    for shape in SHAPES {
        for bits in 0..=28u32 {
            let capacity = Capacity { triangles: 1, cells: 1 << bits, pairs: 1, leaf_cells: 0 };
            let source = Source::Mesh { triangle_count: 1, vertex_count: 3 };
            let inputs = BuildInputs { source, density: 8.0, resolution: None, exact: true, second_level: true };
            let plan = build_plan(&capacity, &inputs, &shape);
            let scatters = plan.steps().filter(|step| step.kernel.name == "sort_scatter").count() as u32;
            assert_eq!(scatters, bits.div_ceil(shape.sort_bits), "2^{bits} cells, {shape:?}");
            for step in plan.steps() {
                if let Dispatch::Indirect(buffer, offset) = step.dispatch {
                    assert_eq!(buffer, gridwalk::plan::Buffer::Arguments);
                    assert_eq!(offset % 16, 0);
                }
            }
        }
    }
    for ((name, sort), shape) in sorts().iter().step_by(2).zip(SHAPES) {
        let scatters = sort.steps().filter(|step| step.kernel.name == "sort_scatter").count() as u32;
        assert_eq!(scatters, RAY_KEY_BITS.div_ceil(shape.sort_bits), "{name}");
    }
    let (_, trace) = &traces()[0];
    assert_eq!(trace.steps().count() as u32, 2 + 2 * CONTINUATIONS);
}
