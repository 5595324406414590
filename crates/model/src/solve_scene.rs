//! The entry point for programs: a scene in, its numbers out.

use std::sync::atomic::AtomicUsize;

use steklov_problem::Scene;

use crate::error::SolveError;
use crate::grid::OnGrid;
use crate::run::adaptive_loop::{Event, Model, Progress, Run, run};
use crate::run::answer::answer;
use crate::run::boundary_elements::BoundaryElements;
use crate::solve::contact_rows::{ContactRow, contact_rows};
use crate::stage::Stage;
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
    solve_watched(scene, &Watch { interrupts: &AtomicUsize::new(0), tell: &|_| {} })
}

/// How a program stops a run and sees how far it is.
pub struct Watch<'a> {
    /// Counts the wishes to stop: after one the step that runs is finished and its answer given, after two the run ends at once.
    pub interrupts: &'a AtomicUsize,
    /// Gets what is done at the moment.
    pub tell: &'a (dyn Fn(Told) + Sync),
}

/// What a run is doing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Told {
    /// A step of the loop, its number from 0, the word of its part, and the share of the step that is done.
    Step(usize, &'static str, f64),
    /// Outcomes of random input: those that are solved, and how many there will be.
    Outcomes(usize, usize),
}

/// As [`solve`], watched.
///
/// # Errors
/// As [`solve`]; [`SolveError::Interrupted`] if it was stopped before there was anything to tell.
pub fn solve_watched(scene: &Scene, watch: &Watch<'_>) -> Result<Answer, SolveError> {
    scene.check()?;
    match scene.is_on_grid() {
        true => solve_from(scene, Progress::<OnGrid>::new(scene, Vec::new())?, watch),
        false => solve_from(scene, Progress::<BoundaryElements>::first(scene), watch),
    }
}

fn solve_from<M: Model>(scene: &Scene, first: Progress<M>, watch: &Watch<'_>) -> Result<Answer, SolveError> {
    let mut run = run(scene, first, watch.interrupts, &mut |step, event| {
        if let Event::Stage(Stage::Progress(what, share)) = event {
            (watch.tell)(Told::Step(step, what, share));
        }
        Ok(())
    })?;
    let tell = |done, count| (watch.tell)(Told::Outcomes(done, count));
    let outcomes = M::outcomes(scene, &mut run, watch.interrupts, &tell, &mut |_| Ok(()))?;
    Ok(Answer::of_run(scene, &run, outcomes))
}
