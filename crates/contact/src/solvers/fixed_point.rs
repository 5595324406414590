//! Coulomb's law as a fixed point of Tresca problems.

use crate::solvers::law::{Law, Piece};
use crate::solvers::linear::largest;
use crate::solvers::pieces::{Linear, laws, nearest_pieces};
use crate::solvers::settle::{ACCEPTED, Settled, iterate, settle, solution};
use crate::{ContactError, Outcome, Problem, Solution, Start, interior_point};

/// Relative change of the pressures at which the iteration ends.
const TOLERANCE: f64 = 1e-11;
/// Tresca problems at most.
const LIMIT: usize = 100;
/// How many of these have an active set trial under Coulomb's law.
const TRIALS: usize = 30;
/// Largest number of problems with a share of the coefficients, the first share, and a step too short to go on.
const CONTINUED: usize = 100;
const FIRST_SHARE: f64 = 1.0 / 64.0;
const LEAST_SHARE: f64 = 1e-6;
/// Active set steps of one trial.
const POLISHING: usize = 12;
/// Steps towards bounds under which a Tresca problem has a solution, or doublings of the first ones.
const RETREATS: usize = 12;

/// Solves a problem with Coulomb friction as a fixed point: Tresca problems with the bounds μ λ_n⁺ of the one before.
///
/// ```text
/// F⁰ = bound + μ p,   p = Σ|f| / Σ D_n, or the pressures of the start;   F^k = bound + μ (λ_n^(k-1))⁺
/// ```
/// Each problem has one answer (up to motions that exhausted friction leaves free), from the interior point method or, with
/// the sets of the one before, from the active set method. Where a body has no rest under some F^k, the mean with the bounds
/// before is tried. It ends when the pressures change by less than 1e-11 of the largest. The history is that of these changes:
/// the ratio of successive ones is the contraction. A problem without Coulomb friction takes two steps.
///
/// *Use when*: as a reference, and to see the contraction: linear convergence with a factor that grows with the
/// coefficients ([`crate::contraction`]). *Fails when*: that factor is 1 or more; then the 100 problems do not settle
/// ([`Outcome::IterationLimit`]), though there may be a solution. *Cost*: one or two factorisations a step as long as the
/// sets change little.
///
/// # Errors
/// As [`crate::active_set`].
///
/// Source: Nečas, Jarušek and Haslinger, Boll. Unione Mat. Ital. B 17 (1980).
pub fn fixed_point(problem: &Problem, start: Option<Start<'_>>) -> Result<Solution, ContactError> {
    problem.check()?;
    let mut bounds = first_bounds(problem, start)?;
    let (mut answer, mut history) = (None, Vec::new());
    for _ in 0..LIMIT {
        let next = tresca_solution(problem, &mut bounds, answer.as_ref())?;
        history.push(change(&bounds.multipliers, &next.multipliers));
        bounds.accept(&next);
        answer = Some(next);
        if history.last().is_some_and(|c| *c <= TOLERANCE) {
            break;
        }
    }
    let answer = answer.expect("at least one problem is solved");
    let outcome =
        if history.last().is_some_and(|c| *c <= TOLERANCE) { answer.outcome } else { Outcome::IterationLimit };
    Ok(Solution { iterations: history.len(), history, outcome, ..answer })
}

/// The active set method under Coulomb's law from full stick, then from the solution of each Tresca problem of the fixed
/// point, until it settles, and last by way of smaller coefficients.
pub(crate) fn coulomb(problem: &Problem) -> Result<Solution, ContactError> {
    let mut history = Vec::new();
    let finished = |history: Vec<f64>, answer: Solution| Solution { iterations: history.len(), history, ..answer };
    let stick = laws(problem, &[]);
    let closed = stick.iter().map(|law| law.closed().clone()).collect();
    if let Some(answer) = settled(problem, &stick, closed, &vec![0.0; problem.load.len()], &mut history) {
        return Ok(finished(history, answer));
    }
    let mut bounds = first_bounds(problem, None)?;
    let mut last: Option<Solution> = None;
    for _ in 0..TRIALS {
        let next = tresca_solution(problem, &mut bounds, last.as_ref())?;
        history.extend(&next.history);
        let (laws, v) = (laws(problem, &next.multipliers), &next.displacement);
        let pieces = nearest_pieces(problem, &laws, v, &body_force(problem, v));
        if let Some(answer) = settled(problem, &laws, pieces, v, &mut history) {
            return Ok(finished(history, answer));
        }
        bounds.accept(&next);
        last = Some(next);
    }
    if let Some(answer) = continued(problem, &mut history) {
        return Ok(finished(history, answer));
    }
    let last = last.expect("at least one problem is solved");
    let laws: Vec<Law> = laws(problem, &last.multipliers);
    let pieces = nearest_pieces(problem, &laws, &last.displacement, &body_force(problem, &last.displacement));
    let mut rest = iterate(problem, &laws, pieces, &last.displacement)?;
    history.append(&mut rest.history);
    Ok(finished(history, rest))
}

/// Solves problems with a rising share of the coefficients, each from the solution of the one before.
fn continued(problem: &Problem, history: &mut Vec<f64>) -> Option<Solution> {
    let (mut share, mut step) = (0.0, FIRST_SHARE);
    let mut last: Option<Solution> = None;
    for _ in 0..CONTINUED {
        let next = f64::min(share + step, 1.0);
        let mut part = problem.clone();
        part.nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| c.coefficient *= next);
        let laws = laws(&part, last.as_ref().map_or(&[], |l| &l.multipliers));
        let (pieces, near) = match &last {
            Some(Solution { displacement: v, .. }) => {
                (nearest_pieces(&part, &laws, v, &body_force(&part, v)), v.clone())
            }
            None => (laws.iter().map(|law| law.closed().clone()).collect(), vec![0.0; part.load.len()]),
        };
        match settled(&part, &laws, pieces, &near, history) {
            Some(answer) if next == 1.0 => return Some(answer),
            Some(answer) => (share, step, last) = (next, 2.0 * step, Some(answer)),
            None if step < LEAST_SHARE => break,
            None => step /= 4.0,
        }
    }
    None
}

/// The solution to which a few active set steps settle, if they do. An error is due to the sets that were tried, not to the
/// problem, and gives none.
pub(crate) fn settled(
    problem: &Problem,
    laws: &[Law],
    pieces: Vec<Piece>,
    near: &[f64],
    history: &mut Vec<f64>,
) -> Option<Solution> {
    let found = settle(problem, laws, pieces, near, POLISHING, history).ok().filter(|s| s.measure <= ACCEPTED)?;
    let Settled { pieces, linear: Linear { displacement, force, .. }, .. } = found;
    let answer = solution(problem, laws, &pieces, displacement, &force, Vec::new(), Outcome::Converged);
    answer.converged().then_some(answer)
}

/// R = f - S v.
pub(crate) fn body_force(problem: &Problem, v: &[f64]) -> Vec<f64> {
    problem.load.iter().zip(problem.stiffness.times(v)).map(|(f, s)| f - s).collect()
}

/// The pressures that give the next bounds, as multipliers, and those of the last problem with a solution.
struct Bounds {
    multipliers: Vec<[f64; 2]>,
    before: Option<Vec<[f64; 2]>>,
}

impl Bounds {
    fn accept(&mut self, answer: &Solution) {
        self.before = Some(std::mem::replace(&mut self.multipliers, answer.multipliers.clone()));
    }
}

fn first_bounds(problem: &Problem, start: Option<Start<'_>>) -> Result<Bounds, ContactError> {
    let conditions: Vec<_> = problem.nodes.iter().flat_map(|n| &n.conditions).collect();
    let multipliers = match start {
        Some(start) => {
            start.nodal_force(problem)?;
            start.multipliers.to_vec()
        }
        None => {
            let weights: f64 = conditions.iter().map(|c| c.normal_weight).sum();
            let pressure = problem.load.iter().map(|f| f.abs()).sum::<f64>() / weights.max(f64::MIN_POSITIVE);
            vec![[pressure, 0.0]; conditions.len()]
        }
    };
    Ok(Bounds { multipliers, before: None })
}

/// The solution of the Tresca problem of these bounds, or of some nearer to the ones before.
fn tresca_solution(problem: &Problem, bounds: &mut Bounds, last: Option<&Solution>) -> Result<Solution, ContactError> {
    for retreat in 0.. {
        let tresca = problem.tresca(&bounds.multipliers);
        let warm = last.and_then(|last| {
            let laws = laws(&tresca, &[]);
            let force = body_force(problem, &last.displacement);
            let pieces = nearest_pieces(&tresca, &laws, &last.displacement, &force);
            settled(&tresca, &laws, pieces, &last.displacement, &mut Vec::new())
        });
        match warm.map_or_else(|| interior_point(&tresca), Ok) {
            Err(ContactError::NotHeld { .. }) if retreat < RETREATS => match &bounds.before {
                Some(before) => {
                    let mean = |(a, b): (&[f64; 2], &[f64; 2])| [(a[0].max(0.0) + b[0].max(0.0)) / 2.0, 0.0];
                    bounds.multipliers = bounds.multipliers.iter().zip(before).map(mean).collect();
                }
                None => bounds.multipliers.iter_mut().for_each(|l| l[0] *= 2.0),
            },
            other => return other,
        }
    }
    unreachable!("the last retreat returns")
}

/// Largest change of the pressures over the largest pressure.
fn change(before: &[[f64; 2]], after: &[[f64; 2]]) -> f64 {
    let of = |l: &[f64; 2]| l[0].max(0.0);
    let moved = largest(before.iter().zip(after).map(|(a, b)| of(a) - of(b)));
    if moved == 0.0 { 0.0 } else { moved / largest(after.iter().map(of)).max(f64::MIN_POSITIVE) }
}
