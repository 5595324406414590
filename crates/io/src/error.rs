//! Errors of files; every message names the file, the object in it, and what was expected and found.

use std::path::PathBuf;

use hdf5::Location;

/// Errors of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The output file exists and is not to be replaced.
    #[error("{path} exists; choose another name or allow it to be replaced")]
    Exists {
        /// The output file.
        path: PathBuf,
    },
    /// The output is a device, a pipe or a socket; replacing it by a file would break its other uses.
    #[error("{path} is no regular file but a device, a pipe or a socket: it is never replaced; choose another name")]
    NotRegular {
        /// The output.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("cannot {action} {path}: {source}")]
    System {
        /// The action that failed.
        action: &'static str,
        /// File or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The HDF5 library refused to write.
    #[error("cannot write {object} of {file}: {why}")]
    Write {
        /// The file.
        file: String,
        /// Path of the object inside the file.
        object: String,
        /// The library's reason, or ours.
        why: String,
    },
    /// Not an HDF5 file, a truncated one, or one whose outermost structure is altered.
    #[error("{path} is no HDF5 file, or is truncated or altered: {why}")]
    NotHdf5 {
        /// The file.
        path: PathBuf,
        /// The library's reason.
        why: String,
    },
    /// An HDF5 file of another program.
    #[error(
        "{file} is an HDF5 file but no result of steklov: its attribute `format` should be \"steklov\", but {found}"
    )]
    Foreign {
        /// The file.
        file: String,
        /// What was found.
        found: String,
    },
    /// A file or an object written by a version that this one cannot read.
    #[error(
        "{object} of {file} has version {found}, this program reads version {known}: use the program that wrote it"
    )]
    Version {
        /// The file.
        file: String,
        /// Path of the object inside the file; `/` for the file itself.
        object: String,
        /// Version found.
        found: i64,
        /// Version that can be read.
        known: u32,
    },
    /// An object that should be there is not.
    #[error("{file} has no {object}")]
    Missing {
        /// The file.
        file: String,
        /// Path of the object inside the file.
        object: String,
    },
    /// An object of another kind, type or shape.
    #[error("{object} of {file}: expected {expected}, found {found}")]
    Mismatch {
        /// The file.
        file: String,
        /// Path of the object inside the file.
        object: String,
        /// What was expected.
        expected: String,
        /// What was found.
        found: String,
    },
    /// Deflated data, which this HDF5 library cannot read.
    #[error(
        "{object} of {file} is deflated, but the HDF5 library of this program is built without zlib: use one with it (feature hdf5-static), or write the data plain by h5repack -f NONE on another machine"
    )]
    NoDeflate {
        /// The file.
        file: String,
        /// Path of the object inside the file.
        object: String,
    },
    /// Data that cannot be read: a checksum that fails, or a part that is missing.
    #[error("{object} of {file} is damaged: {why}")]
    Damaged {
        /// The file.
        file: String,
        /// Path of the object inside the file.
        object: String,
        /// The library's reason, or ours.
        why: String,
    },
    /// Data that can be read but are invalid.
    #[error("{object} of {file} is invalid: {why}")]
    Invalid {
        /// The file.
        file: String,
        /// Path of the object inside the file.
        object: String,
        /// What is wrong.
        why: String,
    },
}

/// File and path of the object `name` in `at`; an empty name means `at` itself.
fn place(at: &Location, name: &str) -> (String, String) {
    let parent = at.name();
    let object = match (parent.as_str(), name) {
        (_, "") => parent,
        ("/", _) => format!("/{name}"),
        _ => format!("{parent}/{name}"),
    };
    (at.filename(), object)
}

pub(crate) fn write_error(at: &Location, name: &str, why: impl ToString) -> IoError {
    let (file, object) = place(at, name);
    IoError::Write { file: crate::file::final_name(&file), object, why: reason(&why.to_string()) }
}

/// The system's reason and a remedy if the library's long message says that there is no room; else the message itself.
pub(crate) fn reason(why: &str) -> String {
    let number = why.split_once("errno = ").and_then(|(_, rest)| rest.split(',').next()?.trim().parse().ok());
    let full = number.map(std::io::Error::from_raw_os_error).filter(|error| remedy(error).is_some());
    full.map_or_else(|| why.to_owned(), |error| system_reason(&error))
}

/// The system's reason, with a remedy if there is no room.
pub(crate) fn system_reason(error: &std::io::Error) -> String {
    remedy(error).map_or_else(|| error.to_string(), |remedy| format!("{error}; {remedy}, or write to another place"))
}

fn remedy(error: &std::io::Error) -> Option<&'static str> {
    use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    match error.kind() {
        StorageFull | QuotaExceeded => Some("make room there"),
        FileTooLarge => Some("raise the limit of file sizes"),
        _ => None,
    }
}

pub(crate) fn missing(at: &Location, name: &str) -> IoError {
    let (file, object) = place(at, name);
    IoError::Missing { file, object }
}

pub(crate) fn mismatch(at: &Location, name: &str, expected: impl ToString, found: impl ToString) -> IoError {
    let (file, object) = place(at, name);
    IoError::Mismatch { file, object, expected: expected.to_string(), found: found.to_string() }
}

pub(crate) fn damaged(at: &Location, name: &str, why: impl ToString) -> IoError {
    let (file, object) = place(at, name);
    IoError::Damaged { file, object, why: why.to_string() }
}

pub(crate) fn no_deflate(at: &Location, name: &str) -> IoError {
    let (file, object) = place(at, name);
    IoError::NoDeflate { file, object }
}

/// For [`Persist`](crate::Persist) implementations: the content of `name` in `at` is invalid.
pub fn invalid(at: &Location, name: &str, why: impl ToString) -> IoError {
    let (file, object) = place(at, name);
    IoError::Invalid { file, object, why: why.to_string() }
}
