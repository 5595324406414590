//! Vectors, points, pairs, integers, scalars.

use hdf5::Group;

use crate::dataset::{Label, read_numbers, write_numbers};
use crate::deflated::Storage::{Deflated, Plain};
use crate::error::{IoError, invalid, mismatch, write_error};

/// Writes n numbers, shape (n). NaN and infinities are kept, bit by bit.
///
/// # Errors
/// [`IoError::Write`], as for all `save_` functions.
pub fn save_vector(at: &Group, name: &str, data: &[f64], label: &Label<'_>) -> Result<(), IoError> {
    write_numbers(at, name, &[data.len()], data, label, Plain)
}

/// Reads what [`save_vector`] wrote, the same bits.
///
/// # Errors
/// [`IoError::Missing`], [`IoError::Mismatch`] for another type or shape, [`IoError::Damaged`] when the checksum fails,
/// [`IoError::Invalid`]; as for all `load_` functions.
pub fn load_vector(at: &Group, name: &str) -> Result<Vec<f64>, IoError> {
    Ok(read_numbers(at, name, 1)?.1)
}

/// Writes one number as a vector of length 1.
///
/// # Errors
/// [`IoError::Write`].
pub fn save_number(at: &Group, name: &str, value: f64, unit: &str, meaning: &str) -> Result<(), IoError> {
    save_vector(at, name, &[value], &Label { unit, meaning, axes: &["value"] })
}

/// Reads what [`save_number`] wrote.
///
/// # Errors
/// As [`load_vector`].
pub fn load_number(at: &Group, name: &str) -> Result<f64, IoError> {
    match load_vector(at, name)?[..] {
        [value] => Ok(value),
        ref other => Err(mismatch(at, name, "one number", format!("{} numbers", other.len()))),
    }
}

/// Writes n pairs of numbers (points, vectors, pairs of values), shape (n, 2).
///
/// # Errors
/// [`IoError::Write`].
pub fn save_points(at: &Group, name: &str, data: &[[f64; 2]], label: &Label<'_>) -> Result<(), IoError> {
    write_numbers(at, name, &[data.len(), 2], data.as_flattened(), label, Plain)
}

/// Reads what [`save_points`] wrote.
///
/// # Errors
/// As [`load_vector`].
pub fn load_points(at: &Group, name: &str) -> Result<Vec<[f64; 2]>, IoError> {
    let (shape, data) = read_numbers::<f64>(at, name, 2)?;
    pairs(at, name, &shape, &data)
}

/// Writes n indices or counts as integers of 64 bits, shape (n).
///
/// # Errors
/// [`IoError::Write`], also for a number above 2⁶³-1.
pub fn save_integers(at: &Group, name: &str, data: &[usize], label: &Label<'_>) -> Result<(), IoError> {
    write_numbers(at, name, &[data.len()], &signed(at, name, data)?, label, Deflated)
}

/// Reads what [`save_integers`] wrote.
///
/// # Errors
/// As [`load_vector`]; [`IoError::Invalid`] for a negative number.
pub fn load_integers(at: &Group, name: &str) -> Result<Vec<usize>, IoError> {
    unsigned(at, name, &read_numbers(at, name, 1)?.1)
}

/// Writes n pairs of indices, shape (n, 2).
///
/// # Errors
/// [`IoError::Write`].
pub fn save_pairs(at: &Group, name: &str, data: &[[usize; 2]], label: &Label<'_>) -> Result<(), IoError> {
    write_numbers(at, name, &[data.len(), 2], &signed(at, name, data.as_flattened())?, label, Deflated)
}

/// Reads what [`save_pairs`] wrote.
///
/// # Errors
/// As [`load_integers`].
pub fn load_pairs(at: &Group, name: &str) -> Result<Vec<[usize; 2]>, IoError> {
    let (shape, data) = read_numbers::<i64>(at, name, 2)?;
    pairs(at, name, &shape, &unsigned(at, name, &data)?)
}

fn signed(at: &Group, name: &str, data: &[usize]) -> Result<Vec<i64>, IoError> {
    let signed = |&i| i64::try_from(i).map_err(|_| write_error(at, name, format!("{i} needs more than 63 bits")));
    data.iter().map(signed).collect()
}

fn unsigned(at: &Group, name: &str, data: &[i64]) -> Result<Vec<usize>, IoError> {
    let unsigned = |&i| usize::try_from(i).map_err(|_| invalid(at, name, format!("{i} is no index")));
    data.iter().map(unsigned).collect()
}

fn pairs<T: Copy>(at: &Group, name: &str, shape: &[usize], data: &[T]) -> Result<Vec<[T; 2]>, IoError> {
    if shape[1] != 2 {
        return Err(mismatch(at, name, "shape (n, 2)", format!("({}, {})", shape[0], shape[1])));
    }
    Ok(data.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
}
