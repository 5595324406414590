//! Many problems that differ in their random input, solved one after the other in parallel chains.

use faer::Mat;
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

/// A condensed contact problem for one outcome of the random input.
#[derive(Debug, Clone, PartialEq)]
pub struct CondensedOutcome {
    /// Young's modulus E over that of the stiffness, > 0.
    pub modulus: f64,
    /// Condensed load f (force per thickness).
    pub load: Vec<f64>,
    /// Contact nodes with their gaps and bounds.
    pub nodes: Vec<ContactNode>,
}

impl CondensedOutcome {
    /// The outcome with all stresses divided by the modulus: that of the stiffness itself, with the same displacements.
    ///
    /// ```text
    /// E S v + Bᵀ W λ = f, |λ_t| ≤ F + μ λ_n      ⇔      S v + Bᵀ W (λ/E) = f/E, |λ_t/E| ≤ F/E + μ λ_n/E
    /// ```
    pub fn scaled(mut self) -> Self {
        let factor = 1.0 / self.modulus;
        self.load.iter_mut().for_each(|f| *f *= factor);
        scale_bounds(&mut self.nodes, factor);
        self.modulus = 1.0;
        self
    }
}

/// Multiplies the friction bounds, which are stresses.
pub fn scale_bounds(nodes: &mut [ContactNode], factor: f64) {
    nodes.iter_mut().flat_map(|n| &mut n.conditions).for_each(|c| c.bound *= factor);
}

/// Solves the problem of an outcome, E S v + Bᵀ W λ = f; `warm` is the answer of a similar one, in the scale of S, and becomes
/// this one.
///
/// One stiffness serves all moduli, see [`CondensedOutcome::scaled`]. *Cost*: usually one to three steps of the active set, each a
/// dense factorisation of the free contact unknowns.
///
/// # Errors
/// [`ContactError::Inconsistent`] for a modulus that is not positive and finite; those of [`active_set`] and
/// [`interior_point`].
pub fn solve_outcome(
    stiffness: &Mat<f64>,
    outcome: CondensedOutcome,
    warm: &mut Option<Solution>,
) -> Result<Solution, ContactError> {
    let modulus = outcome.modulus;
    if !(modulus > 0.0 && modulus.is_finite()) {
        let what =
            format!("the modulus of an outcome is {modulus} of that of the stiffness; it must be positive and finite");
        return Err(ContactError::Inconsistent { what });
    }
    let CondensedOutcome { load, nodes, .. } = outcome.scaled();
    let problem = Problem { stiffness: stiffness.clone(), load, nodes };
    let mut solution = solve_warm(&problem, warm)?;
    solution.multipliers.iter_mut().flatten().for_each(|l| *l *= modulus);
    Ok(solution)
}

/// The active set from a warm start, without one or where that fails the interior point method.
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
