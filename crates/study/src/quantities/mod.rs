//! Error bars of quantities judged by their true errors: uncertainty over error of every quantity at every step of a run.
//!
//! ```text
//! run of another first mesh to a tenth of the tolerance ─► reference ─┐
//! run of the scene, its numbers at every step ────────────────────────┴► Series of each quantity ─► shares ─► report, draw
//! ```
//! On a grid the reference has bilinear elements on fine cells cut into 4 × 4.

mod series;
mod report;
mod draw;

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_document::Source;
use steklov_model::error::SolveError;
use steklov_model::grid::{GridLayout, OnGrid};
use steklov_model::run::adaptive_loop::{Model, Observer, Progress, Reason, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::summary::Summary;
use steklov_problem::{DataError, DataErrorKind, Refine, Scene, grid_of};

use crate::error::StudyError;
use crate::settings::Setting;
use crate::watch::Watch;

pub use draw::pictures;
pub use report::report;
pub use series::{Judged, Series, Shares};

/// Relative error (energy norm) at which a run ends, if the scene has no tolerance.
const TOLERANCE: f64 = 1e-6;
/// Tolerance of the reference, over that of the scene; quantities converge at twice the rate of the energy norm.
const SHARPER: f64 = 0.1;
/// Most unknowns of a reference on a grid.
const LARGEST: f64 = 1.5e6;
/// Least tolerance of the reference, because of rounding errors.
const LEAST: f64 = 3e-8;

/// A finished study.
#[derive(Debug)]
pub struct QuantityStudy<'a> {
    /// The scene as it was run, settings included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// The numbers of the reference.
    pub reference: Summary,
    /// The quantities with error bars, by their paths.
    pub series: Vec<Series>,
    /// The error that ended the run, if one did.
    pub failure: Option<SolveError>,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

impl QuantityStudy<'_> {
    /// Whether nobody stopped it and the run ended by itself.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.failure.is_none()
    }
}

/// The settings for a scene, unless the user overrides them.
pub(crate) fn settings(scene: &Scene) -> Vec<Setting> {
    (scene.method.tolerance.is_none() && !scene.is_on_grid())
        .then_some(Setting::Tolerance(TOLERANCE))
        .into_iter()
        .collect()
}

/// Checks that a scene can be studied.
///
/// # Errors
/// A scene with random input, or of one mesh of boundary elements: such numbers have no error bars, or no steps.
pub fn check(scene: &Scene) -> Result<(), DataError> {
    let refuse = |key: &str, why: &str, help: &'static str| {
        let message = format!("the study is about error bars at the steps of a run, and {why}");
        Err(DataError::at(DataErrorKind::Unsupported, &[vec![key]], message, help))
    };
    if scene.random.is_some() {
        return refuse("random", "the scene has random input", "study --what stochastic, or leave [random] out");
    }
    if scene.method.refine == Refine::None && !scene.is_on_grid() {
        return refuse("method", "its mesh is not refined", "set method.refine = \"hp\"");
    }
    Ok(())
}

/// Runs the reference, and the scene step by step.
///
/// # Errors
/// Those of [`check`], of the reference, and of the first step; an error of a later step is kept.
pub fn study<'a>(scene: &'a Scene, source: &'a Source, watch: &mut Watch<'_>) -> Result<QuantityStudy<'a>, StudyError> {
    check(scene)?;
    let mut steps = Vec::new();
    let (reference, told) = if scene.is_on_grid() {
        let mut parts = 1;
        let told = each_step(scene, watch, Progress::<OnGrid>::new(scene, Vec::new())?, &mut |summary, layout| {
            parts = layout.parts;
            steps.push(summary);
        });
        (reference_on_grid(scene, parts, watch)?, told)
    } else {
        let reference = reference(scene, watch)?;
        let first = Progress::<BoundaryElements>::first(scene);
        (reference, each_step(scene, watch, first, &mut |summary, _| steps.push(summary)))
    };
    let failure = match told {
        Err(error) if steps.is_empty() => return Err(error.into()),
        Err(SolveError::Interrupted) | Ok(()) => None,
        Err(error) => Some(error),
    };
    let series = series::all(&steps, &reference);
    Ok(QuantityStudy { scene, source, reference, series, failure, interrupted: watch.stopped() })
}

/// The numbers of a run from a first mesh of half as many elements again: its vertices are not those of the scene's own run.
fn reference(scene: &Scene, watch: &mut Watch<'_>) -> Result<Summary, StudyError> {
    let mut fine = scene.clone();
    fine.method.elements = Some(scene.method.elements() + scene.method.elements().div_ceil(2));
    fine.method.tolerance = Some((SHARPER * scene.method.tolerance()).max(LEAST));
    let run = run(&fine, Progress::first(&fine), watch.interrupts(), &mut |step, event| {
        watch.tell_step::<BoundaryElements>("reference", "", step, &event);
        Ok(())
    })?;
    match run.reason {
        Reason::Interrupted => Err(SolveError::Interrupted.into()),
        _ => Ok(Summary::of_run(&fine, &run, None)),
    }
}

/// The numbers of bilinear elements on fine cells of which each is cut into more than a run had, along both axes.
fn reference_on_grid(scene: &Scene, parts: usize, watch: &mut Watch<'_>) -> Result<Summary, StudyError> {
    let mut fine = scene.clone();
    (fine.method.refine, fine.method.max_dofs) = (Refine::None, None);
    let cells = grid_of(scene).map(|grid| grid.cells)?;
    let dofs = |cut: usize| cells.iter().map(|n| (n * parts * cut + 1) as f64).product::<f64>() * 2.0;
    let Some(cut) = [4, 2].into_iter().find(|&cut| dofs(cut) <= LARGEST) else {
        let message = format!("a reference of half the cells' size has {} unknowns, more than {LARGEST}", dofs(2));
        let help = "study the scene with fewer cells, or with a smaller method.max_dofs or max_steps";
        return Err(DataError::at(DataErrorKind::Unsupported, &[vec!["grid"]], message, help).into());
    };
    let first = Progress { steps: Vec::new(), next: GridLayout { parts: cut * parts, coarse: None, around: None } };
    let run = run::<OnGrid>(&fine, first, watch.interrupts(), &mut |step, event| {
        watch.tell_step::<OnGrid>("reference", "", step, &event);
        Ok(())
    })?;
    match run.reason {
        Reason::Interrupted => Err(SolveError::Interrupted.into()),
        _ => Ok(Summary::of_run(&fine, &run, None)),
    }
}

/// Passes the numbers and the layout of every step of a run to `found`, as if it had ended there.
fn each_step<M: Model>(
    scene: &Scene,
    watch: &mut Watch<'_>,
    mut progress: Progress<M>,
    found: &mut dyn FnMut(Summary, &M::Kept),
) -> Result<(), SolveError> {
    // after one wish to stop a run ends with the step that it is in
    let one_step = AtomicUsize::new(1);
    while !watch.stopped() {
        let interrupts = watch.interrupts();
        let observe: &mut Observer<'_, M> = &mut |step, event| {
            watch.tell_step("steps", "", step, &event);
            match interrupts.load(Ordering::Relaxed) {
                0 | 1 => Ok(()),
                _ => Err(SolveError::Interrupted),
            }
        };
        let ended = run(scene, progress, &one_step, observe)?;
        found(Summary::of_run(scene, &ended, None), &ended.step().layout);
        if ended.reason != Reason::Interrupted {
            break;
        }
        progress = ended.progress;
    }
    Ok(())
}
