//! `gridwalk.h` is made anew from the sources and compared with what is committed.

use std::fs;

use super::root;

/// The header that these sources make.
fn make(sources: &[(&str, String)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let config = cbindgen::Config::from_file(root().join("crates/capi/cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for (name, text) in sources {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        builder = builder.with_src(path);
    }
    let mut header = Vec::new();
    builder.generate().unwrap().write(&mut header);
    String::from_utf8(header).unwrap()
}

fn sources() -> [(&'static str, String); 2] {
    ["types.rs", "functions.rs"].map(|name| (name, fs::read_to_string(root().join("crates/capi/src").join(name)).unwrap()))
}

#[test]
fn the_header_is_as_its_sources_say() {
    let path = root().join("crates/capi/include/gridwalk.h");
    let made = make(&sources());
    if std::env::var_os("GRIDWALK_BLESS").is_some() {
        fs::write(&path, &made).unwrap();
    }
    let committed = fs::read_to_string(&path).unwrap();
    let line = made.lines().zip(committed.lines()).position(|(made, committed)| made != committed);
    assert!(
        made == committed,
        "crates/capi/include/gridwalk.h is stale, first in line {}: cargo tool bless capi::header",
        line.map_or(committed.lines().count(), |line| line + 1)
    );
}

#[test]
fn a_changed_source_changes_the_header() {
    let mut sources = sources();
    let header = make(&sources);
    sources[0].1 = sources[0].1.replacen("pub struct_size: u32", "pub struct_size: u64", 1);
    assert_ne!(make(&sources), header);
}
