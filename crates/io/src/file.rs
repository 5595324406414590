//! Result files: written whole or not at all, checked on opening.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use hdf5::File;
use hdf5::file::{FileBuilder, FileCloseDegree, LibraryVersion};
use tempfile::NamedTempFile;

#[cfg(unix)]
use crate::abandoned;
use crate::attribute::{read_text_attribute, write_integer_attribute, write_text_attribute};
use crate::error::{IoError, reason};
use crate::persist::check_version;

/// Value of the root attribute `format`.
pub const FORMAT: &str = "steklov";
/// Value of the root attribute `format_version`.
pub const FORMAT_VERSION: u32 = 1;

/// Suffix of half-written files.
pub(crate) const SUFFIX: &str = ".part";

/// HDF5 of version 1.10 with every version of the library: all of its structures have checksums, and every reader knows
/// it. Closing the file closes all objects that the caller left open in it.
///
/// No locks, here and in [`open`]: a file is never written under its own name, and a process that was started meanwhile
/// would inherit the lock and keep it.
fn builder() -> FileBuilder {
    let mut builder = File::with_options();
    builder.with_fapl(|access| {
        access
            .libver_bounds(LibraryVersion::V110, LibraryVersion::V110)
            .fclose_degree(FileCloseDegree::Strong)
            .file_locking(false)
    });
    builder.with_fcpl(|create| create.obj_track_times(false));
    builder
}

/// Whether there is something at `path`, links followed, that is neither a regular file nor a folder: a device, a pipe or
/// a socket.
pub fn is_special(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Writes the file `path` as a whole: `fill` gets a new HDF5 file beside it that is closed, synced and then renamed.
/// Returns what `fill` returns.
///
/// The file has the root attributes `format` and `format_version`; equal content gives equal bytes. On any error no new
/// file remains, and an existing one is untouched. A killed program leaves its half-written file, which the next call
/// for the same path removes.
///
/// # Errors
/// [`IoError::Exists`] when `path` exists and `overwrite` is false, also when it appears meanwhile;
/// [`IoError::NotRegular`] when it is a device, a pipe or a socket; [`IoError::System`] when the folder cannot be written; [`IoError::Write`] when the disk is full; the errors of `fill`.
pub fn create_atomically<T, E: From<IoError>>(
    path: impl AsRef<Path>,
    overwrite: bool,
    fill: impl FnOnce(&File) -> Result<T, E>,
) -> Result<T, E> {
    let path = path.as_ref();
    let exists = || IoError::Exists { path: path.to_owned() };
    let system = |action, path: &Path, source| IoError::System { action, path: path.to_owned(), source };
    let library = |e: hdf5::Error| IoError::Write {
        file: path.display().to_string(),
        object: "/".to_owned(),
        why: reason(&e.to_string()),
    };

    if !overwrite && path.symlink_metadata().is_ok() {
        return Err(exists().into());
    }
    if is_special(path) {
        return Err(IoError::NotRegular { path: path.to_owned() }.into());
    }
    let Some(name) = path.file_name() else {
        return Err(system("write", path, std::io::Error::new(ErrorKind::InvalidInput, "it names no file")).into());
    };
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    };
    let prefix = format!(".{}.", name.to_string_lossy());
    let temporary = beside(&folder, &prefix).map_err(|e| system("write in the folder", &folder, e))?;

    let file = builder().create(temporary.path()).map_err(library)?;
    write_text_attribute(&file, "format", FORMAT)
        .and_then(|()| write_integer_attribute(&file, "format_version", &[i64::from(FORMAT_VERSION)]))?;
    let filled = fill(&file)?;
    file.flush().map_err(library)?;
    file.close().map_err(library)?;
    temporary.as_file().sync_all().map_err(|e| system("sync", path, e))?;
    let renamed = if overwrite { temporary.persist(path) } else { temporary.persist_noclobber(path) };
    renamed.map_err(|e| match e.error.kind() {
        ErrorKind::AlreadyExists => exists(),
        _ => system("write", path, e.error),
    })?;
    // The file is complete; a folder that cannot be synced (some network disks) does not make it lost.
    #[cfg(unix)]
    let _ = fs::File::open(&folder).and_then(|folder| folder.sync_all());
    Ok(filled)
}

/// The path of the complete file; its half-written file is beside it, as `.NAME.RANDOM.part`.
pub(crate) fn final_name(path: &str) -> String {
    let path = Path::new(path);
    let name =
        path.file_name().and_then(|name| name.to_str()?.strip_prefix('.')?.strip_suffix(SUFFIX)?.rsplit_once('.'));
    name.map_or(path.to_owned(), |(name, _)| path.with_file_name(name)).display().to_string()
}

/// A new file to write, locked by this program; files that killed programs have left are removed.
#[cfg(unix)]
fn beside(folder: &Path, prefix: &str) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).suffix(SUFFIX).rand_bytes(abandoned::RANDOM);
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let temporary = builder.tempfile_in(folder)?;
        if abandoned::hold(temporary.as_file()) {
            abandoned::remove(folder, prefix, temporary.as_file());
            return Ok(temporary);
        }
    }
}

/// A new file to write.
#[cfg(not(unix))]
fn beside(folder: &Path, prefix: &str) -> std::io::Result<NamedTempFile> {
    tempfile::Builder::new().prefix(prefix).suffix(SUFFIX).tempfile_in(folder)
}

/// Opens a result file for reading and checks that it is one.
///
/// # Errors
/// [`IoError::System`] when it cannot be opened, [`IoError::NotHdf5`] when it is no HDF5 file, truncated or altered,
/// [`IoError::Foreign`] for another program's file, [`IoError::Version`] for another version of the format.
pub fn open(path: impl AsRef<Path>) -> Result<File, IoError> {
    let path = path.as_ref();
    fs::File::open(path).map_err(|source| IoError::System { action: "open", path: path.to_owned(), source })?;
    let opened = File::with_options().with_fapl(|access| access.file_locking(false)).open(path);
    let file = opened.map_err(|e| IoError::NotHdf5 { path: path.to_owned(), why: e.to_string() })?;
    let foreign = |found| IoError::Foreign { file: path.display().to_string(), found };
    match read_text_attribute(&file, "format") {
        Ok(format) if format == FORMAT => {}
        Ok(format) => return Err(foreign(format!("is {format:?}"))),
        Err(IoError::Missing { .. }) => return Err(foreign("there is none".to_owned())),
        Err(IoError::Mismatch { found, .. }) => return Err(foreign(format!("is of type {found}"))),
        Err(other) => return Err(other),
    }
    check_version(&file, "format_version", FORMAT_VERSION)?;
    Ok(file)
}
