//! The only place that opens files: below one folder, regular files only, up to a size.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Component, Path, PathBuf};

use crate::suggest::closest;
use crate::{Error, Result};

/// A folder and the permission to leave it.
#[derive(Debug)]
pub(crate) struct Files {
    root: Option<PathBuf>,
    allow_external: bool,
}

impl Files {
    /// `root` is where the scene lies; without one (a stream) nothing can be opened.
    pub(crate) fn new(root: Option<&Path>, allow_external: bool) -> Result<Self> {
        let root = match root {
            Some(root) => {
                // The folder of a bare file name is the empty path.
                let root = if root.as_os_str().is_empty() { Path::new(".") } else { root };
                Some(root.canonicalize().map_err(|source| Error::Io { path: root.to_owned(), source })?)
            }
            None => None,
        };
        Ok(Self { root, allow_external })
    }

    /// The folder of the scene, canonical.
    pub(crate) fn root(&self) -> Option<&Path> {
        self.root.as_deref()
    }

    /// Finds a file that another file in `folder` names, and returns its canonical path. Names are taken as written; with backslashes as
    /// slashes; in other case; and, for absolute and upward paths that lead nowhere or out of the scene's folder, by their last part alone.
    pub(crate) fn find(&self, folder: &Path, name: &str) -> Result<PathBuf> {
        let missing = |suggestion| Error::NotFound { path: PathBuf::from(name), suggestion };
        if self.root.is_none() || name.is_empty() || name.contains('\0') {
            return Err(missing(None));
        }
        let slashed = name.replace('\\', "/");
        let mut refused = None;
        let mut spellings = vec![name];
        if slashed != name {
            spellings.push(&slashed);
        }
        for spelling in spellings {
            match self.permitted(&folder.join(spelling)) {
                Ok(path) => return Ok(path),
                Err(Error::Io { source, .. }) if is_missing(&source) => {}
                Err(error) => refused = Some(error),
            }
        }
        if let Some(path) = self.find_ignoring_case(folder, &slashed) {
            return Ok(path);
        }
        let upward = Path::new(&slashed).components().any(|part| part == Component::ParentDir);
        if (is_absolute(&slashed) || upward)
            && let Some(last) = slashed.rsplit('/').next()
            && let Some(path) = self.find_ignoring_case(folder, last)
        {
            return Ok(path);
        }
        Err(refused.unwrap_or_else(|| missing(self.neighbour(folder, &slashed))))
    }

    /// A folder that a file in `within` names, if it may be listed.
    pub(crate) fn folder(&self, within: &Path, name: &str) -> Result<PathBuf> {
        self.permitted(&within.join(name)).map_err(|error| match error {
            Error::Io { source, .. } if is_missing(&source) => {
                Error::NotFound { path: PathBuf::from(name), suggestion: self.neighbour(within, name) }
            }
            error => error,
        })
    }

    /// Reads a file that [`Files::find`] returned, up to `limit` bytes.
    pub(crate) fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        read_file(path, limit)
    }

    /// The canonical path, if it may be opened.
    fn permitted(&self, path: &Path) -> Result<PathBuf> {
        // Canonical before the comparison: `..` and symbolic links are gone.
        let path = path.canonicalize().map_err(|source| Error::Io { path: path.to_owned(), source })?;
        match &self.root {
            Some(root) if self.allow_external || path.starts_with(root) => Ok(path),
            Some(root) => Err(Error::Outside { path, root: root.clone() }),
            None => Err(Error::NotFound { path, suggestion: None }),
        }
    }

    fn find_ignoring_case(&self, folder: &Path, name: &str) -> Option<PathBuf> {
        let mut at = self.permitted(folder).ok()?;
        for part in Path::new(name).components() {
            at = match part {
                Component::Normal(wanted) => {
                    let exact = at.join(wanted);
                    let path = if exact.symlink_metadata().is_ok() { exact } else { at.join(entry_ignoring_case(&at, wanted.to_str()?)?) };
                    self.permitted(&path).ok()?
                }
                Component::ParentDir => self.permitted(&at.join("..")).ok()?,
                Component::CurDir => at,
                Component::RootDir | Component::Prefix(_) => return None,
            };
        }
        at.is_file().then_some(at)
    }

    fn neighbour(&self, folder: &Path, name: &str) -> Option<String> {
        let path = folder.join(name);
        let folder = self.permitted(path.parent()?).ok()?;
        neighbour_in(&folder, path.file_name()?.to_str()?)
    }
}

/// A file of a similar name in the same folder.
fn neighbour_in(folder: &Path, name: &str) -> Option<String> {
    let names: Vec<String> = names_in(folder).filter_map(|name| name.into_string().ok()).collect();
    closest(name, names.iter().map(String::as_str)).map(str::to_owned)
}

/// The names in a folder, in no order; none where it cannot be listed.
pub(crate) fn names_in(folder: &Path) -> impl Iterator<Item = OsString> {
    fs::read_dir(folder).into_iter().flatten().filter_map(|entry| entry.ok().map(|entry| entry.file_name()))
}

/// Of several entries that differ in case only, the first in byte order, so that the choice does not depend on the file system.
fn entry_ignoring_case(folder: &Path, wanted: &str) -> Option<OsString> {
    let wanted = wanted.to_lowercase();
    names_in(folder).filter(|name| name.to_str().is_some_and(|name| name.to_lowercase() == wanted)).min()
}

/// Absolute on this system, or on Windows (a drive, a share).
fn is_absolute(slashed: &str) -> bool {
    let bytes = slashed.as_bytes();
    slashed.starts_with('/') || (bytes.len() >= 2 && bytes[0].is_ascii_alphabetic() && bytes[1] == b':')
}

fn is_missing(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::InvalidInput | ErrorKind::InvalidFilename)
}

/// Reads a regular file of at most `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let io = |source: std::io::Error| {
        if source.kind() == ErrorKind::NotFound {
            let folder = path.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
            let suggestion =
                folder.zip(path.file_name().and_then(|name| name.to_str())).and_then(|(folder, name)| neighbour_in(folder, name));
            Error::NotFound { path: path.to_owned(), suggestion }
        } else {
            Error::Io { path: path.to_owned(), source }
        }
    };
    // Before opening: opening a pipe would wait for its writer. Once more after it: the path may have changed in between.
    if !fs::metadata(path).map_err(io)?.is_file() {
        return Err(Error::NotAFile { path: path.to_owned() });
    }
    let mut file = File::open(path).map_err(io)?;
    let metadata = file.metadata().map_err(io)?;
    if !metadata.is_file() {
        return Err(Error::NotAFile { path: path.to_owned() });
    }
    if metadata.len() > limit {
        return Err(Error::TooLarge { path: path.to_owned(), bytes: metadata.len(), limit });
    }
    read_stream(&mut file, path, limit)
}

/// Reads a stream to its end, which must come within `limit` bytes.
pub(crate) fn read_stream(reader: &mut dyn Read, path: &Path, limit: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|source| Error::Io { path: path.to_owned(), source })?;
    if bytes.len() as u64 > limit {
        return Err(Error::TooLarge { path: path.to_owned(), bytes: bytes.len() as u64, limit });
    }
    Ok(bytes)
}
