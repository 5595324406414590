//! The germs that polynomials of a sparse grid have: those with the largest effect on the numbers. Fresh outcomes have all.
//!
//! ```text
//! g_m = dQ/dξ_m = Σ_c dQ/dE_c E'_c √λ_m b_m,c        share of mode m in the linear variance of Q: g_m² / Σ g²
//! ```

use steklov_expression::{RandomField, Value};
use steklov_problem::{CellModuli, Random, RandomName, Scene, Substance, moduli};

use super::number::Number;
use super::spread::is_rounding;
use crate::error::SolveError;
use crate::grid::{GridSolved, modulus_derivatives};

/// Most germs of which polynomials have all: what second derivatives do, effects do not know, and the points are few.
const FEW: usize = 6;
/// Half of the difference of a field by which moduli are differentiated, in standard deviations.
const STEP: f64 = 1e-4;

/// The germs in the order in which polynomials take them.
pub(super) struct Kept {
    /// Germs by falling share, those of unknown effect first; without those of fields that are drawn as a whole.
    order: Vec<usize>,
    /// How many of them have an unknown effect.
    unknown: usize,
    /// For each number the share in its linear variance that the germs after the first d have, d = 0 ..= all.
    left_out: Vec<Vec<f64>>,
}

impl Kept {
    /// All germs that polynomials can have, each of unknown effect.
    pub(super) fn all(random: &Random) -> Self {
        let drawn = random.drawn_germs();
        let order: Vec<usize> = (0..random.germs.len()).filter(|germ| !drawn.contains(germ)).collect();
        Self { unknown: order.len(), order, left_out: Vec::new() }
    }

    /// The germs by their shares in the variance of each number; none for a germ of unknown effect.
    fn by_shares(random: &Random, shares: &[Option<Vec<f64>>]) -> Self {
        let largest = |germ: &usize| {
            shares[*germ].as_ref().map_or(f64::INFINITY, |shares| shares.iter().copied().fold(0.0, f64::max))
        };
        let mut order = Self::all(random).order;
        order.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
        let numbers = shares.iter().flatten().next().map_or(0, Vec::len);
        let left_out = |k: usize| {
            let mut sums = vec![0.0; order.len() + 1];
            for (d, &germ) in order.iter().enumerate().rev() {
                sums[d] = sums[d + 1] + shares[germ].as_ref().map_or(0.0, |shares| shares[k]);
            }
            sums
        };
        let left_out = (0..numbers).map(left_out).collect();
        Self { unknown: order.iter().filter(|&&germ| shares[germ].is_none()).count(), left_out, order }
    }

    /// The largest share in the linear variance of a number that is left out if d germs are kept.
    pub(super) fn left_out(&self, d: usize) -> f64 {
        self.left_out.iter().map(|sums| sums[d]).fold(0.0, f64::max)
    }

    /// The germs with which polynomials of a level cost least, rising: the points of their grid, and the outcomes that the variance
    /// of the others needs at a standard error of `tolerance` deviations.
    pub(super) fn at_level(&self, level: usize, tolerance: f64) -> Vec<usize> {
        let cost = |d: &usize| about_points(*d, level) + self.left_out(*d) / (tolerance * tolerance);
        let count = (self.unknown.max(1)..=self.order.len()).min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let mut kept = self.order[..count.unwrap_or(0)].to_vec();
        kept.sort_unstable();
        kept
    }
}

/// About as many points as a sparse grid of a level has in d germs: 2^L (d + L)! / (d! L!).
pub(super) fn about_points(d: usize, level: usize) -> f64 {
    (1..=level).map(|k| 2.0 * (d + k) as f64 / k as f64).product()
}

/// The germs of a scene on a grid, with its solved nominal outcome, by their effect on the numbers: of fields that make moduli
/// of cells and nothing else. All are of unknown effect where derivatives of the numbers are.
///
/// # Errors
/// Those of a solution.
pub(super) fn by_effect(
    (scene, nominal): (&Scene, &Scene),
    random: &Random,
    solved: &GridSolved,
    (numbers, scales): (&[Number], &[f64]),
) -> Result<Kept, SolveError> {
    let alone = |name: &&RandomName| scene.moves_cell_moduli_alone(random, name.name());
    let fields = random.names.iter().filter(alone).filter_map(|name| match name {
        RandomName::Field { field, first } if !field.expansion.is_drawn() => Some((field, *first)),
        _ => None,
    });
    let fields: Vec<_> = fields.collect();
    let all = Kept::all(random);
    if fields.is_empty() || random.germs.len() <= FEW {
        return Ok(all);
    }
    let paths: Vec<&str> = numbers.iter().map(|number| number.path.as_str()).collect();
    let Some(derivatives) = modulus_derivatives(nominal, solved, &paths)? else { return Ok(all) };
    let mut squares: Vec<Option<Vec<f64>>> = vec![None; random.germs.len()];
    for (field, first) in fields {
        let slopes = slopes(scene, random, solved, &field.name)?;
        for (m, of_mode) in effects(solved, field, &slopes, &derivatives).into_iter().enumerate() {
            squares[first + m] = Some(of_mode.into_iter().map(|g| g * g).collect());
        }
    }
    let total = |k: usize| squares.iter().flatten().map(|squares| squares[k]).sum::<f64>();
    let totals: Vec<f64> = (0..numbers.len()).map(total).collect();
    for shares in squares.iter_mut().flatten() {
        for ((share, total), scale) in shares.iter_mut().zip(&totals).zip(scales) {
            // forces that balance given loads vary by rounding
            *share = if is_rounding(total.sqrt(), *scale) { 0.0 } else { *share / total };
        }
    }
    Ok(Kept::by_shares(random, &squares))
}

/// dE_c/dg of all cells: the modulus of each by the value of a field there, at the nominal outcome.
fn slopes(scene: &Scene, random: &Random, solved: &GridSolved, name: &str) -> Result<Vec<f64>, SolveError> {
    let at = |value: f64| -> Result<Vec<f64>, SolveError> {
        let mut values = random.values(&random.nominal());
        values.insert(name.to_owned(), Value::Constant(value));
        let mut outcome = scene.clone();
        if let Substance::Cells(cells) = &mut outcome.problem.bodies[0].substance
            && let CellModuli::Expression(young) = &mut cells.young
        {
            *young = young.with_values(&values);
        }
        Ok(moduli(&outcome, &solved.body.grid)?)
    };
    let (above, below) = (at(STEP)?, at(-STEP)?);
    Ok(above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * STEP)).collect())
}

/// g_m of all modes of a field and all numbers.
fn effects(solved: &GridSolved, field: &RandomField, slopes: &[f64], derivatives: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let grid = &solved.body.grid;
    let mut effects = vec![vec![0.0; derivatives.len()]; field.expansion.len()];
    for c in grid.body_cells() {
        let modes = field.expansion.modes(field.support.coordinates(grid.centre(c)));
        for (k, derivative) in derivatives.iter().enumerate() {
            let factor = derivative[c] * slopes[c];
            effects.iter_mut().zip(&modes).for_each(|(effect, mode)| effect[k] += factor * mode);
        }
    }
    effects
}
