//! One scene at many values of its keys.

use numpy::PyArray1;
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use steklov_sweep::{Observer, Outcome, Points, Sweep, SweepError, solve_points};

use crate::{raised, read, scene_error, start_threads, watched};

/// What is known of a point: whether it is solved, and its JSON object, or why it is not.
type Known = (bool, String);

/// A sweep and what is known of its points.
#[pyclass(frozen)]
pub struct Swept(Sweep);

#[pymethods]
impl Swept {
    /// What is known of each point; None where it is not solved yet.
    fn outcomes(&self) -> Vec<Option<Known>> {
        let known = |outcome: &Outcome| match outcome {
            Outcome::Solved(text) => (true, text.clone()),
            Outcome::Failed(text) => (false, text.clone()),
        };
        self.0.outcomes.iter().map(|outcome| outcome.as_ref().map(known)).collect()
    }

    /// The paths of all numbers, and an array with a row for each point and a column for each path, NaN where a point has none.
    fn numbers<'py>(&self, py: Python<'py>) -> PyResult<(Vec<String>, Bound<'py, PyAny>)> {
        let quantities = self.0.quantities();
        let shape = [quantities.rows.len(), quantities.paths.len()];
        let flat: Vec<f64> = quantities.rows.into_iter().flatten().collect();
        Ok((quantities.paths, PyArray1::from_vec(py, flat).call_method1("reshape", (shape,))?))
    }

    /// The table of `steklov sweep`.
    fn csv(&self) -> String {
        self.0.csv()
    }

    /// Writes the file of `steklov sweep`.
    #[cfg(feature = "hdf5")]
    fn save(&self, py: Python<'_>, path: std::path::PathBuf, replace: bool) -> PyResult<()> {
        py.detach(|| steklov_sweep::write(&self.0, &path, replace)).map_err(|error| match error {
            SweepError::Io(error) => crate::file_error(&error),
            error => raised(py, "SolveError", (error.to_string(),)),
        })
    }
}

/// Solves the points of a sweep, each by a row of values for the keys. `progress` is called with a text and the share that is done.
#[pyfunction]
#[pyo3(signature = (text, name, overrides, keys, rows, threads = None, progress = None))]
pub fn sweep(
    py: Python<'_>,
    text: &str,
    name: &str,
    overrides: Vec<String>,
    keys: Vec<String>,
    rows: Vec<Vec<String>>,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Swept> {
    start_threads(py)?;
    let document = read(py, text, name, &overrides)?;
    let points = Points::of_rows(keys, rows).map_err(|error| sweep_error(py, &error))?;
    let mut sweep = Sweep::new(&document, points);
    let threads = threads.unwrap_or_else(rayon::current_num_threads).max(1);
    let outcomes = &mut sweep.outcomes;
    let (points, count) = (&sweep.points, sweep.points.len());
    let wanted: Vec<usize> = (0..count).collect();
    let solved = watched(py, progress.as_ref(), &|| {}, |interrupts, tell| {
        let mut done = 0;
        let mut keep = |point: usize, outcome: &Outcome| {
            done += 1;
            tell((format!("points {done} of {count}"), done as f64 / count as f64));
            if let Some(place) = outcomes.get_mut(point) {
                *place = Some(outcome.clone());
            }
            Ok(())
        };
        solve_points(&document, points, &wanted, threads, Observer { interrupts, keep: &mut keep })
    })?;
    solved.map_err(|error| sweep_error(py, &error))?;
    match sweep.outcomes.contains(&None) {
        true => Err(PyKeyboardInterrupt::new_err("the sweep was stopped")),
        false => Ok(Swept(sweep)),
    }
}

/// A sweep whose points were solved elsewhere.
#[pyfunction]
pub fn swept(
    py: Python<'_>,
    text: &str,
    name: &str,
    overrides: Vec<String>,
    keys: Vec<String>,
    rows: Vec<Vec<String>>,
    outcomes: Vec<Known>,
) -> PyResult<Swept> {
    let document = read(py, text, name, &overrides)?;
    let points = Points::of_rows(keys, rows).map_err(|error| sweep_error(py, &error))?;
    if outcomes.len() != points.len() {
        return Err(PyValueError::new_err(format!("{} outcomes of {} points", outcomes.len(), points.len())));
    }
    let known = |(solved, text)| Some(if solved { Outcome::Solved(text) } else { Outcome::Failed(text) });
    let mut sweep = Sweep::new(&document, points);
    sweep.outcomes = outcomes.into_iter().map(known).collect();
    Ok(Swept(sweep))
}

fn sweep_error(py: Python<'_>, error: &SweepError) -> PyErr {
    match error {
        SweepError::Scene(error) => scene_error(py, error),
        SweepError::Vary { .. } | SweepError::TooMany { .. } => PyValueError::new_err(error.to_string()),
        _ => raised(py, "SolveError", (error.to_string(),)),
    }
}
