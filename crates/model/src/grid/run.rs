//! Finite elements on grids in the adaptive loop.

use steklov_algebra::once_more;
use steklov_problem::{Random, Refine, Scene, Spot};
use steklov_stochastic::{Variable, sample};

use super::answer;
use super::error_parts::GridEstimate;
use super::layout::GridLayout;
use super::refine::next_layout;
use super::solution::GridSolved;
use super::solve::solve_grid;
use crate::bars::Bars;
use crate::error::SolveError;
use crate::run::adaptive_loop::{Advanced, Model, Progress, Reason, Run, Step, seconds_of};
use crate::run::report::Report;
use crate::stage::Stage;
use crate::stochastic::{LastMesh, OutcomeStage, OutcomesWatch, StochasticResult, solve_stochastic_on_grid};
use crate::summary::SideProbe;

/// Dörfler's θ where the scene has none.
pub const MARKING: f64 = 0.5;

/// Coarse cells are not split any more where their part of the squared error is below this part of the fine grid's.
const OUTWEIGHED: f64 = 0.1;

/// Outcomes whose error bars are taken: one of so many that are solved, and at most so many. Their seed is not the scene's.
const EACH: usize = 25;
const WITH_BARS: usize = 4;
const SEED: u64 = 2;

/// Finite elements on grids, as a [`Model`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OnGrid {}

impl Progress<OnGrid> {
    /// The beginning of a run; if steps are done already, the last one is solved again.
    ///
    /// # Errors
    /// Those of the first grid.
    pub fn new(scene: &Scene, mut steps: Vec<Step<OnGrid>>) -> Result<Self, SolveError> {
        let next = match steps.pop() {
            Some(last) => last.layout,
            None => GridLayout::first(scene)?,
        };
        Ok(Self { steps, next })
    }
}

impl Model for OnGrid {
    type Layout = GridLayout;
    type Kept = GridLayout;
    type Estimate = GridEstimate;
    type Solved = GridSolved;
    type Matrices = ();
    type Cache = ();

    fn advance(
        scene: &Scene,
        progress: &Progress<Self>,
        (): &mut (),
        observe: &mut dyn FnMut(Stage<'_>) -> Result<(), SolveError>,
    ) -> Result<Advanced<Self>, SolveError> {
        let layout = &progress.next;
        let solved = solve_grid(scene, layout, observe)?;
        let step = Step {
            layout: layout.clone(),
            dofs: solved.dofs,
            energy: solved.energies.total,
            strain: solved.energies.strain,
            converged: solved.converged(),
            history: solved.contact.as_ref().map_or(Vec::new(), |c| c.reported().history.clone()),
            estimate: solved.estimate.clone(),
            seconds: seconds_of(&solved.seconds, solved.estimate_seconds),
        };
        let theta = scene.method.marking.unwrap_or(MARKING);
        let next = match scene.method.refine {
            Refine::None => None,
            _ => next_layout(layout, &solved, scene, theta)?,
        };
        Ok(Advanced { solved, matrices: (), step, next })
    }

    fn end(scene: &Scene, steps: &[Step<Self>], solved: &GridSolved, next: Option<&GridLayout>) -> Option<Reason> {
        let method = &scene.method;
        let parts = steps.last().map_or(1, |step| step.layout.parts);
        let estimate = solved.estimate.as_ref();
        let reached = estimate.is_some_and(|e| e.relative <= method.tolerance() && e.doubts().is_empty());
        let outweighed =
            estimate.is_some_and(|e| solved.coarse.is_some() && e.multiscale + e.medium <= OUTWEIGHED * e.fine_grid);
        Some(match (method.refine, next) {
            _ if !solved.converged() => Reason::Solver,
            (Refine::None, _) => Reason::Solved,
            _ if reached => Reason::Tolerance,
            (_, None) => Reason::FineGrid,
            _ if outweighed => Reason::FineGrid,
            _ if steps.len() >= method.max_steps => Reason::MaxSteps,
            (_, Some(next)) if next_dofs(scene, solved, parts, next) > method.max_dofs() => Reason::MaxDofs,
            _ => return None,
        })
    }

    fn last_mesh(layout: &GridLayout) -> LastMesh {
        LastMesh::of_grid(layout)
    }

    fn outcomes(
        scene: &Scene,
        run: &mut Run<Self>,
        watch: &OutcomesWatch<'_>,
        observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
    ) -> Result<Option<StochasticResult>, SolveError> {
        let Some(random) = scene.random.as_ref().filter(|_| run.went_well()) else { return Ok(None) };
        let layout = &run.step().layout;
        let solved = once_more(|| solve_stochastic_on_grid(scene, random, layout, watch, observe));
        if let Ok(result) = &solved {
            run.last.over_outcomes = bars_over_outcomes(scene, random, layout, result.solved);
        }
        run.with_outcomes(solved)
    }

    fn release(solved: &mut GridSolved) {
        solved.without_duals();
    }

    fn report<'a>(scene: &Scene, run: &'a Run<Self>) -> Report<'a> {
        answer::report(scene, &run.last)
    }

    fn at(solved: &GridSolved, spot: Spot, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        solved.at_spot(spot, x)
    }

    fn along_sides(scene: &Scene, solved: &GridSolved, sides: &[usize]) -> Vec<SideProbe> {
        solved.along_sides(scene, sides)
    }
}

/// The error bars of a few outcomes in the mean, where all of them have some.
fn bars_over_outcomes(scene: &Scene, random: &Random, layout: &GridLayout, solved: usize) -> Option<Bars> {
    let variables: Vec<Variable> = random.germs.iter().map(|germ| germ.variable.clone()).collect();
    let of = |i: u64| {
        let outcome = scene.outcome(&sample(&variables, SEED, i)).ok()?;
        let solved = solve_grid(&outcome, layout, &mut |_| Ok(())).ok()?;
        Some(Bars::on_grid(&outcome, &solved))
    };
    let count = (solved / EACH).clamp(1, WITH_BARS) as u64;
    Bars::mean(&(0..count).map(of).collect::<Option<Vec<Bars>>>()?)
}

/// Unknowns of the next step, held ones included.
fn next_dofs(scene: &Scene, solved: &GridSolved, parts: usize, next: &GridLayout) -> usize {
    let grid = &solved.body.grid;
    match &next.coarse {
        None if next.parts == parts => solved.dofs,
        // vertices - sides + cells = 1 - holes, and each of them becomes a vertex
        None => {
            let (vertices, cells) = (grid.nodes(), grid.body_cells().count());
            let holes = scene.problem.outline.loops().len() - 1;
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
