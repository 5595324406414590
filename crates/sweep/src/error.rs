//! Why a sweep is refused, or ends.

use std::path::PathBuf;

use steklov_document::SceneError;
#[cfg(feature = "hdf5")]
use steklov_io::IoError;
use steklov_picture::PictureError;

/// Why a sweep is refused, or ends.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// Points that cannot be made.
    #[error("{text:?}: {why}; {help}")]
    Vary {
        /// The text that was given.
        text: String,
        /// What is wrong.
        why: String,
        /// What to change.
        help: String,
    },
    /// A scene that is wrong at all points.
    #[error("{0}")]
    Scene(Box<SceneError>),
    /// More points than are allowed.
    #[error(
        "{count} points are more than {most}: the first one took {seconds:.2} s, and all of them would take about {all}; take fewer values, \
         or divide the points among several sweeps"
    )]
    TooMany {
        /// The number of points.
        count: usize,
        /// The most that are allowed.
        most: usize,
        /// Seconds of the first point.
        seconds: f64,
        /// Estimated time of all points.
        all: String,
    },
    /// The journal of finished points cannot be written or read.
    #[error("the journal {path} of finished points: {source}; {kept} finished point(s) are kept in it: mend that, then go on with --resume", path = path.display())]
    Journal {
        /// The file.
        path: PathBuf,
        /// Points that it holds.
        kept: usize,
        /// Why.
        source: std::io::Error,
    },
    /// A journal that another program writes.
    #[error("another program writes {path}: wait for it, or name another file", path = path.display())]
    Busy {
        /// The journal.
        path: PathBuf,
    },
    /// A journal of a sweep that was stopped.
    #[error("{path} holds {kept} finished point(s) of a sweep that was stopped: go on with --resume, or start again with --force", path = path.display())]
    Unfinished {
        /// The journal.
        path: PathBuf,
        /// Points that it holds.
        kept: usize,
    },
    /// A file of another sweep.
    #[error("{file} is of another sweep: its {what} differ(s); name another file, or replace it with --force")]
    Other {
        /// The file.
        file: String,
        /// What differs.
        what: &'static str,
    },
    /// Two files that have different answers for a point.
    #[error(
        "{first} and {second} have different answers at point {point} ({settings}): merge parts of one sweep by one program"
    )]
    Conflict {
        /// A file.
        first: String,
        /// Another file.
        second: String,
        /// The point.
        point: usize,
        /// Its settings.
        settings: String,
    },
    /// A file that cannot be written or read.
    #[cfg(feature = "hdf5")]
    #[error(transparent)]
    Io(#[from] IoError),
    /// A chart that cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A table that cannot be written.
    #[error("{path}: {source}", path = path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
