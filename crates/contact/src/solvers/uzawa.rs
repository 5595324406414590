//! Uzawa's iteration: projected gradient on the dual.

use faer::Mat;
use steklov_algebra::{check_inverse, llt, symmetric_eigenvalues};

use crate::solvers::linear::{largest, product};
use crate::solvers::multipliers::status;
use crate::{ContactError, Outcome, Problem, Solution, Start, multiplier_rows};

/// Relative displacement residual at which the iteration ends.
const TOLERANCE: f64 = 1e-11;
/// Most iterations.
const LIMIT: usize = 200_000;
/// S counts as singular below this part of its largest eigenvalue.
const COERCIVE: f64 = 1e-12;
/// The iteration is given up when the residual has grown by this factor.
const GROWTH: f64 = 1e6;

/// Solves the problem by λ ← P(λ + ρ (B v - g)), v = S⁻¹(f - Bᵀ D λ).
///
/// B v are the normal and tangential displacements of all conditions, P is the projection on λ_n ≥ 0 and |λ_t| ≤ F, under
/// Coulomb's law with the λ_n of the same step (which contracts for small coefficients only). The
/// step is ρ = 1.9/λ_max(Q), Q = D^½ B S⁻¹ Bᵀ D^½; the iteration contracts for 0 < ρ < 2/λ_max(Q). `step` overrides it
/// (stress over length). It ends when the projected gradient is below 1e-11 of the gaps and the displacements without
/// contact. Where multipliers are not unique (corners) it finds some.
///
/// *Use when*: as an independent reference. *Fails when*: S is singular; a forced step is too large
/// ([`Outcome::Diverged`]); the condition number of Q is so large that 200 000 iterations do not do. *Cost*: an
/// eigenvalue decomposition of Q, then one product with Q an iteration, and as many iterations as Q's condition number
/// times ten.
///
/// # Errors
/// [`ContactError::NotCoercive`] if S is singular; [`ContactError::Inconsistent`] from [`Problem::check`], a start of
/// wrong size or a step that is not positive and finite.
///
/// Source: Glowinski, Lions and Trémolières, Numerical Analysis of Variational Inequalities (1981), chapter 2; Issaoui
/// (2014), algorithm 4.1.
pub fn uzawa(problem: &Problem, step: Option<f64>, start: Option<Start<'_>>) -> Result<Solution, ContactError> {
    problem.check()?;
    let rows = multiplier_rows(&problem.nodes);
    let mut lambda = vec![0.0; rows.len()];
    if let Some(start) = start {
        start.nodal_force(problem)?;
        lambda = start.multipliers.as_flattened().to_vec();
    }
    if let Some(step) = step
        && !(step > 0.0 && step.is_finite())
    {
        return Err(ContactError::Inconsistent {
            what: format!("Uzawa's step is {step}; it must be positive and finite"),
        });
    }
    let (n, m) = (rows.len(), problem.load.len());
    let inverse = coercive_inverse(problem)?;
    let b = Mat::from_fn(n, m, |k, j| rows[k].entry(j));
    let mut dual = &b * &inverse * b.transpose(); // B S⁻¹ Bᵀ
    for i in 0..n {
        for j in 0..n {
            dual[(i, j)] *= rows[j].weight;
        }
    }
    let load = Mat::from_fn(m, 1, |i, _| problem.load[i]);
    let unloaded = &b * &inverse * &load;
    let scaled = Mat::from_fn(n, n, |i, j| {
        if rows[j].weight == 0.0 { 0.0 } else { dual[(i, j)] * (rows[i].weight / rows[j].weight).sqrt() }
    });
    let spectrum = symmetric_eigenvalues(scaled.as_ref()).map_err(|_| ContactError::Decomposition { size: n })?;
    let top = largest(spectrum);
    let safe = if top > 0.0 { 2.0 / top } else { 1.0 };
    let step = step.unwrap_or(0.95 * safe);
    let gaps = largest(rows.iter().filter(|r| r.weight > 0.0 && r.low == 0.0).map(|r| r.at));
    // the displacement without contact is the scale: in full contact and stick the true one vanishes
    let size = gaps + largest((0..n).map(|i| unloaded[(i, 0)]));
    let (mut history, mut outcome) = (Vec::new(), Outcome::IterationLimit);
    for _ in 0..LIMIT {
        let applied = product(&dual, &lambda);
        let mut change = 0.0f64;
        for (i, row) in rows.iter().enumerate() {
            let u = unloaded[(i, 0)] - applied[i];
            let pressure = if i > 0 { lambda[i - 1] } else { 0.0 };
            let next = if row.weight > 0.0 { row.project(lambda[i] + step * (u - row.at), pressure) } else { 0.0 };
            change = change.max((next - lambda[i]).abs() / step);
            lambda[i] = next;
        }
        history.push(if size == 0.0 { 0.0 } else { change / size });
        if change <= TOLERANCE * size {
            outcome = Outcome::Converged;
            break;
        }
        if !change.is_finite() || change > GROWTH * size {
            outcome = Outcome::Diverged;
            break;
        }
    }
    if outcome == Outcome::IterationLimit && step >= safe {
        outcome = Outcome::Diverged;
    }
    let unbalanced = Mat::from_fn(m, 1, |j, _| {
        problem.load[j] - (0..n).map(|k| rows[k].entry(j) * rows[k].weight * lambda[k]).sum::<f64>()
    });
    let displacement: Vec<f64> = (inverse * unbalanced).col_as_slice(0).to_vec();
    let multipliers = lambda.as_chunks().0.to_vec();
    let status = status(problem, &displacement, &multipliers);
    Ok(Solution { displacement, multipliers, status, iterations: history.len(), outcome, history })
}

/// S⁻¹, or the refusal of a singular S.
fn coercive_inverse(problem: &Problem) -> Result<Mat<f64>, ContactError> {
    let size = problem.load.len();
    let failed = |_| ContactError::Decomposition { size };
    let stiffness = problem.stiffness.full();
    let s = symmetric_eigenvalues((*stiffness).as_ref()).map_err(failed)?;
    let smallest = s.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = s.iter().copied().fold(0.0, f64::max);
    if smallest <= COERCIVE * largest {
        return Err(ContactError::NotCoercive { smallest, largest });
    }
    let factor = llt(&stiffness).map_err(|none| none.or(|_| ContactError::NotCoercive { smallest, largest }))?;
    let inverse = factor.inverse();
    check_inverse(factor.lower(), inverse.as_ref())?;
    Ok(inverse)
}
