//! After the first frames nothing grows.

use gridwalk_scene::generate;

use super::*;

/// Three hundred frames of a sequence whose key-frames differ in size, on a device of its own: not a buffer is made after the first round.
#[test]
fn three_hundred_frames_allocate_nothing() {
    let keys: Vec<Mesh> = (0..6).map(|key| generate::sphere([0.0, 0.1 * key as f32, 0.0], 0.8, 6 + key % 3)).collect();
    let folder = sequence(
        &keys,
        "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 10\nloop = true\n[[mesh]]\nshape = \"box\"\nscale = 0.3\ntranslate = [1, 0, 0]\n",
    );
    let own = Gpu::new(None);
    let renderer = Renderer::new(&own.context).unwrap();
    let mut run = Player::new(&own.context, animation(folder.path()), &PlayerOptions::default()).unwrap();
    let settings = RenderSettings { width: 16, height: 12, depth: 1, ..RenderSettings::default() };
    let time = |frame: u32| f64::from(frame) / 15.0;
    let mut state = None;
    let (mut hidden, mut builds) = (0.0, 0);
    for frame in 0..300 {
        let stats = run.seek(time(frame), &[time(frame + 1), time(frame + 2)]).unwrap();
        hidden += stats.hidden_ms;
        builds += u32::from(stats.rebuilt);
        renderer.render(run.scene(), run.grid(), &camera(), &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        if frame >= 20 {
            let now = (own.context.allocations(), own.context.allocated_bytes(), own.context.peak_bytes());
            assert_eq!((stats.grown, now), (0, *state.get_or_insert(now)), "frame {frame}");
        }
    }
    assert!(hidden > 0.0 && builds > 100, "{builds} builds");
    own.check_validation();
    // Negative control: what is made is counted.
    let before = own.context.allocations();
    let scene = GpuScene::upload(&own.context, &run.animation().scene).unwrap();
    assert!(own.context.allocations() > before && scene.bytes() > 0);
}
