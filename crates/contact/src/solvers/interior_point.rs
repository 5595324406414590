//! Primal-dual interior point method for the sets, active set steps for the answer.

use steklov_elastic::plane::{dot, norm};

use crate::solvers::barrier::Barrier;
use crate::solvers::fixed_point::coulomb;
use crate::solvers::law::{Branch, Law, Piece};
use crate::solvers::linear::largest;
use crate::solvers::pieces::{Linear, laws, nearest_pieces};
use crate::solvers::settle::{ACCEPTED, Settled, iterate, settle, solution};
use crate::{ContactError, Outcome, Problem, Solution};

/// Most interior point steps.
const LIMIT: usize = 100;
/// Relative gap and residuals from which the sets are tried once two points agree on them, and from which at once.
const CLEAR: f64 = 1e-4;
const CLOSE: f64 = 1e-12;
/// Relative gap at which there is nothing more to gain.
const CLOSED: f64 = 1e-20;
/// Active set steps of one trial.
const POLISHING: usize = 2;
/// A motion of size 1 is free if it costs less than this part of the stiffness, closes gaps less than this, and the load
/// does more than this part of its work on it.
const ENERGY: f64 = 1e-11;
const RATE: f64 = 1e-5;
const WORK: f64 = 1e-7;

/// Solves the problem by a primal-dual interior point method, polished by active set steps.
///
/// Every contact and friction line d·v = b of weight D has slacks s ≥ 0 on the sides that it allows and, with them,
/// distances z ≥ 0 of its multiplier from the bounds there (contact: s = g - u_n, z = λ_n; friction: u_t = s₁ - s₂,
/// z₁ = F - λ_t, z₂ = F + λ_t); lines of infinite friction are eliminated. Newton's method follows
///
/// ```text
/// S v + Σ D λ d = f,   d·v - b = Σ ± s,   s z = μ D^-¼,   μ → 0
/// ```
/// by Mehrotra's predictor and corrector and up to three centrality corrections, which share a factorisation of S + Σ D (Σ
/// s/z)⁻¹ d dᵀ: the barrier makes it definite also for a body that nothing else holds. The weights make all that an average
/// over the contact boundary, so that short elements cost few steps. As soon as two points agree on the sets (z > c s, c the
/// stiffness of the node) these are handed to the active set method. Where that settles in two steps its answer, exact up to
/// rounding, is returned; else the interior point method goes on. A motion that the sets leave free is 0, or where that
/// violates them (all nodes slip) as in the interior point. The history is that of both: the larger of gap and residuals
/// before each interior point step, the violation before each active set step.
///
/// Under Coulomb's law the active set method tries full stick, then the sets of the Tresca problems of
/// [`crate::fixed_point`], which are solved in this way, one after the other: the first that settle are the answer.
///
/// *Use when*: always; in a loop over meshes, and where a body is held by friction or contact only, it is the one that
/// does not lose its way. It takes no start. *Fails when*: 100 steps do not make the sets clear; then the active set
/// method goes on from those that were found, and its outcome is reported. *Cost*: one dense Cholesky factorisation a
/// step, on one core; 6 to 12 steps on uniform meshes, up to 35 on strongly graded ones.
///
/// # Errors
/// As [`crate::active_set`].
///
/// Source: Mehrotra, SIAM J. Optim. 2 (1992); Gondzio, Comput. Optim. Appl. 6 (1996); Wright, Primal-Dual Interior-Point
/// Methods (1997).
pub fn interior_point(problem: &Problem) -> Result<Solution, ContactError> {
    problem.check()?;
    if problem.is_coulomb() {
        return coulomb(problem);
    }
    let laws = laws(problem, &[]);
    let mut history = Vec::new();
    let mut pieces = nearest_pieces(problem, &laws, &vec![0.0; problem.load.len()], &problem.load);
    let (mut barrier, mut point) = Barrier::new(problem, &laws);
    let (mut branches, mut tried) = (Vec::new(), None);
    let (mut v, mut motion) = (vec![0.0; problem.load.len()], Vec::new());
    for _ in 0..LIMIT {
        let Some(current) = &point else { break };
        let residual = barrier.residual(current);
        let measure = residual.gap.max(residual.feasibility);
        history.push(measure);
        let before = std::mem::replace(&mut v, barrier.displacement(current));
        motion = v.iter().zip(before).map(|(v, before)| v - before).collect();
        if measure <= CLEAR {
            let found = barrier.branches(problem, &laws, current, &v);
            let agreed = std::mem::replace(&mut branches, found) == branches;
            if agreed || measure <= CLOSE {
                pieces = pieces_of(problem, &laws, &branches, &v);
                if tried.as_ref() != Some(&pieces) {
                    tried = Some(pieces.clone());
                    if let Some(settled) = polished(problem, &laws, &pieces, &v, &mut history) {
                        let Settled { pieces, linear: Linear { displacement, force, .. }, .. } = settled;
                        let outcome = Outcome::Converged;
                        return Ok(solution(problem, &laws, &pieces, displacement, &force, history, outcome));
                    }
                }
            }
        }
        point = if residual.gap > CLOSED { barrier.step(current, &residual) } else { None };
    }
    if let Some(error) = unresisted(problem, &laws, &motion) {
        return Err(error);
    }
    // v may have run away
    let mut rest = iterate(problem, &laws, pieces, &vec![0.0; v.len()])?;
    history.append(&mut rest.history);
    Ok(Solution { iterations: history.len(), history, ..rest })
}

/// The solution to which the active set method settles from the sets, if it does: a motion that they leave free is 0, or else
/// as in v.
fn polished(problem: &Problem, laws: &[Law], pieces: &[Piece], v: &[f64], history: &mut Vec<f64>) -> Option<Settled> {
    [&vec![0.0; v.len()], v].into_iter().find_map(|near| {
        // an error is due to these sets, not to the problem
        let settled = settle(problem, laws, pieces.to_vec(), near, POLISHING, history).ok();
        settled.filter(|settled| settled.measure <= ACCEPTED)
    })
}

/// The piece of each node for the branches of its kinks; more kinks may be on than a piece has.
fn pieces_of(problem: &Problem, laws: &[Law], branches: &[Piece], v: &[f64]) -> Vec<Piece> {
    let elastic = problem.stiffness.times(v);
    let force: Vec<f64> = problem.load.iter().zip(&elastic).map(|(f, s)| f - s).collect();
    let nodes = problem.nodes.iter().zip(laws).zip(branches);
    nodes
        .map(|((node, law), branches)| match law.allows(branches) {
            true => branches.clone(),
            false => meeting(law, branches, node.pick(v), node.pick(&force)),
        })
        .collect()
}

/// The piece of the point where the lines meet that are on in `branches`, under the force r.
fn meeting(law: &Law, branches: &[Branch], v: [f64; 2], r: [f64; 2]) -> Piece {
    let mut on = vec![Branch::Below; branches.len()];
    law.basis(law.on(branches).into_iter()).into_iter().for_each(|i| on[i] = Branch::On);
    let (point, directions) = law.free(&on);
    let mut z = [point[0] + r[0] / law.metric[0], point[1] + r[1] / law.metric[1]];
    for e in directions {
        let x = dot(e, v);
        z = [z[0] + x * e[0], z[1] + x * e[1]];
    }
    law.prox(z).1.clone()
}

/// The error for a load that does work on a motion without energy that nothing stops.
///
/// Points of a problem without solution run away along such a motion, so that it is known to a few digits only.
fn unresisted(problem: &Problem, laws: &[Law], motion: &[f64]) -> Option<ContactError> {
    let size = largest(motion.iter().copied());
    if size == 0.0 {
        return None; // no step was taken
    }
    let motion: Vec<f64> = motion.iter().map(|v| v / size).collect();
    let stiffest = (0..motion.len()).fold(0.0f64, |m, i| m.max(problem.stiffness[(i, i)]));
    let energy: f64 = problem.stiffness.times(&motion).iter().zip(&motion).map(|(s, v)| s * v).sum();
    let (mut resistance, mut stopped) = (0.0, false);
    for (node, law) in problem.nodes.iter().zip(laws) {
        for kink in &law.kinks {
            let rate = dot(kink.direction, node.pick(&motion)) / norm(kink.direction);
            match if rate > 0.0 { kink.high } else { -kink.low } {
                force if force.is_finite() => resistance += force * norm(kink.direction) * rate.abs(),
                _ => stopped |= rate.abs() > RATE,
            }
        }
    }
    let works = || problem.load.iter().zip(&motion).map(|(f, v)| f * v);
    let (work, scale) = (works().sum::<f64>() - resistance, works().map(f64::abs).sum::<f64>());
    let free = energy <= ENERGY * stiffest && !stopped && work > WORK * scale;
    free.then_some(ContactError::NotHeld { motion, work, scale })
}
