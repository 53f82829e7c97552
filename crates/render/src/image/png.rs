//! PNG: what a viewer shows.

use std::io::Write;

use super::tonemap::{Tonemap, srgb_encode_u8};
use super::{Error, Metadata, MetadataValue, Result};
use crate::{Layer, Layers};

/// How linear layers become eight bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PngOptions {
    /// Exposure in stops: linear values are multiplied by two to this power before the tone map.
    pub exposure: f32,
    /// The tone map.
    pub tonemap: Tonemap,
    /// Whether the file has an alpha channel. The beauty is then taken as premultiplied by its `A` and divided by it.
    pub alpha: bool,
}

/// A picture of eight bits a channel, sRGB, row by row from the top left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgb8 {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// 3 (red, green, blue) or 4 (and alpha, not premultiplied).
    pub channels: u8,
    /// `width * height * channels` values.
    pub data: Vec<u8>,
    /// Number of pixels that held a value which is not finite: they are shown black (not a number) or as bright as can be (infinite).
    pub not_finite: usize,
}

/// Brings the layer `beauty` into the range of a display.
///
/// # Errors
/// [`Error::Layer`] when there is no layer `beauty` of floats with `R`, `G`, `B`, and with `A` if alpha is asked for.
#[expect(clippy::manual_clamp, reason = "clamp hands a NaN on, max does not")]
pub fn tonemapped(layers: &Layers, options: &PngOptions) -> Result<Rgb8> {
    let missing = |reason: &str| Error::Layer { name: "beauty".to_owned(), reason: reason.to_owned() };
    let beauty = layers.get("beauty").ok_or_else(|| missing("it was not rendered"))?;
    let values = beauty.floats().ok_or_else(|| missing("its values are integers"))?;
    let index = |name: &str| channel_index(beauty, name).ok_or_else(|| missing(&format!("it has no channel {name}")));
    let (r, g, b) = (index("R")?, index("G")?, index("B")?);
    let a = if options.alpha { Some(index("A")?) } else { None };

    let gain = options.exposure.exp2();
    let channels = if a.is_some() { 4 } else { 3 };
    let mut data = Vec::with_capacity(layers.pixel_count().saturating_mul(channels));
    let mut not_finite = 0;
    for pixel in values.chunks_exact(beauty.channels.len()) {
        let mut color = [pixel[r], pixel[g], pixel[b]];
        not_finite += usize::from(color.iter().any(|value| !value.is_finite()));
        let alpha = a.map(|a| pixel[a].max(0.0).min(1.0));
        if let Some(alpha) = alpha.filter(|alpha| *alpha > 0.0) {
            color = color.map(|value| value / alpha);
        }
        let mapped = options.tonemap.apply(color.map(|value| value * gain));
        data.extend(mapped.map(srgb_encode_u8));
        if let Some(alpha) = alpha {
            data.push((alpha * 255.0 + 0.5) as u8);
        }
    }
    Ok(Rgb8 { width: layers.width(), height: layers.height(), channels: channels as u8, data, not_finite })
}

fn channel_index(layer: &Layer, name: &str) -> Option<usize> {
    layer.channels.iter().position(|channel| channel == name)
}

/// Writes a PNG with the chunks that say sRGB, and the metadata as text. Equal pictures give equal bytes.
///
/// # Errors
/// [`Error::Encode`] when the sizes do not agree or are zero; [`Error::Write`] when `writer` fails.
pub fn encode_png<W: Write>(writer: W, picture: &Rgb8, metadata: &Metadata) -> Result<()> {
    let mut encoder = ::png::Encoder::new(writer, picture.width, picture.height);
    encoder.set_color(if picture.channels == 4 { ::png::ColorType::Rgba } else { ::png::ColorType::Rgb });
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    for (name, value) in metadata.iter() {
        let text = match value {
            MetadataValue::Text(text) => text.clone(),
            MetadataValue::Int(value) => value.to_string(),
            MetadataValue::Float(value) => value.to_string(),
            MetadataValue::Matrix(_) => continue,
        };
        // PNG knows `Software` as a keyword.
        let keyword = if name == "software" { "Software" } else { name };
        encoder.add_text_chunk(keyword.to_owned(), text).map_err(png_error)?;
    }
    let mut writer = encoder.write_header().map_err(png_error)?;
    writer.write_image_data(&picture.data).map_err(png_error)?;
    writer.finish().map_err(png_error)
}

fn png_error(error: ::png::EncodingError) -> Error {
    match error {
        ::png::EncodingError::IoError(source) => super::file::write_error(std::path::Path::new("the PNG"), source),
        other => Error::Encode { reason: other.to_string() },
    }
}
