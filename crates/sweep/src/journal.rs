//! The journal of a sweep: a line for each finished point, so that they survive whatever ends the program.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::solve::Outcome;
use crate::{Points, Sweep, SweepError};

const FORMAT: &str = "journal of a sweep by steklov, version 1";

/// The first line.
#[derive(Serialize, Deserialize)]
struct Header {
    format: String,
    scene: String,
    overrides: Vec<String>,
    points: Points,
}

/// Another line.
#[derive(Serialize, Deserialize)]
struct Line {
    point: usize,
    outcome: Outcome,
}

/// An open journal, beside the file that the sweep will be.
pub struct Journal {
    path: PathBuf,
    file: File,
    kept: usize,
}

impl Journal {
    /// The journal of the sweep whose file is `out`: with `resume` one that is there gives its points to the sweep and is continued;
    /// without, it is replaced if `replace` allows it.
    ///
    /// # Errors
    /// [`SweepError::Unfinished`] of one that is there; [`SweepError::Busy`] if another program writes it; [`SweepError::Other`] of one of another sweep; [`SweepError::Journal`] if the
    /// file cannot be read or written.
    pub fn begin(out: &Path, sweep: &mut Sweep, resume: bool, replace: bool) -> Result<Self, SweepError> {
        let mut name = out.file_name().unwrap_or_default().to_owned();
        name.push(".journal");
        let path = out.with_file_name(name);
        let failed = |source| SweepError::Journal { path: path.clone(), kept: 0, source };
        let mut text = String::new();
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(&path).map_err(failed)?;
        // where files cannot be locked, as on some network disks, nobody can tell
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            return Err(SweepError::Busy { path });
        }
        file.read_to_string(&mut text).map_err(failed)?;
        let held = text.lines().count().saturating_sub(1);
        if !resume && !replace && held > 0 {
            return Err(SweepError::Unfinished { path, kept: held });
        }
        let mut kept = 0;
        if resume && held > 0 {
            kept = read(&text, &path, sweep)?;
            if !text.ends_with('\n') {
                // the rest of a line that was cut off
                writeln!(file).map_err(failed)?;
            }
        } else {
            file.set_len(0).and_then(|()| file.seek(SeekFrom::Start(0))).map_err(failed)?;
            let Sweep { scene, overrides, points, .. } = &*sweep;
            let (scene, overrides, points) = (scene.clone(), overrides.clone(), points.clone());
            let header = Header { format: FORMAT.to_owned(), scene, overrides, points };
            writeln!(file, "{}", serde_json::to_string(&header).map_err(Error::from).map_err(failed)?)
                .map_err(failed)?;
        }
        Ok(Self { path, file, kept })
    }

    /// Adds a finished point.
    ///
    /// # Errors
    /// [`SweepError::Journal`], as on a full disk: the points before it are kept.
    pub fn add(&mut self, point: usize, outcome: &Outcome) -> Result<(), SweepError> {
        let line = serde_json::to_string(&Line { point, outcome: outcome.clone() }).map_err(Error::from);
        let written = line.and_then(|line| self.file.write_all(format!("{line}\n").as_bytes()));
        self.kept += usize::from(written.is_ok());
        written.map_err(|source| SweepError::Journal { path: self.path.clone(), kept: self.kept, source })
    }

    /// The number of points in it.
    pub fn kept(&self) -> usize {
        self.kept
    }

    /// Removes it: its points are in the file of the sweep.
    ///
    /// # Errors
    /// [`SweepError::Journal`].
    pub fn end(self) -> Result<(), SweepError> {
        let Self { path, file, kept } = self;
        drop(file);
        std::fs::remove_file(&path).map_err(|source| SweepError::Journal { path, kept, source })
    }
}

/// Gives the points of a journal to the sweep, and returns their number; a line that was cut off counts for nothing.
fn read(text: &str, path: &Path, sweep: &mut Sweep) -> Result<usize, SweepError> {
    let mut lines = text.lines();
    let header: Option<Header> = lines.next().and_then(|line| serde_json::from_str(line).ok());
    let Some(Header { scene, overrides, points, .. }) = header.filter(|header| header.format == FORMAT) else {
        let source = Error::new(ErrorKind::InvalidData, "its first line is not that of a journal");
        return Err(SweepError::Journal { path: path.to_owned(), kept: 0, source });
    };
    sweep.check_same(&scene, &overrides, &points, &path.display().to_string())?;
    let finished = lines.filter_map(|line| serde_json::from_str::<Line>(line).ok());
    let mut kept = 0;
    for Line { point, outcome } in finished.filter(|line| line.point < points.len()) {
        sweep.outcomes[point] = Some(outcome);
        kept += 1;
    }
    Ok(kept)
}
