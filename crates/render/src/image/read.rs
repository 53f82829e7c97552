//! Pictures read back, under limits, for comparison.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use ::exr::prelude::{FlatSamples, ReadChannels, ReadLayers};

use super::{Error, Result};
use crate::{Layer, LayerData, Layers};

/// How much a picture file may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadLimits {
    /// Bytes in memory of all channels together, as 32-bit values.
    pub bytes: u64,
}

impl Default for ReadLimits {
    /// 2 GiB: 8K with all layers.
    fn default() -> ReadLimits {
        ReadLimits { bytes: 2 << 30 }
    }
}

/// Reads a PNG or an EXR; which of the two is told by the first bytes, not by the name.
///
/// A PNG becomes one layer `beauty` of its stored values over their maximum (0 to 1, not made linear). The channels of an EXR become layers by
/// what stands before the last dot of their names; channels without a dot are the layer `beauty`, except `Z`, which is a layer of its own.
///
/// # Errors
/// [`Error::Read`], [`Error::Decode`], [`Error::TooLarge`], each with the path.
pub fn read(path: &Path, limits: ReadLimits) -> Result<Layers> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    if let Ok(metadata) = std::fs::metadata(path)
        && !metadata.is_file()
    {
        return Err(failed(std::io::Error::other("not a regular file")));
    }
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let mut magic = [0; 8];
    let mut length = 0;
    while length < magic.len() {
        match file.read(&mut magic[length..]).map_err(failed)? {
            0 => break,
            read => length += read,
        }
    }
    file.seek(SeekFrom::Start(0)).map_err(failed)?;
    if magic[..length].starts_with(b"\x89PNG\r\n\x1a\n") {
        read_png(path, file, limits)
    } else if magic[..length].starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        read_exr(path, file, limits)
    } else {
        Err(decode(path, "it begins like neither a PNG nor an EXR"))
    }
}

fn decode(path: &Path, reason: impl ToString) -> Error {
    Error::Decode { path: path.to_owned(), reason: reason.to_string() }
}

fn check(path: &Path, size: (u64, u64), channels: u64, limits: ReadLimits) -> Result<(u32, u32)> {
    let (width, height) = size;
    let needed = width.saturating_mul(height).saturating_mul(channels).saturating_mul(4);
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h)) if needed <= limits.bytes => Ok((w, h)),
        _ => Err(Error::TooLarge { path: path.to_owned(), width, height, channels, needed, limit: limits.bytes }),
    }
}

fn read_png(path: &Path, file: BufReader<File>, limits: ReadLimits) -> Result<Layers> {
    let bytes = usize::try_from(limits.bytes).unwrap_or(usize::MAX);
    let mut decoder = ::png::Decoder::new_with_limits(file, ::png::Limits { bytes });
    decoder.set_transformations(::png::Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let failed = |error: ::png::DecodingError| match error {
        ::png::DecodingError::IoError(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            Error::Read { path: path.to_owned(), source }
        }
        ::png::DecodingError::IoError(_) => decode(path, "it ends too early"),
        other => decode(path, other),
    };
    let header = decoder.read_header_info().map_err(failed)?;
    check(path, (header.width.into(), header.height.into()), 4, limits)?;
    let mut reader = decoder.read_info().map_err(failed)?;
    let size = reader.output_buffer_size().ok_or_else(|| decode(path, "it is larger than the address space"))?;
    let mut stored = vec![0; size];
    let info = reader.next_frame(&mut stored).map_err(failed)?;
    stored.truncate(info.buffer_size());

    let values: Vec<f32> = match info.bit_depth {
        ::png::BitDepth::Sixteen => {
            stored.chunks_exact(2).map(|pair| f32::from(u16::from_be_bytes([pair[0], pair[1]])) / 65535.0).collect()
        }
        _ => stored.iter().map(|value| f32::from(*value) / 255.0).collect(),
    };
    // Grey becomes three equal channels, so that a grey picture can be compared with a coloured one.
    let (channels, values): (&[&str], Vec<f32>) = match info.color_type {
        ::png::ColorType::Grayscale => (&["R", "G", "B"], values.iter().flat_map(|v| [*v; 3]).collect()),
        ::png::ColorType::GrayscaleAlpha => {
            (&["R", "G", "B", "A"], values.chunks_exact(2).flat_map(|v| [v[0], v[0], v[0], v[1]]).collect())
        }
        ::png::ColorType::Rgba => (&["R", "G", "B", "A"], values),
        ::png::ColorType::Rgb | ::png::ColorType::Indexed => (&["R", "G", "B"], values),
    };
    let mut layers = Layers::new(info.width, info.height);
    push(path, &mut layers, "beauty", "", channels.iter().map(|name| (*name).to_owned()).collect(), LayerData::Float(values))?;
    Ok(layers)
}

fn read_exr(path: &Path, mut file: BufReader<File>, limits: ReadLimits) -> Result<Layers> {
    let failed = |error: ::exr::error::Error| match error {
        ::exr::error::Error::Io(source) => Error::Read { path: path.to_owned(), source },
        other => decode(path, other),
    };
    // The header alone first: the pixels are only allocated once their number is known to be within the limit.
    let length = file.get_ref().metadata().map_err(|source| Error::Read { path: path.to_owned(), source })?.len();
    let header = ::exr::meta::MetaData::read_from_buffered(&mut file, true).map_err(failed)?;
    let mut total: u64 = 0;
    for part in &header.headers {
        let channels = part.channels.list.len() as u64;
        let size = (part.layer_size.0 as u64, part.layer_size.1 as u64);
        total = total.saturating_add(size.0.saturating_mul(size.1).saturating_mul(channels));
        check(path, size, total.checked_div(size.0.saturating_mul(size.1)).unwrap_or(0), limits)?;
        // Each block has an entry of eight bytes in the offset table.
        if (part.chunk_count as u64).saturating_mul(8) > length {
            return Err(decode(path, "it is shorter than its own table of contents"));
        }
    }
    file.seek(SeekFrom::Start(0)).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(file)
        .map_err(failed)?;

    let size = image.layer_data.first().map(|part| part.size).ok_or_else(|| decode(path, "it holds no part"))?;
    let (width, height) = check(path, (size.0 as u64, size.1 as u64), 1, limits)?;
    let mut groups: Vec<Group> = Vec::new();
    for part in &image.layer_data {
        if part.size != size {
            return Err(decode(path, "its parts have different sizes"));
        }
        let part_name = part.attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
        for channel in &part.channel_data.list {
            let own = channel.name.to_string();
            // In files of several parts the name of the part stands in for the prefix.
            let full = if part_name.is_empty() || own.contains('.') { own } else { format!("{part_name}.{own}") };
            let (prefix, short) = full.rsplit_once('.').map_or(("", full.as_str()), |(prefix, short)| (prefix, short));
            let name = match (prefix, short) {
                ("", "Z") => "Z",
                ("", _) => "beauty",
                (prefix, _) => prefix,
            };
            let data = match &channel.sample_data {
                FlatSamples::U32(values) => LayerData::Uint(values.clone()),
                FlatSamples::F32(values) => LayerData::Float(values.clone()),
                half @ FlatSamples::F16(_) => LayerData::Float(half.values_as_f32().collect()),
            };
            let kind = std::mem::discriminant(&data);
            match groups.iter_mut().find(|group| group.name == name && std::mem::discriminant(&group.channels[0].1) == kind) {
                Some(group) => group.channels.push((short.to_owned(), data)),
                None => {
                    groups.push(Group { name: name.to_owned(), prefix: prefix.to_owned(), channels: vec![(short.to_owned(), data)] });
                }
            }
        }
    }
    let mut layers = Layers::new(width, height);
    for mut group in groups {
        // A layer of two kinds of values becomes two layers.
        if layers.get(&group.name).is_some() {
            group.name.push_str(" (integers)");
        }
        group.channels.sort_by_key(|(name, _)| (rank(name), name.clone()));
        let (names, data): (Vec<_>, Vec<_>) = group.channels.into_iter().unzip();
        let data = interleave(data, layers.pixel_count());
        push(path, &mut layers, &group.name, &group.prefix, names, data)?;
    }
    Ok(layers)
}

struct Group {
    name: String,
    prefix: String,
    channels: Vec<(String, LayerData)>,
}

/// Files hold channels by the alphabet (A B G R); people read R G B A.
fn rank(channel: &str) -> usize {
    ["R", "G", "B", "A", "X", "Y", "Z", "U", "V"].iter().position(|known| *known == channel).unwrap_or(usize::MAX)
}

/// All channels of a group have one kind of values and one length.
fn interleave(channels: Vec<LayerData>, pixels: usize) -> LayerData {
    fn weave<T: Copy>(channels: &[&[T]], pixels: usize) -> Vec<T> {
        (0..pixels).flat_map(|pixel| channels.iter().filter_map(move |channel| channel.get(pixel).copied())).collect()
    }
    let floats: Vec<&[f32]> =
        channels.iter().filter_map(|data| if let LayerData::Float(values) = data { Some(values.as_slice()) } else { None }).collect();
    if floats.is_empty() {
        let uints: Vec<&[u32]> =
            channels.iter().filter_map(|data| if let LayerData::Uint(values) = data { Some(values.as_slice()) } else { None }).collect();
        LayerData::Uint(weave(&uints, pixels))
    } else {
        LayerData::Float(weave(&floats, pixels))
    }
}

fn push(path: &Path, layers: &mut Layers, name: &str, prefix: &str, channels: Vec<String>, data: LayerData) -> Result<()> {
    layers.push(Layer { name: name.to_owned(), prefix: prefix.to_owned(), channels, data }).map_err(|error| decode(path, error))
}
