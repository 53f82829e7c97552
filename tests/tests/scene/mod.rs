//! Scene files: what is read from good ones, what is said about bad ones, and what is never opened.

mod animation;
mod committed;
mod fuzz;
mod gltf;
mod gltf_fuzz;
mod gltf_poses;
mod moving;
mod nasty;
mod oracle;
mod ply;
mod reading;
mod sandbox;

use std::path::Path;

use tempfile::TempDir;

/// A folder with these files.
fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

/// A message with the folder's name, which differs in every run, as `DIR`.
fn without_folder(message: &str, folder: &Path) -> String {
    let canonical = folder.canonicalize().unwrap();
    message.replace(&*canonical.to_string_lossy(), "DIR").replace(&*folder.to_string_lossy(), "DIR")
}

/// A PNG of one row.
fn png(colour: png::ColorType, row: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let width = (row.len() / colour.samples()) as u32;
    let mut encoder = png::Encoder::new(&mut bytes, width, 1);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(row).unwrap();
    bytes
}

/// An uncompressed TGA of one row, bottom up, blue first.
fn tga(bits: u8, row: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0, 0, if bits == 8 { 3 } else { 2 }, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend(((row.len() / (bits as usize / 8)) as u16).to_le_bytes());
    bytes.extend([1, 0, bits, if bits == 32 { 8 } else { 0 }]);
    bytes.extend(row);
    bytes
}
