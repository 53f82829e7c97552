//! The container: GLB chunks, JSON, buffers. Every number of the file that says where something lies is checked here or in `accessor`.

use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::json::{self, Value, deserialize};

use crate::files::Files;
use crate::{Error, LoadOptions, Result};

/// Extensions that are read. Whatever else a file uses is told, and refused where the file requires it.
const SUPPORTED: [&str; 7] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

const MOST_WARNINGS: usize = 100;

/// A glTF file with its buffers.
pub(super) struct Document {
    pub(super) root: json::Root,
    file: String,
    folder: Option<PathBuf>,
    files: Arc<Files>,
    buffers: Vec<Vec<u8>>,
    /// Bytes that may still be unfolded: a small file can name the same numbers a million times.
    left: Cell<u64>,
    limit: u64,
    warnings: RefCell<Warnings>,
}

#[derive(Default)]
struct Warnings {
    list: Vec<String>,
    known: HashSet<String>,
}

impl Document {
    /// `folder` is where the file lies; without one (a stream) it must hold all its data itself.
    pub(super) fn open(bytes: &[u8], file: &str, folder: Option<&Path>, files: &Arc<Files>, options: &LoadOptions) -> Result<Document> {
        let fail = |message: String| Error::Gltf { file: file.to_owned(), message };
        let (text, chunk) = if bytes.starts_with(b"glTF") { chunks(bytes).map_err(fail)? } else { (bytes, None) };
        let root = parse(text).map_err(fail)?;
        let mut document = Document {
            root,
            file: file.to_owned(),
            folder: folder.map(Path::to_owned),
            files: files.clone(),
            buffers: Vec::new(),
            left: Cell::new(options.max_mesh_bytes),
            limit: options.max_mesh_bytes,
            warnings: RefCell::default(),
        };
        document.check_version()?;
        document.check_extensions()?;
        document.read_buffers(chunk)?;
        Ok(document)
    }

    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        Error::Gltf { file: self.file.clone(), message: message.into() }
    }

    /// Each sentence once, and not more of them than anybody reads.
    pub(super) fn warn(&self, message: impl Into<String>) {
        let message = message.into();
        let mut warnings = self.warnings.borrow_mut();
        if warnings.list.len() < MOST_WARNINGS && warnings.known.insert(message.clone()) {
            warnings.list.push(format!("{}: {message}", self.file));
        }
    }

    pub(super) fn take_warnings(&self) -> Vec<String> {
        std::mem::take(&mut self.warnings.borrow_mut().list)
    }

    /// Counts bytes that are about to be allocated.
    pub(super) fn charge(&self, count: usize, each: usize) -> Result<()> {
        let bytes = (count as u64).saturating_mul(each as u64);
        match self.left.get().checked_sub(bytes) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => Err(self.error(format!("unfolds to more than {} bytes; raise the limit if this is meant", self.limit))),
        }
    }

    fn check_version(&self) -> Result<()> {
        let asset = &self.root.asset;
        let needed = asset.min_version.as_deref().unwrap_or("2.0");
        if asset.version.split('.').next() != Some("2") || needed != "2.0" {
            let version = if needed == "2.0" { asset.version.as_str() } else { needed };
            return Err(self.error(format!("is glTF {version}; only glTF 2.0 can be read: convert it")));
        }
        Ok(())
    }

    fn check_extensions(&self) -> Result<()> {
        let unknown = |name: &&String| !SUPPORTED.contains(&name.as_str());
        let required: Vec<&str> = self.root.extensions_required.iter().filter(unknown).map(String::as_str).collect();
        if !required.is_empty() {
            let plural = if required.len() == 1 { "" } else { "s" };
            return Err(self.error(format!(
                "requires the extension{plural} {}, which cannot be read; export it without (readable are {})",
                required.join(", "),
                SUPPORTED.join(", ")
            )));
        }
        for name in self.root.extensions_used.iter().filter(unknown) {
            self.warn(format!("uses the extension {name}, which is not read"));
        }
        Ok(())
    }

    fn read_buffers(&mut self, mut chunk: Option<&[u8]>) -> Result<()> {
        let mut total = 0_u64;
        let mut buffers = Vec::new();
        for (at, buffer) in self.root.buffers.iter().enumerate() {
            let place = named("buffer", at, buffer.name.as_deref());
            let limit = self.limit.saturating_sub(total);
            let mut bytes = match &buffer.uri {
                Some(uri) => self.resource(uri, limit).map_err(|error| match error {
                    Error::Gltf { message, .. } => self.error(format!("{place}: {message}")),
                    error => error,
                })?,
                None => match chunk.take() {
                    Some(chunk) if at == 0 => chunk.to_vec(),
                    _ => return Err(self.error(format!("{place} has no uri, and there is no binary chunk for it"))),
                },
            };
            let wanted = buffer.byte_length.0;
            if (bytes.len() as u64) < wanted {
                return Err(self.error(format!("{place} should have {wanted} bytes and has {}; is the file cut off?", bytes.len())));
            }
            // Not above the length of what is held, so it fits.
            bytes.truncate(wanted as usize);
            total = total.saturating_add(wanted);
            buffers.push(bytes);
        }
        self.buffers = buffers;
        Ok(())
    }

    /// The bytes behind a uri: a `data:` uri, or a file at most `limit` bytes long.
    pub(super) fn resource(&self, uri: &str, limit: u64) -> Result<Vec<u8>> {
        if let Some(data) = uri.strip_prefix("data:") {
            return decode_data(data).map_err(|message| self.error(message));
        }
        if uri.contains("://") {
            return Err(self.error(format!("{} is not a file; fetch it and name it here", shown(uri))));
        }
        let Some(folder) = &self.folder else {
            return Err(self.error(format!("names the file {}, but is a stream; only data in itself is read", shown(uri))));
        };
        let name = percent_decoded(uri);
        let name = String::from_utf8_lossy(&name);
        // Some programs write names as they are, a percent sign or not.
        let path = self.files.find(folder, &name).or_else(|error| self.files.find(folder, uri).map_err(|_| error))?;
        self.files.read(&path, limit)
    }

    /// The bytes of a buffer view and its stride.
    pub(super) fn view(&self, at: usize) -> Result<(&[u8], Option<usize>), String> {
        let view = self.root.buffer_views.get(at).ok_or_else(|| absent("bufferView", at, self.root.buffer_views.len()))?;
        let place = named("bufferView", at, view.name.as_deref());
        let buffer = view.buffer.value();
        let bytes = self.buffers.get(buffer).ok_or_else(|| format!("{place}: {}", absent("buffer", buffer, self.buffers.len())))?;
        let offset = view.byte_offset.unwrap_or_default().0;
        let bytes = range(bytes, offset, view.byte_length.0)
            .ok_or_else(|| format!("{place} ends behind the {} bytes of buffer {buffer}", bytes.len()))?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }
}

/// `length` bytes from `offset` on, if they are there.
pub(super) fn range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let offset = usize::try_from(offset).ok()?;
    let end = offset.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(offset..end)
}

/// How messages call a part of the file.
pub(super) fn named(kind: &str, at: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {at} ({})", shown(name)),
        _ => format!("{kind} {at}"),
    }
}

/// What to say of an index that is too large.
pub(super) fn absent(kind: &str, at: usize, count: usize) -> String {
    format!("there is no {kind} {at}, only {count} of them")
}

/// Text from the file, short and in quotes.
pub(super) fn shown(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{:?}...", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// The JSON text and the binary chunk of a GLB file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?)) };
    let cut = || "the file is cut off".to_owned();
    let version = word(4).ok_or_else(cut)?;
    if version != 2 {
        return Err(format!("is binary glTF {version}; only version 2 can be read"));
    }
    let length = word(8).ok_or_else(cut)? as usize;
    if length > bytes.len() {
        return Err(format!("should have {length} bytes and has {}; is the file cut off?", bytes.len()));
    }
    let mut text = None;
    let mut binary = None;
    let mut at = 12;
    while at < length {
        let (size, kind) = (word(at).ok_or_else(cut)?, word(at + 4).ok_or_else(cut)?);
        let chunk = range(bytes, at as u64 + 8, u64::from(size)).ok_or_else(cut)?;
        match &kind.to_le_bytes() {
            b"JSON" if text.is_none() => text = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            // Chunks of other kinds are for programs that know them.
            _ => {}
        }
        at += 8 + chunk.len();
    }
    Ok((text.ok_or("has no JSON chunk")?, binary))
}

fn parse(text: &[u8]) -> Result<json::Root, String> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    deserialize::from_slice(text).or_else(|error| {
        let message = || format!("cannot be read as glTF 2.0: {error}");
        let mut value: Value = deserialize::from_slice(text).map_err(|_| message())?;
        // Channels of KHR_animation_pointer move no node, which glTF allows and the crate does not.
        for animation in value.get_mut("animations").and_then(Value::as_array_mut).into_iter().flatten() {
            if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
                channels.retain(|channel| channel.pointer("/target/node").is_some());
            }
        }
        deserialize::from_value(value).map_err(|_| message())
    })
}

/// What follows `data:`.
fn decode_data(data: &str) -> Result<Vec<u8>, String> {
    let (head, body) = data.split_once(',').ok_or("a data uri has no comma")?;
    let body = if body.contains('%') { percent_decoded(body) } else { Cow::Borrowed(body.as_bytes()) };
    if !head.ends_with(";base64") {
        return Ok(body.into_owned());
    }
    let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent).with_decode_allow_trailing_bits(true);
    let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, config);
    engine.decode(body.as_ref()).map_err(|error| format!("a data uri is no base64: {error}"))
}

fn percent_decoded(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let digit = |byte: Option<&u8>| byte.and_then(|&byte| char::from(byte).to_digit(16));
    let bytes = text.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        match (byte, digit(bytes.get(at + 1)), digit(bytes.get(at + 2))) {
            (b'%', Some(high), Some(low)) => {
                decoded.push((high * 16 + low) as u8);
                at += 3;
            }
            _ => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    Cow::Owned(decoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_with_and_without_base64() {
        assert_eq!(decode_data("application/octet-stream;base64,AQID"), Ok(vec![1, 2, 3]));
        assert_eq!(decode_data(";base64,AQI"), Ok(vec![1, 2]));
        assert_eq!(decode_data(",a%20b%"), Ok(b"a b%".to_vec()));
        assert!(decode_data("no comma").is_err());
        assert!(decode_data(";base64,!").is_err());
    }
}
