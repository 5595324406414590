//! Many problems that differ in their random input, solved one after the other in parallel chains.

use rayon::prelude::*;
use steklov_contact::{ContactError, ContactNode, Outcome, Problem, Solution, Start, active_set, interior_point};

/// Points of a chain. Fixed, so that answers do not depend on the number of threads.
pub const CHAIN: usize = 16;

/// Calls `solve(i, state)` for i = 0..count; consecutive points share a state, which starts as its default: that of a warm
/// start. Chains of [`CHAIN`] points run in parallel; answers come in the order of the points and do not depend on the number
/// of threads.
///
/// # Errors
/// The error of the first chain that has one.
pub fn solve_points<S, T, E>(count: usize, solve: impl Fn(usize, &mut S) -> Result<T, E> + Sync) -> Result<Vec<T>, E>
where
    S: Default,
    T: Send,
    E: Send,
{
    let chains: Vec<usize> = (0..count).step_by(CHAIN).collect();
    let answers: Vec<Result<Vec<T>, E>> = chains
        .into_par_iter()
        .map(|first| {
            let mut state = S::default();
            (first..count.min(first + CHAIN)).map(|i| solve(i, &mut state)).collect()
        })
        .collect();
    let mut all = Vec::with_capacity(count);
    for chain in answers {
        all.extend(chain?);
    }
    Ok(all)
}

/// Multiplies the friction bounds, which are stresses.
pub fn scale_bounds(nodes: &mut [ContactNode], factor: f64) {
    nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| c.bound *= factor);
}

/// The active set method from a warm start; without one, or if that fails, the interior point method.
///
/// *Fails when*: the solution is not unique (a body that can still move, or under Coulomb's law): then it may depend on the start.
///
/// # Errors
/// Those of [`active_set`] and [`interior_point`].
pub fn solve_warm(problem: &Problem, warm: &mut Option<Solution>) -> Result<Solution, ContactError> {
    let solution = match warm {
        Some(near) => {
            let start = Start { displacement: &near.displacement, multipliers: &near.multipliers };
            match active_set(problem, Some(start)) {
                Ok(solution) if solution.outcome == Outcome::Converged => solution,
                _ => interior_point(problem)?,
            }
        }
        None => interior_point(problem)?,
    };
    *warm = solution.converged().then(|| solution.clone());
    Ok(solution)
}
