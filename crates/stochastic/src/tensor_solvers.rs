//! Uzawa's iteration and the active set for contact coupled over stochastic nodes.

use faer::prelude::*;
use faer::{Mat, Side};
use rayon::prelude::*;
use steklov_contact::Outcome;

use crate::StochasticError;
use crate::tensor_problem::{Dual, TensorProblem, TensorSolution};

/// Relative displacement residual at which Uzawa's iteration ends.
const TOLERANCE: f64 = 1e-11;
/// Most steps of Uzawa's iteration and of the active set.
const LIMIT: usize = 200_000;
const STEPS: usize = 100;
/// Violation, relative, below which a condition keeps its state; and what is accepted where rounding keeps some from settling.
const SETTLED: f64 = 1e-12;
const ACCEPTED: f64 = 1e-10;
/// Relative residual of the linear systems, and most conjugate gradient steps.
const LINEAR: f64 = 1e-14;
const LINEAR_STEPS: usize = 2_000;
/// Added to the diagonal of preconditioners, relative: corners have more multipliers than unknowns.
const REGULAR: f64 = 1e-10;

/// Solves the coupled problem by x ← P(x + ω y), ω = 1.9/(λ_max(H) λ_max(K)), H the compliance of the contact nodes and
/// K = D^½ M_E⁻¹ D^½, both scaled by their weights.
///
/// It ends when no multiplier would move by more than ω times `tolerance` (1e-11 if None) of the displacements without
/// contact and the gaps.
///
/// *Use when*: as an independent reference. *Fails when*: S is singular; the friction coefficient is large; more than 200 000
/// steps are needed. *Cost*: n²J + nJ² a step for n multipliers and J stochastic nodes, and as many steps as the condition
/// numbers of H and K multiplied.
///
/// # Errors
/// [`StochasticError::NotCoercive`], [`StochasticError::Inconsistent`], [`StochasticError::Number`].
pub fn tensor_uzawa(problem: &TensorProblem<'_>, tolerance: Option<f64>) -> Result<TensorSolution, StochasticError> {
    let dual = Dual::new(problem)?;
    let tolerance = tolerance.unwrap_or(TOLERANCE) * dual.size;
    let top = |matrix: &Mat<f64>| -> Result<f64, StochasticError> {
        let failed = |_| StochasticError::Decomposition { size: matrix.nrows() };
        let spectrum = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(failed)?;
        Ok(spectrum.iter().copied().fold(0.0, f64::max))
    };
    let step = 1.9 / (top(&dual.space)? * top(&dual.chance)?);
    let (n, nodes) = (dual.unloaded.nrows(), dual.unloaded.ncols());
    let mut x = Mat::zeros(n, nodes);
    let (mut history, mut outcome) = (Vec::new(), Outcome::IterationLimit);
    for _ in 0..LIMIT {
        let y = dual.residual(&x);
        let mut change = 0.0f64;
        for j in 0..nodes {
            for i in 0..n {
                let [low, high] = dual.bounds(&x, i, j);
                let next = (x[(i, j)] + step * y[(i, j)]).max(low).min(high);
                change = change.max((next - x[(i, j)]).abs() / step);
                x[(i, j)] = next;
            }
        }
        history.push(if dual.size == 0.0 { 0.0 } else { change / dual.size });
        if change <= tolerance {
            outcome = Outcome::Converged;
            break;
        }
        if !change.is_finite() {
            outcome = Outcome::Diverged;
            break;
        }
    }
    Ok(dual.solution(problem, &x, history, outcome))
}

/// Solves the coupled problem by the primal-dual active set: every multiplier is free (its displacement is prescribed) or at
/// one of its bounds, the linear system of the free ones is solved, and each takes the state on which x + y/(H_ii K_jj) lies.
///
/// The linear systems are solved by conjugate gradients, preconditioned by those of the stochastic nodes by themselves. Under
/// Coulomb's law the bounds are those of the step before.
///
/// *Use when*: the exact Galerkin system does not decouple. *Fails when*: S is singular; it cycles (then the last iterate is
/// returned, marked so). *Cost*: 5 to 10 steps, each a Cholesky factor of the free multipliers of each stochastic node and
/// 5 to 20 products with H and K.
///
/// # Errors
/// As [`tensor_uzawa`].
pub fn tensor_active_set(problem: &TensorProblem<'_>) -> Result<TensorSolution, StochasticError> {
    let dual = Dual::new(problem)?;
    let (n, nodes) = (dual.unloaded.nrows(), dual.unloaded.ncols());
    let mut x = Mat::zeros(n, nodes);
    // free: contact and stick everywhere
    let mut free = vec![vec![true; n]; nodes];
    let (mut history, mut outcome) = (Vec::new(), Outcome::IterationLimit);
    for _ in 0..STEPS {
        solve_free(&dual, &free, &mut x);
        let y = dual.residual(&x);
        let force = x.norm_max();
        let mut next = x.clone();
        let (mut changed, mut worst) = (false, 0.0f64);
        for j in 0..nodes {
            for i in 0..n {
                let compliance = dual.space[(i, i)] * dual.chance[(j, j)];
                let [low, high] = dual.bounds(&x, i, j);
                let tried = x[(i, j)] + y[(i, j)] / compliance;
                let projected = tried.max(low).min(high);
                let wrong = (projected - x[(i, j)]).abs();
                let relative = (wrong / force).min(wrong * compliance / dual.size);
                if !(relative > SETTLED) {
                    continue;
                }
                worst = worst.max(relative);
                let is_free = tried > low && tried < high;
                changed |= is_free != free[j][i] || !is_free && projected != x[(i, j)];
                free[j][i] = is_free;
                next[(i, j)] = projected;
            }
        }
        history.push(worst);
        if !changed {
            outcome = if worst <= ACCEPTED { Outcome::Converged } else { outcome };
            break;
        }
        x = next;
    }
    Ok(dual.solution(problem, &x, history, outcome))
}

/// Gives the free multipliers the values at which their y vanish; the others stay.
fn solve_free(dual: &Dual, free: &[Vec<bool>], x: &mut Mat<f64>) {
    let (n, nodes) = (x.nrows(), x.ncols());
    for j in 0..nodes {
        for i in 0..n {
            if free[j][i] {
                x[(i, j)] = 0.0;
            }
        }
    }
    let mask = |matrix: Mat<f64>| Mat::from_fn(n, nodes, |i, j| if free[j][i] { matrix[(i, j)] } else { 0.0 });
    let mut r = mask(dual.residual(x));
    let scale = r.norm_l2();
    if scale == 0.0 {
        return;
    }
    let blocks: Vec<Block> = (0..nodes).into_par_iter().map(|j| Block::new(dual, &free[j], j)).collect();
    let precondition = |r: &Mat<f64>| {
        let columns: Vec<Vec<f64>> = (0..nodes).into_par_iter().map(|j| blocks[j].solve(r.col_as_slice(j))).collect();
        Mat::from_fn(n, nodes, |i, j| columns[j][i])
    };
    let dot = |a: &Mat<f64>, b: &Mat<f64>| -> f64 {
        (0..nodes).map(|j| a.col_as_slice(j).iter().zip(b.col_as_slice(j)).map(|(a, b)| a * b).sum::<f64>()).sum()
    };
    let mut z = precondition(&r);
    let (mut direction, mut rz) = (z.clone(), dot(&r, &z));
    for _ in 0..LINEAR_STEPS {
        let applied = mask(&dual.space * &direction * &dual.chance);
        let curvature = dot(&direction, &applied);
        if !(curvature > 0.0) {
            break;
        }
        let step = rz / curvature;
        *x += Scale(step) * &direction;
        r -= Scale(step) * &applied;
        if r.norm_l2() <= LINEAR * scale {
            break;
        }
        z = precondition(&r);
        let next = dot(&r, &z);
        direction = &z + Scale(next / rz) * &direction;
        rz = next;
    }
}

/// The free multipliers of one stochastic node by themselves.
struct Block {
    size: usize,
    free: Vec<usize>,
    factor: Option<faer::linalg::solvers::Llt<f64>>,
    diagonal: f64,
}

impl Block {
    fn new(dual: &Dual, free: &[bool], j: usize) -> Self {
        let free: Vec<usize> = (0..free.len()).filter(|&i| free[i]).collect();
        let k = dual.chance[(j, j)];
        let h = Mat::from_fn(free.len(), free.len(), |a, b| {
            let regular = if a == b { 1.0 + REGULAR } else { 1.0 };
            dual.space[(free[a], free[b])] * k * regular
        });
        let diagonal = (0..free.len()).fold(0.0f64, |m, a| m.max(h[(a, a)]));
        Self { size: dual.space.nrows(), factor: h.llt(Side::Lower).ok(), free, diagonal }
    }

    fn solve(&self, r: &[f64]) -> Vec<f64> {
        let mut z = vec![0.0; self.size];
        let b = Mat::from_fn(self.free.len(), 1, |a, _| r[self.free[a]]);
        let solved = match &self.factor {
            Some(factor) => factor.solve(b),
            None => b * Scale(1.0 / self.diagonal),
        };
        for (a, &i) in self.free.iter().enumerate() {
            z[i] = solved[(a, 0)];
        }
        z
    }
}
