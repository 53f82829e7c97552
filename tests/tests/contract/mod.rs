//! What stands at the head of crate `gridwalk`, on a device and in memory that the tests make by hand, under synchronization validation.
//!
//! The layers see what commands name by handle: fills, copies and the arguments of indirect dispatches. What kernels reach by address they
//! do not see, and a driver on the CPU, which runs one dispatch after another, gives the right hits without a barrier too: for such a barrier
//! nothing that runs here can be a negative control. Of these barriers the plans' own walk for hazards speaks (`rebuild::plan`): it knows
//! what each kernel reads and writes, and finds a hazard where any barrier is left out, the library's or the caller's.

mod cache;
mod calls;
mod memory;
mod requirements;
mod state;

use gridwalk::ash::vk;
use gridwalk::{Access, Hit, Tracer, cmd_barrier};
use gridwalk_tests::foreign::{Foreign, Memory, POISON, Placed, Terrain, is_validated};

/// Nothing is enabled but what [`gridwalk::requirements::features`] asks for, and nothing is left on the device.
#[test]
fn the_required_features_suffice() {
    let features = gridwalk::requirements::features();
    let enabled = |on: &[vk::Bool32]| on.iter().filter(|on| **on == vk::TRUE).count();
    assert_eq!(enabled(&[features.vulkan_12.buffer_device_address, features.vulkan_13.synchronization2]), 2);
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let placed = Placed::new(&memory, &tracer, Terrain::new(20, 0));
        let commands = foreign.record(|cmd| {
            // SAFETY: what is recorded is submitted once and waited for below, while all of it lives.
            unsafe {
                placed.cmd_build(&tracer, cmd);
                cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::TRACE);
                placed.cmd_trace(&tracer, cmd);
                cmd_barrier(&foreign.device, cmd, Tracer::TRACE, Access::HOST_READ);
            }
        });
        foreign.submit(&[&commands]);
        placed.check();
        memory.check_gaps();
        let mut hits: Vec<Hit> = memory.read(&placed.trace.hits, placed.terrain.rays.len());
        hits[7].triangle = 0;
        assert_eq!(placed.terrain.wrong(&hits), 1, "a wrong hit is not seen");
        foreign.check();
        // The same commands again, in memory that has been poisoned: no build needs what an earlier one left.
        for region in [&placed.build.grid, &placed.build.scratch, &placed.build.report, &placed.trace.scratch, &placed.trace.hits] {
            memory.poison(region);
        }
        foreign.submit(&[&commands]);
        placed.check();
        memory.check_gaps();
    }
    assert_eq!(foreign.close(), [""; 0]);
}

/// Fills, build, trace and fills again in one command buffer, but for the barrier of this number.
fn filled_and_traced(left_out: Option<usize>) -> Vec<String> {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 8 << 20);
        let placed = Placed::new(&memory, &tracer, Terrain::new(8, 1));
        let scratches = [placed.build.scratch, placed.trace.scratch];
        let commands = foreign.record(|cmd| {
            let barrier = |number: usize, before: Access, after: Access| {
                if left_out != Some(number) {
                    // SAFETY: the command buffer is being recorded, outside of a render pass.
                    unsafe { cmd_barrier(&foreign.device, cmd, before, after) };
                }
            };
            let fill = |region: &gridwalk::Region| {
                // SAFETY: as above; regions begin at multiples of 64 in a buffer with usage TRANSFER_DST.
                unsafe { foreign.device.cmd_fill_buffer(cmd, region.buffer, region.offset, region.size / 4 * 4, POISON) };
            };
            scratches.iter().for_each(fill);
            barrier(0, Access::TRANSFER, Tracer::BUILD);
            // SAFETY: what is recorded is submitted once and waited for below, while all of it lives.
            unsafe { placed.cmd_build(&tracer, cmd) };
            barrier(1, Tracer::BUILD, Tracer::TRACE);
            // SAFETY: as above.
            unsafe { placed.cmd_trace(&tracer, cmd) };
            barrier(2, Tracer::TRACE, Access::TRANSFER);
            scratches.iter().for_each(fill);
        });
        if left_out.is_none() {
            foreign.submit(&[&commands]);
            placed.check();
        }
    }
    foreign.close()
}

#[test]
fn the_documented_barriers_suffice() {
    assert_eq!(filled_and_traced(None), [""; 0]);
}

#[test]
fn a_barrier_left_out_is_a_hazard() {
    if !is_validated() {
        return;
    }
    for (number, kind) in [(0, "READ-AFTER-WRITE"), (2, "WRITE-AFTER-READ")] {
        let messages = filled_and_traced(Some(number));
        // Newer layers write "READ_AFTER_WRITE".
        assert!(messages.iter().any(|message| message.replace('_', "-").contains(kind)), "without barrier {number}: {messages:?}");
    }
}

/// While one grid is built another is traced: they share nothing but the tracer.
#[test]
fn a_grid_is_traced_while_the_next_is_built() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memory = Memory::new(&foreign, 16 << 20);
        let grids = [Terrain::new(20, 0), Terrain::new(12, 2)].map(|terrain| Placed::new(&memory, &tracer, terrain));
        let first = foreign.record(|cmd| {
            // SAFETY: what is recorded is submitted and waited for below, while all of it lives.
            unsafe { grids[0].cmd_build(&tracer, cmd) };
        });
        foreign.submit(&[&first]);
        for (traced, built) in [(0, 1), (1, 0), (0, 1)] {
            memory.poison(&grids[built].build.grid);
            memory.poison(&grids[traced].trace.hits);
            let both = foreign.record(|cmd| {
                // SAFETY: as above.
                unsafe {
                    grids[traced].cmd_trace(&tracer, cmd);
                    grids[built].cmd_build(&tracer, cmd);
                }
            });
            foreign.submit(&[&both]);
            grids[traced].check();
        }
    }
    assert_eq!(foreign.close(), [""; 0]);
}

/// One tracer, and a command buffer a thread.
#[test]
fn threads_record_with_one_tracer() {
    let foreign = Foreign::new();
    {
        let tracer = foreign.tracer(vk::PipelineCache::null());
        let memories = [0; 2].map(|_| Memory::new(&foreign, 8 << 20));
        let placed: [Placed; 2] = std::array::from_fn(|i| Placed::new(&memories[i], &tracer, Terrain::new(10 + i as u32, i as u32)));
        let infos = placed.each_ref().map(|placed| (placed.build, placed.trace));
        let (device, tracer) = (&foreign, &tracer);
        let commands: Vec<_> = std::thread::scope(|scope| {
            let threads = infos.each_ref().map(|(build, trace)| {
                scope.spawn(move || {
                    // Recorded many times over, so that the threads meet.
                    (0..20).map(|_| record(device, tracer, build, trace)).next_back().unwrap()
                })
            });
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        foreign.submit(&commands.iter().collect::<Vec<_>>());
        placed.iter().for_each(Placed::check);
        memories.iter().for_each(Memory::check_gaps);
    }
    assert_eq!(foreign.close(), [""; 0]);
}

fn record<'a>(
    foreign: &'a Foreign,
    tracer: &Tracer,
    build: &gridwalk::BuildInfo,
    trace: &gridwalk::TraceInfo,
) -> gridwalk_tests::foreign::Commands<'a> {
    foreign.record(|cmd| {
        // SAFETY: what is submitted of this is waited for, while all of it lives.
        unsafe {
            tracer.cmd_build(cmd, build).unwrap();
            cmd_barrier(&foreign.device, cmd, Tracer::BUILD, Tracer::TRACE);
            tracer.cmd_closest_hit(cmd, build.grid.address, trace).unwrap();
        }
    })
}
