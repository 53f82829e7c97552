//! Recording costs no allocation. A program of its own, since it counts what every thread of it allocates.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, reason = "a test that fails panics")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use gridwalk::ash::vk;
use gridwalk::{BuildInfo, Cull, GeometryRecord, Input, RayCount, Records, TraceInfo, Tracer, cmd_barrier};
use gridwalk_tests::foreign::{Foreign, Memory, Placed, Terrain};

/// Rust's heap, with a count for each thread. What a driver or a layer allocates for its command buffers is not Rust's, and not the library's.
struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: all is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(work: impl FnOnce()) -> u64 {
    let before = COUNT.get();
    work();
    COUNT.get() - before
}

#[test]
fn recording_allocates_nothing() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let placed = Placed::new(&memory, &tracer, Terrain::new(10, 5));
        let count = memory.upload(&[7u32]);
        let counters = memory.region(16 * placed.terrain.rays.len() as u64);
        let rays = placed.terrain.rays.len() as u32;
        let indirect = TraceInfo { count: RayCount::Indirect { count, max: rays }, ..placed.trace };
        let resumed = TraceInfo { resume: true, counters: Some(counters), ..placed.trace };
        let records = memory.upload(&[GeometryRecord::default(); 3]);
        let instances = BuildInfo { input: Input::Records(Records { records, count: 3 }), ..placed.build };
        let masks = memory.region(4 * placed.terrain.rays.len() as u64);
        let geometries = memory.region(3 * 8 * placed.terrain.rays.len() as u64);
        let several = memory.region(3 * 16 * placed.terrain.rays.len() as u64);
        let filtered = TraceInfo { masks: Some(masks), mask: 5, cull: Cull::Back, ..placed.trace };
        let all = TraceInfo { geometries: Some(geometries), hits: several, resume: true, ..filtered };
        let grid = placed.build.grid.address;
        let mut counts = Vec::with_capacity(16);
        let commands = foreign.record(|cmd| {
            // SAFETY: the command buffer is dropped without being submitted, while all of it lives.
            unsafe {
                counts.push(("build", allocations(|| tracer.cmd_build(cmd, &placed.build).unwrap())));
                counts.push(("barrier", allocations(|| cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::TRACE))));
                counts.push(("closest hit", allocations(|| tracer.cmd_closest_hit(cmd, grid, &placed.trace).unwrap())));
                counts.push(("closest hit, indirect", allocations(|| tracer.cmd_closest_hit(cmd, grid, &indirect).unwrap())));
                counts.push(("closest hit, resumed", allocations(|| tracer.cmd_closest_hit(cmd, grid, &resumed).unwrap())));
                counts.push(("any hit", allocations(|| tracer.cmd_any_hit(cmd, grid, &placed.trace).unwrap())));
                counts.push(("build of records", allocations(|| tracer.cmd_build(cmd, &instances).unwrap())));
                counts.push(("any hit, filtered", allocations(|| tracer.cmd_any_hit(cmd, grid, &filtered).unwrap())));
                counts.push(("count of hits", allocations(|| tracer.cmd_count_hits(cmd, grid, &filtered).unwrap())));
                counts.push(("nearest hits", allocations(|| tracer.cmd_nearest_hits(cmd, grid, &all, 3).unwrap())));
            }
        });
        drop(commands);
        for (what, count) in counts {
            assert_eq!(count, 0, "{what} allocates");
        }
        assert_eq!(allocations(|| drop(std::hint::black_box(vec![1u8]))), 1, "allocations are not counted");
        foreign.check();
    }
}
