//! Outcomes of random input that other processes answer.

use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::{ThreadPool, ThreadPoolBuilder};
use steklov_document::Document;
use steklov_model::error::SolveError;
use steklov_model::stochastic::{Answer, LastMesh, Prepared as OnMesh, one_by_one};

use crate::{STACK, raised, read, start_threads, watched};

/// A scene with random input on the last mesh of its solution: it answers outcomes.
#[pyclass(frozen)]
pub struct Prepared {
    document: Document,
    on_mesh: OnMesh,
    /// Its own threads: those of the process may all wait for these answers.
    threads: ThreadPool,
}

/// A scene on the last mesh of its solution, as `elsewhere` of `solve` gets it, for so many threads.
#[pyfunction]
pub fn prepare(
    py: Python<'_>,
    text: &str,
    name: &str,
    overrides: Vec<String>,
    mesh: &[u8],
    threads: usize,
) -> PyResult<Prepared> {
    start_threads(py)?;
    let threads = ThreadPoolBuilder::new().num_threads(threads.max(1)).stack_size(STACK).build();
    let threads = threads.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let document = read(py, text, name, &overrides)?;
    check(py, &document)?;
    let mesh: LastMesh = postcard::from_bytes(mesh).map_err(|e| PyValueError::new_err(e.to_string()))?;
    let scene = &document.scene;
    let on_mesh = watched(py, None, &|| {}, |_, _| {
        scene.check()?;
        threads.install(|| OnMesh::new(scene, &mesh))
    })?;
    match on_mesh {
        Ok(on_mesh) => Ok(Prepared { document, on_mesh, threads }),
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
        let solved = py.detach(|| self.threads.install(|| self.on_mesh.answers(scene, random, &germs)));
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

/// Asks a program of Python for the answers to outcomes on the last mesh by their germs.
pub fn ask(elsewhere: &Py<PyAny>, mesh: &LastMesh, germs: &[Vec<f64>]) -> Result<Vec<Answer>, SolveError> {
    let mesh = postcard::to_stdvec(mesh).map_err(|error| SolveError::Observer(Box::new(error)))?;
    let parts: Vec<Vec<u8>> = Python::attach(|py| {
        let lists: Vec<&[f64]> = germs.iter().map(Vec::as_slice).collect();
        elsewhere.call1(py, (PyBytes::new(py, &mesh), lists))?.extract(py)
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
