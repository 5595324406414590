//! Multilevel Monte Carlo: differences between grids of a family, many on coarse grids and few on fine ones.

use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_contact::Solution;
use steklov_problem::{Random, Scene};
use steklov_stochastic::{Variable, cost_of_levels, outcomes_of_levels, sample, solve_points};

use super::jumps::InGerms;
use super::kept::Kept;
use super::number::Number;
use super::on_grid::{OutcomesOnGrid, numbers_of};
use super::one_by_one::OneByOne;
use super::outcomes::Answer;
use super::result::{End, Level, StochasticResult, of_grid};
use super::spread::{is_rounding, spread};
use super::unseen::beside_samples;
use super::watch::OutcomesWatch;
use crate::error::SolveError;
use crate::grid::GridLayout;

/// Outcomes of the coarsest level before numbers are chosen; half as many on each finer one, but not fewer than the second.
const PILOT: usize = 64;
const FEWEST: usize = 16;
/// Most levels.
const LEVELS: usize = 8;
/// Fewest cells of the coarsest grid along either axis.
const COARSEST: usize = 2;
/// The variance of a difference is not taken as smaller than this part of that of the level before: of few outcomes it may be
/// far too small by chance.
const FALL: f64 = 1.0 / 32.0;
/// Factor by which the outcomes of a level grow at most before the variances are looked at again.
const GROWTH: usize = 4;
/// A solution costs 1 + n/A + n^(3/2)/B of its least cost on n cells: the ratios are those of measured seconds.
const LINEAR: f64 = 55.0;
const FILL: f64 = 6000.0;

/// A grid of the family.
struct Grid<'a> {
    outcomes: OutcomesOnGrid<'a>,
    /// Outcomes of the germs of the next finer grid, where those of its own germs have other fields of the same law.
    of_finer: Option<OutcomesOnGrid<'a>>,
    cells: [usize; 2],
    cost: f64,
}

/// The outcomes of a difference.
#[derive(Default)]
struct Drawn {
    germs: Vec<Vec<f64>>,
    fine: Vec<Answer>,
    /// On the next coarser grid, for the same germs; none for the coarsest one.
    coarse: Vec<Answer>,
}

/// The family of grids of a scene whose finest one has a layout, from the coarsest on.
///
/// # Errors
/// Those of [`OutcomesOnGrid::new`].
fn family<'a>(scene: &Scene, random: &'a Random, layout: &GridLayout) -> Result<Vec<Grid<'a>>, SolveError> {
    let mut family: Vec<Grid<'_>> = Vec::new();
    let mut next = Some((scene.clone(), layout.clone()));
    while let Some((given, layout)) = next.take().filter(|_| family.len() < LEVELS) {
        let (scene, of_finer) = match given.redrawn() {
            Some(own) => (own, Some(given)),
            None => (given, None),
        };
        let Some(input) = scene.body().grid else { break };
        let cells = input.cells().map(|n| n * layout.parts);
        if cells.iter().any(|n| *n < COARSEST) {
            break;
        }
        next = match layout.parts.is_multiple_of(2) {
            true => Some((scene.clone(), GridLayout { parts: layout.parts / 2, ..layout.clone() })),
            false if layout.parts == 1 => scene.coarsened().map(|coarse| (coarse, layout.clone())),
            false => None,
        };
        let n = (cells[0] * cells[1]) as f64;
        let of_finer = of_finer.map(|scene| OutcomesOnGrid::new(scene, random, layout.clone())).transpose()?;
        let outcomes = OutcomesOnGrid::new(scene, random, layout)?;
        family.push(Grid { outcomes, of_finer, cells, cost: 1.0 + n / LINEAR + n.powf(1.5) / FILL });
    }
    family.reverse();
    Ok(family)
}

/// The levels of a scene on its way to the tolerance.
struct Levels<'a> {
    random: &'a Random,
    variables: Vec<Variable>,
    numbers: &'a [Number],
    /// The largest nominal value of those of one scale with each number.
    scales: &'a [f64],
    family: Vec<Grid<'a>>,
    drawn: Vec<Drawn>,
    /// The coarsest level in use.
    start: usize,
}

impl Levels<'_> {
    /// The answer to germs on a grid of the family.
    fn answer(&self, level: usize, germs: &[f64]) -> Result<Answer, SolveError> {
        self.answer_of(&self.family[level].outcomes, germs)
    }

    /// The answer to germs of a grid on the next coarser one.
    fn coarser_answer(&self, level: usize, germs: &[f64]) -> Result<Answer, SolveError> {
        let coarser = &self.family[level - 1];
        self.answer_of(coarser.of_finer.as_ref().unwrap_or(&coarser.outcomes), germs)
    }

    fn answer_of(&self, outcomes: &OutcomesOnGrid<'_>, germs: &[f64]) -> Result<Answer, SolveError> {
        let (outcome, solved) = outcomes.solve(germs)?;
        Ok(numbers_of(&outcome, &solved, self.numbers))
    }

    /// Draws outcomes of a level up to a number of them; `total` are wanted on all levels.
    fn draw(&mut self, level: usize, count: usize, total: usize, watch: &OutcomesWatch<'_>) -> Result<(), SolveError> {
        let have = self.drawn[level].fine.len();
        let done = AtomicUsize::new(self.drawn.iter().map(|drawn| drawn.fine.len()).sum());
        let seed = self.random.stochastic.seed.wrapping_add((level as u64) << 40);
        let new = solve_points(count.saturating_sub(have), |i, (): &mut ()| {
            watch.check()?;
            let germs = sample(&self.variables, seed, (have + i) as u64);
            let fine = self.answer(level, &germs)?;
            let coarse = if level > self.start { Some(self.coarser_answer(level, &germs)?) } else { None };
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            watch.tell(done, total.max(done));
            Ok::<_, SolveError>((germs, fine, coarse))
        })?;
        let drawn = &mut self.drawn[level];
        for (germs, fine, coarse) in new {
            drawn.germs.push(germs);
            drawn.fine.push(fine);
            drawn.coarse.extend(coarse);
        }
        Ok(())
    }

    /// Variance of a quantity on a level, and of its difference from the coarser one.
    fn variances(&self, level: usize, quantity: usize) -> [f64; 2] {
        let Drawn { fine, coarse, .. } = &self.drawn[level];
        let values = |i: usize| fine[i].quantities[quantity];
        let differences = |i: usize| values(i) - coarse.get(i).map_or(0.0, |c| c.quantities[quantity]);
        [spread(fine.len(), &values), spread(fine.len(), &differences)]
    }

    /// Variances of the levels of a quantity from a start on, of differences those that few outcomes do not make too small.
    fn of_quantity(&self, start: usize, quantity: usize) -> Vec<f64> {
        let mut all: Vec<f64> = Vec::new();
        for level in start..self.family.len() {
            let [value, difference] = self.variances(level, quantity);
            let few = self.drawn[level].fine.len() < PILOT;
            let least = all.last().filter(|_| few && level > start).map_or(0.0, |before| FALL * before);
            all.push(if level == start { value } else { difference.max(least) });
        }
        all
    }

    /// Standard error of the variance of a quantity of this mean: that of the differences of its squared deviations.
    fn variance_error(&self, quantity: usize, mean: f64) -> f64 {
        let of_level = |drawn: &Drawn| {
            let squared = |answer: &Answer| (answer.quantities[quantity] - mean).powi(2);
            let difference = |i: usize| squared(&drawn.fine[i]) - drawn.coarse.get(i).map_or(0.0, squared);
            spread(drawn.fine.len(), &difference) / drawn.fine.len() as f64
        };
        self.drawn[self.start..].iter().map(of_level).sum::<f64>().sqrt()
    }

    /// Costs of an outcome of each level from a start on.
    fn costs(&self, start: usize) -> Vec<f64> {
        let own = |l: usize| self.family[l].cost;
        (start..self.family.len()).map(|l| own(l) + if l > start { own(l - 1) } else { 0.0 }).collect()
    }

    /// Quantities that vary, with the variance on the finest grid, from all differences.
    fn varying(&self) -> Vec<(usize, f64)> {
        let total = |k: usize| -> f64 {
            let change = |l: usize| {
                let drawn = &self.drawn[l];
                let of = |answers: &[Answer]| spread(answers.len(), &|i| answers[i].quantities[k]);
                of(&drawn.fine) - if l > self.start { of(&drawn.coarse) } else { 0.0 }
            };
            let first = self.variances(self.start, k)[0];
            (self.start..self.family.len()).map(change).sum::<f64>().max(0.25 * first)
        };
        let mean = |k: usize| self.drawn[self.start].fine.iter().map(|a| a.quantities[k]).sum::<f64>();
        let count = self.drawn[self.start].fine.len() as f64;
        let all = (0..self.numbers.len()).map(|k| (k, total(k)));
        all.filter(|(k, variance)| !is_rounding(variance.sqrt(), self.scales[*k].max((mean(*k) / count).abs())))
            .collect()
    }

    /// The start with which the tolerance costs least.
    fn best_start(&self) -> usize {
        let cost = |start: usize| -> f64 {
            let costs = self.costs(start);
            let of = |(k, variance): &(usize, f64)| cost_of_levels(&self.of_quantity(start, *k), &costs) / variance;
            self.varying().iter().map(of).fold(0.0, f64::max)
        };
        (0..self.family.len()).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(0)
    }

    /// The numbers of outcomes that the tolerance needs now.
    fn wanted(&self) -> Vec<f64> {
        let costs = self.costs(self.start);
        let mut wanted = vec![0.0f64; costs.len()];
        for (k, variance) in self.varying() {
            let error = self.random.stochastic.tolerance * variance.sqrt();
            let counts = outcomes_of_levels(&self.of_quantity(self.start, k), &costs, error);
            wanted.iter_mut().zip(counts).for_each(|(w, n)| *w = w.max(n.ceil()));
        }
        wanted
    }
}

/// Samples differences between the grids of a family until the standard error of each mean is `tolerance` times the standard
/// deviation of the quantity, at the least cost.
///
/// *Use when*: numbers are Lipschitz in the germs, of scenes on grids with cells that can be halved. *Fails when*: they jump, as
/// probabilities of contact: then few outcomes do not see the variance of a difference. *Cost*: with V_l ~ h⁴ and C_l ~ h⁻³ that
/// of `tolerance`⁻² solutions on coarse grids.
///
/// # Errors
/// An outcome that is impossible on one of the grids; [`SolveError::Interrupted`].
///
/// Source: Giles, Operations Research 56 (2008); Cliffe, Giles, Scheichl and Teckentrup, Computing and Visualization in
/// Science 14 (2011).
pub(super) fn of_levels(
    (scene, layout): (&Scene, &GridLayout),
    random: &Random,
    (numbers, scales): (&[Number], &[f64]),
    watch: &OutcomesWatch<'_>,
) -> Result<StochasticResult, SolveError> {
    let settings = &random.stochastic;
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let family = family(scene, random, layout)?;
    let drawn = family.iter().map(|_| Drawn::default()).collect();
    let mut levels = Levels { random, variables, numbers, scales, family, drawn, start: 0 };
    let most = (settings.max_nodes / levels.family.len()).max(2);
    for level in 0..levels.family.len() {
        levels.draw(level, (PILOT >> level).max(FEWEST).min(most), 2 * PILOT, watch)?;
    }
    levels.start = levels.best_start();
    for drawn in &mut levels.drawn[levels.start..=levels.start] {
        drawn.coarse.clear();
    }
    let end = loop {
        let have = |l: usize, levels: &Levels<'_>| levels.drawn[levels.start + l].fine.len();
        let wanted = levels.wanted();
        let total = wanted.iter().sum::<f64>().min(settings.max_nodes as f64) as usize;
        let next: Vec<usize> = (0..wanted.len()).map(|l| (wanted[l] as usize).min(GROWTH * have(l, &levels))).collect();
        if (0..wanted.len()).all(|l| next[l] <= have(l, &levels)) {
            break End::Tolerance;
        }
        if (0..wanted.len()).map(|l| next[l].max(have(l, &levels))).sum::<usize>() > settings.max_nodes {
            break End::MaxNodes;
        }
        for (l, count) in next.into_iter().enumerate() {
            levels.draw(levels.start + l, count, total, watch)?;
        }
    };
    gathered(&levels, end, scene, watch)
}

/// The statistics of the differences: each outcome on a grid is a point whose weight is 1/N of its level, on the coarser grid
/// -1/N.
fn gathered(
    levels: &Levels<'_>,
    end: End,
    scene: &Scene,
    watch: &OutcomesWatch<'_>,
) -> Result<StochasticResult, SolveError> {
    let (mut points, mut weights, mut answers) = (Vec::new(), Vec::new(), Vec::new());
    for Drawn { germs, fine, coarse } in &levels.drawn[levels.start..] {
        for (sign, members) in [(1.0, fine), (-1.0, coarse)] {
            points.extend(germs.iter().take(members.len()).cloned());
            weights.extend(members.iter().map(|_| sign / fine.len() as f64));
            answers.extend(members.iter().cloned());
        }
    }
    let mut result = of_grid(points, weights, &answers, levels.numbers)?;
    let count = |l: usize| levels.drawn[l].fine.len();
    for (k, quantity) in result.quantities.iter_mut().enumerate() {
        let of_level = |l: usize| levels.variances(l, k)[usize::from(l > levels.start)] / count(l) as f64;
        quantity.standard_error = Some((levels.start..levels.family.len()).map(of_level).sum::<f64>().sqrt());
        quantity.variance_error = Some(levels.variance_error(k, quantity.mean));
    }
    result.levels = (levels.start..levels.family.len())
        .map(|l| Level {
            cells: levels.family[l].cells,
            outcomes: count(l),
            cost: levels.costs(levels.start)[l - levels.start] / levels.family[levels.family.len() - 1].cost,
            variances: (0..levels.numbers.len())
                .map(|k| levels.variances(l, k)[usize::from(l > levels.start)])
                .collect(),
        })
        .collect();
    result.end = end;
    beside_coarsest(&mut result, levels, scene, watch)?;
    Ok(result)
}

/// Looks at outcomes that the samples of the coarsest grid may not have seen, on that grid.
fn beside_coarsest(
    result: &mut StochasticResult,
    levels: &Levels<'_>,
    scene: &Scene,
    watch: &OutcomesWatch<'_>,
) -> Result<(), SolveError> {
    let Drawn { germs, fine, .. } = &levels.drawn[levels.start];
    let equal = vec![1.0 / fine.len() as f64; fine.len()];
    let mut coarsest = of_grid(germs.clone(), equal, fine, levels.numbers)?;
    for (own, all) in coarsest.quantities.iter_mut().zip(&result.quantities) {
        own.standard_error = all.standard_error;
    }
    let data = InGerms::new(scene, levels.random);
    let answer = |germs: &[f64], _: &mut Option<Solution>| levels.answer(levels.start, germs);
    let (numbers, scales) = (levels.numbers, levels.scales);
    let kept = Kept::all(levels.random);
    let one_by_one = OneByOne { numbers, scales, data: &data, answer: &answer, kept, block: 1 };
    beside_samples(&mut coarsest, &one_by_one, levels.random, watch)?;
    (result.checks, result.unseen) = (coarsest.checks, coarsest.unseen);
    // errors that outcomes of other contact or data may have are not in the standard errors
    if result.unseen.is_some() && result.end == End::Tolerance {
        result.end = End::Rounds;
    }
    for (own, all) in coarsest.quantities.iter().zip(&mut result.quantities) {
        all.truncation = own.truncation;
    }
    Ok(())
}
