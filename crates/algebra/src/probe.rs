//! Vectors by which factors and products are checked.
//!
//! Two ways of computing the same vector may differ, row by row, by a multiple of the rounding of the sum of the absolute
//! values of the terms, however much the rows of a matrix differ in size. An entry is no larger than that sum, so most rows
//! need the entry alone.

use faer::MatRef;
use steklov_quadrature::unit_uniform;

use crate::Fault;
use crate::operand::{Operand, lower, lower_transposed, symmetric, whole};

/// Largest difference that rounding makes, over the sum of the terms.
const ROUNDING: f64 = 1e-12;
/// Seed of the probes.
const SEED: u64 = 20_261_124;

/// A vector of numbers between ½ and 1 of either sign.
pub(crate) fn probe(size: usize) -> Vec<f64> {
    let entry = |i: usize| {
        let u = unit_uniform(SEED, i as u64);
        if u < 0.5 { u - 1.0 } else { u }
    };
    (0..size).map(entry).collect()
}

/// The same over the roots of a diagonal, so that all unknowns count alike.
pub fn scaled_probe(diagonal: impl ExactSizeIterator<Item = f64>) -> Vec<f64> {
    let mut probe = probe(diagonal.len());
    probe.iter_mut().zip(diagonal).for_each(|(p, d)| *p /= if d > 0.0 { d.sqrt() } else { 1.0 });
    probe
}

/// Whether rounding explains a difference; never if a number is not finite. Numbers below the normal range have no digits.
fn is_rounding(difference: f64, terms: f64) -> bool {
    difference <= ROUNDING * terms + f64::MIN_POSITIVE && difference.is_finite() && terms.is_finite()
}

/// The last product on the way to a vector, and what it is applied to.
pub(crate) struct Last<'a, T, R> {
    /// Values of the vector before it.
    pub inner: &'a [f64],
    /// The sums of the terms of that vector.
    pub terms: T,
    /// The sum of the terms of one row, from values or sums of terms before.
    pub row: R,
}

impl<T: FnOnce() -> Vec<f64>, R: Fn(usize, &[f64]) -> f64> Last<'_, T, R> {
    /// Checks that two ways lead to the same vector, entry by entry.
    ///
    /// Terms are summed where values are too small to tell: first from the values before, then from their terms.
    ///
    /// # Errors
    /// [`Fault`] where they differ by more than rounding, or are no numbers.
    pub fn same(self, what: &'static str, one: &[f64], other: &[f64]) -> Result<(), Fault> {
        let difference = |i: usize| (one[i] - other[i]).abs();
        let mut rows: Vec<usize> = (0..one.len()).collect();
        rows.retain(|&i| !is_rounding(difference(i), one[i].abs() + other[i].abs()));
        rows.retain(|&i| !is_rounding(difference(i), (self.row)(i, self.inner)));
        if rows.is_empty() {
            return Ok(());
        }
        let terms = (self.terms)();
        let part = |&i: &usize| (difference(i), (self.row)(i, &terms));
        let wrong = rows.iter().map(part).filter(|&(difference, terms)| !is_rounding(difference, terms));
        let error =
            wrong.map(|(difference, terms)| difference / terms).reduce(|m, e| if e > m || e.is_nan() { e } else { m });
        error.map_or(Ok(()), |error| Err(Fault { what, size: one.len(), error }))
    }
}

/// Checks that L Lᵀ = A, from the lower triangles of both.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_cholesky(a: MatRef<'_, f64>, l: MatRef<'_, f64>) -> Result<(), Fault> {
    let probe = scaled_probe((0..a.nrows()).map(|i| a[(i, i)]));
    same_as_factor(&probe, symmetric(a), l)
}

/// Checks that L Lᵀ p = A p.
pub(crate) fn same_as_factor(probe: &[f64], a: Operand<'_>, l: MatRef<'_, f64>) -> Result<(), Fault> {
    let (first, last) = (lower_transposed(l), lower(l));
    let inner = first.times(probe);
    let check = Last { inner: &inner, terms: || first.terms(probe), row: |i, x: &[f64]| last.terms_of(i, x) };
    check.same("a Cholesky factor", &last.times(&inner), &a.times(probe))
}

/// Checks that A x = b for a square A, relative to the largest rows: the backward error of a solution.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_solution(a: MatRef<'_, f64>, x: &[f64], b: &[f64]) -> Result<(), Fault> {
    let largest = |v: &mut dyn Iterator<Item = f64>| v.fold(0.0f64, |m, x| if x > m || x.is_nan() { x } else { m });
    let (product, load) = (whole(a).times(x), largest(&mut b.iter().map(|b| b.abs())));
    let difference = largest(&mut product.iter().zip(b).map(|(a, b)| (a - b).abs()));
    if is_rounding(difference, load) {
        return Ok(());
    }
    let scale = load + largest(&mut whole(a).terms(x).into_iter());
    if is_rounding(difference, scale) {
        return Ok(());
    }
    Err(Fault { what: "the solution of a system", size: b.len(), error: difference / scale })
}

/// Checks that A V = U Σ for vectors of length 1, relative to the largest value.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_spectrum(
    a: MatRef<'_, f64>,
    right: MatRef<'_, f64>,
    left: MatRef<'_, f64>,
    values: &[f64],
) -> Result<(), Fault> {
    let probe = probe(values.len());
    let scaled: Vec<f64> = probe.iter().zip(values).map(|(p, value)| p * value).collect();
    // rounding of the values is that of the largest one
    let largest = values.iter().fold(0.0f64, |m, v| if v.abs() > m || v.is_nan() { v.abs() } else { m });
    let (first, last) = (whole(right), whole(a));
    let inner = first.times(&probe);
    let row = |i: usize, x: &[f64]| last.terms_of(i, x) + values.len() as f64 * largest;
    let check = Last { inner: &inner, terms: || first.terms(&probe), row };
    check.same("a spectrum", &last.times(&inner), &whole(left).times(&scaled))
}

/// Checks that A X = 1 for a factor A = L Lᵀ.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_inverse(l: MatRef<'_, f64>, inverse: MatRef<'_, f64>) -> Result<(), Fault> {
    let probe = probe(l.nrows());
    let (first, second, last) = (whole(inverse), lower_transposed(l), lower(l));
    let inner = second.times(&first.times(&probe));
    let terms = || second.terms(&first.terms(&probe));
    let check = Last { inner: &inner, terms, row: |i, x: &[f64]| last.terms_of(i, x) };
    check.same("an inverse", &last.times(&inner), &probe)
}

/// The lower triangle of a sparse symmetric matrix, column by column, diagonal entries first.
#[derive(Debug, Clone, Copy)]
pub struct Sparse<'a> {
    /// Where each column starts, and the end.
    pub start: &'a [usize],
    /// The row of each entry.
    pub rows: &'a [usize],
    /// The entries.
    pub entries: &'a [f64],
}

impl Sparse<'_> {
    /// Calls `of` with row, column and value of each entry of the whole matrix.
    fn each(&self, mut of: impl FnMut(usize, usize, f64)) {
        for (j, range) in self.start.windows(2).enumerate() {
            for k in range[0]..range[1] {
                let (i, a) = (self.rows[k], self.entries[k]);
                of(i, j, a);
                if i != j {
                    of(j, i, a);
                }
            }
        }
    }

    /// A x.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; x.len()];
        self.each(|i, j, a| sum[i] += a * x[j]);
        sum
    }

    /// Checks that A x = b, row by row.
    ///
    /// # Errors
    /// [`Fault`] where rounding does not explain the difference.
    pub fn check(&self, x: &[f64], b: &[f64]) -> Result<(), Fault> {
        let mut terms = vec![0.0; x.len()];
        self.each(|i, j, a| terms[i] += (a * x[j]).abs());
        let check = Last { inner: &terms, terms: Vec::new, row: |i, _: &[f64]| terms[i] };
        check.same("a sparse Cholesky factor", &self.times(x), b)
    }
}
