//! The entry point for programs: a scene in, its numbers out.

use std::sync::atomic::AtomicUsize;

use steklov_problem::Scene;

use crate::error::SolveError;
use crate::grid::OnGrid;
use crate::run::adaptive_loop::{Model, Progress, Run, run};
use crate::run::answer::answer;
use crate::run::boundary_elements::BoundaryElements;
use crate::solve::contact_rows::{ContactRow, contact_rows};
use crate::stochastic::StochasticResult;
use crate::summary::Summary;

/// A scene that is solved.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Energies, the estimate and its doubts, contact with its force, length and ends, reactions, probes: the JSON object of the command.
    pub summary: Summary,
    /// Pressure, shear, gap and slip at every node of the sides in contact; empty without contact.
    pub contact: Vec<ContactRow>,
    /// All outcomes of random input, with mean, variance and quantiles of quantities; `None` if nothing is random, or the run ended before.
    pub outcomes: Option<StochasticResult>,
}

impl Answer {
    /// The numbers of a run, with all outcomes of its random input if they were solved.
    pub fn of_run<M: Model>(scene: &Scene, run: &Run<M>, outcomes: Option<StochasticResult>) -> Self {
        let report = M::report(scene, run);
        let contact = report.contact.map_or(Vec::new(), |contact| contact_rows(report.trace, contact));
        Self { summary: answer(scene, run, report, &contact, outcomes.as_ref()), contact, outcomes }
    }
}

/// Solves a scene as its method says: checks it, refines until the tolerance or a limit is reached, and solves for all
/// outcomes of its random input. Why it ended is [`Summary::reason`], how far the numbers can be trusted the estimate and its
/// doubts.
///
/// *Use when* numbers of one scene are wanted; to watch or stop a run, or for its matrices and fields, take
/// [`run`](crate::run::adaptive_loop::run). *Fails when* the data are impossible, a body can move freely under its loads, or the first
/// mesh has no solution. *Cost*: of a mesh with n displacement unknowns n³ operations and 24 to 72 n² bytes, and all meshes together
/// about twice the last one.
///
/// # Errors
/// [`SolveError::Data`] of what [`Scene::check`] finds, or of an outcome that is impossible; those of
/// [`run`](crate::run::adaptive_loop::run).
pub fn solve(scene: &Scene) -> Result<Answer, SolveError> {
    scene.check()?;
    match scene.is_on_grid() {
        true => solve_from(scene, Progress::<OnGrid>::new(scene, Vec::new())?),
        false => solve_from(scene, Progress::<BoundaryElements>::first(scene)),
    }
}

fn solve_from<M: Model>(scene: &Scene, first: Progress<M>) -> Result<Answer, SolveError> {
    let never = AtomicUsize::new(0);
    let mut run = run(scene, first, &never, &mut |_, _| Ok(()))?;
    let outcomes = M::outcomes(scene, &mut run, &never, &|_, _| {}, &mut |_| Ok(()))?;
    Ok(Answer::of_run(scene, &run, outcomes))
}
