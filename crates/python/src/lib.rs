//! The extension module of the Python package `steklov`: scenes planned and solved, and the numerics one by one, with the GIL released.
//! What is comfortable about the package is written in Python, in `python/steklov`.

mod answer;
mod blocks;
mod outcomes;
#[cfg(feature = "hdf5")]
mod study;
mod sweep;

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;
use steklov_algebra::PARTS;
use steklov_document::{Document, SceneError};
use steklov_model::error::SolveError;
use steklov_model::run::expect::check_expect;
use steklov_model::summary::available_memory_bytes;
use steklov_model::{OnLastMesh, Told, Watch, solve_watched};
use steklov_plan::{explain, refused};

use crate::answer::Solved;

// the system's gives freed matrices back where an environment asks for it, as workers of Dask do: each outcome then waits for pages
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// How often Python looks for signals while a scene is solved.
const LOOK: Duration = Duration::from_millis(50);

/// Stack of each thread, as large as that of a process usually is.
const STACK: usize = 8 << 20;

/// What would be modelled and why, and what it costs, as JSON.
#[pyfunction]
fn plan(py: Python<'_>, text: &str, name: &str, overrides: Vec<String>) -> PyResult<String> {
    let document = read(py, text, name, &overrides)?;
    let plan = steklov_plan::plan(&document.scene);
    serde_json::to_string(&plan).map_err(|e| pyo3::exceptions::PyValueError::new_err(e.to_string()))
}

/// The title of a scene: its name unless it has one.
#[pyfunction]
fn title(py: Python<'_>, text: &str, name: &str, overrides: Vec<String>) -> PyResult<String> {
    Ok(read(py, text, name, &overrides)?.scene.title)
}

/// Solves a scene. `progress` is called with a text and the share of the step, or of the outcomes, that is done;
/// `elsewhere` with the last mesh for `prepare` and lists of germs, for whose outcomes it returns what `Prepared.answers` gives, and its `cancel` to stop.
#[pyfunction]
#[pyo3(signature = (text, name, overrides, progress = None, elsewhere = None))]
fn solve(
    py: Python<'_>,
    text: &str,
    name: &str,
    overrides: Vec<String>,
    progress: Option<Bound<'_, PyAny>>,
    elsewhere: Option<Py<PyAny>>,
) -> PyResult<Solved> {
    start_threads(py)?;
    let mut document = read(py, text, name, &overrides)?;
    if document.scene.method.max_dofs.is_none() && !document.scene.is_on_grid() {
        document.scene.method.memory = available_memory_bytes();
    }
    let scene = &document.scene;
    check_expect(scene).map_err(|error| scene_error(py, &document.error(error)))?;
    if let Some(error) = refused(scene, &steklov_plan::plan(scene).cost) {
        return Err(scene_error(py, &document.error(error)));
    }
    if elsewhere.is_some() {
        outcomes::check(py, &document)?;
    }
    let ask = elsewhere.as_ref().map(|elsewhere| |mesh: &_, germs: &[Vec<f64>]| outcomes::ask(elsewhere, mesh, germs));
    let ask = ask.as_ref().map(|ask| ask as &OnLastMesh<'_>);
    let cancel = || {
        if let Some(elsewhere) = &elsewhere {
            // what was asked for is given up: an error of that is of no interest
            let _ = elsewhere.call_method0(py, "cancel");
        }
    };
    let solved = watched(py, progress.as_ref(), &cancel, |interrupts, tell| {
        let watch = Watch { interrupts, tell: &|told| tell(text_of(told)), elsewhere: ask };
        rayon::scope(|_| solve_watched(scene, &watch))
    })?;
    match solved {
        Ok(answer) => Ok(Solved { document, answer }),
        Err(SolveError::Interrupted) => Err(PyKeyboardInterrupt::new_err("the solution was stopped")),
        Err(SolveError::Observer(error)) if error.is::<PyErr>() => Err(error
            .downcast::<PyErr>()
            .map_or_else(|other| PyRuntimeError::new_err(other.to_string()), |error| *error)),
        Err(error) => Err(match explain(scene, error) {
            Ok(error) => scene_error(py, &document.error(error)),
            Err(error) => raised(py, "SolveError", (error.to_string(),)),
        }),
    }
}

/// The interval of the colours of values at the points of triangles: without those of singular points.
#[pyfunction]
fn colour_interval(
    points: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, i64>,
    values: PyReadonlyArray1<'_, f64>,
) -> [f64; 2] {
    let points: Vec<[f64; 2]> = points.as_array().rows().into_iter().map(|row| [row[0], row[1]]).collect();
    let triangles: Vec<[usize; 3]> =
        triangles.as_array().rows().into_iter().map(|row| [0, 1, 2].map(|k| row[k] as usize)).collect();
    steklov_picture::colour_interval(&points, &triangles, &values.as_array().to_vec())
}

/// As many threads as processors, and the same bits for any number of them.
///
/// # Errors
/// In a process that was forked from one that had its threads: it has none, and would wait for them for ever.
fn start_threads(py: Python<'_>) -> PyResult<()> {
    static OWNER: OnceLock<u32> = OnceLock::new();
    let owner = *OWNER.get_or_init(|| {
        faer::set_global_parallelism(faer::Par::rayon(PARTS));
        let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
        // a program that has made its threads keeps them
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build_global();
        std::process::id()
    });
    if owner == std::process::id() {
        return Ok(());
    }
    let what = "this process was forked from one that had begun to solve, and lacks its threads: start processes anew, as by \
                multiprocessing.get_context(\"spawn\")";
    Err(raised(py, "SolveError", (what,)))
}

/// What a run is doing, and the share of that which is done.
fn text_of(told: Told) -> (String, f64) {
    match told {
        Told::Step(step, what, share) => (format!("step {}: {what}", step + 1), share),
        Told::Outcomes(done, count) => (format!("outcomes {done} of {count}"), done as f64 / count.max(1) as f64),
    }
}

/// Does work beside Python: what it tells goes to the callback, signals are looked for, and an error of either stops the work.
fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    cancel: &dyn Fn(),
    work: impl FnOnce(&AtomicUsize, &(dyn Fn((String, f64)) + Sync)) -> T + Send,
) -> PyResult<T> {
    let interrupts = AtomicUsize::new(0);
    let (sender, receiver) = channel();
    let (receiver, tells) = (Mutex::new(receiver), progress.is_some());
    let worked = std::thread::scope(|scope| {
        let (interrupts, sender) = (&interrupts, Mutex::new(sender));
        let worker = scope.spawn(move || {
            let tell = |told| {
                if tells {
                    // nobody listens any more once the work was given up
                    let _ = sender.lock().unwrap_or_else(PoisonError::into_inner).send(told);
                }
            };
            work(interrupts, &tell)
        });
        let watched = listen(py, &receiver, progress);
        if watched.is_err() {
            interrupts.store(2, Ordering::Relaxed);
            cancel();
        }
        let worked = py.detach(|| worker.join());
        watched.map(|()| worked)
    })?;
    Ok(worked.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

/// Passes on what is told, and looks for signals, until the work has ended; an error of the callback or of a signal ends it before.
fn listen(
    py: Python<'_>,
    receiver: &Mutex<Receiver<(String, f64)>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    loop {
        let told = py.detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK));
        py.check_signals()?;
        match (told, progress) {
            (Ok(told), Some(progress)) => drop(progress.call1(told)?),
            (Err(RecvTimeoutError::Disconnected), _) => return Ok(()),
            _ => {}
        }
    }
}

fn read(py: Python<'_>, text: &str, name: &str, overrides: &[String]) -> PyResult<Document> {
    py.detach(|| Document::parse(text, name, overrides)).map_err(|error| scene_error(py, &error))
}

/// The error of a file that cannot be written.
#[cfg(feature = "hdf5")]
fn file_error(error: &steklov_result::steklov_io::IoError) -> PyErr {
    let help = match error {
        steklov_result::steklov_io::IoError::Exists { .. } => ": choose another name, or replace=True",
        _ => "",
    };
    pyo3::exceptions::PyOSError::new_err(format!("{error}{help}"))
}

fn scene_error(py: Python<'_>, error: &SceneError) -> PyErr {
    let SceneError { message, help, .. } = error;
    raised(py, "SceneError", (error.render(), message.as_str(), help.as_str(), error.file(), error.line()))
}

/// An exception of the package.
fn raised<'py>(py: Python<'py>, name: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py.import("steklov.errors").and_then(|module| module.getattr(name)).and_then(|of| of.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// Scenes of plane elasticity, planned and solved.
#[pymodule]
mod _steklov {
    #[pymodule_export]
    use super::{colour_interval, plan, solve, title};
    #[pymodule_export]
    const MOST_POINTS: usize = steklov_sweep::MOST_POINTS;
    #[pymodule_export]
    use crate::answer::Solved;
    #[pymodule_export]
    use crate::outcomes::{Prepared, prepare};
    #[pymodule_export]
    const TOGETHER: usize = steklov_model::stochastic::TOGETHER;
    #[pymodule_export]
    use crate::blocks::{Answer, ContactProblem, KarhunenLoeve, Mesh, Operators, Polygon, Steklov, cell_basis, rule};
    #[cfg(feature = "hdf5")]
    #[pymodule_export]
    use crate::study::study;
    #[pymodule_export]
    use crate::sweep::{Swept, sweep, swept};
}
