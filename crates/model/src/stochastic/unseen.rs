//! Outcomes that samples and the points of sparse grids may not have seen: those at the ends of the germs, those with other
//! data, and for sparse grids fresh ones beside polynomials.

use steklov_contact::Solution;
use steklov_problem::Random;
use steklov_stochastic::{Points, Variable, sample, solve_points};

use super::check::{STREAM, wanted};
use super::one_by_one::OneByOne;
use super::outcomes::Answer;
use super::result::{OVERLOOKED, StochasticResult, UNDECIDED, touches};
use super::watch::OutcomesWatch;
use crate::error::SolveError;

/// Samples see an event whose probability is this number over their count with a probability of 95 %.
const LIKELY: f64 = 3.0;
/// Most germs that are taken to their ends one by one, and all together.
const SINGLE: usize = 24;
const CORNERS: usize = 5;
/// Root mean squares of a few residuals are rather too small.
pub(super) const SAFETY: f64 = 1.5;
/// Differences below this part of a value are rounding.
const ROUNDING: f64 = 1e-9;

/// Means of an error and of its square over the tail of a germ that N outcomes are likely to miss, of the probability 1/N, as parts
/// of those at its end: of 1/(1 + c x) with c = 0.995 and N = 100.
pub(super) const TAIL: [f64; 2] = [0.4, 0.2];

/// Outcomes that no point has seen.
pub(super) struct Unseen {
    /// Each with the probability that it may have.
    pub(super) answers: Vec<(Answer, Vec<f64>, f64)>,
    /// How many of the first ones are at an end of one germ, the others nominal.
    pub(super) ends: usize,
    /// Probability of data that are neither known nor excluded.
    pub(super) undecided: f64,
}

/// Whether an answer touches where none of these does, or is open where all of them touch.
pub(super) fn other_contact<'a>(all: &'a [&Answer]) -> impl Fn(&Answer) -> bool + 'a {
    let conditions = all.first().map_or(0, |answer| answer.pressure.len());
    let seen = |i: usize, touching: bool| all.iter().any(|answer| touches(answer, i) == touching);
    let states: Vec<[bool; 2]> = (0..conditions).map(|i| [seen(i, false), seen(i, true)]).collect();
    move |answer| states.iter().enumerate().any(|(i, seen)| !seen[usize::from(touches(answer, i))])
}

/// Solves outcomes at the ends of the germs, where `rarest` is the probability beyond them, and those whose data occur at none
/// of the points; `count` points have been examined, as good as samples.
pub(super) fn unseen(
    outcomes: &OneByOne<'_>,
    random: &Random,
    points: &[Vec<f64>],
    count: usize,
    watch: &OutcomesWatch<'_>,
) -> Result<Unseen, SolveError> {
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let likely = (LIKELY / count as f64).min(1.0);
    let end = |v: &Variable, p: f64, bound: f64| if bound.is_finite() { bound } else { v.quantile(p) };
    let rare = 0.1 / count as f64;
    let ends: Vec<[f64; 2]> = variables
        .iter()
        .map(|v| {
            let [low, high] = v.germ_support();
            [end(v, rare, low), end(v, 1.0 - rare, high)]
        })
        .collect();
    let mut places: Vec<(Vec<f64>, f64)> = Vec::new();
    let nominal = random.nominal();
    for d in 0..ends.len().min(SINGLE) {
        for end in ends[d] {
            let mut germ = nominal.clone();
            germ[d] = end;
            places.push((germ, likely));
        }
    }
    let single = places.len();
    if (2..=CORNERS).contains(&ends.len()) {
        let corner = |k: usize| ends.iter().enumerate().map(|(d, e)| e[k >> d & 1]).collect();
        places.extend((0..1usize << ends.len()).map(|k| (corner(k), likely)));
    }
    let open = outcomes.data.open(&outcomes.data.seen(points), &ends, &variables);
    places.extend(open.found.into_iter().map(|found| (found.germ, found.share.min(likely))));
    let answers = solve_points(places.len(), |i, warm: &mut Option<Solution>| {
        watch.check()?;
        (outcomes.answer)(&places[i].0, warm)
    })?;
    let answers = answers.into_iter().zip(places).map(|(answer, (germ, p))| (answer, germ, p)).collect();
    Ok(Unseen { answers, ends: single, undecided: open.undecided.min(likely) })
}

/// Reports what samples may not have seen: outcomes beyond the range of their values may move the mean by their distance from
/// it times the probability that they may have, which is the `truncation` of the quantity. Where that is more than two
/// standard errors, they are in doubt.
pub(super) fn beside_samples(
    result: &mut StochasticResult,
    outcomes: &OneByOne<'_>,
    random: &Random,
    watch: &OutcomesWatch<'_>,
) -> Result<(), SolveError> {
    let Unseen { answers, undecided, .. } = unseen(outcomes, random, &result.points, result.points.len(), watch)?;
    result.checks = answers.len();
    for (k, quantity) in result.quantities.iter_mut().enumerate() {
        let low = quantity.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = quantity.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let rounding = ROUNDING * low.abs().max(high.abs());
        let error = OVERLOOKED * quantity.standard_error.unwrap_or(0.0);
        let mut most = 0.0f64;
        for (answer, _, probability) in &answers {
            let value = answer.quantities[k];
            let beyond = (low - value).max(value - high).max(0.0);
            if beyond > rounding {
                most = most.max(beyond * probability);
                if beyond * probability > error {
                    result.unseen = Some(result.unseen.map_or(*probability, |u| u.max(*probability)));
                }
            }
        }
        quantity.truncation = Some(most);
    }
    if undecided > UNDECIDED {
        result.unseen = Some(result.unseen.map_or(undecided, |u| u.max(undecided)));
    }
    Ok(())
}

/// Measures the polynomials of a sparse grid by fresh outcomes: their root mean square residual, with what the ends of the germs show
/// of the tails that they may miss, and half as much again, is the `truncation` of a quantity. Ends of germs where contact is as at no point, and other data, join with the probability that they may
/// have; where that makes it more than twice as large they are in doubt.
pub(super) fn beside_grid(
    result: &mut StochasticResult,
    (grid, answers): (&Points, &[Answer]),
    outcomes: &OneByOne<'_>,
    random: &Random,
    watch: &OutcomesWatch<'_>,
) -> Result<(), SolveError> {
    let settings = &random.stochastic;
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let polynomials = grid.polynomials(&variables, settings.level)?;
    let fresh: Vec<Vec<f64>> = (0..wanted(settings, grid.points.len()))
        .map(|i| sample(&variables, settings.seed ^ STREAM, i as u64))
        .collect();
    let drawn = solve_points(fresh.len(), |i, warm: &mut Option<Solution>| {
        watch.check()?;
        (outcomes.answer)(&fresh[i], warm)
    })?;
    let Unseen { answers: places, ends, undecided } = unseen(outcomes, random, &grid.points, fresh.len(), watch)?;
    let all: Vec<&Answer> = answers.iter().chain(&drawn).collect();
    let other = other_contact(&all);
    let seen = outcomes.data.seen(&grid.points);
    let others: Vec<_> =
        places.iter().filter(|(answer, germ, _)| other(answer) || outcomes.data.differ(&seen, germ)).collect();
    result.checks = drawn.len() + others.len();
    for (k, quantity) in result.quantities.iter_mut().enumerate() {
        let residual = |answer: &Answer, germ: &[f64]| {
            let theta = polynomials.evaluate(germ);
            let sum: f64 = theta.iter().zip(&quantity.values).map(|(t, v)| t * v).sum();
            (answer.quantities[k] - sum).powi(2)
        };
        let squared = drawn.iter().zip(&fresh).map(|(a, g)| residual(a, g)).sum::<f64>() / fresh.len() as f64;
        let rounding = (ROUNDING * quantity.mean).powi(2);
        let at_end = places[..ends].iter().map(|(answer, germ, _)| residual(answer, germ)).fold(0.0, f64::max);
        let mut most = squared + TAIL[1] * at_end / fresh.len() as f64;
        for (answer, germ, probability) in &others {
            let with = squared + probability * residual(answer, germ);
            most = most.max(with);
            if with > OVERLOOKED * OVERLOOKED * squared.max(rounding) {
                result.unseen = Some(result.unseen.map_or(*probability, |u| u.max(*probability)));
            }
        }
        quantity.truncation = Some(SAFETY * most.sqrt());
    }
    if undecided > UNDECIDED {
        result.unseen = Some(result.unseen.map_or(undecided, |u| u.max(undecided)));
    }
    Ok(())
}
