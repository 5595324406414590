//! Primal-dual interior point method for the sets, active set steps for the answer.

use crate::active_set::{ACCEPTED, Settled, iterate, laws, nearest_pieces, settle, solution};
use crate::barrier::{Barrier, Point};
use crate::law::{Branch, Law, Piece, dot};
use crate::linear::product;
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

/// Solves the problem by a primal-dual interior point method, polished by active set steps.
///
/// Every contact and friction line d·v = b of weight D has slacks s ≥ 0 on the sides that it allows and, with them,
/// distances z ≥ 0 of its multiplier from the bounds there (contact: s = g - u_n, z = λ_n; friction: u_t = s₁ - s₂,
/// z₁ = F - λ_t, z₂ = F + λ_t); lines of infinite friction are eliminated. Newton's method follows
///
/// ```text
/// S v + Σ D λ d = f,   d·v - b = Σ ± s,   s z = μ D^¼,   μ → 0
/// ```
/// by Mehrotra's predictor and corrector and up to three centrality corrections, which share a factorisation of
/// S + Σ D (Σ s/z)⁻¹ d dᵀ: the barrier makes it definite also for a body that nothing else holds. Powers of D make all
/// of them averages over the contact boundary, whatever the mesh. As soon as two points agree on the sets (z > c s, c the
/// stiffness of the node) these are taken over by the active set method. Where that settles in two steps its answer, exact but
/// for rounding, is returned; else the interior point method goes on. The history is that of both: the larger of
/// gap and residuals before each interior point step, the violation before each active set step.
///
/// *Use when*: always; in a loop over meshes, and where a body is held by friction or contact only, it is the one that does
/// not lose its way. *Fails when*: the Newton matrix loses definiteness or 100 steps do not do; then the active set method goes on from
/// the sets that were found, and its outcome is reported. It takes no start. *Cost*: one dense Cholesky factorisation a
/// step, on one core; 6 to 12 steps on uniform meshes, up to 30 on strongly graded ones.
///
/// # Errors
/// As [`crate::active_set`].
///
/// Source: Mehrotra, SIAM J. Optim. 2 (1992); Gondzio, Comput. Optim. Appl. 6 (1996); Wright, Primal-Dual Interior-Point
/// Methods (1997).
pub fn interior_point(problem: &Problem) -> Result<Solution, ContactError> {
    problem.check()?;
    let laws = laws(problem);
    let mut history = Vec::new();
    let mut pieces = nearest_pieces(problem, &laws, &vec![0.0; problem.load.len()], &problem.load);
    let (mut barrier, mut point) = Barrier::new(problem, &laws);
    let mut tried = None;
    for _ in 0..LIMIT {
        let Some(current) = &point else { break };
        let residual = barrier.residual(current);
        let measure = residual.gap.max(residual.feasibility);
        history.push(measure);
        if measure <= CLEAR {
            let found = sets(problem, &laws, &barrier, current);
            let agreed = std::mem::replace(&mut pieces, found) == pieces;
            if (agreed || measure <= CLOSE) && tried.as_ref() != Some(&pieces) {
                let Settled { measure, pieces: last, linear } =
                    settle(problem, &laws, pieces.clone(), POLISHING, &mut history)?;
                if measure <= ACCEPTED {
                    let (v, force) = (linear.displacement, linear.force);
                    return Ok(solution(problem, &laws, &last, v, &force, history, Outcome::Converged));
                }
                tried = Some(pieces.clone());
            }
        }
        point = if residual.gap > CLOSED { barrier.step(current, &residual) } else { None };
    }
    let mut rest = iterate(problem, &laws, pieces)?;
    history.append(&mut rest.history);
    Ok(Solution { iterations: history.len(), history, ..rest })
}

/// The piece of each node that the point suggests.
fn sets(problem: &Problem, laws: &[Law], barrier: &Barrier, point: &Point) -> Vec<Piece> {
    let v = barrier.displacement(point);
    let elastic = product(&problem.stiffness, &v);
    let force: Vec<f64> = problem.load.iter().zip(&elastic).map(|(f, s)| f - s).collect();
    let mut pieces = barrier.branches(problem, laws, point, &v);
    for ((node, law), piece) in problem.nodes.iter().zip(laws).zip(&mut pieces) {
        if !law.allows(piece) {
            *piece = meeting(law, piece, node.pick(&v), node.pick(&force));
        }
    }
    pieces
}

/// The piece of the point where the lines meet that are on in `branches`, more than a piece may have, under the force r.
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
