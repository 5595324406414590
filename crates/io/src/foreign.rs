//! Arrays of other programs' HDF5 files.

use std::fs;
use std::io::{Error, ErrorKind};
use std::path::Path;

use hdf5::types::TypeDescriptor;
use hdf5::{Dataset, File, LocationType};

use crate::attribute::read_foreign_names;
use crate::error::{IoError, damaged, mismatch, missing};

/// Reads a table of numbers, row by row, from any HDF5 file: `dataset` is the path of the table in the file, `shape`
/// its required shape. Integers and numbers of single precision are converted.
///
/// # Errors
/// [`IoError::System`] when the file cannot be opened, [`IoError::NotHdf5`], [`IoError::Missing`] without such a dataset,
/// [`IoError::Mismatch`] for another object, type or shape (the message names both shapes, and says whether the transposed one
/// fits), [`IoError::Damaged`].
pub fn load_foreign_table(path: impl AsRef<Path>, dataset: &str, shape: [usize; 2]) -> Result<Vec<f64>, IoError> {
    let (file, table) = open_dataset(path.as_ref(), dataset)?;
    let name = dataset.trim_start_matches('/');
    match table.dtype().and_then(|kind| kind.to_descriptor()) {
        Ok(TypeDescriptor::Float(_) | TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_)) => {}
        Ok(found) => return Err(mismatch(&file, name, "numbers", found)),
        Err(found) => return Err(mismatch(&file, name, "numbers", found)),
    }
    let found = table.shape();
    if found != shape {
        let words = |shape: &[usize]| shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" by ");
        let hint = match found[..] {
            [m, n] if [n, m] == shape => ", which is the transposed shape",
            _ => "",
        };
        let found = format!("{}{hint}", if found.is_empty() { "a single number".to_owned() } else { words(&found) });
        return Err(mismatch(&file, name, format!("{} numbers", words(&shape)), found));
    }
    table.read_raw().map_err(|e| damaged(&file, name, e))
}

/// Reads the attribute `axes` of a dataset of any HDF5 file: a name for each axis, or one text; None without the
/// attribute.
///
/// # Errors
/// As [`load_foreign_table`]; [`IoError::Mismatch`] for an attribute that is no text.
pub fn load_foreign_axes(path: impl AsRef<Path>, dataset: &str) -> Result<Option<Vec<String>>, IoError> {
    let (_, table) = open_dataset(path.as_ref(), dataset)?;
    match read_foreign_names(&table, "axes") {
        Err(IoError::Missing { .. }) => Ok(None),
        read => read.map(Some),
    }
}

/// Opens a dataset of any HDF5 file for reading.
fn open_dataset(path: &Path, dataset: &str) -> Result<(File, Dataset), IoError> {
    let system = |source| IoError::System { action: "open", path: path.to_owned(), source };
    // opening a pipe would wait for a writer
    if !fs::metadata(path).map_err(system)?.is_file() {
        return Err(system(Error::new(ErrorKind::InvalidInput, "it is no regular file")));
    }
    fs::File::open(path).map_err(system)?;
    let opened = File::with_options().with_fapl(|access| access.file_locking(false)).open(path);
    let file = opened.map_err(|e| IoError::NotHdf5 { path: path.to_owned(), why: e.to_string() })?;
    let name = dataset.trim_start_matches('/');
    if !file.link_exists(name) {
        return Err(missing(&file, name));
    }
    if file.loc_type_by_name(name).map_err(|e| damaged(&file, name, e))? != LocationType::Dataset {
        return Err(mismatch(&file, name, "a dataset", "another object"));
    }
    let table = file.dataset(name).map_err(|e| damaged(&file, name, e))?;
    Ok((file, table))
}
