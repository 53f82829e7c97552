//! OpenEXR: what was measured.

use std::io::{Seek, Write};

use ::exr::math::Vec2;
use ::exr::meta::attribute::{Chromaticities, Text};
use ::exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, LayerAttributes, LineOrder, SmallVec, WritableImage,
};

use super::{Error, Metadata, MetadataValue, Result};
use crate::{Layer, LayerData, Layers};

/// The primaries and white point of Rec. 709, in which all colours are.
const REC_709: Chromaticities =
    Chromaticities { red: Vec2(0.64, 0.33), green: Vec2(0.30, 0.60), blue: Vec2(0.15, 0.06), white: Vec2(0.3127, 0.3290) };

/// Writes all layers as one part: scan lines, ZIP, 32-bit floats and integers, linear. Viewers show the channels without a prefix.
///
/// # Errors
/// [`Error::Encode`] when two channels have one name, a name is not Latin-1, or the picture is empty; [`Error::Write`] when `writer` fails.
pub fn encode_exr<W: Write + Seek>(writer: W, layers: &Layers, metadata: &Metadata) -> Result<()> {
    let refuse = |reason: String| Error::Encode { reason };
    if layers.pixel_count() == 0 {
        return Err(refuse(format!("{} x {} pixels", layers.width(), layers.height())));
    }
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = SmallVec::new();
    for layer in layers.iter() {
        for (index, name) in layer.channel_names().enumerate() {
            let name = text(&name)?;
            if channels.iter().any(|channel| channel.name == name) {
                return Err(refuse(format!("two channels are called {name}")));
            }
            channels.push(AnyChannel::new(name, samples(layer, index)));
        }
    }
    if channels.is_empty() {
        return Err(refuse("there is no layer".to_owned()));
    }

    let encoding = Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let size = (layers.width() as usize, layers.height() as usize);
    let mut attributes = LayerAttributes::default();
    let mut comments = String::new();
    for (name, value) in metadata.iter() {
        match (name, value) {
            ("software", MetadataValue::Text(value)) => attributes.software_name = Some(text(value)?),
            ("worldToCamera", MetadataValue::Matrix(value)) => attributes.world_to_camera = Some(*value),
            ("worldToNDC", MetadataValue::Matrix(value)) => attributes.world_to_normalized_device = Some(*value),
            // Attributes of one's own come out in a different order each time (the crate keeps them in a hash map), and a file that is
            // never twice the same cannot be compared: all of them go into the one standard text.
            (name, MetadataValue::Text(value)) => comments.push_str(&format!("{name}: {value}\n")),
            (name, MetadataValue::Int(value)) => comments.push_str(&format!("{name}: {value}\n")),
            (name, MetadataValue::Float(value)) => comments.push_str(&format!("{name}: {value}\n")),
            (name, MetadataValue::Matrix(value)) => comments.push_str(&format!("{name}: {value:?}\n")),
        }
    }
    if !comments.is_empty() {
        attributes.comments = Some(text(&comments)?);
    }
    let mut image = Image::from_layer(::exr::prelude::Layer::new(size, attributes, encoding, AnyChannels::sort(channels)));
    image.attributes.chromaticities = Some(REC_709);
    image.write().to_buffered(writer).map_err(|error| match error {
        ::exr::error::Error::Io(source) => super::file::write_error(std::path::Path::new("the EXR"), source),
        other => refuse(other.to_string()),
    })
}

fn samples(layer: &Layer, channel: usize) -> FlatSamples {
    fn pick<T: Copy>(values: &[T], channel: usize, stride: usize) -> Vec<T> {
        values.iter().skip(channel).step_by(stride).copied().collect()
    }
    let stride = layer.channels.len();
    match &layer.data {
        LayerData::Float(values) => FlatSamples::F32(pick(values, channel, stride)),
        LayerData::Uint(values) => FlatSamples::U32(pick(values, channel, stride)),
    }
}

fn text(value: &str) -> Result<Text> {
    Text::new_or_none(value).ok_or_else(|| Error::Encode { reason: format!("an EXR file cannot hold the name \"{value}\"") })
}
