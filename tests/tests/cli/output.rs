//! Files appear whole or not at all; standard output carries data alone.

use std::fs;

use super::{decode_png, entries, folder, gridwalk, words};

#[test]
fn standard_output_is_the_picture_and_nothing_else() {
    let folder = folder();
    let run = gridwalk(folder.path(), words("render two.obj --size 20x10 -vvv --stats -o -")).expect(0);
    let (width, height, ..) = decode_png(&run.stdout);
    assert_eq!((width, height), (20, 10));
    assert!(run.stdout.ends_with(b"\0\0\0\0IEND\xaeB`\x82"), "nothing comes after the picture");
    assert!(run.stderr.contains("wall clock"));
    assert_eq!(entries(folder.path()), ["two.obj"]);
}

#[test]
fn several_outputs_at_once() {
    let folder = folder();
    let run = gridwalk(folder.path(), words("render two.obj --size 20x10 -o a.png -o b.exr -o - -o c.png")).expect(0);
    assert_eq!(fs::read(folder.path().join("a.png")).unwrap(), run.stdout);
    assert_eq!(entries(folder.path()), ["a.png", "b.exr", "c.png", "two.obj"]);
}

#[test]
fn what_cannot_be_written_is_status_7() {
    let folder = folder();
    fs::create_dir(folder.path().join("folder.png")).unwrap();
    fs::write(folder.path().join("kept.png"), "theirs").unwrap();
    for (output, said) in [
        ("none/a.png", &["none/a.png", "make the folder first"][..]),
        ("two.obj/a.png", &["two.obj/a.png"]),
        ("folder.png", &["folder.png", "name of a file"]),
        ("none/a.exr", &["none/a.exr", "make the folder first"]),
        ("kept.png --overwrite never", &["kept.png exists"]),
    ] {
        let run = gridwalk(folder.path(), words(&format!("render two.obj --size 8x8 -o {output}")));
        assert_eq!(run.stderr.matches("not found").count().max(1), 1, "the system's words are told once: {}", run.stderr);
        run.fails(7, said);
    }
    assert_eq!(fs::read(folder.path().join("kept.png")).unwrap(), b"theirs");
    assert_eq!(entries(folder.path()), ["folder.png", "kept.png", "two.obj"]);
    gridwalk(folder.path(), words("render two.obj --size 8x8 -o kept.png")).expect(0);
    assert_ne!(fs::read(folder.path().join("kept.png")).unwrap(), b"theirs");
    gridwalk(folder.path(), words("render two.obj --size 8x8 --overwrite never -o new.png")).expect(0);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_status_7() {
    let folder = folder();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full.png")).unwrap();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full.exr")).unwrap();
    for output in ["full.png", "full.exr"] {
        gridwalk(folder.path(), words(&format!("render two.obj --size 8x8 -o {output}"))).fails(7, &[output, "make room"]);
    }
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = super::prepared(folder.path(), words("render two.obj --size 8x8 -o -")).stdout(full).output().unwrap();
    super::Run::new("-o - into a full disk".to_owned(), output).fails(7, &["standard output"]);
}

#[cfg(unix)]
#[test]
fn a_folder_that_must_not_be_written_to() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let locked = folder.path().join("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(locked.join("probe"), "").is_ok() {
        eprintln!("skipped: this user may write anywhere");
        return;
    }
    gridwalk(folder.path(), words("render two.obj --size 8x8 -o locked/a.png")).fails(7, &["locked/a.png", "may write to"]);
    assert_eq!(entries(&locked), [""; 0]);
}

/// `gridwalk devices | head -0`
#[cfg(unix)]
#[test]
fn a_reader_that_leaves_is_no_error() {
    let folder = folder();
    for line in ["devices", "list aovs", "completions bash", "man", "info two.obj"] {
        let mut child = super::prepared(folder.path(), words(line))
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let run = super::Run::new(line.to_owned(), output).expect(0);
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
    }
}
