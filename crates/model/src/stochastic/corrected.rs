//! Polynomials of a sparse grid, corrected by fresh outcomes: the mean of each quantity without bias, with as many points and
//! outcomes as a tolerance needs.
//!
//! ```text
//! S(ξ) = Σ_j θ_j(ξ) Q_j        mean = E S + 1/N Σ_i (Q - S)(ξ_i) = Σ_j (w_j - 1/N Σ_i θ_j(ξ_i)) Q_j + 1/N Σ_i Q_i
//! ```
//! Its standard error is that of the residuals Q - S alone. Grid and outcomes are points of one rule, whose weights have both
//! signs. S need not know all germs: what others do is in the residuals.

use steklov_problem::{Random, Sampling, Stochastic};
use steklov_stochastic::{Points, SparsePolynomials, Variable, sample, smolyak};

use super::in_body::BodySums;
use super::kept::about_points;
use super::one_by_one::OneByOne;
use super::outcomes::Answer;
use super::result::{End, OVERLOOKED, StochasticResult, UNDECIDED, of_grid};
use super::samples::of_samples;
use super::spread::{is_rounding, spread};
use super::stage::OutcomeStage;
use super::unseen::{TAIL, Unseen, beside_samples, other_contact, unseen};
use super::watch::OutcomesWatch;
use crate::error::SolveError;

/// Fresh outcomes at first, and the number from which on their root mean square is believed.
const FEW: usize = 16;
const MANY: usize = 64;
/// Factors by which root mean squares of fewer, and of more of them, are rather too small.
const SAFETY: [f64; 2] = [1.5, 1.1];
/// A level whose residuals are more than this part of those before is the last one.
const FALLS: f64 = 0.7;
/// Part of the variance of outcomes alone below which the corrected one is not believed.
const FEWEST: f64 = 0.25;
/// Factor by which the number of outcomes grows at most before residuals are looked at again.
const GROWTH: usize = 4;

/// Fresh outcomes.
#[derive(Default)]
struct Fresh {
    germs: Vec<Vec<f64>>,
    answers: Vec<Answer>,
    in_body: BodySums,
}

/// The polynomials of a sparse grid.
struct Surrogate {
    /// The germs of the polynomials, rising; the points of the grid have the nominal values of the others.
    kept: Vec<usize>,
    grid: Points,
    polynomials: SparsePolynomials,
    answers: Vec<Answer>,
    in_body: BodySums,
}

/// What grid and fresh outcomes say of a quantity.
struct Measured {
    mean: f64,
    /// Standard error of the mean.
    mean_error: f64,
    variance: f64,
    /// Standard error of the variance.
    variance_error: f64,
    /// Mean of (Q - S)².
    residual: f64,
}

impl Surrogate {
    /// The polynomials of a level from the points of a grid of the germs that are kept.
    fn new(
        mut grid: Points,
        (kept, level): (Vec<usize>, usize),
        outcomes: &OneByOne<'_>,
        random: &Random,
        watch: &OutcomesWatch<'_>,
    ) -> Result<Self, SolveError> {
        let variables: Vec<Variable> = kept.iter().map(|&germ| random.germs[germ].variable.clone()).collect();
        let polynomials = grid.polynomials(&variables, level)?;
        let nominal = random.nominal();
        for point in &mut grid.points {
            let mut all = nominal.clone();
            kept.iter().zip(&*point).for_each(|(&germ, x)| all[germ] = *x);
            *point = all;
        }
        // those of the level that is kept are handed on with the fresh ones
        let (answers, in_body) = outcomes.at_points(&grid, watch, &mut |_| Ok(()))?;
        Ok(Self { kept, grid, polynomials, answers, in_body })
    }

    /// θ_j at germs.
    fn theta(&self, germs: &[f64]) -> Vec<f64> {
        let kept: Vec<f64> = self.kept.iter().map(|&germ| germs[germ]).collect();
        self.polynomials.evaluate(&kept)
    }

    /// The values of the polynomials of all quantities at germs.
    fn values(&self, germs: &[f64]) -> Vec<f64> {
        let theta = self.theta(germs);
        let quantities = self.answers.first().map_or(0, |answer| answer.quantities.len());
        let value = |k: usize| theta.iter().zip(&self.answers).map(|(theta, a)| theta * a.quantities[k]).sum();
        (0..quantities).map(value).collect()
    }

    /// Weights of the points of the grid.
    fn weights(&self, fresh: &Fresh) -> Vec<f64> {
        let mut weights = self.grid.weights.clone();
        for germs in &fresh.germs {
            let theta = self.theta(germs);
            weights.iter_mut().zip(theta).for_each(|(w, theta)| *w -= theta / fresh.germs.len() as f64);
        }
        weights
    }

    /// All quantities: mean E S + E(Q - S) and variance Var S + E(2 (S - E S) (Q - S) + (Q - S)²) - (E(Q - S))².
    fn measured(&self, fresh: &Fresh) -> Vec<Measured> {
        let count = fresh.answers.len();
        let at_fresh: Vec<Vec<f64>> = fresh.germs.iter().map(|germs| self.values(germs)).collect();
        let of = |k: usize| {
            let on_grid: Vec<f64> = self.answers.iter().map(|answer| answer.quantities[k]).collect();
            let by_grid: f64 = self.grid.weights.iter().zip(&on_grid).map(|(w, q)| w * q).sum();
            let value = |i: usize| fresh.answers[i].quantities[k];
            let residual = |i: usize| value(i) - at_fresh[i][k];
            let rest = |i: usize| (2.0 * (at_fresh[i][k] - by_grid) + residual(i)) * residual(i);
            let mean_of = |of: &dyn Fn(usize) -> f64| (0..count).map(of).sum::<f64>() / count as f64;
            let error_of = |of: &dyn Fn(usize) -> f64| (spread(count, of) / count as f64).sqrt();
            let shift = mean_of(&residual);
            let variance = self.polynomials.variance(&on_grid) + mean_of(&rest) - shift * shift;
            let of_outcomes = spread(count, &value);
            Measured {
                mean: by_grid + shift,
                mean_error: error_of(&residual),
                // what is left of large terms of both signs may be nothing, or less
                variance: if variance > FEWEST * of_outcomes { variance } else { of_outcomes },
                variance_error: error_of(&rest),
                residual: mean_of(&|i| residual(i).powi(2)),
            }
        };
        (0..self.answers.first().map_or(0, |answer| answer.quantities.len())).map(of).collect()
    }
}

/// Solves until the standard error of each mean is `tolerance` times the standard deviation of the quantity: the level of the
/// sparse grid and the number of fresh outcomes are those that cost least. Where polynomials say nothing, samples alone.
///
/// *Use when*: a tolerance is asked for with many germs, or of each outcome a body of its own is solved. *Fails when*: outcomes
/// with other contact or data are so rare that `max_nodes` do not find them: then they are in doubt. *Cost*: a solution for each
/// point of the grid and each of about (r / tolerance)² outcomes, r the residual of the polynomials over the deviation.
///
/// # Errors
/// An outcome that is impossible; an observer that fails; [`SolveError::Interrupted`].
pub(super) fn of_corrected(
    outcomes: &OneByOne<'_>,
    random: &Random,
    watch: &OutcomesWatch<'_>,
    observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
) -> Result<StochasticResult, SolveError> {
    let settings = &random.stochastic;
    let mut rule = Rule { outcomes, random, fresh: Fresh::default() };
    rule.draw(FEW.min(settings.max_nodes / 2), watch)?;
    let Some(surrogate) = rule.surrogate(watch)? else { return samples_alone(outcomes, random, watch, observe) };
    // a grid has half of them at most
    let most = settings.max_nodes - surrogate.answers.len();
    let (mut end, mut missed);
    loop {
        end = loop {
            let have = rule.fresh.answers.len();
            let wanted = rule.wanted(&surrogate);
            if wanted <= have {
                break End::Tolerance;
            }
            if have >= most {
                break End::MaxNodes;
            }
            rule.draw(wanted.min(GROWTH * have).min(most), watch)?;
        };
        missed = rule.missed(&surrogate, watch)?;
        let have = rule.fresh.answers.len();
        let wanted = match missed.probability {
            Some(_) => GROWTH * have,
            None => (missed.excess.min(GROWTH as f64) * have as f64).ceil() as usize,
        };
        if wanted <= have || have >= most {
            break;
        }
        rule.draw(wanted.min(most), watch)?;
    }
    if end == End::Tolerance {
        end = match missed.probability {
            Some(_) => End::Rounds,
            None if missed.excess > 1.0 => End::MaxNodes,
            None => End::Tolerance,
        };
    }
    rule.gathered(surrogate, missed, end, observe)
}

/// Samples, as many as the tolerance needs.
fn samples_alone(
    outcomes: &OneByOne<'_>,
    random: &Random,
    watch: &OutcomesWatch<'_>,
    observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
) -> Result<StochasticResult, SolveError> {
    let wanted = (1.0 / random.stochastic.tolerance.powi(2)).ceil();
    let samples = wanted.min(random.stochastic.max_nodes as f64) as usize;
    let stochastic = Stochastic { method: Sampling::MonteCarlo, samples, ..random.stochastic.clone() };
    let random = &Random { stochastic, ..random.clone() };
    let variables: Vec<Variable> = random.germs.iter().map(|g| g.variable.clone()).collect();
    let mut result = of_samples(outcomes, &variables, random, watch, observe)?;
    beside_samples(&mut result, outcomes, random, watch)?;
    result.end = match result.unseen {
        _ if (samples as f64) < wanted => End::MaxNodes,
        Some(_) => End::Rounds,
        None => End::Tolerance,
    };
    Ok(result)
}

/// What outcomes that no point has seen may do.
struct Missed {
    /// By how much they may shift the mean of each quantity.
    shifts: Vec<f64>,
    /// Probability that they may have, where that counts.
    probability: Option<f64>,
    /// By how much the tails of the germs, in which no outcome may lie, shift mean and variance of each quantity.
    tails: Vec<[f64; 2]>,
    /// The largest squared error of a mean, with that, over the squared tolerance.
    excess: f64,
    /// How many were solved.
    looked: usize,
}

/// A rule on its way to the tolerance.
struct Rule<'a> {
    outcomes: &'a OneByOne<'a>,
    random: &'a Random,
    fresh: Fresh,
}

impl Rule<'_> {
    fn variables(&self) -> Vec<Variable> {
        self.random.germs.iter().map(|g| g.variable.clone()).collect()
    }

    /// Draws fresh outcomes up to a number of them.
    fn draw(&mut self, count: usize, watch: &OutcomesWatch<'_>) -> Result<(), SolveError> {
        let (have, variables, seed) = (self.fresh.answers.len(), self.variables(), self.random.stochastic.seed);
        let germs = |i: usize| sample(&variables, seed, (have + i) as u64);
        let fresh = &mut self.fresh;
        self.outcomes.stream(count.saturating_sub(have), &germs, watch, &mut |_, germs, answers| {
            fresh.germs.extend(germs);
            for mut answer in answers {
                fresh.in_body.push(1.0, &std::mem::take(&mut answer.in_body));
                fresh.answers.push(answer);
            }
            Ok(())
        })
    }

    /// What is measured of the quantities that vary.
    fn varying(&self, surrogate: &Surrogate) -> Vec<Measured> {
        let all = surrogate.measured(&self.fresh).into_iter().enumerate();
        let scale = |k: usize, measured: &Measured| self.outcomes.scales[k].max(measured.mean.abs());
        all.filter(|(k, m)| !is_rounding(m.variance.sqrt(), scale(*k, m))).map(|(_, m)| m).collect()
    }

    /// The largest residual of polynomials over the deviation of a quantity, with its safety.
    fn misfit(&self, surrogate: &Surrogate) -> f64 {
        let safety = SAFETY[usize::from(self.fresh.answers.len() >= MANY)];
        let of = |m: &Measured| safety * (m.residual / m.variance).sqrt();
        self.varying(surrogate).iter().map(of).fold(0.0, f64::max)
    }

    /// Fresh outcomes that a misfit needs.
    fn needed(&self, misfit: f64) -> f64 {
        (misfit / self.random.stochastic.tolerance).powi(2).ceil().max(FEW as f64)
    }

    fn wanted(&self, surrogate: &Surrogate) -> usize {
        // fields of the germs that polynomials do not have are those of the outcomes
        let least = if surrogate.kept.len() < self.random.germs.len() { MANY } else { FEW };
        (self.needed(self.misfit(surrogate)).min(1e15) as usize).max(least)
    }

    /// The polynomials with which the tolerance costs least; none if samples alone do.
    fn surrogate(&mut self, watch: &OutcomesWatch<'_>) -> Result<Option<Surrogate>, SolveError> {
        let most = self.random.stochastic.max_nodes as f64;
        // of the germs of the polynomials alone, and of all
        let (mut best, mut within, mut misfit) = (None, 1.0f64, 1.0f64);
        // by which the next level is expected to change the first one: as the last one did
        let mut falls = 0.0;
        for level in 1.. {
            let kept = self.outcomes.kept.at_level(level, self.random.stochastic.tolerance);
            if kept.is_empty() {
                break;
            }
            let left_out = self.outcomes.kept.left_out(kept.len());
            if about_points(kept.len(), level) > 2.0 * most {
                break;
            }
            let variables: Vec<Variable> = kept.iter().map(|&g| self.random.germs[g].variable.clone()).collect();
            let Ok(grid) = smolyak(&variables, level) else { break };
            let points = grid.points.len() as f64;
            let expected = (left_out + (within * falls).powi(2)).sqrt();
            if points > 0.5 * most || points + self.needed(expected) >= self.needed(misfit) {
                break;
            }
            let next = Surrogate::new(grid, (kept, level), self.outcomes, self.random, watch)?;
            let mut own = self.misfit(&next);
            if self.needed(own) > MANY as f64 && (own >= misfit || own > FALLS * misfit) {
                // one outcome far out among few decides nothing
                self.draw(MANY.min(self.random.stochastic.max_nodes / 2), watch)?;
                own = self.misfit(&next);
            }
            if own >= misfit {
                break;
            }
            let own_within = (own * own - left_out).max(0.0).sqrt();
            (falls, within, misfit, best) = (own_within / within, own_within, own, Some(next));
            if falls > FALLS {
                break;
            }
        }
        Ok(best)
    }

    /// Looks at outcomes with other contact or data than all that are solved.
    fn missed(&self, surrogate: &Surrogate, watch: &OutcomesWatch<'_>) -> Result<Missed, SolveError> {
        let points: Vec<Vec<f64>> = surrogate.grid.points.iter().chain(&self.fresh.germs).cloned().collect();
        let all: Vec<&Answer> = surrogate.answers.iter().chain(&self.fresh.answers).collect();
        let Unseen { answers, ends, undecided } =
            unseen(self.outcomes, self.random, &points, self.fresh.answers.len(), watch)?;
        let (other, seen) = (other_contact(&all), self.outcomes.data.seen(&points));
        let is_other = |answer: &Answer, germs: &[f64]| other(answer) || self.outcomes.data.differ(&seen, germs);
        let others = answers.iter().filter(|(answer, germs, _)| is_other(answer, germs));
        let others: Vec<_> = others.map(|(answer, germs, p)| (answer, surrogate.values(germs), p)).collect();
        let ends = answers[..ends].iter().map(|(answer, germs, _)| (answer, surrogate.values(germs)));
        let ends: Vec<(&Answer, Vec<f64>)> = ends.collect();
        let mut missed =
            Missed { shifts: Vec::new(), probability: None, tails: Vec::new(), excess: 0.0, looked: answers.len() };
        let share = |part: usize| TAIL[part] / self.fresh.answers.len() as f64;
        for (k, Measured { mean, mean_error, variance, residual, .. }) in
            surrogate.measured(&self.fresh).into_iter().enumerate()
        {
            let told = (residual / self.fresh.answers.len() as f64).sqrt();
            let allowed = told.max(self.random.stochastic.tolerance * variance.max(0.0).sqrt());
            let mut most = 0.0f64;
            for (answer, foreseen, probability) in &others {
                let shift = *probability * (answer.quantities[k] - foreseen[k]).abs();
                most = most.max(shift);
                if shift > OVERLOOKED * allowed && !is_rounding(shift, self.outcomes.scales[k].max(mean.abs())) {
                    missed.probability = Some(missed.probability.map_or(**probability, |u: f64| u.max(**probability)));
                }
            }
            missed.shifts.push(most);
            let mut tail = [0.0f64; 2];
            for (answer, foreseen) in &ends {
                let residual = answer.quantities[k] - foreseen[k];
                let squared = 2.0 * (foreseen[k] - mean) * share(0) * residual + share(1) * residual * residual;
                tail = [tail[0].max(share(0) * residual.abs()), tail[1].max(squared.abs())];
            }
            let (error, deviation) = (mean_error.hypot(tail[0]), variance.max(0.0).sqrt());
            if !is_rounding(error, self.outcomes.scales[k].max(mean.abs())) {
                let over = error / (self.random.stochastic.tolerance * deviation);
                missed.excess = missed.excess.max(over * over);
            }
            missed.tails.push(tail);
        }
        if undecided > UNDECIDED {
            missed.probability = Some(missed.probability.map_or(undecided, |u| u.max(undecided)));
        }
        Ok(missed)
    }

    /// The statistics of grid and outcomes.
    fn gathered(
        self,
        surrogate: Surrogate,
        missed: Missed,
        end: End,
        observe: &mut dyn FnMut(OutcomeStage<'_>) -> Result<(), SolveError>,
    ) -> Result<StochasticResult, SolveError> {
        let count = self.fresh.answers.len();
        let mut weights = surrogate.weights(&self.fresh);
        weights.extend(vec![1.0 / count as f64; count]);
        let points = surrogate.grid.points.iter().chain(&self.fresh.germs).cloned().collect();
        let answers: Vec<Answer> = surrogate.answers.iter().chain(&self.fresh.answers).cloned().collect();
        observe(OutcomeStage::Answers { first: 0, count: answers.len(), answers: &answers })?;
        let mut result = of_grid(points, weights, &answers, self.outcomes.numbers)?;
        let measured = surrogate.measured(&self.fresh);
        for (k, (quantity, measured)) in result.quantities.iter_mut().zip(measured).enumerate() {
            let Measured { mean, mean_error, variance, variance_error, .. } = measured;
            let [of_mean, of_variance] = missed.tails[k];
            (quantity.mean, quantity.variance) = (mean, variance);
            quantity.standard_error = Some(mean_error.hypot(of_mean));
            quantity.variance_error = Some(variance_error.hypot(of_variance));
            quantity.truncation = Some(missed.shifts[k]);
        }
        if surrogate.kept.len() < self.random.germs.len() {
            let left_out = self.outcomes.kept.left_out(surrogate.kept.len());
            result.kept = Some((surrogate.kept.clone(), left_out));
        }
        // the points of a grid of some germs do not vary in the others
        let all = result.kept.is_none();
        result.in_body = if all { surrogate.in_body.moments() } else { self.fresh.in_body.moments() };
        (result.checks, result.unseen, result.end) = (missed.looked, missed.probability, end);
        Ok(result)
    }
}
