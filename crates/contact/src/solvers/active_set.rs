//! Primal-dual active set: semi-smooth Newton on the proximal map of the law.

use crate::solvers::fixed_point::coulomb;
use crate::solvers::pieces::{laws, nearest_pieces};
use crate::solvers::settle::iterate;
use crate::{ContactError, Problem, Solution, Start};

/// Solves the problem by the primal-dual active set method.
///
/// Every node holds a piece of its law: which of its contact and stick lines are on, and the known friction force of
/// the others. The linear system of all pieces gives v and R = f - S v; then each node that violates its piece takes
/// the one on which v + C⁻¹R lies, C = diag S (for an ordinary node: λ_n + c(u_n - g) > 0 is contact,
/// λ_t + c u_t outside [-F, F] is slip, c = S_ii/D_i; slip the other way is stick first). It ends when no node does. If
/// the number of changes has not fallen for 8 steps, only the last node that is wrong changes, by one line (Murty's
/// rule), and if that does not end either (which semi-definite S allows), the sets of problems with a slightly
/// increased stiffness, centred at the last iterate (proximal points), are tried. Without a start all nodes begin in
/// contact and stick.
///
/// Under Coulomb's law a slipping node carries ±μ λ_n with the pressure of the same linear system, which is then not
/// symmetric, and pieces are chosen with the bounds μ (λ_n + c(u_n - g))₊. No rule makes sure that this ends: where it does
/// not, the fixed point of Tresca problems takes over, as in [`crate::interior_point`].
///
/// *Use when*: always a good choice; 2 to 7 steps are usual. *Fails when*: it cycles beyond the iteration limit (then the best
/// iterate is returned, marked so). A singular system (a floating body) gives the solution nearest to the start; a load on its
/// free motion moves the body along it until the first condition stops it. *Cost*: one dense factorisation a step.
///
/// # Errors
/// [`ContactError::Inconsistent`] from [`Problem::check`] or a start of wrong size; [`ContactError::NotHeld`] if
/// nothing ever stops that motion.
///
/// Source: Hintermüller, Ito and Kunisch, SIAM J. Optim. 13 (2003); Murty, Opsearch 11 (1974); Rockafellar, SIAM J. Control
/// Optim. 14 (1976), for proximal points.
pub fn active_set(problem: &Problem, start: Option<Start<'_>>) -> Result<Solution, ContactError> {
    problem.check()?;
    if !problem.is_coulomb() {
        return from_start(problem, start);
    }
    start.map(|start| start.nodal_force(problem)).transpose()?;
    match from_start(problem, start) {
        Ok(answer) if answer.converged() => Ok(answer),
        _ => coulomb(problem),
    }
}

/// The method without a fallback.
pub(crate) fn from_start(problem: &Problem, start: Option<Start<'_>>) -> Result<Solution, ContactError> {
    match start {
        None => {
            let laws = laws(problem, &[]);
            let pieces = laws.iter().map(|law| law.closed().clone()).collect();
            iterate(problem, &laws, pieces, &vec![0.0; problem.load.len()])
        }
        Some(start) => {
            let force = start.nodal_force(problem)?;
            let laws = laws(problem, start.multipliers);
            let pieces = nearest_pieces(problem, &laws, start.displacement, &force);
            iterate(problem, &laws, pieces, start.displacement)
        }
    }
}
