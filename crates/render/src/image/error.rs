//! What can go wrong with image files.

use std::path::PathBuf;

/// Result of the image files.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong with image files. Every message names the file and says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be written; what stood under its name before still does.
    #[error("cannot write {}: {source}; {cure}", .path.display())]
    Write {
        /// The file that was asked for.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
        /// What to do.
        cure: &'static str,
    },
    /// The file exists and must not be replaced.
    #[error("{} exists; choose another name, or allow overwriting", .path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The extension names no format.
    #[error("{}: the extension names no picture format; use .png or .exr", .path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A file could not be opened or read.
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is not what it claims to be.
    #[error("{} is no readable picture: {reason}", .path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file holds more pixels than allowed.
    #[error("{}: {width} x {height} pixels of {channels} channels need {needed} bytes, {limit} are allowed; raise the limit (--max-size)", .path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Pixels in a row.
        width: u64,
        /// Rows.
        height: u64,
        /// Channels of a pixel.
        channels: u64,
        /// Bytes in memory.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The encoder refused.
    #[error("cannot encode the picture: {reason}")]
    Encode {
        /// What the encoder said.
        reason: String,
    },
    /// What a movie's format cannot hold.
    #[error("{}: {reason}", .path.display())]
    Movie {
        /// The file.
        path: PathBuf,
        /// What is wrong, and the cure.
        reason: String,
    },
    /// ffmpeg, which writes some formats, is not there or has failed.
    #[error("cannot write {} by ffmpeg: {reason}", .path.display())]
    Ffmpeg {
        /// The file.
        path: PathBuf,
        /// What is wrong: the cure, or what ffmpeg said.
        reason: String,
    },
    /// A layer that is needed is not there, or has the wrong kind of values.
    #[error("the picture has no usable layer {name}: {reason}")]
    Layer {
        /// Name of the layer.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// Two pictures of different size cannot be compared.
    #[error("cannot compare {} x {} with {} x {} pixels; render both at one size", .a.0, .a.1, .b.0, .b.1)]
    SizeMismatch {
        /// Size of the first.
        a: (u32, u32),
        /// Size of the second.
        b: (u32, u32),
    },
    /// Two pictures share no layer.
    #[error("the pictures share no layer: {a} against {b}")]
    NoCommonLayer {
        /// Layers of the first.
        a: String,
        /// Layers of the second.
        b: String,
    },
}

impl Error {
    /// An error of writing `path`, with the cure that fits what the system said.
    pub fn write(path: &std::path::Path, source: std::io::Error) -> Error {
        super::file::write_error(path, source)
    }
}
