//! Statistics of a surrogate: moments from its nodes, quantiles and probabilities from samples of it.

use rayon::prelude::*;
use steklov_problem::{Random, Scene};
use steklov_stochastic::{CellBasis, density, quantiles, sample};

use super::effects::{exact_effects, sampled_effect};
use super::events::events;
use super::number::Number;
use super::outcomes::{Answer, Outcomes};
use super::result::{BINS, BLOCK, Cells, OVERLOOKED, Quantity, StochasticResult, UNDECIDED, bounds, of_grid};
use super::stage::{Modulus, OutcomeStage};
use super::surrogate::{Cell, Surrogate};
use super::watch::OutcomesWatch;
use crate::error::SolveError;

/// Most samples of a surrogate of several cells for the effects of single germs.
const EFFECTS: usize = 20_000;
/// Relative to the mean square, variances below this are rounding.
const NO_VARIANCE: f64 = 1e-20;

/// A surrogate with the data for evaluating it anywhere.
struct View<'a> {
    surrogate: &'a Surrogate,
    /// Values that the quantities cannot leave.
    limits: Vec<[f64; 2]>,
    /// The change of contact of each condition at the nodes of each cell.
    changes: Vec<Vec<Vec<f64>>>,
}

impl<'a> View<'a> {
    fn new(scene: &Scene, surrogate: &'a Surrogate, answers: &[Answer], numbers: &[Number]) -> Self {
        let mut rest = events(&answers.iter().collect::<Vec<_>>()).into_iter();
        let changes = surrogate.cells.iter().map(|c| rest.by_ref().take(c.answers.len()).collect()).collect();
        Self { surrogate, limits: numbers.iter().map(|number| bounds(scene, &number.path)).collect(), changes }
    }

    /// The quantities, and 1 for each of the conditions for which the surrogate of the change of contact is positive.
    fn at(&self, germ: &[f64], conditions: usize) -> (Vec<f64>, Vec<f64>) {
        let c = self.surrogate.mesh.locate(germ).unwrap_or(0);
        let cell = &self.surrogate.cells[c];
        let mut theta = vec![0.0; cell.answers.len()];
        cell.basis.evaluate(germ, &mut theta);
        let sum = |value: &dyn Fn(usize) -> f64| theta.iter().enumerate().map(|(j, t)| t * value(j)).sum::<f64>();
        let value = |(k, [low, high]): (usize, &[f64; 2])| sum(&|j| cell.answers[j].quantities[k]).clamp(*low, *high);
        let quantities = self.limits.iter().enumerate().map(value).collect();
        let touches = |i: usize| f64::from(u8::from(sum(&|j| self.changes[c][j][i]) > 0.0));
        (quantities, (0..conditions).map(touches).collect())
    }

    /// The quantities of each sample with germ d alone taken from its partner, for Jansen's formula.
    fn partners(&self, count: usize, germ: &(impl Fn(usize) -> Vec<f64> + Sync)) -> Vec<Vec<Vec<f64>>> {
        let few = if self.surrogate.cells.len() > 1 { count.min(EFFECTS) } else { 0 };
        let of = |i: usize| {
            let (base, other) = (germ(i), germ(count + i));
            let changed = |d: usize| {
                let mut germ = base.clone();
                germ[d] = other[d];
                self.at(&germ, 0).0
            };
            (0..base.len()).map(changed).collect()
        };
        (0..few).into_par_iter().map(of).collect()
    }
}

/// Statistics of a surrogate.
///
/// # Errors
/// [`SolveError::Interrupted`]; quantities that are not finite; an observer that fails.
pub(super) fn of_surrogate(
    scene: &Scene,
    random: &Random,
    surrogate: &Surrogate,
    outcomes: &Outcomes<'_>,
    watch: &OutcomesWatch<'_>,
    observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
) -> Result<StochasticResult, SolveError> {
    let cells = &surrogate.cells;
    let points = cells.iter().flat_map(|c| c.basis.points.clone()).collect();
    let weights = cells.iter().flat_map(|c| c.basis.weights.clone()).collect();
    let answers: Vec<Answer> = cells.iter().flat_map(|c| c.answers.clone()).collect();
    observe(OutcomeStage::Answers { first: 0, count: answers.len(), answers: &answers })?;
    let nominal = scene.body().material().young;
    let modulus = |germs: &[f64]| Ok(scene.outcome(germs)?.body().material().young / nominal);
    let bases: Vec<&CellBasis> = cells.iter().map(|c| &c.basis).collect();
    let modulus: &Modulus<'_> = &modulus;
    observe(OutcomeStage::Cells { bases: &bases, modulus: scene.uses(random).young.then_some(modulus) })?;
    let mut result = of_grid(points, weights, &answers, &outcomes.numbers)?;
    let settings = &random.stochastic;
    let count = settings.samples;
    let view = View::new(scene, surrogate, &answers, &outcomes.numbers);
    let germ = |i: usize| sample(&surrogate.mesh.variables, settings.seed, i as u64);
    let conditions = result.pressure.mean.len();
    let mut samples = vec![Vec::with_capacity(count); outcomes.numbers.len()];
    let mut touching = vec![0.0; conditions];
    for first in (0..count).step_by(BLOCK) {
        watch.check()?;
        let block: Vec<(Vec<f64>, Vec<f64>)> =
            (first..count.min(first + BLOCK)).into_par_iter().map(|i| view.at(&germ(i), conditions)).collect();
        for (quantities, contact) in block {
            samples.iter_mut().zip(quantities).for_each(|(all, v)| all.push(v));
            touching.iter_mut().zip(contact).for_each(|(sum, c)| *sum += c);
        }
    }
    let partners = view.partners(count, &germ);
    let equal = vec![1.0; count];
    for (k, quantity) in result.quantities.iter_mut().enumerate() {
        quantity.truncation = Some(surrogate.told.quantities[k].sqrt());
        quantity.quantiles = Some(quantiles(&samples[k], &equal, &settings.quantiles)?);
        quantity.density = density(&samples[k], &equal, BINS).ok(); // none of a constant
        quantity.effects =
            effects(quantity, cells, |d| partners.iter().zip(&samples[k]).map(|(p, v)| [*v, p[d][k]]).collect());
    }
    result.probability = touching.iter().map(|sum| sum / count as f64).collect();
    add_truncation(&mut result, surrogate, &answers, settings.tolerance);
    Ok(result)
}

/// The total effects: of a single cell from its polynomial, of several from pairs of samples that differ in germ d alone.
fn effects(quantity: &Quantity, cells: &[Cell], pairs: impl Fn(usize) -> Vec<[f64; 2]>) -> Option<Vec<f64>> {
    let square = quantity.mean * quantity.mean + quantity.variance;
    let germs = cells.first()?.basis.points.first()?.len();
    (quantity.variance > NO_VARIANCE * square).then(|| match cells {
        [cell] => exact_effects(&cell.basis, &quantity.values),
        _ => (0..germs).map(|d| sampled_effect(&pairs(d))).collect(),
    })
}

/// Adds the truncation error of the surrogate's polynomials, its cells, and why it was not made finer.
fn add_truncation(result: &mut StochasticResult, surrogate: &Surrogate, answers: &[Answer], tolerance: f64) {
    let Surrogate { mesh, cells, coupled, told, end, solved } = surrogate;
    let energy: f64 = result.weights.iter().zip(answers).map(|(w, a)| w * 2.0 * a.strain).sum();
    let errors: Vec<_> = cells.iter().map(Cell::errors).collect();
    let by_germ = |d: usize| errors.iter().map(|e| e[d].error).sum::<f64>();
    let part = |error: f64| if error == 0.0 { 0.0 } else { error / energy };
    result.truncation_by_germ = (0..mesh.variables.len()).map(|d| part(by_germ(d))).collect();
    let bound = |k: usize| mesh.cells.iter().map(|c| c.bounds.iter().map(|b| b[k]).collect()).collect();
    let degree = mesh.cells.iter().map(|c| c.degree.clone()).collect();
    result.cells = Some(Cells { low: bound(0), high: bound(1), degree });
    result.truncation = Some(told.relative);
    result.truncation_measured = Some(told.measured);
    result.overlooked = told.relative > OVERLOOKED * told.by_nodes.max(tolerance);
    result.unseen = (told.undecided > UNDECIDED).then_some(told.undecided);
    result.checks = told.checks;
    result.end = *end;
    result.coupled = *coupled;
    result.solved = *solved;
}
