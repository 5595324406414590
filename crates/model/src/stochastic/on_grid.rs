//! Outcomes on a grid: each is a body of its own, with its moduli, loads, supports and contact, and is solved anew.

use std::time::Instant;

use steklov_contact::Solution;
use steklov_msfem::Grid;
use steklov_problem::{Random, Sampling, Scene, Uses, moduli};
use steklov_stochastic::{Variable, sample};

use super::affine::{Asked, of_affine};
use super::all_outcomes::{finish, scales};
use super::in_body::InBody;
use super::jumps::InGerms;
use super::kept::{Kept, by_effect};
use super::multilevel::of_levels;
use super::number::{Number, numbers};
use super::one_by_one::OneByOne;
use super::outcomes::{Answer, contact_answer};
use super::result::StochasticResult;
use super::stage::OutcomeStage;
use super::watch::OutcomesWatch;
use crate::answer::report::figures;
use crate::error::SolveError;
use crate::grid::{Acting, GridLayout, GridSolved, solve_once};
use crate::solve::contact_rows::contact_rows;
use crate::summary::{Probe, Summary};

/// Answers that are held at a time with their fields.
const BLOCK: usize = 64;
/// Samples of the moduli that are kept.
const SHOWN: u64 = 5;

/// Solves a scene for all outcomes of its random input on one grid; `observe` is handed the answers.
///
/// *Cost*: a solution of the grid for each outcome; of Galerkin one system for all of them.
///
/// # Errors
/// As [`solve_stochastic`](super::solve_stochastic).
pub fn solve_stochastic_on_grid(
    scene: &Scene,
    random: &Random,
    layout: &GridLayout,
    watch: &OutcomesWatch<'_>,
    observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
) -> Result<StochasticResult, SolveError> {
    let clock = Instant::now();
    observe(OutcomeStage::Begin(random))?;
    let (numbers, data) = (numbers(scene, random)?, InGerms::new(scene, random));
    let outcomes = OutcomesOnGrid::new(scene.clone(), random, layout.clone())?;
    let (nominal, solved) = outcomes.solve(&random.nominal())?;
    let scales = scales(scene, &numbers, &summary(&nominal, &solved))?;
    let method = random.stochastic.method;
    let mut result = match method {
        Sampling::Galerkin => {
            let asked = Asked { outcomes: &outcomes, random, layout, numbers: &numbers, scales: &scales };
            of_affine(&asked, &solved.body.grid, watch)?
        }
        Sampling::Multilevel => of_levels((scene, layout), random, (&numbers, &scales), watch)?,
        _ => {
            let answer = |germs: &[f64], _: &mut Option<Solution>| {
                outcomes.solve(germs).map(|(scene, solved)| kept(&scene, &solved, &numbers))
            };
            let kept = match method {
                Sampling::Corrected => by_effect((scene, &nominal), random, &solved, (&numbers, &scales))?,
                _ => Kept::all(random),
            };
            let one_by_one =
                OneByOne { numbers: &numbers, scales: &scales, data: &data, answer: &answer, kept, block: BLOCK };
            one_by_one.solve(random, watch, observe)?
        }
    };
    result.moduli = sampled_moduli(scene, random, &solved.body.grid);
    finish(scene, random, &mut result, &scales);
    result.seconds = clock.elapsed().as_secs_f64();
    Ok(result)
}

/// The moduli of the cells of the body in the first samples that are possible, if they vary.
fn sampled_moduli(scene: &Scene, random: &Random, grid: &Grid) -> Vec<Vec<f64>> {
    if !scene.uses(random).young || scene.body().cells().is_none() {
        return Vec::new();
    }
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let of = |i: u64| {
        let all = moduli(&scene.outcome(&sample(&variables, random.stochastic.seed, i)).ok()?, grid).ok()?;
        Some(grid.body_cells().map(|cell| all[cell]).collect())
    };
    (0..SHOWN).filter_map(of).collect()
}

/// A grid on which outcomes are solved.
pub(super) struct OutcomesOnGrid<'a> {
    pub(super) scene: Scene,
    random: &'a Random,
    layout: GridLayout,
    /// What acts on it, if that is the same in all outcomes.
    acting: Option<Acting>,
}

impl<'a> OutcomesOnGrid<'a> {
    /// The outcomes of a scene on the grid of a layout.
    ///
    /// # Errors
    /// Data that are not finite, moduli that are impossible.
    pub(super) fn new(scene: Scene, random: &'a Random, layout: GridLayout) -> Result<Self, SolveError> {
        let Uses { loads, contact, held, springs, .. } = scene.uses(random);
        let moves = loads || contact || held || springs;
        let acting = if moves { None } else { Some(Acting::of_layout(&scene, &layout)?) };
        Ok(Self { scene, random, layout, acting })
    }

    /// The outcome for germs as a scene, and its solution.
    ///
    /// # Errors
    /// Data that the outcome makes impossible; what keeps it from being solved, with its name.
    pub(super) fn solve(&self, germs: &[f64]) -> Result<(Scene, GridSolved), SolveError> {
        let outcome = self.scene.outcome(germs)?;
        let named = |error| match error {
            SolveError::Data(_) => error,
            error => SolveError::Outcome { outcome: self.random.outcome_name(germs), error: Box::new(error) },
        };
        solve_once(&outcome, &self.layout, self.acting.as_ref()).map(|solved| (outcome, solved)).map_err(named)
    }
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
            Probe::new(point, displacement, stress)
        })
        .collect();
    figures
}

/// The requested numbers of an outcome and what its result tells of it, without its fields.
pub(super) fn numbers_of(scene: &Scene, solved: &GridSolved, numbers: &[Number]) -> Answer {
    let body = &solved.body;
    let figures = summary(scene, solved);
    let (count, sum) = body.grid.body_cells().fold((0, 0.0), |(count, sum), c| (count + 1, sum + body.young[c]));
    Answer {
        // the mean over the body, a stress
        modulus: sum / f64::from(count),
        quantities: numbers.iter().map(|number| number.of(&figures)).collect(),
        strain: solved.energies.strain,
        iterations: solved.contact.as_ref().map_or(0, |c| c.solution.iterations),
        converged: solved.converged(),
        ..Answer::default()
    }
}

/// The data of an outcome that statistics need.
pub(super) fn kept(scene: &Scene, solved: &GridSolved, numbers: &[Number]) -> Answer {
    let body = &solved.body;
    let cells: Vec<usize> = body.grid.body_cells().collect();
    let stresses = body.stresses(&solved.displacement);
    let rows = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(solved.trace(), c));
    let Answer { modulus, quantities, strain, converged, .. } = numbers_of(scene, solved, numbers);
    Answer {
        modulus,
        quantities,
        strain,
        converged,
        displacement: solved.boundary_displacement.clone(),
        in_body: InBody {
            displacement: solved.displacement.clone(),
            stress: cells.iter().flat_map(|&c| stresses[c]).collect(),
            young: cells.iter().map(|&c| body.young[c]).collect(),
        },
        ..contact_answer(&rows, solved.contact.as_ref())
    }
}
