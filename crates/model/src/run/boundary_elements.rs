//! Boundary elements in the adaptive loop.

use std::sync::atomic::AtomicUsize;
use std::time::Instant;

use steklov_algebra::once_more;
use steklov_bem_operators::{Mark, Mesh, PairCache, Subdivision};
use steklov_contact::{Located, Tip};
use steklov_problem::{Refine, Scene, Spot};

use crate::answer::probes;
use crate::bars::Bars;
use crate::doubt::Doubt;
use crate::error::SolveError;
use crate::estimate::elastic::EnrichedBody;
use crate::estimate::error_estimate::{Estimate, ROUNDOFF, estimate, is_estimated};
use crate::estimate::penetration::Unseen;
use crate::mesh::layout::{Layout, MeshedCuts};
use crate::quantities::needs_tractions;
use crate::run::adaptive_loop::{Advanced, Model, Progress, Reason, Run, Step, run, seconds_of};
use crate::run::boundary_report;
use crate::run::memory::{Lack, lack};
use crate::run::report::{OfMeans, Report};
use crate::solve::body::Body;
use crate::solve::one_mesh::solve;
use crate::solve::solution::Solved;
use crate::stage::Stage;
use crate::stochastic::{LastMesh, OutcomeStage, OutcomesWatch, StochasticResult, mean_estimate, solve_stochastic};
use crate::summary::SideProbe;
use crate::zone_bars::off_by_fits;

/// Boundary elements, as a [`Model`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BoundaryElements {}

/// The data that a step keeps of its mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinedMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// The vertices of the mesh that follow transitions of contact and stick.
    pub tips: Vec<Tip>,
    /// The believed positions of the transitions.
    pub located: Vec<Located>,
    /// The cuts through the body, if it is cut.
    pub cuts: Option<MeshedCuts>,
}

impl Step<BoundaryElements> {
    /// Estimate of the error.
    ///
    /// # Panics
    /// If the mesh was too large for one.
    pub fn estimate(&self) -> &Estimate {
        self.estimate.as_ref().expect("meshes that lead to others are estimated")
    }
}

impl Progress<BoundaryElements> {
    /// The beginning of a run.
    pub fn first(scene: &Scene) -> Self {
        Self { steps: Vec::new(), next: Layout::first(scene) }
    }

    /// The memory that the next mesh lacks if its matrices do not fit into the memory that the method may take.
    pub fn lack(&self, scene: &Scene) -> Option<Lack> {
        lack(scene, &self.next)
    }

    /// The state before the last of these steps was solved; None without steps. Solving it again gives the same bits and the
    /// same next layout.
    pub fn before_last(mut steps: Vec<Step<BoundaryElements>>) -> Option<Self> {
        let RefinedMesh { mesh, tips, cuts, .. } = steps.pop()?.layout;
        let subdivision = Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]);
        Some(Self { steps, next: Layout { subdivision, tips, cuts } })
    }
}

impl Run<BoundaryElements> {
    /// The matrices of the last step, made again where they were given up.
    ///
    /// # Errors
    /// Those of [`solve`]; [`SolveError::Interrupted`] if the run was interrupted.
    pub fn matrices(&mut self, scene: &Scene) -> Result<&Body, SolveError> {
        match &mut self.matrices {
            Some(body) => Ok(body),
            None if self.reason == Reason::Interrupted => Err(SolveError::Interrupted),
            none => {
                let (mesh, estimated) = (self.last.mesh.clone(), is_estimated(scene, self.last.space.dofs()));
                let cuts = self.progress.steps.last().and_then(|step| step.layout.cuts.clone());
                let again = || {
                    solve(scene, (mesh.clone(), cuts.as_ref()), estimated, &mut PairCache::default(), &mut |_| Ok(()))
                };
                let (_, body, _) = once_more(again)?;
                Ok(none.insert(body))
            }
        }
    }
}

/// Solves a scene of boundary elements from its first mesh to its last: [`run`] without an observer or interrupts.
///
/// # Errors
/// As [`run`].
pub fn unobserved(scene: &Scene) -> Result<Run<BoundaryElements>, SolveError> {
    run(scene, Progress::first(scene), &AtomicUsize::new(0), &mut |_, _| Ok(()))
}

/// Whether the error of a step is down where rounding may decide. If the mesh does not resolve the loads, an estimate of 0
/// says nothing.
fn is_exact(step: &Step<BoundaryElements>) -> bool {
    step.estimate.as_ref().is_some_and(|e| e.relative < ROUNDOFF && !e.doubts.contains(&Doubt::Data))
}

/// Whether the last estimate is half of the one before at most: rounding errors would have stopped it.
fn still_falls(steps: &[Step<BoundaryElements>]) -> bool {
    let relative = |s: &Step<BoundaryElements>| s.estimate.as_ref().map(|e| e.relative);
    match steps {
        [.., before, last] => relative(last).zip(relative(before)).is_some_and(|(last, before)| last < FALLS * before),
        _ => false,
    }
}

/// Whether a step whose estimate does not end the run is the last one nevertheless.
fn is_last(scene: &Scene, steps: usize, next: &Layout) -> bool {
    scene.method.refine == Refine::None || steps >= scene.method.max_steps || is_too_large(scene, next)
}

/// Whether a mesh has more unknowns than allowed, or needs more memory than there is.
fn is_too_large(scene: &Scene, next: &Layout) -> bool {
    next.dofs() > scene.method.max_dofs() || lack(scene, next).is_some()
}

/// Part of the estimate before below which an estimate falls.
const FALLS: f64 = 0.5;

impl Model for BoundaryElements {
    type Layout = Layout;
    type Kept = RefinedMesh;
    type Estimate = Estimate;
    type Solved = Solved;
    type Matrices = Body;
    type Cache = PairCache;

    fn advance(
        scene: &Scene,
        progress: &Progress<BoundaryElements>,
        cache: &mut PairCache,
        observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
    ) -> Result<Advanced<Self>, SolveError> {
        let mesh = progress.next.subdivision.mesh(&scene.problem.outline)?;
        let estimated = is_estimated(scene, progress.next.dofs());
        let (mut solved, mut body, factors) =
            solve(scene, (mesh, progress.next.cuts.as_ref()), estimated, cache, observe)?;
        if let (Some(contact), Some(part)) = (&solved.contact, &factors.contact) {
            observe(Stage::Contact(&part.problem, &contact.solution))?;
        }
        let clock = Instant::now();
        observe(Stage::Progress("estimate", 0.97))?;
        let enriched =
            if estimated { Some(EnrichedBody::new(&mut body, cache, needs_tractions(scene))?) } else { None };
        let (mut estimate, unseen) = match &enriched {
            Some(enriched) => {
                let (estimate, unseen) = estimate((scene, &progress.next.tips), &solved, &body, enriched, &factors)?;
                (Some(estimate), unseen)
            }
            None => (None, Unseen::default()),
        };
        let decided = solved.contact.as_ref().zip(factors.contact.as_ref()).map(|(contact, part)| {
            part.decided(scene, &contact.solution, estimate.as_ref().map_or(0.0, |estimate| estimate.error))
        });
        let next = |estimate: Option<&Estimate>| {
            progress.next.next(scene, &solved, &factors, estimate, &unseen, decided.as_ref())
        };
        let (mut layout, located) = next(estimate.as_ref())?;
        let before = progress.steps.last().map(|last| last.layout.located.as_slice());
        if let Some(estimate) = &mut estimate {
            estimate.add_transitions(scene, &solved.mesh, &located, before);
            decided.iter().for_each(|decided| estimate.add_undecided(decided));
            estimate.add_roundoff(&solved);
            estimate.settle_exact(scene, &solved, &body)?;
        }
        let mut over_outcomes = None;
        if let (Some(random), Some(enriched), Some(one)) = (&scene.random, &enriched, &mut estimate) {
            // the mean outcome is solved well enough: are the others?
            if one.relative <= scene.method.tolerance() {
                let (mean, numbers) = mean_estimate(scene, random, &body, enriched, one)?;
                (*one, over_outcomes) = (mean, Some(numbers));
                (layout, _) = next(Some(one))?;
            } else if is_last(scene, progress.steps.len() + 1, &layout) {
                // without error bars the step is good too
                over_outcomes = mean_estimate(scene, random, &body, enriched, one).ok().map(|(_, numbers)| numbers);
            }
        }
        solved.over_outcomes = over_outcomes;
        let contact = solved.contact.as_ref();
        let step = Step {
            layout: RefinedMesh {
                mesh: solved.mesh.clone(),
                tips: progress.next.tips.clone(),
                located,
                cuts: progress.next.cuts.clone(),
            },
            dofs: progress.next.dofs(),
            energy: solved.energies.total,
            strain: solved.energies.strain,
            converged: solved.balanced && contact.is_none_or(|c| c.converged()),
            history: contact.map_or(Vec::new(), |c| c.reported().history.clone()),
            estimate,
            seconds: seconds_of(&solved.seconds, clock.elapsed().as_secs_f64()),
        };
        let refined = layout.subdivision != progress.next.subdivision || layout.cuts != progress.next.cuts;
        Ok(Advanced { solved, matrices: body, step, next: refined.then_some(layout) })
    }

    fn end(scene: &Scene, steps: &[Step<Self>], _: &Solved, next: Option<&Layout>) -> Option<Reason> {
        let method = &scene.method;
        let unchanged = next.is_none();
        let step = steps.last()?;
        let reached =
            |s: &Step<BoundaryElements>| s.estimate.as_ref().is_some_and(|e| e.relative <= method.tolerance());
        let exact = is_exact(step);
        // an estimate that is in doubt has to be confirmed by the next step, if there is any
        let doubted = step.estimate.iter().flat_map(|e| &e.doubts).any(|d| *d != Doubt::Roundoff);
        let confirmed = !doubted || exact || unchanged || steps.len() > 1 && reached(&steps[steps.len() - 2]);
        Some(match method.refine {
            _ if !step.converged => Reason::Solver,
            Refine::None => Reason::Solved,
            _ if reached(step) && confirmed => Reason::Tolerance,
            _ if unchanged || exact && !still_falls(steps) => Reason::Roundoff,
            _ if steps.len() >= method.max_steps => Reason::MaxSteps,
            _ if next.is_some_and(|next| is_too_large(scene, next)) => Reason::MaxDofs,
            _ => return None,
        })
    }

    fn report<'a>(scene: &Scene, run: &'a Run<BoundaryElements>) -> Report<'a> {
        let step = run.step();
        let estimates: Option<Vec<&Estimate>> = run.progress.steps.iter().map(|step| step.estimate.as_ref()).collect();
        let (reactions, estimates) = (&run.last.reactions, estimates.unwrap_or_default());
        let bars = Bars::new(scene, reactions, &estimates);
        let over_outcomes = run.last.over_outcomes.as_ref().map(|over| {
            let bars = Bars::over_outcomes(scene, reactions, &estimates, over);
            OfMeans { bars, energy: Some(over.energy), lengths: Some(over.lengths) }
        });
        let steps: Vec<&[Located]> = run.progress.steps.iter().map(|step| &step.layout.located[..]).collect();
        let off = match estimates[..] {
            [.., before, last] => {
                let fallen = if before.error > 0.0 { (last.error / before.error).min(1.0) } else { 1.0 };
                off_by_fits(scene, &steps[steps.len().saturating_sub(3)..], fallen)
            }
            // of an exact solution that has no ends
            [last] => (steps[0].is_empty() && last.relative < ROUNDOFF).then(Vec::new),
            [] => None,
        };
        let bars_of_step = (step.estimate.as_ref(), bars);
        let report = boundary_report::report(scene, &run.last, bars_of_step, (&step.layout.located, off));
        Report { over_outcomes, ..report }
    }

    fn is_exact(run: &Run<BoundaryElements>) -> bool {
        run.step().estimate.as_ref().is_some_and(|e| e.relative < ROUNDOFF)
    }

    fn at(solved: &Solved, spot: Spot, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        solved.at(spot, x)
    }

    fn along_sides(scene: &Scene, solved: &Solved, sides: &[usize]) -> Vec<SideProbe> {
        let equally_spaced = |e: usize| {
            let parts = 2 * solved.space.degree(e);
            (0..=parts).map(|k| (2.0 * k as f64 - parts as f64) / parts as f64).collect()
        };
        let at = |e, t| (solved.on_boundary(e, t), solved.traction(e, t));
        probes::along_sides(scene, &solved.mesh, sides, equally_spaced, at)
    }

    fn last_mesh(kept: &RefinedMesh) -> LastMesh {
        LastMesh::of_elements(&kept.mesh)
    }

    fn outcomes(
        scene: &Scene,
        run: &mut Run<BoundaryElements>,
        watch: &OutcomesWatch<'_>,
        observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
    ) -> Result<Option<StochasticResult>, SolveError> {
        let (Some(random), Some(body)) = (scene.random.as_ref().filter(|_| run.went_well()), &run.matrices) else {
            return Ok(None);
        };
        let solved = once_more(|| solve_stochastic(scene, random, body, watch, observe));
        run.with_outcomes(solved)
    }

    fn lack(scene: &Scene, run: &Run<BoundaryElements>) -> Option<Lack> {
        let small = run.progress.next.dofs() <= scene.method.max_dofs();
        lack(scene, &run.progress.next).filter(|_| small && run.reason == Reason::MaxDofs)
    }
}
