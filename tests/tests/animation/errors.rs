//! Key-frames that are missing or broken, and players that end early.

use gridwalk_render::Error;
use gridwalk_scene::generate;

use super::*;

fn keys(count: usize) -> Vec<Mesh> {
    (0..count).map(|key| generate::sphere([0.1 * key as f32, 0.0, 0.0], 1.0, 8)).collect()
}

const SCENE: &str = "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\n";

#[test]
fn a_bad_key_frame_is_an_error_of_the_frame_that_needs_it_alone() {
    let folder = sequence(&keys(6), SCENE);
    std::fs::write(folder.path().join("key.0002.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
    std::fs::remove_file(folder.path().join("key.0004.obj")).unwrap();
    let mut run = play(folder.path());
    for time in [0.0, 0.5, 1.0] {
        let stats = seek(&mut run, time, &[1.5, 2.0, 2.5]);
        assert!(stats.rebuilt, "{time}");
    }
    let before = shoot_player(&run);
    for time in [1.5, 2.0, 2.5, 1.25] {
        let error = run.seek(time, &[3.0]).unwrap_err();
        assert!(matches!(error, Error::KeyFrame(_)) && error.to_string().contains("key.0002.obj:2"), "{error}");
        // What was there is there still.
        assert_same_picture("after the error", &before, &shoot_player(&run));
    }
    seek(&mut run, 3.0, &[4.0]);
    let error = run.seek(3.5, &[]).unwrap_err();
    assert!(error.to_string().contains("key.0004.obj"), "{error}");
    seek(&mut run, 5.0, &[]);
    seek(&mut run, 1.0, &[]);
    assert_same_picture("back again", &before, &shoot_player(&run));
    // Once it is mended it is read.
    std::fs::write(folder.path().join("key.0002.obj"), obj(&keys(3)[2])).unwrap();
    seek(&mut run, 2.0, &[]);
    assert!(differ(&before, &shoot_player(&run)));
}

#[test]
fn times_without_a_meaning_are_refused() {
    let folder = sequence(&keys(2), SCENE);
    let mut run = play(folder.path());
    for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = run.seek(time, &[]).unwrap_err();
        assert!(matches!(error, Error::Setting { setting: "time", .. }), "{error}");
    }
    for time in [-1e300, 1e300, f64::MIN_POSITIVE] {
        seek(&mut run, time, &[f64::NAN, -time]);
    }
}

#[test]
fn a_player_may_end_while_it_reads() {
    let folder = sequence(&vec![generate::sphere([0.0; 3], 1.0, 60); 8], SCENE);
    let bytes = context().allocated_bytes();
    for upcoming in 0..6 {
        let mut run = play(folder.path());
        if upcoming > 0 {
            seek(&mut run, 0.5, &[2.0, 3.0, 4.0]);
            seek(&mut run, f64::from(upcoming), &[7.0, 6.0]);
        }
        drop(run);
        Gpu::shared().check_validation();
    }
    // Other tests run on the same device; one of its own is exact.
    let own = Gpu::new(None);
    let mut run = Player::new(&own.context, animation(folder.path()), &PlayerOptions::default()).unwrap();
    run.seek(0.5, &[2.0]).unwrap();
    drop(run);
    assert_eq!(own.context.allocated_bytes(), 0);
    own.check_validation();
    assert!(bytes < u64::MAX);
}

#[test]
fn an_animation_whose_parts_do_not_fit_is_refused() {
    let folder = sequence(&keys(2), SCENE);
    let mut wrong = animation(folder.path());
    wrong.motions.clear();
    let error = Player::new(context(), wrong, &PlayerOptions::default()).unwrap_err();
    assert!(matches!(error, Error::Scene { .. }), "{error}");
}
