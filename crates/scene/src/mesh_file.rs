//! A file with one mesh, whatever its format.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::assets::Assets;
use crate::files::read_file;
use crate::load::{folder_of, stem};
use crate::{Mesh, Result, obj_scene};

/// A mesh, and what it took to get it.
pub(crate) struct Timed {
    pub(crate) mesh: Mesh,
    pub(crate) read_ms: f64,
    pub(crate) parse_ms: f64,
}

/// Reads a file that may be opened; `shown` is its name in messages.
pub(crate) fn read(assets: &mut Assets, path: &Path, shown: &str) -> Result<Timed> {
    let begin = Instant::now();
    let bytes = read_file(path, assets.options.max_mesh_bytes)?;
    let read_ms = milliseconds(begin);
    let begin = Instant::now();
    let folder: PathBuf = folder_of(path);
    let mesh = parse(assets, &bytes, shown, &stem(path), Some(&folder))?;
    Ok(Timed { mesh, read_ms, parse_ms: milliseconds(begin) })
}

/// Makes a mesh of a file's bytes. `folder` is where the files that it names are looked for.
pub(crate) fn parse(assets: &mut Assets, bytes: &[u8], shown: &str, name: &str, folder: Option<&Path>) -> Result<Mesh> {
    obj_scene::read(assets, bytes, shown, name, folder, 0)
}

pub(crate) fn milliseconds(begin: Instant) -> f64 {
    begin.elapsed().as_secs_f64() * 1e3
}
