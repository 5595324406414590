//! Requests space on the disk before the library copies: if writing fails during a copy, the library reads memory that
//! is not its own.

use std::fs::OpenOptions;
use std::io::{self, Seek as _, SeekFrom, Write as _};

use hdf5::{Group, LocationType};

/// Bytes for the structures of an object, more than any object in result files needs.
const STRUCTURES: u64 = 1 << 12;

/// Bytes of an object and its content in a file.
pub(crate) fn size(at: &Group, name: &str) -> hdf5::Result<u64> {
    match at.loc_type_by_name(name)? {
        LocationType::Group => {
            let group = at.group(name)?;
            group.member_names()?.iter().try_fold(STRUCTURES, |sum, name| Ok(sum.saturating_add(size(&group, name)?)))
        }
        LocationType::Dataset => Ok(at.dataset(name)?.storage_size().saturating_add(STRUCTURES)),
        _ => Ok(STRUCTURES),
    }
}

/// Writes `bytes` zeros at the end of the file of a group and removes them again.
pub(crate) fn check(at: &Group, bytes: u64) -> io::Result<()> {
    let end = at.file().map_err(io::Error::other)?.size();
    let mut file = OpenOptions::new().write(true).open(at.filename())?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(end.max(length)))?;
    let written = io::copy(&mut io::Read::take(io::repeat(0), bytes), &mut file).and_then(|_| file.flush());
    file.set_len(length)?;
    written
}
