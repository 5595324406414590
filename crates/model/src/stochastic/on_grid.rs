//! Outcomes on a grid: each is a body of its own, with its moduli, loads, supports and contact, and is solved anew.

use std::time::Instant;

use steklov_contact::Solution;
use steklov_problem::{Random, Scene};

use super::all_outcomes::{finish, scales};
use super::in_body::InBody;
use super::jumps::InGerms;
use super::number::{Number, numbers};
use super::one_by_one::OneByOne;
use super::outcomes::{Answer, contact_answer};
use super::result::{StochasticResult, Watch};
use super::stage::OutcomeStage;
use crate::answer::report::figures;
use crate::error::SolveError;
use crate::grid::{GridLayout, GridSolved, solve_once};
use crate::solve::contact_rows::contact_rows;
use crate::summary::{Probe, Summary};

/// Answers that are held at a time with their fields.
const BLOCK: usize = 64;

/// Solves a scene for all outcomes of its random input on one grid; `observe` is handed the answers.
///
/// *Cost*: a solution of the grid for each outcome.
///
/// # Errors
/// As [`solve_stochastic`](super::solve_stochastic).
pub fn solve_stochastic_on_grid(
    scene: &Scene,
    random: &Random,
    layout: &GridLayout,
    progress: &(dyn Fn(usize, usize) + Sync),
    stopped: &(dyn Fn() -> bool + Sync),
    observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
) -> Result<StochasticResult, SolveError> {
    let clock = Instant::now();
    let watch = Watch { progress, stopped };
    observe(OutcomeStage::Begin(random))?;
    let (numbers, data) = (numbers(scene, random)?, InGerms::new(scene, random));
    let outcome = |germs: &[f64]| {
        let of_germs = scene.outcome(germs)?;
        let named = |error| match error {
            SolveError::Data(_) => error,
            error => SolveError::Outcome { outcome: random.outcome_name(germs), error: Box::new(error) },
        };
        solve_once(&of_germs, layout).map(|solved| (of_germs, solved)).map_err(named)
    };
    let (nominal, solved) = outcome(&random.nominal())?;
    let scales = scales(scene, &numbers, &summary(&nominal, &solved))?;
    let answer =
        |germs: &[f64], _: &mut Option<Solution>| outcome(germs).map(|(scene, solved)| kept(&scene, &solved, &numbers));
    let one_by_one = OneByOne { numbers: &numbers, data: &data, answer: &answer, block: BLOCK };
    let mut result = one_by_one.solve(random, &watch, observe)?;
    finish(scene, random, &mut result, &scales);
    result.seconds = clock.elapsed().as_secs_f64();
    Ok(result)
}

/// The numbers of an outcome.
fn summary(scene: &Scene, solved: &GridSolved) -> Summary {
    let rows = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(solved.trace(), c));
    let (contact, trace) = (solved.contact.as_ref(), solved.trace());
    let mut figures = figures(scene, &solved.energies, (contact, trace), &solved.reactions, &rows);
    figures.probe = scene
        .probe
        .iter()
        .map(|&point| {
            let (displacement, stress) = solved.at(point);
            Probe { point, displacement, stress, stress_unbounded: false }
        })
        .collect();
    figures
}

/// The data of an outcome that statistics need.
fn kept(scene: &Scene, solved: &GridSolved, numbers: &[Number]) -> Answer {
    let body = &solved.body;
    let cells: Vec<usize> = body.grid.body_cells().collect();
    let stresses = body.stresses(&solved.displacement);
    let young: Vec<f64> = cells.iter().map(|&c| body.young[c]).collect();
    let rows = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(solved.trace(), c));
    let figures = summary(scene, solved);
    Answer {
        // the mean over the body, a stress
        modulus: young.iter().sum::<f64>() / young.len() as f64,
        displacement: solved.boundary_displacement.clone(),
        quantities: numbers.iter().map(|number| number.of(&figures)).collect(),
        strain: solved.energies.strain,
        converged: solved.converged(),
        in_body: InBody {
            displacement: solved.displacement.clone(),
            stress: cells.iter().flat_map(|&c| stresses[c]).collect(),
            young,
        },
        ..contact_answer(&rows, solved.contact.as_ref())
    }
}
