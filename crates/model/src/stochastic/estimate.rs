//! The spatial error in the mean over the outcomes.

use steklov_contact::{Solution, unlocated};
use steklov_problem::{Random, Scene};
use steklov_stochastic::{CellBasis, Nodes, StochasticMesh, Variable, latin_hypercube, sample};

use super::jumps::split_at_cuts;
use super::outcomes::{Given, Outcomes};
use crate::data::on_mesh::OnMesh;
use crate::doubt::Doubt;
use crate::error::SolveError;
use crate::estimate::elastic::EnrichedBody;
use crate::estimate::error_estimate::{Bubble, Estimate, ROUNDOFF, estimate};
use crate::estimators::{Estimator, ON_BOUNDARY, TRUNCATION};
use crate::quantities::EstimatedQuantity;
use crate::solve::body::{Body, Factors};
use crate::solve::contact_rows::{contact_rows, max_pressure};
use crate::solve::solution::{OverOutcomes, Solved};
use crate::zone_bars::lengths_of_nodes;

/// Most germs of which all combinations of two values are taken, and samples beyond.
const FEW: usize = 4;
const SAMPLES: u64 = 16;
/// Samples of a Latin hypercube beside the values of few germs: data may vanish at these.
const BESIDE: usize = 8;
/// Ratio of the mean square error of these samples to that of the values from which on the samples count: smaller ratios are
/// their own spread.
const OVERLOOKED: f64 = 2.25;
/// Probability beyond the ends of germs whose outcomes may count too, with this weight: the mean may have its energy there alone.
const RARE: f64 = 1e-3;
/// Part of the mean square error from which on they do.
const COUNTS: f64 = 0.1;
/// Part of an energy norm below which the energy of an outcome is none.
const NO_ENERGY: f64 = 1e-3;
/// Seed of these samples: not the scene's, which must not move the mesh that they refine.
const SEED: u64 = 1;

/// The estimate of an answer of the nominal outcome with its indicators, errors and scale replaced by their means in square over
/// outcomes, see [`mean_over`], and what the enriched spaces add to its numbers in the mean. Doubts are those of any.
pub(crate) fn mean_estimate(
    scene: &Scene,
    random: &Random,
    body: &Body,
    enriched: &EnrichedBody,
    nominal: &Estimate,
) -> Result<(Estimate, OverOutcomes), SolveError> {
    let outcomes = Outcomes::new(scene, random, body)?;
    let ends = ends(random);
    mean_over(scene, random, &ends, |points, weights| {
        let mut mean = nominal.clone();
        let mut numbers = OverOutcomes::default();
        mean.doubts.retain(|doubt| *doubt != Doubt::Roundoff);
        let (mut error, mut scale) = (0.0, 0.0);
        mean.indicators.fill(Bubble::default());
        let mut warm: Option<Solution> = None;
        for (germs, weight) in points.iter().zip(weights) {
            let Given { scene, body: own, loading } = outcomes.given(germs)?;
            let body = own.as_ref().unwrap_or(body);
            let (solved, factors) = outcomes.solved(&scene, body, loading, &mut warm)?;
            let one = one(&scene, &solved, body, &enriched.with_moduli(body), &factors)?;
            error += weight * one.error * one.error;
            scale += weight * one.scale * one.scale;
            for (sum, b) in mean.indicators.iter_mut().zip(&one.indicators) {
                sum.displacement += weight * b.displacement;
                sum.traction += weight * b.traction;
                sum.oscillation += weight * b.oscillation;
            }
            let gain = [one.energy - solved.energies.total, one.uncertainty];
            numbers.energy.iter_mut().zip(gain).for_each(|(sum, own)| *sum += weight * own);
            add_quantities(&mut numbers.quantities, *weight, &one.quantities);
            if let Some(contact) = &solved.contact {
                let rows = contact_rows(solved.trace(), contact);
                let edges = scene.problem.outline.edges();
                let lengths = lengths_of_nodes(solved.trace(), (contact, &rows), edges, false);
                numbers.peak += weight * max_pressure(&rows);
                numbers.lengths.iter_mut().zip(lengths).for_each(|(sum, [_, off])| *sum += weight * off);
            }
            for doubt in one.doubts {
                if !mean.doubts.contains(&doubt) {
                    mean.doubts.push(doubt);
                }
            }
        }
        (mean.error, mean.scale) = (error.sqrt(), scale.sqrt());
        mean.relative = if mean.error == 0.0 { 0.0 } else { mean.error / mean.scale };
        // rounding of a mean outcome that has hardly any energy says nothing of the others
        let counts = nominal.scale > NO_ENERGY * mean.scale && nominal.doubts.contains(&Doubt::Roundoff);
        if (counts || mean.relative < ROUNDOFF) && !mean.doubts.contains(&Doubt::Roundoff) {
            mean.doubts.push(Doubt::Roundoff);
        }
        Ok((error, (mean, numbers)))
    })
}

/// Adds the quantities of an outcome with its weight; those without dual weighted residuals in one outcome have none in the mean.
fn add_quantities(sums: &mut Vec<EstimatedQuantity>, weight: f64, own: &[EstimatedQuantity]) {
    if sums.is_empty() {
        sums.extend(own.iter().map(|_| EstimatedQuantity { value: 0.0, enriched: 0.0, weighted: Some([0.0; 2]) }));
    }
    for (sum, own) in sums.iter_mut().zip(own) {
        sum.value += weight * own.value;
        sum.enriched += weight * own.enriched;
        let both = sum.weighted.zip(own.weighted);
        sum.weighted = both.map(|(sum, own)| [0, 1].map(|k| sum[k] + weight * own[k]));
    }
}

/// The residual estimator in the mean over outcomes, see [`mean_over`]: each term in mean square, and with `truncation` (energy
/// norm) what polynomials of the germs leave out.
pub(super) fn mean_estimator(
    scene: &Scene,
    random: &Random,
    outcomes: &Outcomes<'_>,
    truncation: Option<f64>,
) -> Result<Estimator, SolveError> {
    let body = outcomes.body;
    mean_over(scene, random, &[], |points, weights| {
        let (mut sums, mut scale) = ([0.0; ON_BOUNDARY.len()], 0.0);
        let mut warm: Option<Solution> = None;
        for (germs, weight) in points.iter().zip(weights) {
            let Given { scene, body: own, loading } = outcomes.given(germs)?;
            let (solved, _) = outcomes.solved(&scene, own.as_ref().unwrap_or(body), loading, &mut warm)?;
            let data = OnMesh { scene: &scene, mesh: &body.mesh, space: &body.space };
            for residual in data.all_residuals(&solved)? {
                sums.iter_mut().zip(residual.terms()).for_each(|(sum, term)| *sum += weight * term);
            }
            scale += weight * 2.0 * solved.energies.strain;
        }
        let scale = scale.sqrt();
        let truncation = truncation.map(|relative| (TRUNCATION, (relative * scale).powi(2)));
        let parts = ON_BOUNDARY.into_iter().map(|(name, _)| name).zip(sums).chain(truncation);
        Ok((sums.iter().sum(), Estimator::new(parts, scale)))
    })
}

/// A mean over outcomes: those of the two-point Gauss rules of up to 4 germs, else 16 samples; and these ends of the germs, where
/// their squared error, times their probability, is more than a tenth of it. Where
/// data vanish at the points of the rules, q² - 1/3 of a uniform q, these see nothing: the mean of 8 samples of a Latin
/// hypercube is taken where its squared error is much larger. `mean` of points and weights also gives the mean square error.
fn mean_over<T>(
    scene: &Scene,
    random: &Random,
    ends: &[Vec<f64>],
    mut mean: impl FnMut(&[Vec<f64>], &[f64]) -> Result<(f64, T), SolveError>,
) -> Result<T, SolveError> {
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let germs = variables.len();
    let (chosen, (squared, told)) = if germs > FEW {
        let points: Vec<Vec<f64>> = (0..SAMPLES).map(|i| sample(&variables, SEED, i)).collect();
        let rule = (points, vec![1.0 / SAMPLES as f64; SAMPLES as usize]);
        let told = mean(&rule.0, &rule.1)?;
        (rule, told)
    } else {
        let mut mesh = StochasticMesh::uniform(variables.clone(), &vec![1; germs], &vec![1; germs])?;
        split_at_cuts(&mut mesh, scene.cuts(random))?;
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for cell in 0..mesh.cells.len() {
            let basis: CellBasis = mesh.basis(cell, Nodes::Gauss)?;
            points.extend(basis.points);
            weights.extend(basis.weights);
        }
        let of_rule = mean(&points, &weights)?;
        let samples = (latin_hypercube(&variables, BESIDE, SEED), vec![1.0 / BESIDE as f64; BESIDE]);
        let of_samples = mean(&samples.0, &samples.1)?;
        if of_samples.0 > OVERLOOKED * of_rule.0 { (samples, of_samples) } else { ((points, weights), of_rule) }
    };
    let rare = vec![RARE; ends.len()];
    if ends.is_empty() || mean(ends, &rare)?.0 <= COUNTS * squared {
        return Ok(told);
    }
    let (points, weights) = chosen;
    Ok(mean(&[&points, ends].concat(), &[weights, rare].concat())?.1)
}

/// Each of a few germs alone at its ends, many of them all together.
fn ends(random: &Random) -> Vec<Vec<f64>> {
    let (variables, nominal) = (random.germs.iter().map(|g| &g.variable).collect::<Vec<_>>(), random.nominal());
    let end = |v: &Variable, high: bool| {
        let bound = v.germ_support()[usize::from(high)];
        let quantile = v.quantile(if high { 1.0 - RARE } else { RARE });
        if bound.is_finite() { bound } else { quantile }
    };
    if variables.len() > FEW {
        return [false, true].map(|high| variables.iter().map(|v| end(v, high)).collect()).to_vec();
    }
    let alone = |d: usize| {
        [false, true].map(|high| {
            let mut germs = nominal.clone();
            germs[d] = end(variables[d], high);
            germs
        })
    };
    (0..variables.len()).flat_map(alone).collect()
}

/// The estimate of one outcome, with its transitions inside elements.
fn one(
    scene: &Scene,
    solved: &Solved,
    body: &Body,
    enriched: &EnrichedBody,
    factors: &Factors,
) -> Result<Estimate, SolveError> {
    let (mut estimate, _) = estimate((scene, &[]), solved, body, enriched, factors)?;
    if let (Some(contact), Some(part)) = (&solved.contact, &factors.contact) {
        let decided = part.decided(scene, &contact.solution, estimate.error);
        estimate.add_tips(scene, &unlocated(part.solved(&contact.solution, &decided)));
    }
    Ok(estimate)
}
