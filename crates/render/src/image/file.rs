//! Files that appear whole or not at all.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Cursor, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{Error, Result};

/// What encoders write into.
pub trait SeekWrite: Write + Seek {}
impl<T: Write + Seek> SeekWrite for T {}

/// What to do when the file exists already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overwrite {
    /// Replace it, at once and whole.
    #[default]
    Replace,
    /// Leave it and fail with [`Error::Exists`].
    Refuse,
}

/// Writes a file by way of a temporary one in the same folder: `content` fills it, then it is renamed. When anything fails, the temporary
/// file is removed and what stood under `path` before is untouched. A symbolic link is followed; a device or pipe is written directly,
/// once `content` is complete in memory.
///
/// # Errors
/// [`Error::Write`] with the path and the cure; [`Error::Exists`] under [`Overwrite::Refuse`]; whatever `content` returns.
pub fn write_file(path: &Path, overwrite: Overwrite, content: impl FnOnce(&mut dyn SeekWrite) -> Result<()>) -> Result<()> {
    let mut writer = BufWriter::new(PartFile::create(path, overwrite, true)?);
    content(&mut writer).map_err(|error| named(path, error))?;
    writer.into_inner().map_err(|error| write_error(path, error.into_error()))?.commit()
}

/// A file on its way: filled under a temporary name in the same folder, and renamed by [`PartFile::commit`]. Dropped before that, it leaves
/// nothing behind, and what stood under its name is untouched.
#[derive(Debug)]
pub(super) struct PartFile {
    path: PathBuf,
    overwrite: Overwrite,
    place: Place,
}

enum Place {
    /// A temporary file, what it becomes, and its note among those that are not finished.
    Beside(tempfile::NamedTempFile, PathBuf, Unfinished),
    /// For what cannot seek: written out when it is complete.
    Memory(Cursor<Vec<u8>>, Box<dyn Write + Send>),
    /// Bytes go where they belong at once.
    Through(Box<dyn Write + Send>),
}

impl std::fmt::Debug for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Place::Beside(temporary, target, _) => f.debug_tuple("Beside").field(temporary).field(target).finish(),
            Place::Memory(bytes, _) => f.debug_tuple("Memory").field(&bytes.get_ref().len()).finish(),
            Place::Through(_) => f.write_str("Through"),
        }
    }
}

impl PartFile {
    /// Begins a file. A symbolic link is followed; a device or pipe is written directly, in the end if `seeks` is set, else at once.
    pub(super) fn create(path: &Path, overwrite: Overwrite, seeks: bool) -> Result<PartFile> {
        let failed = |source: io::Error| write_error(path, source);
        let target = match fs::metadata(path) {
            Ok(_) if overwrite == Overwrite::Refuse => return Err(Error::Exists { path: path.to_owned() }),
            Ok(existing) if existing.is_dir() => return Err(failed(ErrorKind::IsADirectory.into())),
            Ok(existing) if !existing.is_file() => {
                let file = File::options().write(true).open(path).map_err(failed)?;
                return Ok(PartFile::stream(path, Box::new(file), seeks));
            }
            // A rename would replace the link and leave what it points to.
            Ok(_) => fs::canonicalize(path).map_err(failed)?,
            Err(_) => path.to_owned(),
        };
        if target.file_name().is_none() {
            return Err(failed(ErrorKind::IsADirectory.into()));
        }
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".gridwalk-").suffix(".part");
        #[cfg(unix)]
        {
            // The crate's default is 0600, for secrets; this is a file like any other, subject to the umask.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let (temporary, unfinished) = Unfinished::make(|| builder.tempfile_in(&folder)).map_err(|error| failed(plain(error)))?;
        Ok(PartFile { path: path.to_owned(), overwrite, place: Place::Beside(temporary, target, unfinished) })
    }

    /// Something that was opened by others; `name` is for messages. What seeks is gathered in memory first.
    pub(super) fn stream(name: &Path, writer: Box<dyn Write + Send>, seeks: bool) -> PartFile {
        let place = if seeks { Place::Memory(Cursor::new(Vec::new()), writer) } else { Place::Through(writer) };
        PartFile { path: name.to_owned(), overwrite: Overwrite::Replace, place }
    }

    /// The name that it was asked for under.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The name that it has so far, for programs that write by name; `None` for what is no file.
    pub(super) fn temporary_path(&self) -> Option<&Path> {
        match &self.place {
            Place::Beside(temporary, ..) => Some(temporary.path()),
            Place::Memory(..) | Place::Through(_) => None,
        }
    }

    /// Puts the file in its place.
    pub(super) fn commit(self) -> Result<()> {
        let PartFile { path, overwrite, place } = self;
        let failed = |source: io::Error| write_error(&path, source);
        match place {
            Place::Beside(temporary, target, _unfinished) => {
                // A disk that is full may say so only now; after the rename it would be too late.
                temporary.as_file().sync_all().map_err(failed)?;
                match overwrite {
                    Overwrite::Replace => temporary.persist(&target).map_err(|error| failed(error.error))?,
                    Overwrite::Refuse => temporary.persist_noclobber(&target).map_err(|error| match error.error.kind() {
                        ErrorKind::AlreadyExists => Error::Exists { path: path.clone() },
                        _ => failed(error.error),
                    })?,
                };
                Ok(())
            }
            Place::Memory(bytes, mut writer) => writer.write_all(bytes.get_ref()).and_then(|()| writer.flush()).map_err(failed),
            Place::Through(mut writer) => writer.flush().map_err(failed),
        }
    }
}

impl Write for PartFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.place {
            Place::Beside(temporary, ..) => temporary.as_file_mut().write(bytes),
            Place::Memory(memory, _) => memory.write(bytes),
            Place::Through(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.place {
            Place::Beside(temporary, ..) => temporary.as_file_mut().flush(),
            Place::Memory(..) => Ok(()),
            Place::Through(writer) => writer.flush(),
        }
    }
}

impl Seek for PartFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        match &mut self.place {
            Place::Beside(temporary, ..) => temporary.as_file_mut().seek(position),
            Place::Memory(memory, _) => memory.seek(position),
            Place::Through(_) => Err(ErrorKind::NotSeekable.into()),
        }
    }
}

/// Temporary files that exist.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn all_unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file's note among [`UNFINISHED`], gone when this is dropped.
#[derive(Debug)]
struct Unfinished(PathBuf);

impl Unfinished {
    fn make(create: impl FnOnce() -> io::Result<tempfile::NamedTempFile>) -> io::Result<(tempfile::NamedTempFile, Unfinished)> {
        // Under the lock, so that there is never a file without a note.
        let mut all = all_unfinished();
        let temporary = create()?;
        let path = temporary.path().to_owned();
        all.insert(path.clone());
        Ok((temporary, Unfinished(path)))
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        all_unfinished().remove(&self.0);
    }
}

/// Removes all files of this module that are not finished, and lets no other begin: for a program that ends right after, without dropping
/// its encoders. Files that are finished stay; whatever else writes pictures or movies waits for ever.
pub fn remove_unfinished() {
    let all = all_unfinished();
    for path in all.iter() {
        // One that has just got its name is not there any more.
        let _ = fs::remove_file(path);
    }
    std::mem::forget(all);
}

/// tempfile puts the temporary path, which means nothing to anyone, into its messages.
fn plain(error: io::Error) -> io::Error {
    match error.raw_os_error().or_else(|| error.get_ref().and_then(os_error)) {
        Some(code) => io::Error::from_raw_os_error(code),
        None => error.kind().into(),
    }
}

fn os_error(error: &(dyn std::error::Error + Send + Sync + 'static)) -> Option<i32> {
    let mut source = error.source();
    while let Some(error) = source {
        if let Some(code) = error.downcast_ref::<io::Error>().and_then(io::Error::raw_os_error) {
            return Some(code);
        }
        source = error.source();
    }
    None
}

/// Encoders do not know the path: an I/O error from inside one becomes an error of this file.
pub(super) fn named(path: &Path, error: Error) -> Error {
    match error {
        Error::Write { source, .. } => write_error(path, source),
        other => other,
    }
}

pub(super) fn write_error(path: &Path, source: io::Error) -> Error {
    let cure = match source.kind() {
        ErrorKind::NotFound => "make the folder first",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "choose a folder that you may write to with -o",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => "make room, or choose another disk with -o",
        ErrorKind::IsADirectory => "give the name of a file",
        ErrorKind::NotADirectory => "a part of the path is a file; give another",
        ErrorKind::BrokenPipe => "the reader at the other end has gone",
        _ => "choose another place with -o",
    };
    Error::Write { path: path.to_owned(), source, cure }
}
