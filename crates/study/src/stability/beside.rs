//! Results of other methods for the same scene, for comparison.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::incompressible::{POISSON, Truth};
use crate::table::Column;

/// One result of another method.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beside {
    /// Name of the method and its mesh: results with the same name form one curve.
    pub name: String,
    /// Poisson's ratio, one of [`POISSON`].
    pub poisson: f64,
    /// J of the scene at that ratio.
    pub energy: f64,
}

/// Why a file of results cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BesideError {
    /// The file cannot be read.
    #[error("{} cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a list of results.
    #[error(
        "{} is not a list [{{\"name\": TEXT, \"poisson\": NUMBER, \"energy\": NUMBER}}, ...]: {source}",
        path.display()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: serde_json::Error,
    },
    /// A ratio that the study does not have.
    #[error("{}: \"{name}\" has ν = {poisson}; the study has only {POISSON:?}", path.display())]
    Poisson {
        /// The file.
        path: PathBuf,
        /// The method.
        name: String,
        /// Its ratio.
        poisson: f64,
    },
}

/// Reads a JSON list of results.
///
/// # Errors
/// A file that cannot be read or is no list of results, a ratio that is not in [`POISSON`].
pub fn read_beside(path: &Path) -> Result<Vec<Beside>, BesideError> {
    let text = std::fs::read_to_string(path).map_err(|source| BesideError::Read { path: path.to_owned(), source })?;
    let format = |source| BesideError::Format { path: path.to_owned(), source };
    let mut all: Vec<Beside> = serde_json::from_str(&text).map_err(format)?;
    for Beside { name, poisson, .. } in &mut all {
        let near = POISSON.iter().find(|p| (*p - *poisson).abs() < 1e-12);
        *poisson = *near.ok_or_else(|| BesideError::Poisson {
            path: path.to_owned(),
            name: name.clone(),
            poisson: *poisson,
        })?;
    }
    Ok(all)
}

/// A result with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judged {
    /// Poisson's ratio.
    pub(super) poisson: f64,
    /// J.
    pub(super) energy: f64,
    /// (|J - J_ref|/|J_ref|)^½; NaN without a reference.
    pub(super) energy_error: f64,
}

/// Columns of the results.
pub(super) const RESULTS: [Column<Judged>; 3] = [
    ("poisson", "1", "Poisson's ratio", |j| j.poisson),
    ("energy", "force*length/thickness", "J", |j| j.energy),
    ("energy_error", "1", "(|J - J_ref|/|J_ref|)^(1/2)", |j| j.energy_error),
];

/// The results by name, each with its errors.
pub(super) fn judged<'a>(beside: &'a [Beside], truths: &[Truth]) -> Vec<(&'a str, Vec<Judged>)> {
    let mut groups: Vec<(&str, Vec<Judged>)> = Vec::new();
    for &Beside { ref name, poisson, energy } in beside {
        let truth = truths.iter().find(|t| t.poisson == poisson).map_or(f64::NAN, |t| t.energy);
        let judged = Judged { poisson, energy, energy_error: ((energy - truth) / truth).abs().sqrt() };
        match groups.iter_mut().find(|g| g.0 == name) {
            Some(group) => group.1.push(judged),
            None => groups.push((name, vec![judged])),
        }
    }
    groups
}
