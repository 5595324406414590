//! A scene solved on its grid, and on finer ones as far as the scene wants.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use steklov_problem::{Refine, Scene};

use super::estimate::GridEstimate;
use super::layout::GridLayout;
use super::solve::{GridSolved, solve_grid};
use crate::run::Reason;
use crate::solve::{SolveError, Stage};

/// Dörfler's θ where the scene has none.
pub const MARKING: f64 = 0.5;

/// Coarse cells are not split any more where their part of the squared error is below this part of the fine grid's.
const OUTWEIGHED: f64 = 0.1;

/// What is kept of every step.
#[derive(Debug, Clone, PartialEq)]
pub struct GridStep {
    /// Its grid.
    pub layout: GridLayout,
    /// Unknowns of the system, held ones included.
    pub dofs: usize,
    /// J.
    pub energy: f64,
    /// Half of a(u, u).
    pub strain: f64,
    /// Whether the contact solver reached its criterion and the forces balance.
    pub converged: bool,
    /// The contact solver's measure of the error, iteration by iteration; empty without contact.
    pub history: Vec<f64>,
    /// Estimate of the error.
    pub estimate: Option<GridEstimate>,
    /// Wall seconds: set-up, assembly, factorisation, solution, estimate.
    pub seconds: [f64; 5],
}

/// Steps that are done, and what they lead to.
#[derive(Debug, Clone, PartialEq)]
pub struct GridProgress {
    /// All steps.
    pub steps: Vec<GridStep>,
    /// What is to be solved next.
    pub next: GridLayout,
}

/// A finished run.
pub struct GridRun {
    /// The last step.
    pub last: GridSolved,
    /// The steps.
    pub steps: Vec<GridStep>,
    /// Why it ended.
    pub reason: Reason,
    /// The error of the step after the last one, where one ended the run.
    pub error: Option<SolveError>,
    /// Wall clock of the run.
    pub clock: Instant,
}

impl GridProgress {
    /// The beginning of a run; of steps that are done already, the last one is solved again.
    ///
    /// # Errors
    /// Those of the first grid.
    pub fn new(scene: &Scene, mut steps: Vec<GridStep>) -> Result<Self, SolveError> {
        let next = match steps.pop() {
            Some(last) => last.layout,
            None => GridLayout::first(scene)?,
        };
        Ok(Self { steps, next })
    }
}

impl GridRun {
    /// Whether everything that was asked for is reached.
    pub fn converged(&self) -> bool {
        matches!(self.reason, Reason::Solved | Reason::Tolerance)
    }
}

/// Solves a scene on grids; see [`crate::run::run`] for the interrupts.
///
/// # Errors
/// Those of the first step that it solves: an error of a later one ends the run with the steps before it. Those of the
/// observer always. [`SolveError::Interrupted`] if there is nothing to keep.
pub fn run_grid(
    scene: &Scene,
    progress: GridProgress,
    interrupts: &AtomicUsize,
    observe: &mut dyn FnMut(usize, Stage<'_>) -> Result<(), SolveError>,
) -> Result<GridRun, SolveError> {
    let clock = Instant::now();
    let GridProgress { mut steps, mut next } = progress;
    let mut last: Option<GridSolved> = None;
    loop {
        let number = steps.len();
        let mut watched = |stage: Stage<'_>| match interrupts.load(Ordering::Relaxed) {
            0 | 1 => observe(number, stage),
            _ => Err(SolveError::Interrupted),
        };
        let solved = match (solve_grid(scene, &next, &mut watched), last) {
            (Err(SolveError::Interrupted), Some(last)) => {
                return Ok(GridRun { last, steps, reason: Reason::Interrupted, error: None, clock });
            }
            (Err(error), Some(last)) if !matches!(error, SolveError::Observer(_)) => {
                return Ok(GridRun { last, steps, reason: Reason::Failed, error: Some(error), clock });
            }
            (solved, _) => solved?,
        };
        let s = &solved.seconds;
        steps.push(GridStep {
            layout: next.clone(),
            dofs: solved.dofs,
            energy: solved.energies.total,
            strain: solved.energies.strain,
            converged: solved.converged(),
            history: solved.contact.as_ref().map_or(Vec::new(), |c| c.reported().history.clone()),
            estimate: solved.estimate.clone(),
            seconds: [s.set_up, s.assemble, s.factorise, s.solve, solved.estimate_seconds],
        });
        let theta = scene.method.marking.unwrap_or(MARKING);
        let wanted = match scene.method.refine {
            Refine::None => None,
            _ => next.next(&solved, scene, theta)?,
        };
        let interrupted = interrupts.load(Ordering::Relaxed) > 0;
        match (reason(scene, &steps, &solved, wanted.as_ref(), interrupted), wanted) {
            (None, Some(layout)) => {
                next = layout;
                last = Some(solved);
            }
            (reason, _) => {
                let reason = reason.unwrap_or(Reason::FineGrid);
                return Ok(GridRun { last: solved, steps, reason, error: None, clock });
            }
        }
    }
}

/// Unknowns of the next step, held ones included.
fn next_dofs(scene: &Scene, solved: &GridSolved, parts: usize, next: &GridLayout) -> usize {
    let grid = &solved.body.grid;
    match &next.coarse {
        None if next.parts == parts => solved.dofs,
        // vertices - sides + cells = 1 - holes, and each of them becomes a vertex
        None => {
            let (vertices, cells) = (grid.nodes(), grid.body_cells().count());
            let holes = scene.body().outline.loops().len() - 1;
            2 * (2 * vertices + 2 * cells + holes - 1)
        }
        Some(cells) => {
            let mut corners: Vec<_> = cells.iter().flat_map(|c| c.corners()).collect();
            corners.sort_unstable();
            corners.dedup();
            2 * corners.len()
        }
    }
}

/// Why the run ends after the last of the steps, if it does.
fn reason(
    scene: &Scene,
    steps: &[GridStep],
    solved: &GridSolved,
    next: Option<&GridLayout>,
    interrupted: bool,
) -> Option<Reason> {
    let method = &scene.method;
    let parts = steps.last().map_or(1, |step| step.layout.parts);
    let estimate = solved.estimate.as_ref();
    let reached = estimate.is_some_and(|e| e.relative <= method.tolerance && e.doubts().is_empty());
    let outweighed =
        estimate.is_some_and(|e| solved.coarse.is_some() && e.multiscale + e.medium <= OUTWEIGHED * e.fine_grid);
    Some(match (method.refine, next) {
        _ if !solved.converged() => Reason::Solver,
        (Refine::None, _) => Reason::Solved,
        _ if reached => Reason::Tolerance,
        (_, None) => Reason::FineGrid,
        _ if outweighed => Reason::FineGrid,
        _ if steps.len() >= method.max_steps => Reason::MaxSteps,
        (_, Some(next)) if next_dofs(scene, solved, parts, next) > method.max_dofs => Reason::MaxDofs,
        _ if interrupted => Reason::Interrupted,
        _ => return None,
    })
}
