//! The spatial error in the mean over the outcomes.

use steklov_contact::{Solution, unlocated};
use steklov_problem::{Random, Scene};
use steklov_stochastic::{CellBasis, Nodes, StochasticMesh, Variable, sample};

use super::jumps::split_at_cuts;
use super::outcomes::Outcomes;
use crate::data::on_mesh::OnMesh;
use crate::error::SolveError;
use crate::estimate::elastic::EnrichedBody;
use crate::estimate::error_estimate::{Bubble, Estimate, estimate};
use crate::estimators::{Estimator, ON_BOUNDARY, TRUNCATION};
use crate::solve::body::{Body, Factors};
use crate::solve::solution::Solved;

/// Most germs of which all combinations of two values are taken, and samples beyond.
const FEW: usize = 4;
const SAMPLES: u64 = 16;
/// Seed of these samples: not the scene's, which must not move the mesh that they refine.
const SEED: u64 = 1;

/// The estimate of an answer of the nominal outcome with its indicators, errors and scale replaced by their means in square over
/// outcomes: those of the two-point Gauss rules of up to 4 germs, else 16 samples. Doubts are those of any.
pub(crate) fn mean_estimate(
    scene: &Scene,
    random: &Random,
    body: &Body,
    enriched: &EnrichedBody,
    nominal: Estimate,
) -> Result<Estimate, SolveError> {
    let outcomes = Outcomes::new(scene, random, body)?;
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let (points, weights) = outcomes_of(scene, random, variables)?;
    let mut mean = nominal;
    let (mut error, mut scale) = (0.0, 0.0);
    mean.indicators.fill(Bubble::default());
    let mut warm: Option<Solution> = None;
    for (germs, weight) in points.iter().zip(weights) {
        let (outcome, modulus, given) = outcomes.given(germs)?;
        let (solved, factors) = outcomes.solved(&outcome, given, &mut warm)?;
        let one = one(&outcome, &solved, body, enriched, &factors)?;
        let weight = weight * modulus;
        error += weight * one.error * one.error;
        scale += weight * one.scale * one.scale;
        for (sum, b) in mean.indicators.iter_mut().zip(&one.indicators) {
            sum.displacement += weight * b.displacement;
            sum.traction += weight * b.traction;
            sum.oscillation += weight * b.oscillation;
        }
        for doubt in one.doubts {
            if !mean.doubts.contains(&doubt) {
                mean.doubts.push(doubt);
            }
        }
    }
    (mean.error, mean.scale) = (error.sqrt(), scale.sqrt());
    mean.relative = if mean.error == 0.0 { 0.0 } else { mean.error / mean.scale };
    Ok(mean)
}

/// The residual estimator in the mean over outcomes, the same as in [`mean_estimate`]: each term in mean square, and with `truncation`
/// (energy norm) what polynomials of the germs leave out.
pub(super) fn mean_estimator(
    scene: &Scene,
    random: &Random,
    outcomes: &Outcomes<'_>,
    truncation: Option<f64>,
) -> Result<Estimator, SolveError> {
    let body = outcomes.body;
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let (points, weights) = outcomes_of(scene, random, variables)?;
    let (mut sums, mut scale) = ([0.0; ON_BOUNDARY.len()], 0.0);
    let mut warm: Option<Solution> = None;
    for (germs, weight) in points.iter().zip(weights) {
        let (outcome, modulus, given) = outcomes.given(germs)?;
        let (solved, _) = outcomes.solved(&outcome, given, &mut warm)?;
        let data = OnMesh { scene: &outcome, mesh: &body.mesh, space: &body.space };
        let weight = weight * modulus;
        for residual in data.all_residuals(&solved, modulus)? {
            sums.iter_mut().zip(residual.terms()).for_each(|(sum, term)| *sum += weight * term);
        }
        scale += weight * 2.0 * solved.energies.strain;
    }
    let scale = scale.sqrt();
    let truncation = truncation.map(|relative| (TRUNCATION, (relative * scale).powi(2)));
    Ok(Estimator::new(ON_BOUNDARY.into_iter().map(|(name, _)| name).zip(sums).chain(truncation), scale))
}

/// Outcomes over which errors are averaged, and their weights.
fn outcomes_of(
    scene: &Scene,
    random: &Random,
    variables: Vec<Variable>,
) -> Result<(Vec<Vec<f64>>, Vec<f64>), SolveError> {
    let germs = variables.len();
    if germs > FEW {
        let points = (0..SAMPLES).map(|i| sample(&variables, SEED, i)).collect();
        return Ok((points, vec![1.0 / SAMPLES as f64; SAMPLES as usize]));
    }
    let mut mesh = StochasticMesh::uniform(variables, &vec![1; germs], &vec![1; germs])?;
    split_at_cuts(&mut mesh, scene.cuts(random))?;
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for cell in 0..mesh.cells.len() {
        let basis: CellBasis = mesh.basis(cell, Nodes::Gauss)?;
        points.extend(basis.points);
        weights.extend(basis.weights);
    }
    Ok((points, weights))
}

/// The estimate of one outcome, with its transitions inside elements.
fn one(
    scene: &Scene,
    solved: &Solved,
    body: &Body,
    enriched: &EnrichedBody,
    factors: &Factors,
) -> Result<Estimate, SolveError> {
    let (mut estimate, _) = estimate(scene, solved, body, enriched, factors)?;
    if let (Some(contact), Some(part)) = (&solved.contact, &factors.contact) {
        let decided = part.decided(scene, &contact.solution, estimate.error);
        estimate.add_tips(scene, &unlocated(part.solved(&contact.solution, &decided)));
    }
    Ok(estimate)
}
