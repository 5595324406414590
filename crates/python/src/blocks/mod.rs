//! The numerics one by one, for `steklov.blocks`: rules, boundary meshes, operators, contact problems, random fields and multiscale
//! bases as arrays of NumPy.

mod boundary;
mod cells;
mod contact;
mod karhunen_loeve;
mod operators;
mod rules;

pub use boundary::{Mesh, Polygon};
pub use cells::cell_basis;
pub use contact::{Answer, ContactProblem};
pub use karhunen_loeve::KarhunenLoeve;
pub use operators::{Operators, Steklov};
pub use rules::rule;

use std::fmt::Display;

use numpy::PyArray1;
use pyo3::prelude::*;
use steklov_algebra::faer::MatRef;
use steklov_algebra::is_fault;
use steklov_elastic::Plane;

use crate::{raised, start_threads};

/// f without the GIL, on the threads of all numerics.
fn work<T: Send>(py: Python<'_>, f: impl FnOnce() -> T + Send) -> PyResult<T> {
    start_threads(py)?;
    Ok(py.detach(|| rayon::scope(|_| f())))
}

/// The exception of data that make no block.
fn wrong(py: Python<'_>, what: impl Display) -> PyErr {
    raised(py, "BlockError", (what.to_string(),))
}

/// The exception of an error of the numerics: of the data, unless the algebra failed.
fn failed(py: Python<'_>, error: impl std::error::Error + 'static) -> PyErr {
    match is_fault(&error) {
        true => raised(py, "SolveError", (error.to_string(),)),
        false => wrong(py, error),
    }
}

/// The exception of a word that has no meaning here.
fn unknown(py: Python<'_>, what: &str, word: &str) -> PyErr {
    wrong(py, format!("{word:?} is no {what}"))
}

fn plane(py: Python<'_>, word: &str) -> PyResult<Plane> {
    match word {
        "strain" => Ok(Plane::Strain),
        "stress" => Ok(Plane::Stress),
        _ => Err(unknown(py, "plane", word)),
    }
}

/// An array of this shape, the last index running fastest.
fn array<'py>(py: Python<'py>, flat: Vec<f64>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    PyArray1::from_vec(py, flat).call_method1("reshape", (shape.to_vec(),))
}

/// An array of whole numbers.
fn whole<'py>(py: Python<'py>, numbers: impl IntoIterator<Item = usize>) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_iter(py, numbers.into_iter().map(|n| n as i64))
}

/// A copy of a matrix, column by column.
fn matrix<'py>(py: Python<'py>, a: MatRef<'_, f64>) -> PyResult<Bound<'py, PyAny>> {
    let flat: Vec<f64> = py.detach(|| a.col_iter().flat_map(|column| column.iter().copied()).collect());
    array(py, flat, &[a.ncols(), a.nrows()])?.getattr("T")
}
