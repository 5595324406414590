//! The contact solver that a scene names.

use steklov_contact::{ContactError, Problem, Solution, active_set, interior_point, newton, uzawa};
use steklov_problem::Solver;

/// The answer of the solver that a scene names.
pub(crate) fn solve_problem(problem: &Problem, solver: Solver) -> Result<Solution, ContactError> {
    match solver {
        Solver::Auto => interior_point(problem),
        Solver::Newton => newton(problem, None),
        Solver::ActiveSet => active_set(problem, None),
        Solver::Uzawa => uzawa(problem, None, None),
    }
}
