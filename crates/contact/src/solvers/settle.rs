//! Linear systems of pieces, and pieces changed until none is violated.

use std::ops::Range;

use steklov_elastic::plane::{dot, norm};

use crate::solvers::coupled::{renewed_laws, solve_coupled};
use crate::solvers::free::{Free, off_forces};
use crate::solvers::kkt::friction;
use crate::solvers::law::{Branch, Law, Piece};
use crate::solvers::linear::{largest, solve_semidefinite};
use crate::solvers::multipliers::{multipliers, status};
use crate::solvers::pieces::{Linear, nearest_pieces};
use crate::{ContactError, ContactNode, Outcome, Problem, Solution};

/// A node keeps its piece while it violates it by less than this, relative.
const TOLERANCE: f64 = 1e-12;
/// The violation that is accepted when roundoff keeps some node from settling.
pub(crate) const ACCEPTED: f64 = 1e-10;
/// Violation of the friction law beyond which a solution under Coulomb's law is none.
const JUDGED: f64 = 1e-9;
/// Steps without fewer changes before one node is changed at a time.
const PATIENCE: usize = 8;
/// Steps, besides two for each node, before the stiffness is regularised.
const LIMIT: usize = 60;
/// Regularised problems that are tried, and the first regularisation, relative to the diagonal of S.
const ROUNDS: i32 = 30;
const REGULARISATION: f64 = 1e-2;

/// v on all lines that are on, R equal to the known forces in the directions that are free; if that leaves a motion free
/// (a body that slips everywhere, say), the v nearest to `near`.
pub(crate) fn solve_pieces(
    problem: &Problem,
    laws: &[Law],
    pieces: &[Piece],
    near: &[f64],
) -> Result<Linear, ContactError> {
    if problem.is_coulomb() {
        return solve_coupled(problem, laws, pieces, near);
    }
    let s = &problem.stiffness;
    let free = Free::new(problem, laws, pieces);
    let known = off_forces(problem, laws, pieces);
    let elastic = s.times(&free.fixed);
    let rest: Vec<f64> = (0..known.len()).map(|i| problem.load[i] - elastic[i] - known[i]).collect();
    let moved = free.expand(&solve_semidefinite(&free.stiffness(s), &free.project(&rest), &free.project(near))?);
    let displacement: Vec<f64> = free.fixed.iter().zip(moved).map(|(a, b)| a + b).collect();
    let elastic = s.times(&displacement);
    let force: Vec<f64> = problem.load.iter().zip(&elastic).map(|(f, s)| f - s).collect();
    let excess: Vec<f64> = force.iter().zip(&known).map(|(r, k)| r - k).collect();
    Ok(Linear { displacement, unbalanced: free.expand(&free.project(&excess)), force })
}

/// Relative violation of the current piece at each node.
pub(crate) fn violations(problem: &Problem, laws: &[Law], pieces: &[Piece], v: &[f64], r: &[f64]) -> Vec<f64> {
    let length = largest(v.iter().copied()) + largest(laws.iter().flat_map(|l| &l.kinks).map(|k| k.at));
    let weights: Vec<f64> = problem
        .nodes
        .iter()
        .map(|n| n.conditions.iter().fold(0.0f64, |m, c| m.max(c.normal_weight).max(c.tangent_weight)))
        .collect();
    let stress = problem.nodes.iter().zip(&weights).filter(|(_, w)| **w > 0.0).fold(0.0f64, |m, (n, w)| {
        let f = n.pick(r);
        m.max(norm(f) / w)
    });
    let nodes = problem.nodes.iter().zip(laws).zip(pieces).zip(weights);
    nodes
        .map(|(((node, law), piece), weight)| {
            let (distance, excess) = law.violation(piece, node.pick(v), node.pick(r));
            let noise = noise(problem, node.first..node.first + node.unknowns, v);
            let length = if distance > 0.0 { distance / length } else { 0.0 };
            let force = if excess > noise { (excess - noise) / (weight * stress) } else { 0.0 };
            length.max(force)
        })
        .collect()
}

/// Rounding errors of S v in the given rows.
fn noise(problem: &Problem, rows: Range<usize>, v: &[f64]) -> f64 {
    let terms = rows.map(|i| {
        let mut sum = 0.0;
        problem.stiffness.each_of_column(i, |j, s| sum += (s * v[j]).abs()); // S = Sᵀ
        sum
    });
    1e-15 * terms.fold(0.0f64, f64::max)
}

/// The method itself, from given pieces and a displacement; if it does not settle, by way of regularised problems.
pub(crate) fn iterate(
    problem: &Problem,
    laws: &[Law],
    pieces: Vec<Piece>,
    start: &[f64],
) -> Result<Solution, ContactError> {
    // under Coulomb's law there is a fixed point to fall back on, and Murty's rule proves nothing
    let (limit, rounds) = if problem.is_coulomb() { (LIMIT, 0) } else { (LIMIT + 4 * pieces.len(), ROUNDS) };
    let mut history = Vec::new();
    let mut best = settle(problem, laws, pieces, start, limit, &mut history)?;
    let mut centre = best.linear.displacement.clone();
    for round in 0..rounds {
        if best.measure <= ACCEPTED {
            break;
        }
        let regular = regularised(problem, &centre, REGULARISATION * 0.1f64.powi(round.min(6)));
        let near = settle(&regular, laws, best.pieces.clone(), &centre, limit, &mut history)?;
        centre = near.linear.displacement;
        let tried = settle(problem, laws, near.pieces, &centre, limit, &mut history)?;
        if tried.measure < best.measure {
            best = tried;
        }
    }
    let outcome = if best.measure <= ACCEPTED { Outcome::Converged } else { Outcome::IterationLimit };
    Ok(solution(problem, laws, &best.pieces, best.linear.displacement, &best.linear.force, history, outcome))
}

/// The problem with ½ ε (v - centre)ᵀ C (v - centre) added, whose stiffness is positive definite.
fn regularised(problem: &Problem, centre: &[f64], epsilon: f64) -> Problem {
    let mut regular = problem.clone();
    for (i, v) in centre.iter().enumerate() {
        let c = epsilon * problem.stiffness[(i, i)];
        regular.stiffness.add_to_diagonal(i, c);
        regular.load[i] += c * v;
    }
    regular
}

/// Pieces, the solution of their linear system, and how much it violates the law.
pub(crate) struct Settled {
    /// Largest relative violation.
    pub measure: f64,
    pub pieces: Vec<Piece>,
    pub linear: Linear,
}

/// Changes pieces until none is violated or `limit` steps are done, at least one; returns the best iterate. Motions that
/// pieces leave free are as in `near`.
pub(crate) fn settle(
    problem: &Problem,
    laws: &[Law],
    mut pieces: Vec<Piece>,
    near: &[f64],
    limit: usize,
    history: &mut Vec<f64>,
) -> Result<Settled, ContactError> {
    let (mut fewest, mut waited, mut best) = (usize::MAX, 0, None::<Settled>);
    for _ in 0..limit {
        let linear = solve_pieces(problem, laws, &pieces, near)?;
        let (v, r) = (&linear.displacement, &linear.force);
        let renewed = problem.is_coulomb().then(|| renewed_laws(problem, laws, &pieces, v, r));
        let laws = renewed.as_deref().unwrap_or(laws);
        let wrong = violations(problem, laws, &pieces, v, r);
        let proposed = nearest_pieces(problem, laws, v, r);
        let changes: Vec<usize> =
            (0..pieces.len()).filter(|&i| wrong[i] > TOLERANCE && proposed[i] != pieces[i]).collect();
        let unbalanced = imbalance(problem, &linear);
        let measure = largest(wrong).max(unbalanced);
        history.push(measure);
        let mut next = pieces.clone();
        if unbalanced > ACCEPTED {
            let (n, i) = stopped(problem, laws, &pieces, &linear)?;
            if changes.is_empty() {
                next[n][i] = Branch::On;
            }
        }
        if waited <= PATIENCE {
            changes.iter().for_each(|&i| next[i] = laws[i].towards(&pieces[i], &proposed[i]));
        } else if let Some(&i) = changes.last() {
            let node = &problem.nodes[i];
            let neighbour = laws[i].neighbour(&pieces[i], node.pick(v), node.pick(r));
            next[i] = neighbour.unwrap_or_else(|| proposed[i].clone());
        }
        let settled = next == pieces;
        let current = std::mem::replace(&mut pieces, next);
        if settled || best.as_ref().is_none_or(|b| measure < b.measure) {
            best = Some(Settled { measure, pieces: current, linear });
        }
        (fewest, waited) = if changes.len() < fewest { (changes.len(), 0) } else { (fewest, waited + 1) };
        if settled || waited > 2 * PATIENCE && best.as_ref().is_some_and(|b| b.measure <= ACCEPTED) {
            break;
        }
    }
    Ok(best.expect("at least one step is done"))
}

/// Largest part of the load that no condition and no stiffness carries, relative.
fn imbalance(problem: &Problem, linear: &Linear) -> f64 {
    let load = largest(problem.load.iter().copied());
    let elastic = problem.load.iter().zip(&linear.force).map(|(f, r)| f - r);
    let scale = load + largest(elastic);
    let unbalanced = largest(linear.unbalanced.iter().copied());
    // a body far from its place in the frame of v has rounding errors beyond its loads
    let noise = noise(problem, 0..problem.load.len(), &linear.displacement);
    if unbalanced > noise { (unbalanced - noise) / scale } else { 0.0 }
}

/// The first kink (node, index) that stops the motion of the unbalanced load, along which no energy is spent.
fn stopped(problem: &Problem, laws: &[Law], pieces: &[Piece], linear: &Linear) -> Result<(usize, usize), ContactError> {
    let size = largest(linear.unbalanced.iter().copied());
    let motion: Vec<f64> = linear.unbalanced.iter().map(|x| x / size).collect();
    let mut first: Option<(f64, (usize, usize))> = None;
    for (n, (node, law)) in problem.nodes.iter().zip(laws).enumerate() {
        let (w, e) = (node.pick(&linear.displacement), node.pick(&motion));
        for (i, kink) in law.kinks.iter().enumerate() {
            let (rate, left) = (dot(kink.direction, e), kink.at - dot(kink.direction, w));
            let nears = match pieces[n][i] {
                Branch::Below => rate > 1e-9,
                Branch::Above => rate < -1e-9,
                Branch::On => false,
            };
            if nears && first.is_none_or(|f| left / rate < f.0) {
                first = Some((left / rate, (n, i)));
            }
        }
    }
    first.map(|f| f.1).ok_or_else(|| {
        let work = motion.iter().zip(&linear.unbalanced).map(|(e, r)| e * r).sum();
        let scale = motion.iter().zip(&problem.load).map(|(e, f)| (e * f).abs()).sum();
        ContactError::NotHeld { motion, work, scale }
    })
}

/// Multipliers and states added to a displacement and its pieces.
pub(crate) fn solution(
    problem: &Problem,
    laws: &[Law],
    pieces: &[Piece],
    displacement: Vec<f64>,
    force: &[f64],
    history: Vec<f64>,
    outcome: Outcome,
) -> Solution {
    let renewed = problem.is_coulomb().then(|| renewed_laws(problem, laws, pieces, &displacement, force));
    let laws = renewed.as_deref().unwrap_or(laws);
    let multipliers = multipliers(problem, laws, pieces, &displacement, force);
    let status = status(problem, &displacement, &multipliers);
    let mut answer = Solution { displacement, multipliers, status, iterations: history.len(), outcome, history };
    // at a corner under Coulomb's law no pressures may go with the pieces that were found; on short elements rounding of forces
    // makes much of stresses
    if problem.is_coulomb() {
        let known = |node: &ContactNode| noise(problem, node.first..node.first + node.unknowns, &answer.displacement);
        if friction(problem, &answer, 0.0, known) > JUDGED {
            answer.outcome = Outcome::IterationLimit;
        }
    }
    answer
}
