//! Image files: layers out as PNG and EXR, frames out as movies, heat maps, and the comparison of two pictures.
//!
//! Pure CPU code. PNG holds what a viewer shows: exposure, a tone map, the sRGB curve, eight bits. EXR holds what was measured: linear,
//! untouched, 32 bits, identifiers as integers. Files are written beside their final place and renamed, so that no reader, no crash and no
//! full disk ever leaves half a picture under the name that was asked for.

mod apng;
mod diff;
mod error;
mod exr;
mod ffmpeg;
mod file;
mod font;
mod gif;
mod heatmap;
mod movie;
mod png;
mod rate;
mod read;
mod tonemap;
mod y4m;

pub use apng::ApngEncoder;
pub use diff::{Difference, LayerDifference, diff};
pub use error::{Error, Result};
pub use exr::encode_exr;
pub use file::{Overwrite, SeekWrite, remove_unfinished, write_file};
pub use gif::GifEncoder;
pub use heatmap::{Heatmap, heatmap, ramp};
pub use movie::{MovieDesc, MovieFormat, MovieWriter};
pub use png::{PngOptions, Rgb8, encode_png, tonemapped};
pub use rate::Rate;
pub use read::{ReadLimits, read};
pub use tonemap::{Tonemap, srgb_decode, srgb_encode, srgb_encode_u8};
pub use y4m::{Chroma, Matrix, Y4mEncoder};

/// A value of the metadata that goes into a picture file.
#[derive(Clone, Debug, PartialEq)]
pub enum MetadataValue {
    /// Words.
    Text(String),
    /// An integer.
    Int(i32),
    /// A number.
    Float(f32),
    /// A matrix, row by row.
    Matrix([f32; 16]),
}

/// What a picture file says about itself, beside its pixels. The OpenEXR names `software`, `worldToCamera` and `worldToNDC` become the
/// standard attributes of an EXR header, everything else its `comments`, a line each; a PNG holds everything but matrices as text.
///
/// Times of day and durations stay out on purpose: the same input gives the same file, byte for byte.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    entries: Vec<(String, MetadataValue)>,
}

impl Metadata {
    /// No metadata at all.
    pub const fn new() -> Metadata {
        Metadata { entries: Vec::new() }
    }

    /// Adds or replaces an entry. Characters that the formats cannot hold (beyond Latin-1, control characters) become `?`; names are cut
    /// to 79 characters, the limit of PNG.
    #[must_use]
    pub fn with(mut self, name: &str, value: MetadataValue) -> Metadata {
        let name: String = latin1(name).chars().take(79).collect();
        let value = match value {
            MetadataValue::Text(text) => MetadataValue::Text(latin1(&text)),
            other => other,
        };
        self.entries.retain(|(existing, _)| *existing != name);
        if !name.is_empty() {
            self.entries.push((name, value));
        }
        self
    }

    /// All entries, in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &MetadataValue)> {
        self.entries.iter().map(|(name, value)| (name.as_str(), value))
    }
}

fn latin1(text: &str) -> String {
    text.chars().map(|c| if (c as u32) < 0x20 || (0x7f..0xa0).contains(&(c as u32)) || c as u32 > 0xff { '?' } else { c }).collect()
}

/// The kinds of file that hold one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Eight bits, tone mapped.
    Png,
    /// 32 bits, linear, all layers.
    Exr,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 2] = [Format::Png, Format::Exr];

    /// The file extension, without the dot.
    pub const fn extension(self) -> &'static str {
        match self {
            Format::Png => "png",
            Format::Exr => "exr",
        }
    }

    /// What the format holds, in one line.
    pub const fn description(self) -> &'static str {
        match self {
            Format::Png => "8-bit sRGB after exposure and tone mapping: the beauty, or a heat map",
            Format::Exr => "32-bit linear OpenEXR with every layer asked for, ids as integers",
        }
    }

    /// The format that a path's extension names.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`] for any other extension, or none.
    pub fn of_path(path: &std::path::Path) -> Result<Format> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        Format::ALL
            .into_iter()
            .find(|format| extension.as_deref() == Some(format.extension()))
            .ok_or_else(|| Error::UnknownFormat { path: path.to_owned() })
    }
}
