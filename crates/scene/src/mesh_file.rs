//! A file with one mesh, whatever its format.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use flate2::bufread::MultiGzDecoder;

use crate::assets::Assets;
use crate::files::{read_file, read_stream};
use crate::load::{ending, folder_of, stem};
use crate::texture::Use;
use crate::{Material, Mesh, Result, obj_scene, ply};

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

/// Makes a mesh of a file's bytes, packed or not. `folder` is where the files that it names are looked for.
pub(crate) fn parse(assets: &mut Assets, bytes: &[u8], shown: &str, name: &str, folder: Option<&Path>) -> Result<Mesh> {
    let bytes = unpacked(bytes, shown, assets.options.max_mesh_bytes)?;
    // By what it holds; the name only tells which reader's complaint is the right one.
    let named_ply = matches!(ending(Path::new(shown)).as_deref(), Some("ply" | "ply.gz"));
    if ply::is_ply(&bytes) || named_ply {
        read_ply(assets, &bytes, shown, name, folder)
    } else {
        obj_scene::read(assets, &bytes, shown, name, folder, 0)
    }
}

fn read_ply(assets: &mut Assets, bytes: &[u8], shown: &str, name: &str, folder: Option<&Path>) -> Result<Mesh> {
    let mut ply = ply::parse(bytes, shown, name)?;
    assets.warnings.append(&mut ply.warnings);
    let texture = match (&ply.texture, folder) {
        (Some((file, line)), Some(folder)) => {
            let mut load = |usage: Use| assets.textures.load(folder, file, usage);
            let loaded = load(Use::Colour).and_then(|colour| Ok((colour, load(Use::AlphaOfColour)?)));
            loaded.map_err(|message| assets.warnings.push(format!("{shown}:{line}: no texture: {message}"))).ok()
        }
        (Some((_, line)), None) => {
            assets.warnings.push(format!("{shown}:{line}: the texture of a stream is not read"));
            None
        }
        (None, _) => None,
    };
    let (diffuse_map, opacity_map) = texture.unwrap_or_default();
    let coloured = !ply.mesh.colours.is_empty();
    if coloured || diffuse_map.is_some() {
        // What the file says of colour is all of it, not a tint of the default grey.
        let name = ply.texture.map_or_else(|| "vertex colours".to_owned(), |(file, _)| file);
        let material = assets.material(Material { name, diffuse: [1.0; 3], diffuse_map, opacity_map, ..Material::default() });
        ply.mesh.materials.fill(material);
    }
    Ok(ply.mesh)
}

/// The bytes themselves, or what is packed in them by gzip, up to a limit: a few bytes may hold any number of them.
fn unpacked<'a>(bytes: &'a [u8], shown: &str, limit: u64) -> Result<Cow<'a, [u8]>> {
    if bytes.starts_with(&[0x1f, 0x8b]) {
        read_stream(&mut MultiGzDecoder::new(bytes), Path::new(shown), limit).map(Cow::Owned)
    } else {
        Ok(Cow::Borrowed(bytes))
    }
}

pub(crate) fn milliseconds(begin: Instant) -> f64 {
    begin.elapsed().as_secs_f64() * 1e3
}
