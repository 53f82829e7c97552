//! After the first frames nothing grows: neither on the device nor beside it.

use std::alloc::{GlobalAlloc, Layout, System};
use std::process::Command;
use std::sync::atomic::{AtomicI64, Ordering};

use gridwalk_scene::generate;

use super::*;

/// Rust's heap, with the bytes that are in use.
struct Counting;

static IN_USE: AtomicI64 = AtomicI64::new(0);

#[global_allocator]
static ALLOCATOR: Counting = Counting;

// SAFETY: all is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        IN_USE.fetch_add(layout.size() as i64, Ordering::Relaxed);
        // SAFETY: the caller's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        IN_USE.fetch_add(layout.size() as i64, Ordering::Relaxed);
        // SAFETY: the caller's contract.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        IN_USE.fetch_add(size as i64 - layout.size() as i64, Ordering::Relaxed);
        // SAFETY: the caller's contract.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size() as i64, Ordering::Relaxed);
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// Resident bytes of this process; `None` where the system does not tell them like Linux.
fn resident() -> Option<i64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(text.split_whitespace().nth(1)?.parse::<i64>().ok()? * 4096)
}

const FRAMES: u32 = 300;

/// Plays three hundred frames on a device of its own: not a buffer is made after the first round of so many frames. Returns what is in use of
/// the heap and resident after each frame.
fn play_long(path: &Path, round: u32, time: impl Fn(u32) -> f64) -> Vec<(i64, i64)> {
    let own = Gpu::new(None);
    let renderer = Renderer::new(&own.context).unwrap();
    let mut run = Player::new(&own.context, animation(path), &PlayerOptions::default()).unwrap();
    let settings = RenderSettings { width: 16, height: 12, depth: 1, ..RenderSettings::default() };
    let mut state = None;
    let mut builds = 0;
    let mut memory = Vec::with_capacity(FRAMES as usize);
    for frame in 0..FRAMES {
        let stats = run.seek(time(frame), &[time(frame + 1), time(frame + 2)]).unwrap();
        builds += u32::from(stats.rebuilt);
        renderer.render(run.scene(), run.grid(), &camera(), &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        if frame >= round {
            let now = (own.context.allocations(), own.context.allocated_bytes(), own.context.peak_bytes());
            assert_eq!((stats.grown, now), (0, *state.get_or_insert(now)), "frame {frame}");
        }
        memory.push((IN_USE.load(Ordering::Relaxed), resident().unwrap_or(0)));
    }
    assert!(builds > 100, "{builds} builds");
    own.check_validation();
    // Negative control: what is made is counted.
    let before = own.context.allocations();
    let scene = GpuScene::upload(&own.context, &run.animation().scene).unwrap();
    assert!(own.context.allocations() > before && scene.bytes() > 0);
    memory
}

/// Set in the processes that play, with what they play.
const CHILD: &str = "GRIDWALK_TEST_STEADY";
const NAME: &str = "animation::steady::three_hundred_frames_take_no_more_memory";

/// Growth of the heap that is no leak: what the reading thread holds differs from frame to frame. A leak of 300 bytes a frame is more.
const HEAP_SLACK: i64 = 30 << 10;
/// The same of all memory, which holds the driver's and comes in pages.
const RESIDENT_SLACK: i64 = 8 << 20;

#[test]
fn three_hundred_frames_take_no_more_memory() {
    if let Some(what) = std::env::var_os(CHILD) {
        let memory = if what == "keys" {
            let keys: Vec<Mesh> = (0..6).map(|key| generate::sphere([0.0, 0.1 * key as f32, 0.0], 0.8, 6 + key % 3)).collect();
            let text = "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 10\nloop = true\n[[mesh]]\nshape = \"box\"\nscale = 0.3\ntranslate = [1, 0, 0]\n";
            play_long(sequence(&keys, text).path(), 20, |frame| f64::from(frame) / 15.0)
        } else {
            // The two seconds of the clip, again and again: in the first round a cell is split, and the grid makes room for it.
            play_long(&deformed::file().path().join("a.gltf"), 80, |frame| f64::from(frame % 80) / 40.0)
        };
        let line: Vec<String> = memory.iter().map(|(heap, resident)| format!("{heap} {resident}")).collect();
        println!("memory {}", line.join(" "));
        return;
    }
    // Processes of their own, since other tests use memory too.
    for what in ["keys", "skin"] {
        let mut command = Command::new(std::env::current_exe().unwrap());
        let output = command.args(["--exact", NAME, "--nocapture"]).env(CHILD, what).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{what}: {text}{}", String::from_utf8_lossy(&output.stderr));
        let line = text.lines().find_map(|line| line.find("memory ").map(|at| line[at + 7..].to_owned())).expect("a line of memory");
        let numbers: Vec<i64> = line.split_whitespace().map(|number| number.parse().unwrap()).collect();
        assert_eq!(numbers.len(), 2 * FRAMES as usize);
        // The most of the second hundred frames, and of the third.
        let most = |hundred: usize, which: usize| numbers[200 * hundred..][..200].iter().skip(which).step_by(2).max().copied().unwrap();
        let grown = [0, 1].map(|which| most(2, which) - most(1, which));
        assert!(grown[0] < HEAP_SLACK && grown[1] < RESIDENT_SLACK, "{what}: {} bytes of the heap, {} resident", grown[0], grown[1]);
        assert!(numbers[0] > 10_000, "the heap is counted");
    }
}

/// The next key-frame is read, parsed and sent while nobody asks for it: when it is there, its file may go, and a seek has nothing to wait for.
#[test]
fn key_frames_come_beside_the_frame_before() {
    let keys: Vec<Mesh> = (0..5).map(|key| generate::sphere([0.0, 0.1 * key as f32, 0.0], 0.8, 40 + key)).collect();
    let folder = sequence(&keys, "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\nfirst = 0\nlast = 4\n");
    let mut run = play(folder.path());
    seek(&mut run, 0.0, &[1.0]);
    for key in 1..5 {
        let time = f64::from(key);
        let begin = std::time::Instant::now();
        while !run.is_ready(time) {
            assert!(begin.elapsed().as_secs() < 60, "key-frame {key} does not come");
            std::thread::yield_now();
        }
        std::fs::remove_file(folder.path().join(format!("key.{key:04}.obj"))).unwrap();
        let stats = seek(&mut run, time, &[time + 1.0]);
        let took = stats.read_ms + stats.parse_ms + stats.stage_ms + stats.upload_ms;
        assert!(stats.key_frames == 1 && took > 0.0 && stats.rebuilt, "{stats:?}");
        assert!((stats.hidden_ms - took).abs() < 1e-6 && stats.wait_ms == 0.0, "all of it was hidden: {stats:?}");
    }
    // Negative control: what was not named as upcoming is not there, and has to be waited for.
    let folder = sequence(&keys, "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\n");
    let mut run = play(folder.path());
    let stats = seek(&mut run, 0.0, &[]);
    assert!(stats.key_frames == 1 && stats.hidden_ms == 0.0, "nothing is hidden behind no frame: {stats:?}");
    assert!(!run.is_ready(3.0) && run.is_ready(0.0));
    let stats = seek(&mut run, 3.0, &[]);
    assert!(stats.key_frames == 1 && stats.wait_ms > 0.0 && stats.hidden_ms == 0.0, "{stats:?}");
    assert!(run.is_ready(3.0));
}
