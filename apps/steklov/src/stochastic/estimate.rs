//! The spatial error in the mean over the outcomes.

use steklov_contact::{Solution, unlocated};
use steklov_stochastic::{Variable, smolyak};

use super::outcomes::Outcomes;
use crate::body::{Body, Factors};
use crate::estimate::{Estimate, estimate};
use crate::scene::{Random, Scene};
use crate::solve::{SolveError, Solved};

/// Level of the sparse grid over which errors are averaged: two or three values of each germ, the others in the middle.
const LEVEL: usize = 1;

/// The estimate of an answer of the nominal outcome with its indicators, errors and scale replaced by their means in square over
/// outcomes; doubts are those of any.
///
/// Negative weights of the grid are left out, and the others sum to 1: errors are averaged, not integrated.
pub(crate) fn mean_estimate(
    scene: &Scene,
    random: &Random,
    body: &Body,
    nominal: Estimate,
) -> Result<Estimate, SolveError> {
    let outcomes = Outcomes::new(scene, random, body)?;
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let grid = smolyak(&variables, LEVEL)?;
    let inner = random.nominal();
    let others = grid.points.iter().filter(|p| **p != inner);
    let count = 1.0 + others.clone().count() as f64;
    let mut mean = nominal;
    let mut squared = [mean.error * mean.error, mean.scale * mean.scale];
    let mut warm: Option<Solution> = None;
    for germs in others {
        let (outcome, modulus, given) = outcomes.given(germs)?;
        let (solved, factors) = outcomes.solved(&outcome, given, &mut warm)?;
        let Some(one) = one(&outcome, &solved, body, &factors)? else { continue };
        squared[0] += modulus * one.error * one.error;
        squared[1] += modulus * one.scale * one.scale;
        for (sum, b) in mean.indicators.iter_mut().zip(&one.indicators) {
            sum.displacement += modulus * b.displacement;
            sum.traction += modulus * b.traction;
            sum.oscillation += modulus * b.oscillation;
        }
        for doubt in one.doubts {
            if !mean.doubts.contains(&doubt) {
                mean.doubts.push(doubt);
            }
        }
    }
    for sum in &mut mean.indicators {
        sum.displacement /= count;
        sum.traction /= count;
        sum.oscillation /= count;
    }
    mean.error = (squared[0] / count).sqrt();
    mean.scale = (squared[1] / count).sqrt();
    mean.relative = if mean.error == 0.0 { 0.0 } else { mean.error / mean.scale };
    Ok(mean)
}

/// The estimate of one outcome, with its transitions inside elements.
fn one(scene: &Scene, solved: &Solved, body: &Body, factors: &Factors) -> Result<Option<Estimate>, SolveError> {
    let Some(mut estimate) = estimate(scene, solved, body, factors)? else { return Ok(None) };
    if let (Some(contact), Some(part)) = (&solved.contact, &factors.contact) {
        let located = unlocated(steklov_contact::Solved {
            problem: &part.problem,
            solution: &contact.solution,
            sets: &part.sets,
            lines: &part.lines,
        });
        estimate.add_tips(scene, &located);
    }
    Ok(Some(estimate))
}
