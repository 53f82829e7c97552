//! Animated models of MegaGlest (G3D, version 4) as OBJ key-frames.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

/// Little-endian values from the front of a file.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn bytes(&mut self, count: usize) -> Result<&'a [u8]> {
        let (front, rest) = self.0.split_at_checked(count).context("the file ends early")?;
        self.0 = rest;
        Ok(front)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut array = [0; N];
        array.copy_from_slice(self.bytes(N)?);
        Ok(array)
    }

    fn u32(&mut self) -> Result<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn f32s(&mut self, count: usize) -> Result<Vec<f32>> {
        let bytes = self.bytes(count.checked_mul(4).context("a number too large")?)?;
        Ok(bytes.as_chunks().0.iter().map(|chunk| f32::from_le_bytes(*chunk)).collect())
    }

    /// A name in a field of 64 bytes.
    fn name(&mut self) -> Result<String> {
        Ok(self.bytes(64)?.iter().take_while(|&&byte| byte != 0).map(|&byte| char::from(byte)).collect())
    }
}

/// A part of a model; all its key-frames have the same triangles.
struct Part {
    frames: usize,
    vertices: usize,
    /// Key-frame after key-frame.
    positions: Vec<f32>,
    normals: Vec<f32>,
    uvs: Option<Vec<f32>>,
    triangles: Vec<u32>,
    diffuse: Vec<f32>,
    opacity: f32,
    texture: Option<String>,
}

fn parts(bytes: &[u8]) -> Result<Vec<Part>> {
    let mut reader = Reader(bytes);
    if reader.array::<4>()? != *b"G3D\x04" {
        bail!("no G3D file of version 4");
    }
    let count = u16::from_le_bytes(reader.array()?);
    reader.bytes(1)?;
    let mut parts = Vec::new();
    for _ in 0..count {
        reader.name()?;
        let [frames, vertices, indices] = [reader.u32()? as usize, reader.u32()? as usize, reader.u32()? as usize];
        let diffuse = reader.f32s(3)?;
        // Specular colour and power.
        reader.bytes(16)?;
        let opacity = f32::from_le_bytes(reader.array()?);
        reader.u32()?;
        let textures = reader.u32()?;
        let mut texture = None;
        for bit in 0..5 {
            if textures & (1 << bit) != 0 {
                let name = reader.name()?;
                texture = texture.or((bit == 0).then_some(name));
            }
        }
        let numbers = frames.checked_mul(vertices).and_then(|n| n.checked_mul(3)).context("a number too large")?;
        let (positions, normals) = (reader.f32s(numbers)?, reader.f32s(numbers)?);
        let uvs = if textures & 1 != 0 { Some(reader.f32s(2 * vertices)?) } else { None };
        let bytes = reader.bytes(indices.checked_mul(4).context("a number too large")?)?;
        let triangles: Vec<u32> = bytes.as_chunks().0.iter().map(|chunk| u32::from_le_bytes(*chunk)).collect();
        if frames == 0 || !triangles.len().is_multiple_of(3) || triangles.iter().any(|&index| index as usize >= vertices) {
            bail!("a part whose triangles do not fit its vertices");
        }
        parts.push(Part { frames, vertices, positions, normals, uvs, triangles, diffuse, opacity, texture });
    }
    Ok(parts)
}

/// Writes `NAME.0000.obj` and so on, `NAME.mtl` and the textures into a folder.
pub fn convert(model: &Path, folder: &Path, name: &str) -> Result<()> {
    let bytes = fs::read(model).with_context(|| format!("{}: cannot be read", model.display()))?;
    let parts = parts(&bytes).with_context(|| format!("{}: not understood", model.display()))?;
    fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
    let write = |file: String, text: &str| fs::write(folder.join(&file), text).with_context(|| format!("{file}: cannot be written"));
    let mut mtl = String::new();
    for (index, part) in parts.iter().enumerate() {
        // Nearly all files give leaves and earth a white gloss, of which the game shows nothing.
        let _ = writeln!(mtl, "newmtl m{index}\nKd {}\nd {}", words(&part.diffuse), part.opacity);
        if let Some(texture) = &part.texture {
            let _ = writeln!(mtl, "map_Kd {}", copy_texture(model, texture, folder)?);
        }
    }
    write(format!("{name}.mtl"), &mtl)?;
    let frames = parts.iter().map(|part| part.frames).max().context("a model without parts")?;
    for frame in 0..frames {
        write(format!("{name}.{frame:04}.obj"), &key_frame(&parts, frame, frames, name))?;
    }
    Ok(())
}

fn words(numbers: &[f32]) -> String {
    numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

fn key_frame(parts: &[Part], frame: usize, frames: usize, name: &str) -> String {
    let mut obj = format!("mtllib {name}.mtl\n");
    let (mut base, mut uv_base) = (1, 1);
    for (index, part) in parts.iter().enumerate() {
        // A part with fewer key-frames goes through them in the same time.
        let own = (frame * part.frames / frames).min(part.frames - 1);
        let range = 3 * own * part.vertices..3 * (own + 1) * part.vertices;
        let _ = writeln!(obj, "o part{index}\nusemtl m{index}");
        for (keyword, values) in [("v", &part.positions), ("vn", &part.normals)] {
            for value in values[range.clone()].chunks(3) {
                let _ = writeln!(obj, "{keyword} {}", words(value));
            }
        }
        for uv in part.uvs.iter().flat_map(|uvs| uvs.chunks(2)) {
            let _ = writeln!(obj, "vt {}", words(uv));
        }
        for triangle in part.triangles.chunks(3) {
            obj.push('f');
            for &corner in triangle {
                let v = base + corner as usize;
                let _ = match part.uvs {
                    Some(_) => write!(obj, " {v}/{}/{v}", uv_base + corner as usize),
                    None => write!(obj, " {v}//{v}"),
                };
            }
            obj.push('\n');
        }
        base += part.vertices;
        uv_base += if part.uvs.is_some() { part.vertices } else { 0 };
    }
    obj
}

/// Copies a texture that lies beside a model, whatever the case of its name, and gives its true name.
fn copy_texture(model: &Path, texture: &str, folder: &Path) -> Result<String> {
    let beside = model.parent().context("a model without a folder")?;
    for entry in fs::read_dir(beside).with_context(|| format!("{}: cannot be listed", beside.display()))? {
        let name = entry?.file_name();
        if name.to_string_lossy().eq_ignore_ascii_case(texture) {
            super::copy(&beside.join(&name), &folder.join(&name))?;
            return Ok(name.to_string_lossy().into_owned());
        }
    }
    bail!("{}: its texture {texture} is missing", model.display())
}
