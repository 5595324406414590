//! Texts and lists of texts, UTF-8.

use hdf5::types::TypeDescriptor;
use hdf5::{Dataset, Group};

use crate::attribute::{pack, read_integer_attribute, unpack, write_integer_attribute};
use crate::dataset::{Label, create, open};
use crate::deflated::Storage;
use crate::error::{IoError, damaged, invalid, mismatch, write_error};
use crate::raw;

/// FNV-1a of 64 bits, as a signed number. HDF5 applies filters to chunks, and a scalar has none, so a text has this
/// checksum in an attribute instead.
fn fnv1a(bytes: &[u8]) -> i64 {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    hash.cast_signed()
}

/// Writes a text as a scalar string of fixed length; h5py: `file[name].asstr()[()]`.
///
/// # Errors
/// [`IoError::Write`], also for a text that contains a NUL character.
pub fn save_text(at: &Group, name: &str, text: &str, meaning: &str) -> Result<(), IoError> {
    let (size, bytes) = pack(&[text]).map_err(|why| write_error(at, name, why))?;
    let label = Label { unit: "text", meaning, axes: &[] };
    let dataset = create(at, name, TypeDescriptor::FixedUnicode(size), &[], &label, Storage::Plain)?;
    write_integer_attribute(&dataset, "fnv1a", &[fnv1a(&bytes)])?;
    raw::write_dataset(&dataset, &bytes).map_err(|e| write_error(at, name, e))
}

/// Reads what [`save_text`] wrote.
///
/// # Errors
/// [`IoError::Missing`], [`IoError::Mismatch`] for another type, [`IoError::Damaged`] when the checksum fails,
/// [`IoError::Invalid`] for bytes that are not UTF-8.
pub fn load_text(at: &Group, name: &str) -> Result<String, IoError> {
    let (dataset, size) = open_texts(at, name, 0)?;
    let wanted = read_integer_attribute(&dataset, "fnv1a")?;
    let bytes = raw::read_dataset(&dataset).map_err(|e| damaged(at, name, e))?;
    if wanted != [fnv1a(&bytes)] {
        return Err(damaged(at, name, "its checksum fails"));
    }
    let mut texts = unpack(size, &bytes).map_err(|why| invalid(at, name, why))?;
    texts.pop().ok_or_else(|| invalid(at, name, "there is no text"))
}

/// Writes a list of texts as strings of one fixed length, shape (n); h5py: `file[name].asstr()[:]`.
///
/// # Errors
/// As [`save_text`].
pub fn save_texts(at: &Group, name: &str, texts: &[String], meaning: &str, axis: &str) -> Result<(), IoError> {
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let (size, bytes) = pack(&texts).map_err(|why| write_error(at, name, why))?;
    let label = Label { unit: "text", meaning, axes: &[axis] };
    let dataset = create(at, name, TypeDescriptor::FixedUnicode(size), &[texts.len()], &label, Storage::Plain)?;
    if texts.is_empty() {
        return Ok(());
    }
    raw::write_dataset(&dataset, &bytes).map_err(|e| write_error(at, name, e))
}

/// Reads what [`save_texts`] wrote.
///
/// # Errors
/// As [`load_text`].
pub fn load_texts(at: &Group, name: &str) -> Result<Vec<String>, IoError> {
    let (dataset, size) = open_texts(at, name, 1)?;
    let bytes = raw::read_dataset(&dataset).map_err(|e| damaged(at, name, e))?;
    unpack(size, &bytes).map_err(|why| invalid(at, name, why))
}

fn open_texts(at: &Group, name: &str, rank: usize) -> Result<(Dataset, usize), IoError> {
    let dataset = open(at, name)?;
    let size = match dataset.dtype().and_then(|t| t.to_descriptor()).map_err(|e| damaged(at, name, e))? {
        TypeDescriptor::FixedUnicode(size) | TypeDescriptor::FixedAscii(size) => size,
        other => return Err(mismatch(at, name, "text of fixed length", other)),
    };
    if dataset.ndim() != rank {
        return Err(mismatch(at, name, format!("{rank} dimensions"), dataset.ndim()));
    }
    Ok((dataset, size))
}
