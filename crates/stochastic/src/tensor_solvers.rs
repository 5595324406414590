//! The active set for contact coupled over stochastic nodes.

use faer::Mat;
use faer::prelude::*;
use rayon::prelude::*;
use steklov_algebra::{Cholesky, symmetric_eigenvalues};
use steklov_contact::Outcome;

use crate::StochasticError;
use crate::tensor_problem::{Dual, TensorProblem, TensorSolution};

/// Most steps of the gradient.
const LIMIT: usize = 200_000;
/// Most active set steps of a trial, and steps without fewer changes that end it before.
const STEPS: usize = 100;
const PATIENCE: usize = 8;
/// Steps of the gradient before the second trial; before each other one twice as many.
const FIRST: usize = 100;
/// Violation, relative, below which a condition keeps its state; the violation that is accepted where rounding keeps some from
/// settling.
const SETTLED: f64 = 1e-12;
const ACCEPTED: f64 = 1e-10;
/// Relative residual of the linear systems, and most conjugate gradient steps.
const LINEAR: f64 = 1e-15;
const LINEAR_STEPS: usize = 1_000;
/// Curvature over that of the preconditioner below which a direction counts as one that moves nothing.
const SINGULAR: f64 = 1e-5;
/// Added to the diagonal of preconditioners, relative: corners have more multipliers than unknowns.
const REGULAR: f64 = 1e-10;

/// Solves the coupled problem by the primal-dual active set: every multiplier is free (its displacement is prescribed) or at
/// one of its bounds, the linear system of the free ones is solved, and each takes the state on which x + y/(H_ii K_jj) lies.
///
/// It begins in contact and stick. If the number of changes has not fallen for 8 steps, it begins anew with the states that
/// 100, then 200, 400, .. accelerated steps of the projected gradient find, which end in the right ones. The linear systems are solved by
/// conjugate gradients, preconditioned by those of the stochastic nodes by themselves. Under Coulomb's law the bounds are those of
/// the step before. The history is the violation of each active set step, over the largest stress or displacement.
///
/// *Use when*: the exact Galerkin system does not decouple. *Fails when*: S is singular; the friction coefficient is large;
/// 200 000 steps of the gradient are not enough (then its last iterate is returned, marked so). *Cost*: 5 to 10 steps, each a
/// Cholesky factor of H for every set of free multipliers that stochastic nodes have, and 5 to 20 products with H and K.
///
/// # Errors
/// [`StochasticError::NotCoercive`], [`StochasticError::Inconsistent`], [`StochasticError::Number`];
/// [`StochasticError::Contact`] from [`steklov_contact::Problem::check`] of a stochastic node.
///
/// Source: Hintermüller, Ito and Kunisch, SIAM J. Optim. 13 (2003); O'Donoghue and Candès, Found. Comput. Math. 15 (2015);
/// Nesterov (1983).
pub fn tensor_active_set(problem: &TensorProblem<'_>) -> Result<TensorSolution, StochasticError> {
    let dual = Dual::new(problem)?;
    let mut gradient = Gradient::new(&dual)?;
    let (n, nodes) = (gradient.x.nrows(), gradient.x.ncols());
    let mut free = vec![vec![true; n]; nodes];
    let (mut history, mut steps, mut next) = (Vec::new(), 0, FIRST);
    loop {
        if let Some(x) = settle(&dual, free, gradient.x.clone(), &mut history) {
            return Ok(dual.solution(&x, history, Outcome::Converged));
        }
        for _ in 0..next {
            let change = gradient.advance();
            if change <= SETTLED {
                history.push(change);
                return Ok(dual.solution(&gradient.x, history, Outcome::Converged));
            }
        }
        (steps, next) = (steps + next, 2 * next);
        if steps >= LIMIT {
            return Ok(dual.solution(&gradient.x, history, Outcome::IterationLimit));
        }
        let inside = |i: usize, j: usize| {
            let [low, high] = dual.bounds(&gradient.x, i, j);
            low < gradient.x[(i, j)] && gradient.x[(i, j)] < high
        };
        free = (0..nodes).map(|j| (0..n).map(|i| inside(i, j)).collect()).collect();
    }
}

/// The projected gradient in the metric of H_ii K_jj, accelerated by Nesterov's momentum, which ends where it goes uphill.
struct Gradient<'a> {
    dual: &'a Dual,
    /// 1/λ_max of H and K with diagonals 1.
    step: f64,
    x: Mat<f64>,
    /// Where the gradient is taken, and the momentum's number.
    ahead: Mat<f64>,
    momentum: f64,
}

impl<'a> Gradient<'a> {
    fn new(dual: &'a Dual) -> Result<Self, StochasticError> {
        let scaled =
            |a: &Mat<f64>| Mat::from_fn(a.nrows(), a.nrows(), |i, j| a[(i, j)] / (a[(i, i)] * a[(j, j)]).sqrt());
        let step = 1.0 / (top(&scaled(&dual.space))? * top(&scaled(&dual.chance))?);
        let x = Mat::zeros(dual.root.nrows(), dual.root.ncols());
        Ok(Self { dual, step, ahead: x.clone(), x, momentum: 1.0 })
    }

    /// One step; gives back the displacement that drives it over the largest one.
    fn advance(&mut self) -> f64 {
        let Self { dual, step, x, ahead, momentum } = self;
        let y = dual.residual(ahead);
        let (mut change, mut uphill) = (0.0f64, 0.0);
        for j in 0..x.ncols() {
            for i in 0..x.nrows() {
                let compliance = dual.space[(i, i)] * dual.chance[(j, j)] / *step;
                // with the pressure of this step
                let [low, high] = dual.bounds(x, i, j);
                let next = (ahead[(i, j)] + y[(i, j)] / compliance).max(low).min(high);
                let moved = next - ahead[(i, j)];
                change = change.max(moved.abs() * compliance / dual.root[(i, j)]);
                uphill -= compliance * moved * (next - x[(i, j)]);
                // the way of this step, until the momentum is known
                ahead[(i, j)] = next - x[(i, j)];
                x[(i, j)] = next;
            }
        }
        let next = if uphill > 0.0 { 1.0 } else { 0.5 * (1.0 + (1.0 + 4.0 * *momentum * *momentum).sqrt()) };
        let share = if uphill > 0.0 { 0.0 } else { (*momentum - 1.0) / next };
        *ahead = &*x + Scale(share) * &*ahead;
        *momentum = next;
        if change == 0.0 { 0.0 } else { change / dual.size }
    }
}

/// Largest eigenvalue.
fn top(matrix: &Mat<f64>) -> Result<f64, StochasticError> {
    let failed = |_| StochasticError::Decomposition { size: matrix.nrows() };
    let spectrum = symmetric_eigenvalues(matrix.as_ref()).map_err(failed)?;
    Ok(spectrum.iter().copied().fold(0.0, f64::max))
}

/// The active set from these states and values; none if it does not settle.
fn settle(dual: &Dual, mut free: Vec<Vec<bool>>, mut x: Mat<f64>, history: &mut Vec<f64>) -> Option<Mat<f64>> {
    let (n, nodes) = (x.nrows(), x.ncols());
    let (mut fewest, mut least, mut waited) = (usize::MAX, f64::INFINITY, 0);
    for _ in 0..STEPS {
        solve_free(dual, &free, &mut x);
        let y = dual.residual(&x);
        let force = Mat::from_fn(n, nodes, |i, j| x[(i, j)] / dual.root[(i, j)]).norm_max();
        if !force.is_finite() {
            return None;
        }
        let mut next = x.clone();
        let (mut changes, mut worst) = (0, 0.0f64);
        for j in 0..nodes {
            for i in 0..n {
                let compliance = dual.space[(i, i)] * dual.chance[(j, j)];
                let [low, high] = dual.bounds(&x, i, j);
                let tried = x[(i, j)] + y[(i, j)] / compliance;
                let projected = tried.max(low).min(high);
                let wrong = (projected - x[(i, j)]).abs() / dual.root[(i, j)];
                let relative = (wrong / force).min(wrong * compliance / dual.size);
                if relative.is_nan() || relative <= SETTLED {
                    continue;
                }
                worst = worst.max(relative);
                let is_free = low < tried && tried < high;
                changes += usize::from(is_free != free[j][i] || !is_free);
                free[j][i] = is_free;
                next[(i, j)] = projected;
            }
        }
        history.push(worst);
        if changes == 0 {
            return (worst <= ACCEPTED).then_some(x);
        }
        waited = if changes < fewest || worst < 0.5 * least { 0 } else { waited + 1 };
        if waited == PATIENCE {
            return None;
        }
        (fewest, least, x) = (fewest.min(changes), least.min(worst), next);
    }
    None
}

/// Gives the free multipliers the values at which their y vanish, by conjugate gradients from those that they have; the
/// others stay.
fn solve_free(dual: &Dual, free: &[Vec<bool>], x: &mut Mat<f64>) {
    let (n, nodes) = (x.nrows(), x.ncols());
    let mask = |matrix: Mat<f64>| Mat::from_fn(n, nodes, |i, j| if free[j][i] { matrix[(i, j)] } else { 0.0 });
    let solved =
        |r: &Mat<f64>| (0..nodes).all(|j| (0..n).all(|i| r[(i, j)].abs() <= LINEAR * dual.size * dual.root[(i, j)]));
    let mut r = mask(dual.residual(x));
    if solved(&r) {
        return;
    }
    let mut sets: Vec<&Vec<bool>> = free.iter().collect();
    sets.sort_unstable();
    sets.dedup();
    let blocks: Vec<Block> = sets.par_iter().map(|set| Block::new(&dual.space, set)).collect();
    let own: Vec<usize> = free.iter().map(|set| sets.partition_point(|s| s < &set)).collect();
    let precondition = |r: &Mat<f64>| {
        let column = |j: usize| blocks[own[j]].solve(r.col_as_slice(j), dual.chance[(j, j)]);
        let columns: Vec<Vec<f64>> = (0..nodes).into_par_iter().map(column).collect();
        Mat::from_fn(n, nodes, |i, j| columns[j][i])
    };
    let dot = |a: &Mat<f64>, b: &Mat<f64>| -> f64 {
        (0..nodes).map(|j| a.col_as_slice(j).iter().zip(b.col_as_slice(j)).map(|(a, b)| a * b).sum::<f64>()).sum()
    };
    let mut z = precondition(&r);
    let (mut direction, mut rz) = (z.clone(), dot(&r, &z));
    for _ in 0..LINEAR_STEPS {
        let applied = mask(dual.applied(&direction));
        let curvature = dot(&direction, &applied);
        // a direction that moves nothing: prescribed displacements that contradict each other
        if rz.is_nan() || curvature <= SINGULAR * rz {
            break;
        }
        let step = rz / curvature;
        *x += Scale(step) * &direction;
        r -= Scale(step) * &applied;
        if solved(&r) {
            break;
        }
        z = precondition(&r);
        let next = dot(&r, &z);
        direction = &z + Scale(next / rz) * &direction;
        rz = next;
    }
}

/// H of the free multipliers of a set.
struct Block {
    size: usize,
    free: Vec<usize>,
    factor: Option<Cholesky>,
    diagonal: f64,
}

impl Block {
    fn new(space: &Mat<f64>, set: &[bool]) -> Self {
        let free: Vec<usize> = (0..set.len()).filter(|&i| set[i]).collect();
        let regular = |a: usize, b: usize| if a == b { 1.0 + REGULAR } else { 1.0 };
        let h = Mat::from_fn(free.len(), free.len(), |a, b| space[(free[a], free[b])] * regular(a, b));
        let diagonal = (0..free.len()).fold(0.0f64, |m, a| m.max(h[(a, a)]));
        Self { size: set.len(), factor: Cholesky::new(h.as_ref()).ok(), free, diagonal }
    }

    /// H⁻¹ r/k, about.
    fn solve(&self, r: &[f64], k: f64) -> Vec<f64> {
        let mut z = vec![0.0; self.size];
        let b = Mat::from_fn(self.free.len(), 1, |a, _| r[self.free[a]] / k);
        let solved = match &self.factor {
            Some(factor) => factor.solve(b.as_ref()),
            None => b * Scale(1.0 / self.diagonal),
        };
        for (a, &i) in self.free.iter().enumerate() {
            z[i] = solved[(a, 0)];
        }
        z
    }
}
