//! Outcomes of random input that other processes answer.

use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use steklov_document::Document;
use steklov_model::AnyRun;
use steklov_model::error::SolveError;
use steklov_model::grid::OnGrid;
use steklov_model::run::adaptive_loop::{Progress, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stochastic::{Answer, answers, answers_on_grid, one_by_one};

use crate::{raised, read, start_threads, watched};

/// A scene with random input whose last mesh is solved: it answers outcomes.
#[pyclass(frozen)]
pub struct Prepared {
    document: Document,
    run: AnyRun,
}

/// Solves a scene up to its last mesh.
#[pyfunction]
pub fn prepare(py: Python<'_>, text: &str, name: &str, overrides: Vec<String>) -> PyResult<Prepared> {
    start_threads(py)?;
    let document = read(py, text, name, &overrides)?;
    check(py, &document)?;
    let scene = &document.scene;
    let run = watched(py, None, &|| {}, |interrupts, _| {
        scene.check()?;
        rayon::scope(|_| match scene.is_on_grid() {
            true => run(scene, Progress::<OnGrid>::new(scene, Vec::new())?, interrupts, &mut |_, _| Ok(()))
                .map(|run| AnyRun::OnGrid(Box::new(run))),
            false => run(scene, Progress::<BoundaryElements>::first(scene), interrupts, &mut |_, _| Ok(()))
                .map(|run| AnyRun::BoundaryElements(Box::new(run))),
        })
    })?;
    match run {
        Ok(run) => Ok(Prepared { document, run }),
        Err(error) => Err(told(py, error)),
    }
}

#[pymethods]
impl Prepared {
    /// The answers to outcomes by their germs, as bytes.
    fn answers<'py>(&self, py: Python<'py>, germs: Vec<Vec<f64>>) -> PyResult<Bound<'py, PyBytes>> {
        let scene = &self.document.scene;
        let Some(random) = scene.random.as_ref() else { return Err(PyValueError::new_err("nothing is random")) };
        let count = random.germs.len();
        if let Some(wrong) = germs.iter().find(|own| own.len() != count) {
            return Err(PyValueError::new_err(format!("{} germs of {count}", wrong.len())));
        }
        let solved = py.detach(|| match &self.run {
            AnyRun::BoundaryElements(run) => match &run.matrices {
                Some(body) => answers(scene, random, body, &germs),
                None => Err(SolveError::Interrupted),
            },
            AnyRun::OnGrid(run) => answers_on_grid(scene, random, &run.step().layout, &germs),
        });
        let solved = solved.map_err(|error| told(py, error))?;
        let bytes = postcard::to_stdvec(&solved).map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }
}

/// Refuses scenes whose outcomes are not solved one by one.
pub fn check(py: Python<'_>, document: &Document) -> PyResult<()> {
    let message = match &document.scene.random {
        None => "nothing of this scene is random: its outcomes cannot be divided among workers; leave out client",
        Some(random) if !one_by_one(random) => {
            "the outcomes of this scene are not solved one by one: leave out client, or set stochastic.method to \"monte-carlo\", \
             \"sparse\" or \"corrected\""
        }
        Some(_) => return Ok(()),
    };
    Err(raised(py, "SolveError", (message,)))
}

/// Asks a program of Python for the answers to outcomes by their germs.
pub fn ask(elsewhere: &Py<PyAny>, germs: &[Vec<f64>]) -> Result<Vec<Answer>, SolveError> {
    let parts: Vec<Vec<u8>> = Python::attach(|py| {
        let lists: Vec<&[f64]> = germs.iter().map(Vec::as_slice).collect();
        elsewhere.call1(py, (lists,))?.extract(py)
    })
    .map_err(|error: PyErr| SolveError::Observer(Box::new(error)))?;
    let mut all = Vec::with_capacity(germs.len());
    for part in parts {
        let answers: Vec<Answer> =
            postcard::from_bytes(&part).map_err(|error| SolveError::Observer(Box::new(error)))?;
        all.extend(answers);
    }
    Ok(all)
}

fn told(py: Python<'_>, error: SolveError) -> PyErr {
    match error {
        SolveError::Interrupted => PyKeyboardInterrupt::new_err("the solution was stopped"),
        error => raised(py, "SolveError", (error.to_string(),)),
    }
}
