//! What may be in flight together, as the contract says.

use gridwalk::{BuildOptions, Hit, Tracer, cmd_barrier};
use gridwalk_tests::gpu::Gpu;

use super::compare::differences;
use super::{meshes, rays};

/// One grid is traced while the next is built, without a barrier between the two.
#[test]
fn a_frame_is_traced_while_the_next_is_built() {
    let gpu = Gpu::shared();
    let frames: Vec<_> = (0..4).map(|seed| meshes::soup(400 + 100 * seed, 0.2, 95 + seed as u64)).collect();
    let mut grids: Vec<_> = frames.iter().map(|mesh| gpu.prepare(mesh, super::roomy(mesh), BuildOptions::default())).collect();
    let alone: Vec<_> = frames.iter().map(|mesh| gpu.build(mesh, super::roomy(mesh), BuildOptions::default())).collect();
    let rays = rays::random_rays(&frames[0], 2_000, 99);
    gpu.rebuild(&mut grids[0]);
    for frame in 0..3 {
        let next = grids[frame + 1].info;
        let found: Vec<Hit> = gpu.trace(&grids[frame], &rays, |cmd, at, info| {
            // SAFETY: see `trace`; the next grid's memory lives until then too, and shares nothing with this one's.
            unsafe {
                gpu.tracer.cmd_build(cmd, &next)?;
                gpu.tracer.cmd_closest_hit(cmd, at, info)?;
                cmd_barrier(gpu.context.device(), cmd, Tracer::BUILD, Tracer::TRACE);
            }
            Ok(())
        });
        grids[frame + 1].check_guards();
        assert_eq!(differences(&found, &gpu.closest(&alone[frame], &rays)), [0; 0], "frame {frame}");
    }
    assert_eq!(differences(&gpu.closest(&grids[3], &rays), &gpu.closest(&alone[3], &rays)), [0; 0]);
    assert!(!differences(&gpu.closest(&alone[2], &rays), &gpu.closest(&alone[3], &rays)).is_empty(), "frames differ");
}
