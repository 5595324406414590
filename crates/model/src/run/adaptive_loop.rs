//! A scene solved step by step: the one adaptive loop of boundary elements and of finite elements on grids.
//!
//! ```text
//! Progress (steps, next layout) ─► advance: solve, estimate, next ─► Step ─► end? ─► Run (last solution, progress, reason)
//!      ▲                                                               │ no
//!      └───────────────────────────────────────────────────────────────┘
//! ```

use std::fmt::Debug;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use steklov_algebra::once_more;
use steklov_problem::{Scene, Spot};

use crate::error::SolveError;
use crate::run::memory::Lack;
use crate::run::report::Report;
use crate::solve::solution::Seconds;
use crate::stage::Stage;
use crate::stochastic::number::check_quantities;
use crate::stochastic::{End, LastMesh, OutcomeStage, OutcomesWatch, StochasticResult};
use crate::summary::SideProbe;

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The one requested mesh is solved.
    Solved,
    /// The estimated error is within the tolerance.
    Tolerance,
    /// The next mesh would have more unknowns than allowed, or need more memory.
    MaxDofs,
    /// The largest allowed number of steps is done.
    MaxSteps,
    /// The stochastic mesh has the largest allowed number of nodes, and its truncation is still above its tolerance.
    MaxNodes,
    /// Coarse cells need not, or cannot, be split any more: the remaining error is that of the fine grid.
    FineGrid,
    /// Rounding errors leave nothing to refine.
    Roundoff,
    /// The contact solver did not reach its criterion.
    Solver,
    /// The user stopped it.
    Interrupted,
    /// The next step failed: [`Run::error`].
    Failed,
}

impl Reason {
    /// The word of the JSON object.
    pub fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Tolerance => "tolerance",
            Self::MaxDofs => "max_dofs",
            Self::MaxSteps => "max_steps",
            Self::MaxNodes => "max_nodes",
            Self::FineGrid => "fine_grid",
            Self::Roundoff => "roundoff",
            Self::Solver => "solver",
            Self::Interrupted => "interrupted",
            Self::Failed => "failed",
        }
    }
}

/// A model that is solved again and again, each time with another layout: [`crate::run::boundary_elements::BoundaryElements`]
/// or [`crate::grid::OnGrid`].
pub trait Model: Debug + Clone + PartialEq {
    /// The input of a step: a subdivision of the boundary, a grid.
    type Layout: Debug + Clone + PartialEq + Send;
    /// The part of it that a step keeps.
    type Kept: Debug + Clone + PartialEq + Send;
    /// The estimate of a step.
    type Estimate: Debug + Clone + PartialEq + Send;
    /// A solved layout.
    type Solved: Send + Sync;
    /// The factored matrices.
    type Matrices: Send;
    /// Data that one step passes to the next, besides its layout.
    type Cache: Default;

    /// Solves and estimates a layout, after the steps that are done.
    ///
    /// # Errors
    /// Data that are not finite, a free rigid motion that the loads drive, an observer that fails.
    fn advance(
        scene: &Scene,
        progress: &Progress<Self>,
        cache: &mut Self::Cache,
        observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
    ) -> Result<Advanced<Self>, SolveError>;

    /// Why the run ends after the last of the steps, if it does; `next` is the next layout, if anything is refined.
    fn end(scene: &Scene, steps: &[Step<Self>], solved: &Self::Solved, next: Option<&Self::Layout>) -> Option<Reason>;

    /// Frees what the report of a solution alone needs, before the next step.
    fn release(_: &mut Self::Solved) {}

    /// The report of the last solution.
    fn report<'a>(scene: &Scene, run: &'a Run<Self>) -> Report<'a>;

    /// Whether the last solution is known to be exact.
    fn is_exact(_: &Run<Self>) -> bool {
        false
    }

    /// Displacement and stress of a solution at a point where something lies.
    fn at(solved: &Self::Solved, spot: Spot, x: [f64; 2]) -> ([f64; 2], [f64; 3]);

    /// Displacement, traction and stress of a solution along sides, by their numbers.
    fn along_sides(scene: &Scene, solved: &Self::Solved, sides: &[usize]) -> Vec<SideProbe>;

    /// The mesh of a step, for other processes.
    fn last_mesh(kept: &Self::Kept) -> LastMesh;

    /// The outcomes of random input on the last step of a run that went well; the run says why there are none or not all.
    ///
    /// # Errors
    /// Data of an outcome that are impossible; an observer that fails.
    fn outcomes(
        _: &Scene,
        _: &mut Run<Self>,
        _: &OutcomesWatch<'_>,
        _: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
    ) -> Result<Option<StochasticResult>, SolveError> {
        Ok(None)
    }

    /// The memory that the next step would have lacked, if that ended the run.
    fn lack(_: &Scene, _: &Run<Self>) -> Option<Lack> {
        None
    }
}

/// The events that a run passes to its observer.
pub enum Event<'a, M: Model> {
    /// A stage of the running step.
    Stage(Stage<'a>),
    /// A step is solved and estimated.
    Done {
        /// The solution.
        solved: &'a M::Solved,
        /// The kept data of the step.
        step: &'a Step<M>,
        /// Wall seconds since the run began.
        seconds: f64,
    },
}

/// Receives the events of every step, with the step's number.
pub type Observer<'a, M> = dyn FnMut(usize, Event<'_, M>) -> Result<(), SolveError> + 'a;

/// A finished step, and the layout that follows.
pub struct Advanced<M: Model> {
    /// The solution.
    pub solved: M::Solved,
    /// The factored matrices.
    pub matrices: M::Matrices,
    /// The kept data of the step.
    pub step: Step<M>,
    /// The next layout; none if nothing is refined.
    pub next: Option<M::Layout>,
}

/// The kept data of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step<M: Model> {
    /// Its mesh, or its grid.
    pub layout: M::Kept,
    /// Unknowns of the displacement; on a grid the held ones included.
    pub dofs: usize,
    /// J.
    pub energy: f64,
    /// Half of a(u, u).
    pub strain: f64,
    /// Whether the contact solver reached its criterion and the forces balance.
    pub converged: bool,
    /// The contact solver's measure of the error, iteration by iteration; empty without contact.
    pub history: Vec<f64>,
    /// Estimate of the error; none for a single mesh of thousands of unknowns.
    pub estimate: Option<M::Estimate>,
    /// Wall seconds: set-up, assembly, factorisation, solution, estimate.
    pub seconds: [f64; 5],
}

/// Wall seconds of a step.
pub(crate) fn seconds_of(s: &Seconds, estimate: f64) -> [f64; 5] {
    [s.set_up, s.assemble, s.factorise, s.solve, s.enrich + estimate]
}

/// Finished steps, and the layout that follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress<M: Model> {
    /// All steps.
    pub steps: Vec<Step<M>>,
    /// The next layout.
    pub next: M::Layout,
}

/// A finished run.
pub struct Run<M: Model> {
    /// The last step.
    pub last: M::Solved,
    /// Its factored matrices; None if a later step was begun, for which they were released.
    pub matrices: Option<M::Matrices>,
    /// The steps and what comes next.
    pub progress: Progress<M>,
    /// Why it ended.
    pub reason: Reason,
    /// The error of the step after the last one, if it ended the run.
    pub error: Option<SolveError>,
    /// Wall seconds so far.
    pub clock: Instant,
}

impl<M: Model> Run<M> {
    /// Whether the run reached its aim: the tolerance, or the solution of the one requested mesh.
    pub fn converged(&self) -> bool {
        matches!(self.reason, Reason::Solved | Reason::Tolerance)
    }

    /// Whether the run ended by itself: outcomes of random input may follow.
    pub(crate) fn went_well(&self) -> bool {
        !matches!(self.reason, Reason::Interrupted | Reason::Failed)
    }

    /// Takes the end of the outcomes of random input: the run says why there are none, or not all.
    ///
    /// # Errors
    /// Data of an outcome that are impossible; an observer that fails.
    pub(crate) fn with_outcomes(
        &mut self,
        solved: Result<StochasticResult, SolveError>,
    ) -> Result<Option<StochasticResult>, SolveError> {
        match solved {
            Ok(result) => {
                self.reason = match result.end {
                    _ if !self.converged() => self.reason,
                    _ if result.unconverged > 0 => Reason::Solver,
                    End::MaxNodes => Reason::MaxNodes,
                    End::Rounds => Reason::MaxSteps,
                    End::Solved | End::Tolerance => self.reason,
                };
                Ok(Some(result))
            }
            Err(SolveError::Interrupted) => {
                self.reason = Reason::Interrupted;
                Ok(None)
            }
            Err(error @ (SolveError::Data(_) | SolveError::Observer(_))) => Err(error),
            Err(error) => {
                (self.reason, self.error) = (Reason::Failed, Some(error));
                Ok(None)
            }
        }
    }

    /// The last step.
    pub fn step(&self) -> &Step<M> {
        self.progress.steps.last().unwrap_or_else(|| unreachable!("a run has at least one step"))
    }

    /// Wall seconds of all steps: set-up, assembly, factorisation, solution, estimate.
    pub fn seconds(&self) -> [f64; 5] {
        [0, 1, 2, 3, 4].map(|k| self.progress.steps.iter().map(|s| s.seconds[k]).sum())
    }
}

/// Solves a scene. `interrupts` counts the user's wishes to stop: after one the step that runs is finished and kept,
/// after two the run ends at once with the steps before it.
///
/// # Errors
/// As [`Model::advance`] for the first step that it solves; an error of a later step ends the run with the steps before it.
/// Errors of the observer always. [`SolveError::Interrupted`] if there is nothing to keep.
pub fn run<M: Model>(
    scene: &Scene,
    mut progress: Progress<M>,
    interrupts: &AtomicUsize,
    observe: &mut Observer<'_, M>,
) -> Result<Run<M>, SolveError> {
    let clock = Instant::now();
    if let Some(random) = &scene.random {
        check_quantities(scene, random)?;
    }
    let mut cache = M::Cache::default();
    let mut last: Option<M::Solved> = None;
    loop {
        let number = progress.steps.len();
        let mut watched = |stage: Stage<'_>| match interrupts.load(Ordering::Relaxed) {
            0 | 1 => observe(number, Event::Stage(stage)),
            _ => Err(SolveError::Interrupted),
        };
        let mut begun = false;
        let advanced = once_more(|| {
            if std::mem::replace(&mut begun, true) {
                watched(Stage::Again)?;
            }
            M::advance(scene, &progress, &mut cache, &mut watched)
        });
        let Advanced { solved, matrices, step, next } = match (advanced, last) {
            (Err(SolveError::Interrupted), Some(last)) => {
                return Ok(Run { last, matrices: None, progress, reason: Reason::Interrupted, error: None, clock });
            }
            (Err(error), Some(last)) if !matches!(error, SolveError::Observer(_)) => {
                return Ok(Run { last, matrices: None, progress, reason: Reason::Failed, error: Some(error), clock });
            }
            (advanced, _) => advanced?,
        };
        observe(number, Event::Done { solved: &solved, step: &step, seconds: clock.elapsed().as_secs_f64() })?;
        progress.steps.push(step);
        let end = M::end(scene, &progress.steps, &solved, next.as_ref());
        let interrupted = (interrupts.load(Ordering::Relaxed) > 0).then_some(Reason::Interrupted);
        if let Some(next) = next {
            progress.next = next;
        }
        if let Some(reason) = end.or(interrupted) {
            return Ok(Run { last: solved, matrices: Some(matrices), progress, reason, error: None, clock });
        }
        let mut solved = solved;
        M::release(&mut solved);
        last = Some(solved);
    }
}
