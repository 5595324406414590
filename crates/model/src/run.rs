//! A scene solved from its first mesh to its last.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use steklov_bem_operators::{Mark, Mesh, PairCache, Subdivision};
use steklov_contact::{Located, Tip};
use steklov_problem::{Refine, Scene};

use crate::adapt::Layout;
use crate::body::Body;
use crate::elastic::EnrichedBody;
use crate::estimate::{Doubt, Estimate, ROUNDOFF, estimate, is_estimated};
use crate::hidden::Unseen;
use crate::memory::{Lack, lack};
use crate::solve::{SolveError, Solved, Stage, solve};
use crate::stochastic::mean_estimate;

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The one mesh that was asked for is solved.
    Solved,
    /// The estimated error is down at the tolerance.
    Tolerance,
    /// The next mesh would have more unknowns than allowed, or need more memory.
    MaxDofs,
    /// As many steps as allowed are done.
    MaxSteps,
    /// The stochastic mesh has as many nodes as allowed, and its truncation is not down at its tolerance.
    MaxNodes,
    /// Coarse cells need not, or cannot, be split any more: what is left is the error of the fine grid.
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

/// What is kept of every step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Its mesh.
    pub mesh: Mesh,
    /// Displacement unknowns.
    pub dofs: usize,
    /// J.
    pub energy: f64,
    /// Half of a(u, u).
    pub strain: f64,
    /// Whether the contact solver reached its criterion and the forces balance.
    pub converged: bool,
    /// The contact solver's measure of the error, iteration by iteration; empty without contact.
    pub history: Vec<f64>,
    /// Estimate of the error; none of a single mesh of thousands of unknowns.
    pub estimate: Option<Estimate>,
    /// The vertices of the mesh that follow transitions of contact and stick.
    pub tips: Vec<Tip>,
    /// Where the transitions are believed to be.
    pub located: Vec<Located>,
    /// Wall seconds: set-up, assembly, factorisation, solution, estimate.
    pub seconds: [f64; 5],
}

impl Step {
    /// Estimate of the error.
    ///
    /// # Panics
    /// If the mesh was too large for one.
    pub fn estimate(&self) -> &Estimate {
        self.estimate.as_ref().expect("meshes that lead to others are estimated")
    }
}

/// Steps that are done, and the layout that they lead to.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// All steps.
    pub steps: Vec<Step>,
    /// What is to be solved next.
    pub next: Layout,
}

impl Progress {
    /// The beginning of a run.
    pub fn first(scene: &Scene) -> Self {
        Self { steps: Vec::new(), next: Layout::first(scene) }
    }

    /// What the next mesh lacks if the matrices that it needs do not fit into the memory that the method may take.
    pub fn lack(&self, scene: &Scene) -> Option<Lack> {
        lack(scene, self.next.subdivision.elements(), self.next.dofs())
    }

    /// The state before the last of these steps was solved; None of no steps. Solving it again gives the same bits, and
    /// what they lead to.
    pub fn before_last(mut steps: Vec<Step>) -> Option<Self> {
        let Step { mesh, tips, .. } = steps.pop()?;
        let subdivision = Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]);
        Some(Self { steps, next: Layout { subdivision, tips } })
    }
}

/// A finished run.
pub struct Run {
    /// The last step.
    pub last: Solved,
    /// Its matrices; None where a later step was begun, for which they were given up.
    pub body: Option<Body>,
    /// The steps and what comes next.
    pub progress: Progress,
    /// Why it ended.
    pub reason: Reason,
    /// The error of the step after the last one, where one ended the run.
    pub error: Option<SolveError>,
    /// Wall seconds so far.
    pub clock: Instant,
}

impl Run {
    /// Whether everything that was asked for is reached.
    pub fn converged(&self) -> bool {
        matches!(self.reason, Reason::Solved | Reason::Tolerance)
    }

    /// The matrices of the last step, made again where they were given up.
    ///
    /// # Errors
    /// Those of [`solve`]; [`SolveError::Interrupted`] if the run was interrupted.
    pub fn matrices(&mut self, scene: &Scene) -> Result<&Body, SolveError> {
        match &mut self.body {
            Some(body) => Ok(body),
            None if self.reason == Reason::Interrupted => Err(SolveError::Interrupted),
            none => {
                let (mesh, estimated) = (self.last.mesh.clone(), is_estimated(scene, self.last.space.dofs()));
                let (_, body, _) = solve(scene, mesh, estimated, &mut PairCache::default(), &mut |_| Ok(()))?;
                Ok(none.insert(body))
            }
        }
    }

    /// The last step.
    pub fn step(&self) -> &Step {
        self.progress.steps.last().unwrap_or_else(|| unreachable!("a run has at least one step"))
    }
}

/// Solves a scene of boundary elements from its first mesh to its last: [`run`] that nobody watches or stops.
///
/// # Errors
/// As [`run`].
pub fn unobserved(scene: &Scene) -> Result<Run, SolveError> {
    run(scene, Progress::first(scene), &AtomicUsize::new(0), &mut |_, _| Ok(()))
}

/// Solves a scene. `interrupts` counts the user's wishes to stop: after one the step that runs is finished and kept,
/// after two the run ends at once with the steps before it.
///
/// # Errors
/// As [`solve`], of the first step that it solves: an error of a later one ends the run with the steps before it. Those of
/// the observer always. [`SolveError::Interrupted`] if there is nothing to keep.
pub fn run(
    scene: &Scene,
    mut progress: Progress,
    interrupts: &AtomicUsize,
    observe: &mut dyn FnMut(usize, Stage<'_>) -> Result<(), SolveError>,
) -> Result<Run, SolveError> {
    let clock = Instant::now();
    let mut cache = PairCache::default();
    let mut last: Option<Solved> = None;
    loop {
        let number = progress.steps.len();
        let mut watched = |stage: Stage<'_>| match interrupts.load(Ordering::Relaxed) {
            0 | 1 => observe(number, stage),
            _ => Err(SolveError::Interrupted),
        };
        let next = advance(scene, &progress, &mut cache, &mut watched);
        let (solved, body, step, layout) = match (next, last) {
            (Err(SolveError::Interrupted), Some(last)) => {
                return Ok(Run { last, body: None, progress, reason: Reason::Interrupted, error: None, clock });
            }
            (Err(error), Some(last)) if !matches!(error, SolveError::Observer(_)) => {
                return Ok(Run { last, body: None, progress, reason: Reason::Failed, error: Some(error), clock });
            }
            (next, _) => next?,
        };
        observe(number, Stage::Step { solved: &solved, step: &step, seconds: clock.elapsed().as_secs_f64() })?;
        let unchanged = layout.subdivision == progress.next.subdivision;
        progress.steps.push(step);
        progress.next = layout;
        let interrupted = interrupts.load(Ordering::Relaxed) > 0;
        if let Some(reason) = reason(scene, &progress, unchanged, interrupted) {
            return Ok(Run { last: solved, body: Some(body), progress, reason, error: None, clock });
        }
        last = Some(solved);
    }
}

/// Solves and estimates the next layout; the one after it.
fn advance(
    scene: &Scene,
    progress: &Progress,
    cache: &mut PairCache,
    observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
) -> Result<(Solved, Body, Step, Layout), SolveError> {
    let mesh = progress.next.subdivision.mesh(&scene.body().outline)?;
    let estimated = is_estimated(scene, progress.next.dofs());
    let (solved, body, factors) = solve(scene, mesh, estimated, cache, observe)?;
    let clock = Instant::now();
    observe(Stage::Progress("estimate", 0.97))?;
    let enriched = if estimated { Some(EnrichedBody::new(&body, cache)?) } else { None };
    let (mut estimate, unseen) = match &enriched {
        Some(enriched) => {
            let (estimate, unseen) = estimate(scene, &solved, (&body, enriched), &factors)?;
            (Some(estimate), unseen)
        }
        None => (None, Unseen::default()),
    };
    let (mut layout, located) = progress.next.next(scene, &solved, &factors, estimate.as_ref(), &unseen)?;
    let before = progress.steps.last().map(|last| last.located.as_slice());
    if let Some(estimate) = &mut estimate {
        estimate.add_transitions(scene, &solved.mesh, &located, before);
        estimate.add_roundoff(&solved);
        estimate.settle_exact(scene, &solved)?;
    }
    if let (Some(random), Some(enriched), Some(one)) = (&scene.random, &enriched, &mut estimate)
        && one.relative <= scene.method.tolerance
    {
        // the mean outcome is solved well enough: what of the others?
        *one = mean_estimate(scene, random, (&body, enriched), one.clone())?;
        (layout, _) = progress.next.next(scene, &solved, &factors, Some(one), &unseen)?;
    }
    let s = &solved.seconds;
    let seconds = [s.set_up, s.assemble, s.factorise, s.solve, clock.elapsed().as_secs_f64()];
    let contact = solved.contact.as_ref();
    let step = Step {
        mesh: solved.mesh.clone(),
        dofs: solved.space.dofs(),
        energy: solved.energies.total,
        strain: solved.energies.strain,
        converged: solved.balanced && contact.is_none_or(|c| c.converged()),
        history: contact.map_or(Vec::new(), |c| c.reported().history.clone()),
        estimate,
        tips: progress.next.tips.clone(),
        located,
        seconds,
    };
    Ok((solved, body, step, layout))
}

/// Why the run ends after the last of the steps, if it does.
fn reason(scene: &Scene, progress: &Progress, unchanged: bool, interrupted: bool) -> Option<Reason> {
    let method = &scene.method;
    let steps = &progress.steps;
    let step = steps.last()?;
    let reached = |s: &Step| s.estimate.as_ref().is_some_and(|e| e.relative <= method.tolerance);
    let exact = step.estimate.as_ref().is_some_and(|e| e.relative < ROUNDOFF);
    // an estimate that is in doubt has to be confirmed by the next step, if there is any
    let doubted = step.estimate.iter().flat_map(|e| &e.doubts).any(|d| *d != Doubt::Roundoff);
    let confirmed = !doubted || exact || unchanged || steps.len() > 1 && reached(&steps[steps.len() - 2]);
    Some(match method.refine {
        _ if !step.converged => Reason::Solver,
        Refine::None => Reason::Solved,
        _ if reached(step) && confirmed => Reason::Tolerance,
        _ if unchanged || exact => Reason::Roundoff,
        _ if steps.len() >= method.max_steps => Reason::MaxSteps,
        _ if progress.next.dofs() > method.max_dofs || progress.lack(scene).is_some() => Reason::MaxDofs,
        _ if interrupted => Reason::Interrupted,
        _ => return None,
    })
}
