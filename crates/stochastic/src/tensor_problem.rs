//! Contact coupled over the nodes of a stochastic cell: the exact Galerkin system where it does not decouple.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use rayon::prelude::*;
use steklov_algebra::{Cholesky, check_inverse, llt, symmetric_eigenvalues};
use steklov_contact::{ContactNode, MultiplierRow, Outcome, Problem, multiplier_rows};

use crate::StochasticError;

/// S or D^-½ M_E D^-½ counts as singular below this part of its largest eigenvalue.
const COERCIVE: f64 = 1e-12;
/// M_E is symmetric up to this part of (M_jj M_kk)^½.
const SYMMETRIC: f64 = 1e-9;
/// Columns of a product that are one task: fixed, so that its bits do not depend on the number of threads.
const COLUMNS: usize = 16;

/// Find v_k and λ_k, k = 1..J, with
///
/// ```text
/// Σ_k (M_E)_jk S v_k + D_j Bᵀ W λ_j = F_j          S for the modulus 1, M_E = ∫ E θ_j θ_k ρ, F_j = ∫ f θ_j ρ, D_j = ∫ θ_j ρ
/// B_n v_j ≤ g_j, λ_n,j ≥ 0, λ_n,j (g_j - B_n v_j) = 0, and Tresca's or Coulomb's law of λ_t,j and B_t v_j
/// ```
///
/// S is m×m (stress over the modulus' unit), M_E is J×J, F m×J. The matrix M_E ⊗ S is never formed.
///
/// Source: Issaoui (2014), equation (4.44).
pub struct TensorProblem<'a> {
    /// S, condensed to the unknowns of the contact nodes, positive definite.
    pub stiffness: &'a Mat<f64>,
    /// M_E.
    pub mass: &'a Mat<f64>,
    /// D_j > 0.
    pub weights: &'a [f64],
    /// F.
    pub load: &'a Mat<f64>,
    /// The contact nodes with the gaps and bounds of every stochastic node; the rest is the same for all.
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
/// y = y⁰ - H x K,   H = W^½ B S⁻¹ Bᵀ W^½,   K = (D^-½ M_E D^-½)⁻¹
/// y_ij = (W_i D_j)^½ (B v - at)_ij,   x = P(x + ω y) for any ω > 0
/// ```
pub(crate) struct Dual {
    /// H, n×n.
    pub space: Mat<f64>,
    /// K, J×J.
    pub chance: Mat<f64>,
    /// (W_i D_j)^½, n×J: x over it is a stress, y over it a displacement.
    pub root: Mat<f64>,
    /// Largest displacement without contact and gap.
    pub size: f64,
    /// y⁰, n×J.
    unloaded: Mat<f64>,
    /// Scaled bounds, n×J; the coefficient widens those of tangential rows.
    low: Mat<f64>,
    high: Mat<f64>,
    /// Coulomb's coefficient of row i; the pressure is that of the row before, times `ratio`.
    coefficient: Vec<f64>,
    /// (W_i / W_(i-1))^½.
    ratio: Vec<f64>,
    rows: Vec<usize>,
    conditions: usize,
    weights: Vec<f64>,
    /// S⁻¹ Bᵀ W^½ and S⁻¹ F D^-½.
    response: Mat<f64>,
    loaded: Mat<f64>,
}

impl Dual {
    pub(crate) fn new(problem: &TensorProblem<'_>) -> Result<Self, StochasticError> {
        problem.check()?;
        let (m, nodes) = (problem.stiffness.nrows(), problem.weights.len());
        let all: Vec<Vec<MultiplierRow>> = problem.nodes.iter().map(|n| multiplier_rows(n)).collect();
        let rows: Vec<usize> = (0..all[0].len()).filter(|&i| all[0][i].weight > 0.0).collect();
        let n = rows.len();
        let row = |i: usize, j: usize| &all[j][rows[i]];
        let weight = |i: usize| row(i, 0).weight.sqrt();
        let chance = |j: usize| problem.weights[j].sqrt();
        let mass = Mat::from_fn(nodes, nodes, |j, k| problem.mass[(j, k)] / (chance(j) * chance(k)));
        let of_mass = coercive(&mass, "M_E")?;
        let inverse_mass = of_mass.inverse();
        check_inverse(of_mass.lower(), inverse_mass.as_ref())?;
        let factor = coercive(problem.stiffness, "the stiffness")?;
        let b = Mat::from_fn(n, m, |i, k| weight(i) * row(i, 0).entry(k));
        let response = factor.solve(b.transpose());
        let loaded = factor.solve(Mat::from_fn(m, nodes, |i, j| problem.load[(i, j)] / chance(j)).as_ref());
        let moved = product(&product(&b, &loaded), &inverse_mass);
        let root = Mat::from_fn(n, nodes, |i, j| weight(i) * chance(j));
        let scaled = |bound: f64, i: usize, j: usize| if bound == 0.0 { 0.0 } else { bound * root[(i, j)] };
        let size = Mat::from_fn(n, nodes, |i, j| moved[(i, j)] / root[(i, j)]).norm_max()
            + Mat::from_fn(n, nodes, |i, j| row(i, j).at).norm_max();
        Ok(Self {
            space: product(&b, &response),
            chance: inverse_mass,
            unloaded: Mat::from_fn(n, nodes, |i, j| moved[(i, j)] - root[(i, j)] * row(i, j).at),
            low: Mat::from_fn(n, nodes, |i, j| scaled(row(i, j).low, i, j)),
            high: Mat::from_fn(n, nodes, |i, j| scaled(row(i, j).high, i, j)),
            coefficient: (0..n).map(|i| row(i, 0).coefficient).collect(),
            ratio: (0..n).map(|i| if i > 0 { weight(i) / weight(i - 1) } else { 0.0 }).collect(),
            size,
            weights: problem.weights.to_vec(),
            conditions: all[0].len() / 2,
            rows,
            root,
            response,
            loaded,
        })
    }

    /// H x K.
    pub(crate) fn applied(&self, x: &Mat<f64>) -> Mat<f64> {
        product(&product(&self.space, x), &self.chance)
    }

    /// y of x.
    pub(crate) fn residual(&self, x: &Mat<f64>) -> Mat<f64> {
        &self.unloaded - self.applied(x)
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
    pub(crate) fn solution(&self, x: &Mat<f64>, history: Vec<f64>, outcome: Outcome) -> TensorSolution {
        let (n, nodes) = (x.nrows(), x.ncols());
        let mut displacement = product(&(&self.loaded - product(&self.response, x)), &self.chance);
        let mut multipliers = vec![vec![[0.0; 2]; self.conditions]; nodes];
        for j in 0..nodes {
            displacement.col_as_slice_mut(j).iter_mut().for_each(|v| *v /= self.weights[j].sqrt());
            for i in 0..n {
                multipliers[j][self.rows[i] / 2][self.rows[i] % 2] = x[(i, j)] / self.root[(i, j)];
            }
        }
        TensorSolution { displacement, multipliers, iterations: history.len(), outcome, history }
    }
}

/// a b, in tasks of a few columns.
fn product(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    let mut result = Mat::zeros(a.nrows(), b.ncols());
    let tasks = result.par_col_chunks_mut(COLUMNS).zip(b.par_col_chunks(COLUMNS));
    tasks.for_each(|(part, b)| matmul(part, Accum::Replace, a, b, 1.0, Par::Seq));
    result
}

impl TensorProblem<'_> {
    /// Whether the parts fit together.
    ///
    /// # Errors
    /// [`StochasticError::Inconsistent`] for parts of other sizes, M_E that is not symmetric with a positive diagonal, or nodes
    /// that differ in more than gaps and bounds; [`StochasticError::Number`] for a weight that is not positive;
    /// [`StochasticError::Contact`] for nodes that do not fit S.
    pub fn check(&self) -> Result<(), StochasticError> {
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
        for (j, k) in (0..nodes).flat_map(|j| (0..=j).map(move |k| (j, k))) {
            let (entry, other) = (self.mass[(j, k)], self.mass[(k, j)]);
            let scale = (self.mass[(j, j)] * self.mass[(k, k)]).sqrt();
            if !(entry - other).is_finite() || scale.is_nan() || (entry - other).abs() > SYMMETRIC * scale {
                return inconsistent(format!(
                    "M_E is {entry} at ({j}, {k}) and {other} at ({k}, {j}); it must be finite, symmetric and positive"
                ));
            }
        }
        let alike = |a: &MultiplierRow, b: &MultiplierRow| {
            (a.first, a.unknowns, a.direction, a.weight, a.coefficient)
                == (b.first, b.unknowns, b.direction, b.weight, b.coefficient)
        };
        let first = multiplier_rows(&self.nodes[0]);
        let mut single = Problem { stiffness: self.stiffness.clone().into(), load: vec![], nodes: vec![] };
        for (j, nodes) in self.nodes.iter().enumerate() {
            single.load = self.load.col_as_slice(j).to_vec();
            single.nodes.clone_from(nodes);
            single.check()?;
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
fn coercive(matrix: &Mat<f64>, what: &str) -> Result<Cholesky, StochasticError> {
    let size = matrix.nrows();
    let spectrum = symmetric_eigenvalues(matrix.as_ref()).map_err(|_| StochasticError::Decomposition { size })?;
    let smallest = spectrum.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = spectrum.iter().copied().fold(0.0, f64::max);
    let refused = || StochasticError::NotCoercive { what: what.to_owned(), smallest, largest };
    if smallest <= COERCIVE * largest {
        return Err(refused());
    }
    llt(matrix).map_err(|none| none.or(|_| refused()))
}
