//! Contact coupled over the nodes of a stochastic cell: the exact Galerkin system where it does not decouple.

use faer::linalg::solvers::DenseSolveCore;
use faer::prelude::*;
use faer::{Mat, Side};
use steklov_contact::{ContactNode, MultiplierRow, Outcome, multiplier_rows};

use crate::StochasticError;

/// S or M_E counts as singular below this part of its largest eigenvalue.
const COERCIVE: f64 = 1e-12;

/// Find v_k and λ_k, k = 1..J, with
///
/// ```text
/// Σ_k (M_E)_jk S v_k + D_j Bᵀ W λ_j = F_j          S for the modulus 1, M_E = ∫ E θ_j θ_k ρ, F_j = ∫ f θ_j ρ, D_j = ∫ θ_j ρ
/// B_n v_j ≤ g_j, λ_n,j ≥ 0, λ_n,j (g_j - B_n v_j) = 0, and Tresca's or Coulomb's law of λ_t,j and B_t v_j
/// ```
///
/// S is m×m (stress over the modulus' unit), M_E is J×J, F m×J. The matrix M_E ⊗ S is never formed.
pub struct TensorProblem<'a> {
    /// S, condensed to the unknowns of the contact nodes, positive definite.
    pub stiffness: &'a Mat<f64>,
    /// M_E.
    pub mass: &'a Mat<f64>,
    /// D_j > 0.
    pub weights: &'a [f64],
    /// F.
    pub load: &'a Mat<f64>,
    /// The contact nodes with the gaps and bounds of every stochastic node; weights and directions are those of the first.
    pub nodes: &'a [Vec<ContactNode>],
}

/// What solvers of a [`TensorProblem`] return.
#[derive(Debug, Clone)]
pub struct TensorSolution {
    /// v_j in column j, m×J.
    pub displacement: Mat<f64>,
    /// `[λ_n, λ_t]` of each condition, for each stochastic node.
    pub multipliers: Vec<Vec<[f64; 2]>>,
    /// Iterations done.
    pub iterations: usize,
    /// How the solver ended.
    pub outcome: Outcome,
    /// The solver's own measure of the error, iteration by iteration.
    pub history: Vec<f64>,
}

/// The problem in its scaled multipliers x_ij = (W_i D_j)^½ λ_ij, the rows i with a multiplier and the stochastic nodes j:
///
/// ```text
/// y = y⁰ - H x K,   H = W^½ B S⁻¹ Bᵀ W^½,   K = D^½ M_E⁻¹ D^½
/// y_ij = (W_i D_j)^½ (B v - at)_ij,   x = P(x + ω y) for any ω > 0
/// ```
pub(crate) struct Dual {
    /// H, n×n.
    pub space: Mat<f64>,
    /// K, J×J.
    pub chance: Mat<f64>,
    /// y⁰, n×J.
    pub unloaded: Mat<f64>,
    /// Scaled bounds, n×J: lower and upper; the coefficient widens those of tangential rows.
    pub low: Mat<f64>,
    pub high: Mat<f64>,
    /// Coulomb's coefficient of row i; the pressure is that of the row before, times `ratio`.
    pub coefficient: Vec<f64>,
    /// (W_i / W_(i-1))^½.
    pub ratio: Vec<f64>,
    /// Largest |y| without contact and of the gaps: the scale of residuals.
    pub size: f64,
    rows: Vec<usize>,
    root: Mat<f64>,
    response: Mat<f64>,
    free: Mat<f64>,
    conditions: usize,
}

impl Dual {
    pub(crate) fn new(problem: &TensorProblem<'_>) -> Result<Self, StochasticError> {
        problem.check()?;
        let (m, nodes) = (problem.stiffness.nrows(), problem.weights.len());
        let all: Vec<Vec<MultiplierRow>> = problem.nodes.iter().map(|n| multiplier_rows(n)).collect();
        let rows: Vec<usize> = (0..all[0].len()).filter(|&i| all[0][i].weight > 0.0).collect();
        let n = rows.len();
        let row = |i: usize, j: usize| &all[j][rows[i]];
        let factor = coercive(problem.stiffness, "the stiffness")?;
        let inverse_mass = coercive(problem.mass, "M_E")?.inverse();
        let weight = |i: usize| row(i, 0).weight.sqrt();
        let chance = |j: usize| problem.weights[j].sqrt();
        let b = Mat::from_fn(n, m, |i, k| weight(i) * row(i, 0).entry(k));
        let response = factor.solve(b.transpose()); // S⁻¹ Bᵀ W^½
        let free = factor.solve(problem.load) * &inverse_mass; // v without contact
        let moved = &b * &free;
        let unloaded = Mat::from_fn(n, nodes, |i, j| chance(j) * (moved[(i, j)] - weight(i) * row(i, j).at));
        let root = Mat::from_fn(n, nodes, |i, j| weight(i) * chance(j));
        let scaled = |bound: f64, i: usize, j: usize| if bound == 0.0 { 0.0 } else { bound * root[(i, j)] };
        let largest = |values: Mat<f64>| values.norm_max();
        Ok(Self {
            space: &b * &response,
            chance: Mat::from_fn(nodes, nodes, |j, k| chance(j) * inverse_mass[(j, k)] * chance(k)),
            low: Mat::from_fn(n, nodes, |i, j| scaled(row(i, j).low, i, j)),
            high: Mat::from_fn(n, nodes, |i, j| scaled(row(i, j).high, i, j)),
            coefficient: (0..n).map(|i| row(i, 0).coefficient).collect(),
            ratio: (0..n).map(|i| if i > 0 { weight(i) / weight(i - 1) } else { 0.0 }).collect(),
            size: largest(Mat::from_fn(n, nodes, |i, j| chance(j) * moved[(i, j)]))
                + largest(Mat::from_fn(n, nodes, |i, j| root[(i, j)] * row(i, j).at)),
            conditions: all[0].len() / 2,
            unloaded,
            rows,
            root,
            response,
            free,
        })
    }

    /// y of x.
    pub(crate) fn residual(&self, x: &Mat<f64>) -> Mat<f64> {
        &self.unloaded - &self.space * x * &self.chance
    }

    /// The bounds of x_ij with the pressures that x holds.
    pub(crate) fn bounds(&self, x: &Mat<f64>, i: usize, j: usize) -> [f64; 2] {
        let (low, high) = (self.low[(i, j)], self.high[(i, j)]);
        if self.coefficient[i] == 0.0 {
            return [low, high];
        }
        let wider = self.coefficient[i] * self.ratio[i] * x[(i - 1, j)].max(0.0);
        [low - wider, high + wider]
    }

    /// Displacements and multipliers of x.
    pub(crate) fn solution(
        &self,
        problem: &TensorProblem<'_>,
        x: &Mat<f64>,
        history: Vec<f64>,
        outcome: Outcome,
    ) -> TensorSolution {
        let nodes = problem.weights.len();
        let moved = &self.response * x * &self.chance;
        let displacement =
            Mat::from_fn(moved.nrows(), nodes, |i, j| self.free[(i, j)] - moved[(i, j)] / problem.weights[j].sqrt());
        let multipliers = (0..nodes)
            .map(|j| {
                let mut values = vec![0.0; 2 * self.conditions];
                for (i, &row) in self.rows.iter().enumerate() {
                    values[row] = x[(i, j)] / self.root[(i, j)];
                }
                values.as_chunks().0.to_vec()
            })
            .collect();
        TensorSolution { displacement, multipliers, iterations: history.len(), outcome, history }
    }
}

impl TensorProblem<'_> {
    fn check(&self) -> Result<(), StochasticError> {
        let (m, nodes) = (self.stiffness.nrows(), self.weights.len());
        let inconsistent = |what: String| Err(StochasticError::Inconsistent { what });
        if nodes == 0 || self.mass.nrows() != nodes || self.mass.ncols() != nodes || self.nodes.len() != nodes {
            let (a, b, c) = (self.mass.nrows(), self.mass.ncols(), self.nodes.len());
            return inconsistent(format!("M_E is {a}×{b}, there are {nodes} weights and the conditions of {c} nodes"));
        }
        if self.load.nrows() != m || self.load.ncols() != nodes {
            let (a, b) = (self.load.nrows(), self.load.ncols());
            return inconsistent(format!("the load is {a}×{b}; it must be {m}×{nodes}"));
        }
        if let Some(&d) = self.weights.iter().find(|d| !(**d > 0.0 && d.is_finite())) {
            let what = "the weight of a stochastic node".to_owned();
            return Err(StochasticError::Number { what, value: d, wanted: "positive: use Gauss points" });
        }
        let alike = |a: &MultiplierRow, b: &MultiplierRow| {
            (a.first, a.unknowns, a.direction, a.weight, a.coefficient)
                == (b.first, b.unknowns, b.direction, b.weight, b.coefficient)
        };
        let first = multiplier_rows(&self.nodes[0]);
        for (j, nodes) in self.nodes.iter().enumerate() {
            let rows = multiplier_rows(nodes);
            if rows.len() != first.len() || !rows.iter().zip(&first).all(|(a, b)| alike(a, b)) {
                return inconsistent(format!(
                    "the multipliers of stochastic nodes 0 and {j} differ in more than gaps and bounds"
                ));
            }
        }
        if first.iter().all(|r| r.weight == 0.0) {
            return inconsistent("there is no multiplier".to_owned());
        }
        Ok(())
    }
}

/// Cholesky factor, or the refusal of a matrix that is singular.
fn coercive(matrix: &Mat<f64>, what: &str) -> Result<faer::linalg::solvers::Llt<f64>, StochasticError> {
    let size = matrix.nrows();
    let spectrum = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(|_| StochasticError::Decomposition { size })?;
    let smallest = spectrum.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = spectrum.iter().copied().fold(0.0, f64::max);
    let refused = || StochasticError::NotCoercive { what: what.to_owned(), smallest, largest };
    if smallest <= COERCIVE * largest {
        return Err(refused());
    }
    matrix.llt(Side::Lower).map_err(|_| refused())
}
