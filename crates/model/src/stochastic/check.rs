//! Fresh outcomes beside the polynomials of their cells: the error that is measured.

use steklov_contact::Solution;
use steklov_problem::Stochastic;
use steklov_stochastic::{StochasticMesh, sample, solve_points};

use super::events::Unanimous;
use super::outcome_checks::{Miss, Residual, residual};
use super::outcomes::{Answer, Outcomes};

use super::surrogate::Cell;
use super::watch::OutcomesWatch;
use crate::error::SolveError;

/// Number of samples at which polynomials say whether contact or stick differ from all nodes.
const SCREENED: usize = 2000;
/// Number of outcomes that are solved among those where they do.
const CHANGED: usize = 16;
/// Smallest and largest number of the others, and their number times the tolerance.
const FEWEST: usize = 8;
const MOST: usize = 1000;
const PER_TOLERANCE: f64 = 0.1;
/// These samples are not those of quantiles.
pub(super) const STREAM: u64 = 0x636865636b;

/// The errors that fresh outcomes show.
pub(super) struct Check {
    /// Outcomes that were solved.
    pub(super) outcomes: usize,
    /// Means of the squared errors.
    pub(super) residual: Residual,
    /// Mean of the squared energy norm.
    pub(super) energy: f64,
    /// Share of it in each cell.
    by_cell: Vec<f64>,
    /// The outcome of each cell with the largest error.
    worst: Vec<Option<(Vec<f64>, f64)>>,
}

/// Number of outcomes that are drawn where no change is foreseen: half the number of nodes, but no more than the tolerance
/// needs.
pub(super) fn wanted(settings: &Stochastic, nodes: usize) -> usize {
    let needed = ((PER_TOLERANCE / settings.tolerance).ceil() as usize).clamp(FEWEST, MOST);
    (nodes / 2).clamp(FEWEST, needed)
}

/// Solves fresh outcomes, in two strata: where polynomials foresee contact or stick that differ from all nodes of their cell, and
/// the rest. `round` counts such samples: none is used twice.
pub(super) fn check(
    outcomes: &Outcomes<'_>,
    mesh: &StochasticMesh,
    cells: &[&Cell],
    settings: &Stochastic,
    round: usize,
    watch: &OutcomesWatch<'_>,
) -> Result<Check, SolveError> {
    let draw = |i: usize| sample(&mesh.variables, settings.seed ^ STREAM, (round * SCREENED + i) as u64);
    let foreseen: Vec<Unanimous<'_>> = cells.iter().map(|c| Unanimous::new(&c.basis, &c.answers, &[])).collect();
    let data: Vec<_> = cells.iter().map(|c| outcomes.data.seen(&c.basis.points)).collect();
    let mut strata: [Vec<(usize, Vec<f64>)>; 2] = Default::default();
    for germ in (0..SCREENED).map(draw) {
        let cell = mesh.locate(&germ).unwrap_or(0);
        let changed = foreseen[cell].beyond(&germ) > 0.0 || outcomes.data.differ(&data[cell], &germ);
        strata[usize::from(changed)].push((cell, germ));
    }
    let nodes = cells.iter().map(|c| c.answers.len()).sum();
    let mut points: Vec<(usize, Vec<f64>, f64)> = Vec::new();
    for (stratum, most) in strata.into_iter().zip([wanted(settings, nodes), CHANGED]) {
        let count = stratum.len().min(most);
        let weight = stratum.len() as f64 / (SCREENED * count.max(1)) as f64;
        points.extend(stratum.into_iter().take(count).map(|(cell, germ)| (cell, germ, weight)));
    }
    let answers = solve_points(points.len(), |i, warm: &mut Option<Solution>| {
        watch.check()?;
        outcomes.answer(&points[i].1, warm)
    })?;
    let mut check = Check {
        outcomes: points.len(),
        residual: Residual { squared: 0.0, quantities: vec![0.0; outcomes.numbers.len()] },
        energy: 0.0,
        by_cell: vec![0.0; cells.len()],
        worst: vec![None; cells.len()],
    };
    for ((cell, germ, weight), answer) in points.into_iter().zip(&answers) {
        let one = residual(outcomes, &cells[cell].basis, &cells[cell].answers, &germ, answer);
        check.energy += weight * 2.0 * answer.strain;
        check.residual.squared += weight * one.squared;
        check.residual.quantities.iter_mut().zip(&one.quantities).for_each(|(sum, q)| *sum += weight * q);
        check.by_cell[cell] += weight * one.squared;
        if check.worst[cell].as_ref().is_none_or(|w| one.squared > w.1) {
            check.worst[cell] = Some((germ, one.squared));
        }
    }
    Ok(check)
}

impl Check {
    /// The misses of the cells that together have the part `share` of the squared error: in the direction which, changed
    /// alone, makes the worst outcome of the cell differ most from the nearest node. Returns them with their cells, and the
    /// number of outcomes solved for this.
    pub(super) fn misses(
        &self,
        outcomes: &Outcomes<'_>,
        cells: &[&Cell],
        share: f64,
    ) -> Result<(Vec<(usize, Miss)>, usize), SolveError> {
        let mut order: Vec<usize> = (0..cells.len()).collect();
        order.sort_by(|&a, &b| self.by_cell[b].total_cmp(&self.by_cell[a]));
        let (mut found, mut solved, mut sum) = (Vec::new(), 0, 0.0);
        for c in order {
            let (Some((germ, _)), true) = (&self.worst[c], sum < share * self.residual.squared) else { break };
            sum += self.by_cell[c];
            let cell = cells[c];
            let nearest = nearest(cell, germ);
            let along = |d: usize| {
                let mut place = nearest.clone();
                place[d] = germ[d];
                place
            };
            let places: Vec<Vec<f64>> = (0..germ.len()).map(along).collect();
            let answers: Vec<Answer> =
                solve_points(places.len(), |d, _: &mut ()| outcomes.answer(&places[d], &mut None))?;
            solved += places.len();
            let of = |d: usize| residual(outcomes, &cell.basis, &cell.answers, &places[d], &answers[d]).squared;
            let residuals: Vec<f64> = (0..germ.len()).map(of).collect();
            let Some(direction) = (0..germ.len()).max_by(|&a, &b| residuals[a].total_cmp(&residuals[b])) else {
                continue;
            };
            let change = Unanimous::new(&cell.basis, &cell.answers, &answers).change(
                direction,
                &nearest,
                &places[direction],
                0.0,
            );
            let on_way = |t: f64| nearest[direction] + t * (germ[direction] - nearest[direction]);
            let residual = Residual { squared: self.by_cell[c], quantities: vec![0.0; outcomes.numbers.len()] };
            let at = Some(on_way(change.unwrap_or(0.5)));
            found.push((c, Miss { direction, at, event: change.is_some(), residual }));
        }
        Ok((found, solved))
    }
}

/// The node next to a germ, in units of the spread of the nodes.
fn nearest(cell: &Cell, germ: &[f64]) -> Vec<f64> {
    let points = &cell.basis.points;
    let spread = |d: usize| {
        let all = || points.iter().map(|p| p[d]);
        (all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)).max(f64::MIN_POSITIVE)
    };
    let units: Vec<f64> = (0..germ.len()).map(spread).collect();
    let apart = |p: &&Vec<f64>| p.iter().zip(germ).zip(&units).map(|((p, g), u)| ((p - g) / u).powi(2)).sum::<f64>();
    points
        .iter()
        .min_by(|a, b| apart(a).total_cmp(&apart(b)))
        .unwrap_or_else(|| unreachable!("a cell has nodes"))
        .clone()
}
