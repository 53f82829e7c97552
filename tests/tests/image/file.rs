use std::fs;
use std::path::{Path, PathBuf};

use gridwalk_render::image::{Error, Format, Overwrite, write_file};

fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    entries
}

fn write(path: &Path, overwrite: Overwrite, bytes: &[u8]) -> Result<(), Error> {
    write_file(path, overwrite, |writer| writer.write_all(bytes).map_err(|_| Error::Encode { reason: "write".to_owned() }))
}

#[test]
fn a_failure_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    write(&path, Overwrite::Replace, b"first").unwrap();
    let result = write_file(&path, Overwrite::Replace, |writer| {
        writer.write_all(b"half a pic").unwrap();
        Err(Error::Encode { reason: "stop".to_owned() })
    });
    assert!(matches!(result, Err(Error::Encode { .. })));
    assert_eq!(fs::read(&path).unwrap(), b"first");
    assert_eq!(entries(folder.path()), std::slice::from_ref(&path), "no temporary file is left");
    write(&path, Overwrite::Replace, b"second").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"second");
}

#[test]
fn nothing_is_overwritten_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    write(&path, Overwrite::Refuse, b"first").unwrap();
    assert!(matches!(write(&path, Overwrite::Refuse, b"second"), Err(Error::Exists { .. })));
    // Made by someone else between the first look and the rename.
    let late = folder.path().join("late.png");
    let result = write_file(&late, Overwrite::Refuse, |writer| {
        fs::write(&late, b"theirs").unwrap();
        writer.write_all(b"ours").unwrap();
        Ok(())
    });
    assert!(matches!(result, Err(Error::Exists { .. })), "{result:?}");
    assert_eq!(fs::read(&late).unwrap(), b"theirs");
    assert_eq!(entries(folder.path()), [path, late]);
}

#[test]
fn messages_name_the_path_and_the_cure() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, b"").unwrap();
    for (path, cure) in [
        (folder.path().join("none/a.png"), "make the folder first"),
        (folder.path().to_owned(), "give the name of a file"),
        (file.join("a.png"), "a part of the path is a file"),
    ] {
        let message = write(&path, Overwrite::Replace, b"x").unwrap_err().to_string();
        assert!(message.contains(&path.display().to_string()) && message.contains(cure), "{message}");
        assert!(!message.contains(".part"), "{message}");
    }
    assert_eq!(entries(folder.path()), [file]);
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_modes_are_ordinary() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("target.png");
    let link = folder.path().join("link.png");
    write(&target, Overwrite::Replace, b"first").unwrap();
    assert_ne!(fs::metadata(&target).unwrap().permissions().mode() & 0o600, 0);
    let plain = folder.path().join("plain");
    fs::write(&plain, b"").unwrap();
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode(), fs::metadata(&plain).unwrap().permissions().mode());
    std::os::unix::fs::symlink(&target, &link).unwrap();
    write(&link, Overwrite::Replace, b"second").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&target).unwrap(), b"second");
}

/// A device is no file that may be replaced by one; and one that is always full says what a full disk says.
#[cfg(target_os = "linux")]
#[test]
fn devices_are_written_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    write(Path::new("/dev/null"), Overwrite::Replace, b"x").unwrap();
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let message = write(Path::new("/dev/full"), Overwrite::Replace, b"x").unwrap_err().to_string();
    assert!(message.contains("/dev/full") && message.contains("make room"), "{message}");
    assert!(fs::metadata("/dev/full").unwrap().file_type().is_char_device());
}

#[test]
fn formats_by_extension() {
    assert_eq!(Format::of_path(Path::new("a/b.PNG")).unwrap(), Format::Png);
    assert_eq!(Format::of_path(Path::new("b.c.exr")).unwrap(), Format::Exr);
    for path in ["a", "a.jpg", ".png", ""] {
        assert!(matches!(Format::of_path(Path::new(path)), Err(Error::UnknownFormat { .. })), "{path}");
    }
}
