//! Attributes. They are in object headers, which have their own checksum, so an altered attribute is noticed.

use hdf5::types::{TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5::{Attribute, Location};

use crate::error::{IoError, damaged, invalid, mismatch, missing, write_error};
use crate::raw;

/// Equally long records of texts, padded with NUL, and their length (at least 1).
pub(crate) fn pack(texts: &[&str]) -> Result<(usize, Vec<u8>), String> {
    if let Some(text) = texts.iter().find(|t| t.contains('\0')) {
        return Err(format!("the text {text:?} contains a NUL character, which HDF5 strings cannot hold"));
    }
    let size = texts.iter().map(|t| t.len()).max().unwrap_or(0).max(1);
    let mut bytes = vec![0; size * texts.len()];
    for (record, text) in bytes.chunks_exact_mut(size).zip(texts) {
        record[..text.len()].copy_from_slice(text.as_bytes());
    }
    Ok((size, bytes))
}

/// The texts of records of `size` bytes.
pub(crate) fn unpack(size: usize, bytes: &[u8]) -> Result<Vec<String>, String> {
    let mut texts = Vec::new();
    for record in bytes.chunks_exact(size.max(1)) {
        let end = record.iter().rposition(|&b| b != 0).map_or(0, |last| last + 1);
        let text =
            std::str::from_utf8(&record[..end]).map_err(|e| format!("text {} is not UTF-8: {e}", texts.len()))?;
        if text.contains('\0') {
            return Err(format!("text {} contains a NUL character", texts.len()));
        }
        texts.push(text.to_owned());
    }
    Ok(texts)
}

fn write_strings(at: &Location, name: &str, shape: &[usize], texts: &[&str], ascii: bool) -> Result<(), IoError> {
    let (size, bytes) = pack(texts).map_err(|why| write_error(at, name, why))?;
    raw::create_attribute(at, name, (size, ascii), shape, &bytes).map_err(|e| write_error(at, name, e))
}

/// Writes the text attribute `name` of `at`, UTF-8 of fixed length. h5py shows it as bytes.
///
/// # Errors
/// [`IoError::Write`], also for a text that contains a NUL character.
pub fn write_text_attribute(at: &Location, name: &str, text: &str) -> Result<(), IoError> {
    write_strings(at, name, &[], &[text], false)
}

/// As [`write_text_attribute`], in ASCII for VTK.
pub(crate) fn write_ascii_attribute(at: &Location, name: &str, text: &str) -> Result<(), IoError> {
    write_strings(at, name, &[], &[text], true)
}

pub(crate) fn write_names_attribute(at: &Location, name: &str, texts: &[&str]) -> Result<(), IoError> {
    write_strings(at, name, &[texts.len()], texts, false)
}

/// Writes the attribute `name` of `at`: integers of 64 bits, a scalar if there is one, else a list.
///
/// # Errors
/// [`IoError::Write`].
pub fn write_integer_attribute(at: &Location, name: &str, values: &[i64]) -> Result<(), IoError> {
    let shape = if values.len() == 1 { vec![] } else { vec![values.len()] };
    let new = at.new_attr::<i64>().shape(shape);
    new.create(name).and_then(|a| a.write_raw(values)).map_err(|e| write_error(at, name, e))
}

fn attribute(at: &Location, name: &str) -> Result<Attribute, IoError> {
    let names = at.attr_names().map_err(|e| damaged(at, "", e))?;
    if !names.iter().any(|n| n == name) {
        return Err(missing(at, &format!("@{name}")));
    }
    at.attr(name).map_err(|e| damaged(at, name, e))
}

fn type_of(at: &Location, name: &str, attribute: &Attribute) -> Result<TypeDescriptor, IoError> {
    attribute.dtype().and_then(|t| t.to_descriptor()).map_err(|e| damaged(at, name, e))
}

fn read_strings(at: &Location, name: &str, rank: usize) -> Result<Vec<String>, IoError> {
    let attribute = attribute(at, name)?;
    let size = match type_of(at, name, &attribute)? {
        TypeDescriptor::FixedUnicode(size) | TypeDescriptor::FixedAscii(size) => size,
        other => return Err(mismatch(at, name, "text of fixed length", other)),
    };
    if attribute.ndim() != rank {
        return Err(mismatch(at, name, format!("{rank} dimensions"), attribute.ndim()));
    }
    let bytes = raw::read_attribute(&attribute).map_err(|e| damaged(at, name, e))?;
    unpack(size, &bytes).map_err(|why| invalid(at, name, why))
}

/// Reads the text attribute `name` of `at`.
///
/// # Errors
/// [`IoError::Missing`], [`IoError::Mismatch`] for another type or rank, [`IoError::Damaged`], [`IoError::Invalid`].
pub fn read_text_attribute(at: &Location, name: &str) -> Result<String, IoError> {
    let mut texts = read_strings(at, name, 0)?;
    texts.pop().ok_or_else(|| invalid(at, name, "there is no text"))
}

pub(crate) fn read_names_attribute(at: &Location, name: &str) -> Result<Vec<String>, IoError> {
    read_strings(at, name, 1)
}

/// Reads the attribute `name` that another program wrote: one text or a list of them, of any kind of string.
pub(crate) fn read_foreign_names(at: &Location, name: &str) -> Result<Vec<String>, IoError> {
    let attribute = attribute(at, name)?;
    let damage = |e: hdf5::Error| damaged(at, name, e);
    match type_of(at, name, &attribute)? {
        TypeDescriptor::FixedUnicode(size) | TypeDescriptor::FixedAscii(size) => {
            let bytes = raw::read_attribute(&attribute).map_err(|e| damaged(at, name, e))?;
            unpack(size, &bytes).map_err(|why| invalid(at, name, why))
        }
        TypeDescriptor::VarLenUnicode => {
            let texts: Vec<VarLenUnicode> = attribute.read_raw().map_err(damage)?;
            Ok(texts.iter().map(|text| text.to_string()).collect())
        }
        TypeDescriptor::VarLenAscii => {
            let texts: Vec<VarLenAscii> = attribute.read_raw().map_err(damage)?;
            Ok(texts.iter().map(|text| text.to_string()).collect())
        }
        other => Err(mismatch(at, name, "text", other)),
    }
}

/// Reads the attribute `name` of `at`: a scalar or a list of integers of 64 bits.
///
/// # Errors
/// [`IoError::Missing`], [`IoError::Mismatch`] for another type, [`IoError::Damaged`].
pub fn read_integer_attribute(at: &Location, name: &str) -> Result<Vec<i64>, IoError> {
    let attribute = attribute(at, name)?;
    match type_of(at, name, &attribute)? {
        TypeDescriptor::Integer(hdf5::types::IntSize::U8) => attribute.read_raw().map_err(|e| damaged(at, name, e)),
        other => Err(mismatch(at, name, "integers of 64 bits", other)),
    }
}
