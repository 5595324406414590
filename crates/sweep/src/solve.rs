//! The points of a sweep solved side by side.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use steklov_document::{Document, SceneError, SceneErrorKind};
use steklov_model::error::SolveError;
use steklov_model::run::expect::check_expect;
use steklov_model::summary::{Summary, available_memory_bytes};
use steklov_model::{Watch, solve_watched};
use steklov_plan::{explain, plan, refused};

use crate::SweepError;
use crate::points::{MOST_POINTS, Points};

/// What is known of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    /// Its JSON object, without seconds, memory and the name of a file: the same bits in every run.
    Solved(String),
    /// Why it has no solution.
    Failed(String),
}

/// How a sweep is watched and stopped.
pub struct Observer<'a> {
    /// Counts the wishes to stop: after one no further point begins, after two those that run are given up.
    pub interrupts: &'a AtomicUsize,
    /// Gets each point with what is known of it, in the order in which they are finished.
    ///
    /// # Errors
    /// End the sweep.
    pub keep: &'a mut dyn FnMut(usize, &Outcome) -> Result<(), SweepError>,
}

/// Stack of each thread, as large as that of a process usually is.
const STACK: usize = 8 << 20;

/// How often wishes to stop are looked for.
const LOOK: Duration = Duration::from_millis(50);

/// Solves these points of a sweep by so many threads, several points at once. A point has the same bits as if it were solved alone. Each
/// point that cannot be solved is told as such, and the others go on.
///
/// # Errors
/// [`SweepError::Scene`] if the first or the last point has a key that the scene does not have or use; [`SweepError::TooMany`]; those of
/// the observer.
pub fn solve_points(
    document: &Document,
    points: &Points,
    wanted: &[usize],
    threads: usize,
    observer: Observer<'_>,
) -> Result<(), SweepError> {
    let Some(&first) = wanted.first() else { return Ok(()) };
    for point in [first, *wanted.last().unwrap_or(&first)] {
        check_keys(document, points, point)?;
    }
    let workers = threads.clamp(1, wanted.len());
    let Observer { interrupts, keep } = observer;
    if points.len() > MOST_POINTS {
        return Err(too_many(document, points, (first, workers), interrupts));
    }
    let (next, stop, abort) = (AtomicUsize::new(0), AtomicBool::new(false), AtomicUsize::new(0));
    let (sender, receiver) = channel();
    std::thread::scope(|scope| {
        for worker in 0..workers {
            let (sender, next, stop, abort) = (sender.clone(), &next, &stop, &abort);
            // all threads have work: those that are left over are given to the first points
            let own = threads / workers + usize::from(worker < threads % workers);
            scope.spawn(move || {
                let pool = pool(own);
                while !stop.load(Ordering::Relaxed)
                    && let Some(&point) = wanted.get(next.fetch_add(1, Ordering::Relaxed))
                {
                    let outcome = within(pool.as_ref(), || solve_point(document, points, point, workers, abort));
                    if outcome.is_some_and(|outcome| sender.send((point, outcome)).is_err()) {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let mut kept = Ok(());
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok((point, outcome)) if kept.is_ok() => kept = keep(point, &outcome),
                Err(RecvTimeoutError::Disconnected) => return kept,
                _ => {}
            }
            if kept.is_err() || interrupts.load(Ordering::Relaxed) > 0 {
                stop.store(true, Ordering::Relaxed);
            }
            if interrupts.load(Ordering::Relaxed) > 1 {
                abort.store(2, Ordering::Relaxed);
            }
        }
    })
}

/// Threads of their own for a worker; none if the system gives none: then it takes those of all.
fn pool(threads: usize) -> Option<ThreadPool> {
    ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build().ok()
}

fn within<T: Send>(pool: Option<&ThreadPool>, work: impl FnOnce() -> T + Send) -> T {
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

fn read(document: &Document, points: &Points, point: usize) -> Result<Document, SceneError> {
    let source = &document.source;
    let overrides: Vec<String> = source.overrides.iter().cloned().chain(points.settings(point)).collect();
    Document::parse(&source.text, &source.name, &overrides)
}

/// Refuses keys that no value could make right.
fn check_keys(document: &Document, points: &Points, point: usize) -> Result<(), SweepError> {
    match read(document, points, point) {
        Err(error)
            if matches!(
                error.kind,
                SceneErrorKind::UnknownKey | SceneErrorKind::UnusedKey | SceneErrorKind::Syntax
            ) =>
        {
            Err(SweepError::Scene(Box::new(error)))
        }
        _ => Ok(()),
    }
}

/// The refusal of so many points, with the time that they would take.
fn too_many(
    document: &Document,
    points: &Points,
    (first, workers): (usize, usize),
    interrupts: &AtomicUsize,
) -> SweepError {
    let clock = Instant::now();
    solve_point(document, points, first, workers, interrupts);
    let seconds = clock.elapsed().as_secs_f64();
    let all = seconds * points.len() as f64 / workers as f64;
    let all = match all {
        s if s < 7200.0 => format!("{:.0} minutes", s / 60.0),
        s if s < 172_800.0 => format!("{:.0} hours", s / 3600.0),
        s => format!("{:.0} days", s / 86400.0),
    };
    SweepError::TooMany { count: points.len(), most: MOST_POINTS, seconds, all }
}

/// A point as it is solved alone, while `workers` points share the memory; None if it was given up.
fn solve_point(
    document: &Document,
    points: &Points,
    point: usize,
    workers: usize,
    interrupts: &AtomicUsize,
) -> Option<Outcome> {
    let failed = |error: SceneError| {
        let line = error.line().filter(|_| error.file() == document.source.name);
        let place = line.map_or(String::new(), |line| format!(" (line {line})"));
        Outcome::Failed(format!("{}{place}; {}", error.message, error.help))
    };
    let mut document = match read(document, points, point) {
        Ok(document) => document,
        Err(error) => return Some(failed(error)),
    };
    if document.scene.method.max_dofs.is_none() && !document.scene.is_on_grid() {
        document.scene.method.memory = available_memory_bytes().map(|bytes| bytes / workers as u64);
    }
    let scene = &document.scene;
    let checked = check_expect(scene).map_err(|error| document.error(error));
    let refused = || refused(scene, &plan(scene).cost).map(|error| document.error(error));
    if let Some(error) = checked.err().or_else(refused) {
        return Some(failed(error));
    }
    match solve_watched(scene, &Watch { interrupts, tell: &|_| {}, elsewhere: None }) {
        Ok(answer) => Some(Outcome::Solved(kept(&answer.summary))),
        Err(SolveError::Interrupted) => None,
        Err(error) => Some(match explain(scene, error) {
            Ok(error) => failed(document.error(error)),
            Err(error) => Outcome::Failed(error.to_string()),
        }),
    }
}

/// The JSON object of a point: what does not differ from run to run.
fn kept(summary: &Summary) -> String {
    let mut object = serde_json::to_value(summary).unwrap_or_default();
    // by their whole paths: sides may have such names too
    for (table, keys) in [("", &["seconds", "peak_memory_bytes", "file"][..]), ("/stochastic/solution", &["seconds"])] {
        if let Some(Value::Object(entries)) = object.pointer_mut(table) {
            keys.iter().for_each(|key| drop(entries.remove(*key)));
        }
    }
    object.to_string()
}
