//! What can go wrong with a scene, each with the file, the place and the cure.

use std::path::PathBuf;

use crate::suggest::closest;

/// The result of this crate's functions.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a scene could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// No such file, with a file of a similar name where there is one.
    #[error("{} does not exist{}", path.display(), suggestion.as_ref().map(|name| format!(": did you mean {name}?")).unwrap_or_default())]
    NotFound {
        /// The file.
        path: PathBuf,
        /// The name of a neighbour.
        suggestion: Option<String>,
    },
    /// A device, a pipe or a folder, which could block for ever or never end.
    #[error("{} is not a regular file; read a stream by the name -", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// A path that leads out of the scene's folder.
    #[error("{} lies outside the scene's folder {}; move it there, or allow it with --allow-external-paths", path.display(), root.display())]
    Outside {
        /// The path as it is after all links.
        path: PathBuf,
        /// The folder.
        root: PathBuf,
    },
    /// A file beyond the cap for its kind.
    #[error("{} has {bytes} bytes, more than the limit of {limit}; raise the limit if this is meant", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size, or for a stream what was read of it.
        bytes: u64,
        /// The cap.
        limit: u64,
    },
    /// A file name whose ending says no format that can be read.
    #[error("{}: cannot tell the format by the ending; readable are .obj, .ply (also as .gz), .gltf, .glb and .toml", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A pattern for key-frames that makes no sense, or that no file matches.
    #[error("{message}")]
    Sequence {
        /// What is wrong, and the cure.
        message: String,
    },
    /// A key-frame that a sequence leaves out.
    #[error("{} does not exist, but its sequence goes from {first} to {last}; put it there, or play only the part before it", path.display())]
    MissingKeyFrame {
        /// The file.
        path: PathBuf,
        /// The number of the first key-frame.
        first: u64,
        /// The number of the last one.
        last: u64,
    },
    /// A key-frame that was asked for beyond the last, or of a mesh that has none.
    #[error("there is no key-frame {key}; the mesh has {count} of them")]
    NoKeyFrame {
        /// What was asked for, counted from 0.
        key: u32,
        /// How many there are.
        count: u32,
    },
    /// A clip that no file names.
    #[error("there is no clip \"{clip}\"; {}", clips_known(clip, known))]
    UnknownClip {
        /// What was asked for.
        clip: String,
        /// All names.
        known: Vec<String>,
    },
    /// A glTF file that cannot be read.
    #[error("{file}: {message}")]
    Gltf {
        /// The file, or `-`.
        file: String,
        /// What is wrong, with the part of the file that it is wrong with, and the cure where there is one.
        message: String,
    },
    /// A line of an OBJ file that cannot be read.
    #[error("{file}:{line}: {message}")]
    Obj {
        /// The file, or `-`.
        file: String,
        /// Counted from 1.
        line: u64,
        /// What is wrong, and the cure.
        message: String,
    },
    /// A place of a PLY file that cannot be read.
    #[error("{file}:{place}: {message}")]
    Ply {
        /// The file, or `-`.
        file: String,
        /// Where in the file.
        place: Place,
        /// What is wrong, and the cure.
        message: String,
    },
    /// A place of a scene file that cannot be read.
    #[error("{file}:{line}: {message}")]
    Description {
        /// The file.
        file: String,
        /// Counted from 1.
        line: u64,
        /// What is wrong, and the cure.
        message: String,
    },
    /// A picture that the scene cannot do without and that cannot be read (a background).
    #[error("{}: {message}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line, counted from 1.
    Line(u64),
    /// A byte, counted from 0; of what it holds, where the file is packed.
    Byte(u64),
}

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line(line) => write!(formatter, "{line}"),
            Self::Byte(byte) => write!(formatter, "byte {byte}"),
        }
    }
}

/// What to say instead of a clip that there is not.
fn clips_known(clip: &str, known: &[String]) -> String {
    if known.is_empty() {
        return "this scene has none: leave the clip out".to_owned();
    }
    let names = known.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    let near = closest(clip, known.iter().map(String::as_str)).map(|near| format!("; did you mean \"{near}\"?")).unwrap_or_default();
    format!("there are {names}{near}")
}
