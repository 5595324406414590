//! Sparse grids.

use crate::cell_basis::tensor;
use crate::total_degree::next;
use crate::{Recurrence, StochasticError, TotalDegree, Variable};
use std::cmp::Ordering;
use steklov_quadrature::Rule;

/// Most points before equal ones are merged, and most pairs of index sets and directions.
const MOST: f64 = 2e6;
/// Most numbers of them: 400 MB.
const NUMBERS: f64 = 5e7;
/// Highest level: rules of 2·60 + 1 points.
const LEVELS: usize = 60;

/// Points with weights: E f ≈ Σ_j `weights[j]` f(`points[j]`).
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Germs, one for each variable.
    pub points: Vec<Vec<f64>>,
    /// Weights, which sum to 1; those of sparse grids may be negative.
    pub weights: Vec<f64>,
}

/// Smolyak's combination of the Gauss rules U_l of 2l + 1 points of the variables:
///
/// Σ_{L-d+1 ≤ |l| ≤ L} (-1)^{L-|l|} binomial(d-1, L-|l|) U_{l_1} ⊗ .. ⊗ U_{l_d}.
///
/// Exact for polynomials of total degree 2L + 1 in the germs and for those of a single germ to degree 4L + 1. Equal points
/// are merged (symmetric densities share the mean among all rules); points ascend.
///
/// *Use when*: answers are smooth in more than three germs. *Fails when*: they have kinks (contact comes and goes): negative
/// weights can even make a variance negative; use cells or samples. *Cost*: about (2d)^L/L! points.
///
/// # Errors
/// [`StochasticError::Number`] for a level above 60 or more than two million points.
///
/// Source: Smolyak (1963); Wasilkowski and Woźniakowski, J. Complexity 11 (1995), lemma 1; Novak and Ritter,
/// Constr. Approx. 15 (1999) for the degree.
pub fn smolyak(variables: &[Variable], level: usize) -> Result<Points, StochasticError> {
    let refuse = |what: &str, value: f64, wanted| Err(StochasticError::Number { what: what.into(), value, wanted });
    if level > LEVELS {
        return refuse("the level of a sparse grid", level as f64, "at most 60");
    }
    let d = variables.len();
    let level = if d == 0 { 0 } else { level };
    let lowest = (level + 1).saturating_sub(d.max(1));
    // index sets l with |l| = k and their points: powers of Σ x^l and of Σ (2l + 1) x^l
    let counted = |weight: &dyn Fn(usize) -> f64| -> f64 {
        let mut counts = vec![0.0; level + 1];
        counts[0] = 1.0;
        for _ in 0..d {
            counts = (0..=level).map(|k| (0..=k).map(|l| weight(l) * counts[k - l]).sum()).collect();
        }
        counts[lowest..].iter().sum()
    };
    let size = counted(&|l| (2 * l + 1) as f64).max(counted(&|_| 1.0) * d as f64);
    if size > MOST || size * d as f64 > NUMBERS {
        return refuse("the number of points of a sparse grid", size, "at most 2e6: lower the level, or use samples");
    }
    let rules: Result<Vec<Vec<Rule>>, StochasticError> = variables.iter().map(|v| one_dimensional(v, level)).collect();
    let rules = rules?;
    let mut weighted: Vec<(Vec<f64>, f64)> = vec![];
    let mut index = vec![0; d];
    loop {
        let sum: usize = index.iter().sum();
        if sum >= lowest {
            let missing = level - sum;
            let sign = if missing.is_multiple_of(2) { 1.0 } else { -1.0 };
            let factor = sign * binomial(d.saturating_sub(1), missing);
            let chosen: Vec<&Rule> = index.iter().zip(&rules).map(|(&l, rules)| &rules[l]).collect();
            let (points, weights) = tensor(&chosen);
            weighted.extend(points.into_iter().zip(weights.iter().map(|w| factor * w)));
        }
        if !next(&mut index, level) {
            break;
        }
    }
    // stable: the weights of equal points are added in the order of their index sets
    weighted.sort_by(|(x, _), (y, _)| {
        let differing = x.iter().zip(y).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne());
        differing.unwrap_or(Ordering::Equal)
    });
    let mut result = Points { points: vec![], weights: vec![] };
    for (point, weight) in weighted {
        if result.points.last() == Some(&point) {
            let last = result.weights.len() - 1;
            result.weights[last] += weight;
        } else {
            result.points.push(point);
            result.weights.push(weight);
        }
    }
    Ok(result)
}

/// Polynomials of total degree L fitted to the answers at the points of a sparse grid of level L, in the mean square of its
/// rule.
#[derive(Debug, Clone)]
pub struct SparsePolynomials {
    /// ψ_a.
    basis: TotalDegree,
    /// w_j ψ_a(x_j), one row for each a.
    weighted: Vec<Vec<f64>>,
}

impl Points {
    /// The polynomials Σ_a c_a ψ_a, c_a = Σ_j w_j f(x_j) ψ_a(x_j), of total degree `level`, which has to be that of the grid: its rule
    /// is exact for their products, so that polynomials of this degree come back.
    ///
    /// # Errors
    /// [`StochasticError::Number`] for a level above 60.
    ///
    /// Source: Xiu (2007).
    pub fn polynomials(&self, variables: &[Variable], level: usize) -> Result<SparsePolynomials, StochasticError> {
        let basis = TotalDegree::new(variables, level)?;
        let at: Vec<Vec<f64>> = self.points.iter().map(|x| basis.values(x)).collect();
        let row = |a: usize| at.iter().zip(&self.weights).map(|(psi, w)| w * psi[a]).collect();
        let weighted = (0..basis.degrees().len()).map(row).collect();
        Ok(SparsePolynomials { basis, weighted })
    }
}

impl SparsePolynomials {
    /// Variance Σ_(a ≠ 0) c_a² of the polynomials of the answers f(x_j).
    pub fn variance(&self, answers: &[f64]) -> f64 {
        let coefficient = |row: &Vec<f64>| row.iter().zip(answers).map(|(w, f)| w * f).sum::<f64>();
        self.weighted.iter().skip(1).map(|row| coefficient(row).powi(2)).sum()
    }

    /// θ_j with Σ_j θ_j f(x_j) the value of the polynomials at a germ.
    ///
    /// # Panics
    /// If `germ` does not have a number for each variable.
    pub fn evaluate(&self, germ: &[f64]) -> Vec<f64> {
        let mut theta = vec![0.0; self.weighted[0].len()];
        for (value, row) in self.basis.values(germ).into_iter().zip(&self.weighted) {
            theta.iter_mut().zip(row).for_each(|(t, w)| *t += value * w);
        }
        theta
    }
}

/// Gauss rules of 1, 3, .., 2·`level` + 1 points.
fn one_dimensional(variable: &Variable, level: usize) -> Result<Vec<Rule>, StochasticError> {
    let recurrence = Recurrence::new(variable, variable.germ_support(), 2 * level + 1)?;
    (0..=level).map(|l| recurrence.gauss(2 * l + 1)).collect()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).map(|i| n.saturating_sub(i) as f64 / (i + 1) as f64).product::<f64>().round()
}
