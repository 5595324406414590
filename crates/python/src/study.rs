//! Studies of a scene, whose tables Python reads.

use std::path::PathBuf;

use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyValueError};
use pyo3::prelude::*;
use steklov_document::Document;
use steklov_model::error::SolveError;
use steklov_plan::{explain, plan, too_many_dofs};
use steklov_study::convergence::{MULTIPLIERS, NAMES};
use steklov_study::{Draw, Report, StudyError, StudyKind};

use crate::{file_error, raised, read, scene_error, start_threads, watched};

/// The JSON object of a study, its printed text, names and contents of its tables (CSV), and the files that were written.
type Studied = (String, String, Vec<(String, String)>, Vec<PathBuf>);

/// Carries out a study, `what`, of a scene; its files are written into `folder` if that is given. `progress` is called with
/// a text and the share of the parts that is done.
#[pyfunction]
#[pyo3(signature = (text, name, overrides, what, strategies, multipliers, repeat = 1, folder = None, progress = None))]
pub fn study(
    py: Python<'_>,
    text: &str,
    name: &str,
    overrides: Vec<String>,
    what: &str,
    strategies: Vec<String>,
    multipliers: Vec<String>,
    repeat: usize,
    folder: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Studied> {
    start_threads(py)?;
    let words = StudyKind::ALL.map(|(_, word, _)| word);
    known("study", &[what.to_owned()], &words)?;
    known("strategy", &strategies, &NAMES.map(|(name, _)| name))?;
    known("multiplier", &multipliers, &MULTIPLIERS.map(|(name, _)| name))?;
    if !(1..=1000).contains(&repeat) {
        return Err(PyValueError::new_err(format!("repeat is {repeat}: it must be 1 to 1000")));
    }
    let Some(kind) = StudyKind::of_word(what) else { return Err(PyValueError::new_err("there is no such study")) };
    let mut document = read(py, text, name, &overrides)?;
    kind.prepare(&mut document).map_err(|error| scene_error(py, &document.error(error)))?;
    let refused = |error| told(py, &document, error);
    let mut options = kind.options(&document.scene, &strategies, &multipliers).map_err(refused)?;
    options.repeat = repeat;
    let parts = kind.parts(&document.scene, &options).map_err(|error| refused(error.into()))?;
    if let Some(error) = too_many_dofs(&document.scene, plan(&document.scene).cost.dofs) {
        return Err(refused(error.into()));
    }
    let studied = watched(py, progress.as_ref(), &|| {}, |interrupts, tell| {
        let (mut last, mut begun) = (String::new(), 0);
        let mut show = |part: &str, detail: &str| {
            if last != part {
                (last, begun) = (part.to_owned(), begun + 1);
            }
            let share = (begun as f64 - 1.0) / parts.max(1) as f64;
            tell((format!("{part}: {detail}"), share.clamp(0.0, 1.0)));
        };
        let keep = |report: &Report<'_>, pictures: Draw<'_>| -> Result<Studied, StudyError> {
            let tables = report.tables.iter().map(|(name, table)| ((*name).to_owned(), table.clone())).collect();
            let files = match &folder {
                Some(folder) => report.store(folder, kind.file_name(), pictures)?,
                None => Vec::new(),
            };
            Ok((report.json().to_string(), report.text(), tables, files))
        };
        rayon::scope(|_| {
            let mut watch = steklov_study::Watch::new(interrupts, &mut show);
            let studied = kind.carry_out(&document, options, &mut watch, keep);
            if watch.stopped() { Err(SolveError::Interrupted.into()) } else { studied? }
        })
    })?;
    studied.map_err(refused)
}

/// Refuses a word that is not known.
fn known(what: &str, words: &[String], all: &[&str]) -> PyResult<()> {
    match words.iter().find(|word| !all.contains(&word.as_str())) {
        Some(word) => Err(PyValueError::new_err(format!("{word:?} is no {what}; known are {}", all.join(", ")))),
        None => Ok(()),
    }
}

fn told(py: Python<'_>, document: &Document, error: StudyError) -> PyErr {
    match error {
        StudyError::Data(error) => scene_error(py, &document.error(error)),
        StudyError::Solve(SolveError::Interrupted) => PyKeyboardInterrupt::new_err("the study was stopped"),
        StudyError::Solve(error) => match explain(&document.scene, error) {
            Ok(error) => scene_error(py, &document.error(error)),
            Err(error) => raised(py, "SolveError", (error.to_string(),)),
        },
        StudyError::Io(error) => file_error(&error),
        error @ (StudyError::Write { .. } | StudyError::Picture(_)) => PyOSError::new_err(error.to_string()),
        error @ (StudyError::OnGrid { .. } | StudyError::NoContact | StudyError::Misplaced { .. }) => {
            PyValueError::new_err(error.to_string())
        }
        error => raised(py, "SolveError", (error.to_string(),)),
    }
}
