//! Outcomes answered for another program, which has the points and takes the statistics.

use steklov_contact::Solution;
use steklov_problem::{Random, Sampling, Scene};
use steklov_stochastic::solve_points;

use super::number::numbers;
use super::on_grid::{OutcomesOnGrid, kept};
use super::outcomes::{Answer, Outcomes};
use crate::error::SolveError;
use crate::grid::GridLayout;
use crate::solve::body::Body;

/// Whether the outcomes of random input are solved one by one, so that others can do it.
pub fn one_by_one(random: &Random) -> bool {
    matches!(random.stochastic.method, Sampling::Sparse | Sampling::Corrected | Sampling::MonteCarlo)
}

/// The answers to outcomes by their germs, on the mesh of a body.
///
/// # Errors
/// As [`solve_stochastic`](super::solve_stochastic).
pub fn answers(scene: &Scene, random: &Random, body: &Body, germs: &[Vec<f64>]) -> Result<Vec<Answer>, SolveError> {
    let outcomes = Outcomes::new(scene, random, body)?;
    solve_points(germs.len(), |i, warm: &mut Option<Solution>| outcomes.answer(&germs[i], warm))
}

/// The answers to outcomes by their germs, on a grid.
///
/// # Errors
/// As [`solve_stochastic_on_grid`](super::solve_stochastic_on_grid).
pub fn answers_on_grid(
    scene: &Scene,
    random: &Random,
    layout: &GridLayout,
    germs: &[Vec<f64>],
) -> Result<Vec<Answer>, SolveError> {
    let numbers = numbers(scene, random)?;
    let outcomes = OutcomesOnGrid::new(scene.clone(), random, layout.clone())?;
    solve_points(germs.len(), |i, _: &mut Option<Solution>| {
        outcomes.solve(&germs[i]).map(|(scene, solved)| kept(&scene, &solved, &numbers))
    })
}
