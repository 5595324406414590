//! All outcomes of a scene: from points to statistics.

use std::time::Instant;

use steklov_contact::Solution;
use steklov_expression::RandomField;
use steklov_problem::{Random, Sampling, Scene};

use super::estimate::mean_estimator;
use super::kept::Kept;
use super::nodes::{is_coupled, solve_nodes};
use super::number::Number;
use super::of_surrogate::of_surrogate;
use super::one_by_one::OneByOne;
use super::outcomes::Outcomes;
use super::result::{BLOCK, FieldModes, StochasticResult};
use super::spread::{is_missed, judge, of_one_scale};
use super::stage::OutcomeStage;
use super::watch::OutcomesWatch;
use crate::error::SolveError;
use crate::estimate::error_estimate::has_residuals;
use crate::solve::body::Body;
use crate::summary::Summary;

/// Steps along a side, and in each direction over the body, at which modes of random fields are stored.
const LINE: usize = 200;
const GRID: usize = 32;

/// Solves a scene for all outcomes of its random input, on the mesh of a body; `observe` is handed the answers.
///
/// # Errors
/// An outcome that is impossible, a quantity that is not a number of the result, an observer that fails,
/// [`SolveError::Interrupted`].
pub fn solve_stochastic(
    scene: &Scene,
    random: &Random,
    body: &Body,
    watch: &OutcomesWatch<'_>,
    observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
) -> Result<StochasticResult, SolveError> {
    let clock = Instant::now();
    observe(OutcomeStage::Begin(random))?;
    let settings = &random.stochastic;
    let outcomes = Outcomes::new(scene, random, body)?;
    let nominal = outcomes.outcome(&random.nominal(), &mut None)?.figures;
    let scales = scales(scene, &outcomes.numbers, &nominal)?;
    let mut result = match settings.method {
        Sampling::Galerkin | Sampling::Collocation => {
            let coupled = is_coupled(scene, random)?;
            let surrogate = solve_nodes(scene, random, &outcomes, coupled, watch)?;
            of_surrogate(scene, random, &surrogate, &outcomes, watch, observe)?
        }
        Sampling::Multilevel => return Err(scene.no_family_of_grids().into()),
        Sampling::Sparse | Sampling::Corrected | Sampling::MonteCarlo => {
            let answer = |germs: &[f64], warm: &mut Option<Solution>| outcomes.answer(germs, warm);
            let (numbers, data) = (&outcomes.numbers[..], &outcomes.data);
            let kept = Kept::all(random);
            let one_by_one = OneByOne { numbers, scales: &scales, data, answer: &answer, kept, block: BLOCK };
            one_by_one.solve(random, watch, observe)?
        }
    };
    if has_residuals(scene) {
        result.estimator = Some(mean_estimator(scene, random, &outcomes, result.truncation)?);
    }
    finish(scene, random, &mut result, &scales);
    let young = scene.problem.bodies[random.constants.first_young()].material().young;
    result.young.iter_mut().for_each(|e| *e *= young);
    result.seconds = clock.elapsed().as_secs_f64();
    Ok(result)
}

/// The largest nominal value of those of one scale with each number.
///
/// # Errors
/// A quantity that is no number of the nominal outcome.
pub(super) fn scales(scene: &Scene, numbers: &[Number], nominal: &Summary) -> Result<Vec<f64>, SolveError> {
    if let Some(number) = numbers.iter().find(|number| number.of(nominal).is_nan()) {
        return Err(scene.quantity_error(&number.path).into());
    }
    let size = |path: &String| Number::new(path).map_or(f64::NAN, |number| number.of(nominal).abs());
    let of_contact = nominal.contact.as_ref().map(|contact| &contact.force);
    let forces = nominal.reactions.values().chain(of_contact).chain(nominal.interfaces.iter().map(|i| &i.force));
    let force = forces.flatten().fold(0.0, |most: f64, force| most.max(force.abs()));
    let scale = |number: &Number| {
        let own = of_one_scale(&number.path).iter().map(size).fold(0.0, f64::max);
        // a side may carry nothing
        let is_force = number.path.starts_with("reactions.") || number.path.contains(".force.");
        if is_force { own.max(force) } else { own }
    };
    Ok(numbers.iter().map(scale).collect())
}

/// Judges the quantities by their scales, and adds what the scene gives.
pub(super) fn finish(scene: &Scene, random: &Random, result: &mut StochasticResult, scales: &[f64]) {
    result.quantities.iter_mut().zip(scales).for_each(|(quantity, scale)| judge(scene, quantity, *scale));
    if random.stochastic.method == Sampling::Sparse {
        result.overlooked |= result.quantities.iter().zip(scales).any(|(quantity, scale)| is_missed(quantity, *scale));
    }
    let expanded = random.fields().filter(|(field, _)| !field.expansion.is_drawn());
    result.fields = expanded.map(|(field, _)| field_modes(field)).collect();
    result.labels = random.germs.iter().map(|g| g.label.clone()).collect();
    result.probabilities = random.stochastic.quantiles.clone();
}

/// The expansion of a field along its side, or on a grid over the body.
fn field_modes(field: &RandomField) -> FieldModes {
    let step = |k: usize, n: usize, length: f64| length * k as f64 / n as f64;
    let points: Vec<Vec<f64>> = match field.expansion.sides()[..] {
        [x, y] => (0..=GRID).flat_map(|j| (0..=GRID).map(move |i| vec![step(i, GRID, x), step(j, GRID, y)])).collect(),
        ref length => (0..=LINE).map(|k| vec![step(k, LINE, length[0])]).collect(),
    };
    let at = |p: &Vec<f64>| field.expansion.modes([p[0], p.get(1).copied().unwrap_or(0.0)]);
    FieldModes {
        name: field.name.clone(),
        eigenvalues: field.expansion.eigenvalues(),
        captured: field.expansion.captured(),
        unresolved: field.expansion.unresolved(),
        modes: points.iter().map(at).collect(),
        points,
    }
}
