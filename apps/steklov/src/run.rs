//! A scene solved from its first mesh to its last.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use steklov_bem_operators::Mesh;

use crate::plan::first_mesh;
use crate::scene::{Refine, Scene};
use crate::solve::{SolveError, Solved, Stage, solve};

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// The one mesh that was asked for is solved.
    Solved,
    /// The next mesh would have more unknowns than allowed.
    MaxDofs,
    /// As many steps as allowed are done.
    MaxSteps,
    /// The contact solver did not reach its criterion.
    Solver,
    /// The user stopped it.
    Interrupted,
}

impl Reason {
    /// The word of the JSON object.
    pub fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::MaxDofs => "max_dofs",
            Self::MaxSteps => "max_steps",
            Self::Solver => "solver",
            Self::Interrupted => "interrupted",
        }
    }
}

/// What is kept of every step.
#[derive(Debug, Clone)]
pub struct Step {
    /// Its mesh.
    pub mesh: Mesh,
    /// Displacement unknowns.
    pub dofs: usize,
    /// J.
    pub energy: f64,
    /// Whether the contact solver reached its criterion and the forces balance.
    pub converged: bool,
    /// The contact solver's measure of the error, iteration by iteration; empty without contact.
    pub history: Vec<f64>,
    /// Wall seconds: set-up, assembly, factorisation, solution.
    pub seconds: [f64; 4],
}

/// A finished run.
pub struct Run {
    /// The last step.
    pub last: Solved,
    /// All steps.
    pub steps: Vec<Step>,
    /// Why it ended.
    pub reason: Reason,
    /// Wall seconds so far.
    pub clock: Instant,
}

impl Run {
    /// Whether everything that was asked for is reached: uniform strategies have no target.
    pub fn converged(&self) -> bool {
        !matches!(self.reason, Reason::Solver | Reason::Interrupted)
    }
}

/// Solves a scene. `interrupts` counts the user's wishes to stop: after one the step that runs is finished and kept,
/// after two the run ends at once with the steps before it.
///
/// # Errors
/// As [`solve`]; [`SolveError::Interrupted`] if there is nothing to keep.
pub fn run(
    scene: &Scene,
    interrupts: &AtomicUsize,
    observe: &mut dyn FnMut(usize, Stage<'_>) -> Result<(), SolveError>,
) -> Result<Run, SolveError> {
    let clock = Instant::now();
    let mut mesh = first_mesh(scene);
    let mut steps = Vec::new();
    let mut last: Option<Solved> = None;
    loop {
        let number = steps.len();
        let mut watched = |stage: Stage<'_>| match interrupts.load(Ordering::Relaxed) {
            0 | 1 => observe(number, stage),
            _ => Err(SolveError::Interrupted),
        };
        let solved = match (solve(scene, mesh, &mut watched), last) {
            (Err(SolveError::Interrupted), Some(last)) => {
                return Ok(Run { last, steps, reason: Reason::Interrupted, clock });
            }
            (solved, _) => solved?,
        };
        let step = step(&solved);
        let stuck = !step.converged;
        steps.push(step);
        let next = refined(scene, &solved.mesh);
        let reason = match next {
            _ if stuck => Some(Reason::Solver),
            None => Some(Reason::Solved),
            _ if steps.len() >= scene.method.max_steps => Some(Reason::MaxSteps),
            Some(ref next) if dofs(next) > scene.method.max_dofs => Some(Reason::MaxDofs),
            _ if interrupts.load(Ordering::Relaxed) > 0 => Some(Reason::Interrupted),
            _ => None,
        };
        match (reason, next) {
            (Some(reason), _) => return Ok(Run { last: solved, steps, reason, clock }),
            (None, Some(next)) => (mesh, last) = (next, Some(solved)),
            (None, None) => unreachable!("without a next mesh there is a reason to end"),
        }
    }
}

fn step(solved: &Solved) -> Step {
    let s = &solved.seconds;
    let contact = solved.contact.as_ref();
    Step {
        mesh: solved.mesh.clone(),
        dofs: solved.space.dofs(),
        energy: solved.energies.total,
        converged: solved.balanced && contact.is_none_or(|c| c.solution.converged()),
        history: contact.map_or(Vec::new(), |c| c.solution.history.clone()),
        seconds: [s.set_up, s.assemble, s.factorise, s.solve],
    }
}

fn dofs(mesh: &Mesh) -> usize {
    2 * mesh.degree.iter().sum::<usize>()
}

/// The mesh of the next step; none if there is none.
fn refined(scene: &Scene, mesh: &Mesh) -> Option<Mesh> {
    let all = vec![true; mesh.len()];
    match scene.method.refine {
        Some(Refine::UniformH) => Some(mesh.bisected(&all).0).filter(|next| next.len() > mesh.len()),
        Some(Refine::UniformP) if mesh.degree.iter().all(|&p| p < Mesh::MAX_DEGREE) => Some(mesh.raised(&all)),
        _ => None,
    }
}
