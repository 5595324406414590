//! Orthonormal polynomials of total degree p in several germs, and their products with a germ.

use crate::{Recurrence, StochasticError, Variable};

/// Most polynomials.
const MOST: f64 = 2e6;

/// ψ_a(ξ) = Π_m p_{a_m}(ξ_m) for all a with |a| = Σ_m a_m ≤ p, orthonormal for the density of independent germs:
/// binomial(d + p, p) of them. ψ_0 = 1 comes first; the last index runs fastest.
#[derive(Debug, Clone)]
pub struct TotalDegree {
    recurrences: Vec<Recurrence>,
    degrees: Vec<Vec<usize>>,
    degree: usize,
}

/// A polynomial next to ψ_a in one germ, and E[(ξ_m - E ξ_m) ψ_a ψ_b].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupled {
    /// m.
    pub germ: usize,
    /// b.
    pub other: usize,
    /// The integral, in units of the germ.
    pub value: f64,
}

impl TotalDegree {
    /// The polynomials of total degree `degree` in the germs of variables.
    ///
    /// # Errors
    /// [`StochasticError::Number`] for more than two million polynomials or a degree above 254; those of [`Recurrence::new`].
    pub fn new(variables: &[Variable], degree: usize) -> Result<Self, StochasticError> {
        let count = (1..=degree).fold(1.0, |c, k| c * (variables.len() + k) as f64 / k as f64);
        if count > MOST {
            return Err(StochasticError::Number {
                what: format!("the number of polynomials of degree {degree} in {} germs", variables.len()),
                value: count,
                wanted: "at most 2e6: lower the degree",
            });
        }
        let recurrences: Result<Vec<_>, _> =
            variables.iter().map(|v| Recurrence::new(v, v.germ_support(), degree + 1)).collect();
        let mut degrees = vec![vec![0; variables.len()]];
        let mut index = vec![0; variables.len()];
        while next(&mut index, degree) {
            degrees.push(index.clone());
        }
        Ok(Self { recurrences: recurrences?, degrees, degree })
    }

    /// Degrees of each polynomial in each germ.
    pub fn degrees(&self) -> &[Vec<usize>] {
        &self.degrees
    }

    /// p.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// |a| of each polynomial.
    pub fn totals(&self) -> impl Iterator<Item = usize> {
        self.degrees.iter().map(|a| a.iter().sum())
    }

    /// E ξ_m and the standard deviation of ξ_m, of a germ with degree 1 or more.
    pub fn germ(&self, m: usize) -> [f64; 2] {
        let Recurrence { shift, scale, alpha, beta, .. } = &self.recurrences[m];
        [shift + scale * alpha[0], scale * beta.get(1).map_or(0.0, |b| b.sqrt())]
    }

    /// All ψ_a at a germ.
    ///
    /// # Panics
    /// If `germ` does not have a number for each variable.
    pub fn values(&self, germ: &[f64]) -> Vec<f64> {
        assert_eq!(germ.len(), self.recurrences.len(), "a number for each variable");
        let mut one = vec![vec![0.0; self.degree + 1]; germ.len()];
        for ((recurrence, &x), values) in self.recurrences.iter().zip(germ).zip(&mut one) {
            recurrence.evaluate(x, values);
        }
        self.degrees.iter().map(|a| a.iter().zip(&one).map(|(&k, p)| p[k]).product()).collect()
    }

    /// For each ψ_a the entries G_m[a, b] = E[(ξ_m - E ξ_m) ψ_a ψ_b] that are not zero, by germ and by other polynomial:
    /// with the coefficients of the recurrence and t = (ξ_m - shift)/scale, t p_k = √β_{k+1} p_{k+1} + α_k p_k + √β_k p_{k-1}.
    ///
    /// Source: Ghanem and Spanos (1991), section 3.3; Gautschi (2004), section 1.3.
    pub fn products(&self) -> Vec<Vec<Coupled>> {
        let place = |a: &Vec<usize>| self.degrees.binary_search(a).ok();
        let of = |a: &Vec<usize>| {
            let mut row = Vec::new();
            for (germ, recurrence) in self.recurrences.iter().enumerate() {
                let (k, Recurrence { scale, alpha, beta, .. }) = (a[germ], recurrence);
                let mut beside = a.clone();
                let mut push = |degree: usize, value: f64| {
                    beside[germ] = degree;
                    row.extend(place(&beside).map(|other| Coupled { germ, other, value: scale * value }));
                };
                if k > 0 {
                    push(k - 1, beta[k].sqrt());
                }
                if alpha[k] != alpha[0] {
                    push(k, alpha[k] - alpha[0]);
                }
                if k < self.degree {
                    push(k + 1, beta[k + 1].sqrt());
                }
            }
            row
        };
        self.degrees.iter().map(of).collect()
    }

    /// The share of the variance Σ_(a ≠ 0) c_a² that remains when all other germs are known, for each germ: Sobol's total
    /// effect Σ_(a_m > 0) c_a²/Σ_(a ≠ 0) c_a².
    ///
    /// Source: Sudret (2008).
    pub fn effects(&self, coefficients: &[f64]) -> Vec<f64> {
        let variance: f64 = coefficients.iter().skip(1).map(|c| c * c).sum();
        let of = |m: usize| {
            let depends = self.degrees.iter().zip(coefficients).filter(|(a, _)| a[m] > 0);
            depends.map(|(_, c)| c * c).sum::<f64>() / variance
        };
        (0..self.recurrences.len()).map(of).collect()
    }
}

/// The next index set with a sum to `degree`, the last index fastest; whether there is one.
pub(crate) fn next(index: &mut [usize], degree: usize) -> bool {
    let mut sum: usize = index.iter().sum();
    for d in (0..index.len()).rev() {
        if sum < degree {
            index[d] += 1;
            return true;
        }
        sum -= index[d];
        index[d] = 0;
    }
    false
}
