//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Cursor, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};

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
    let failed = |source: io::Error| write_error(path, source);
    let target = match fs::metadata(path) {
        Ok(_) if overwrite == Overwrite::Refuse => return Err(Error::Exists { path: path.to_owned() }),
        Ok(existing) if existing.is_dir() => return Err(failed(ErrorKind::IsADirectory.into())),
        Ok(existing) if !existing.is_file() => return write_through(path, content),
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
    let temporary = builder.tempfile_in(&folder).map_err(|error| failed(plain(error)))?;
    {
        let mut writer = BufWriter::new(temporary.as_file());
        content(&mut writer).map_err(|error| named(path, error))?;
        writer.flush().map_err(failed)?;
    }
    // A disk that is full may say so only now; after the rename it would be too late.
    temporary.as_file().sync_all().map_err(failed)?;
    match overwrite {
        Overwrite::Replace => temporary.persist(&target).map_err(|error| failed(error.error))?,
        Overwrite::Refuse => temporary.persist_noclobber(&target).map_err(|error| match error.error.kind() {
            ErrorKind::AlreadyExists => Error::Exists { path: path.to_owned() },
            _ => failed(error.error),
        })?,
    };
    Ok(())
}

fn write_through(path: &Path, content: impl FnOnce(&mut dyn SeekWrite) -> Result<()>) -> Result<()> {
    let mut bytes = Cursor::new(Vec::new());
    content(&mut bytes).map_err(|error| named(path, error))?;
    let mut file = File::options().write(true).open(path).map_err(|error| write_error(path, error))?;
    file.write_all(bytes.get_ref()).and_then(|()| file.flush()).map_err(|error| write_error(path, error))
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
fn named(path: &Path, error: Error) -> Error {
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
