//! Vectors by which factors and products are checked.
//!
//! Every entry has the sum of the absolute values of its terms beside it: what two ways to the same vector may differ by is a
//! multiple of rounding of that sum, row by row, however the rows of a matrix differ in size.

use faer::{MatRef, Side};
use steklov_quadrature::unit_uniform;

use crate::Fault;

/// Differences that rounding may make, over the sum of the terms.
const ROUNDING: f64 = 1e-12;
/// Seed of the probes.
const SEED: u64 = 20_261_124;
/// Sums that run beside each other.
const LANES: usize = 8;

/// A vector, and for each of its entries the sum of the absolute values of its terms.
#[derive(Debug, Clone)]
pub struct Probe {
    value: Vec<f64>,
    terms: Vec<f64>,
}

/// Part of a matrix that counts.
#[derive(Debug, Clone, Copy)]
enum Part {
    Lower,
    Symmetric(Side),
}

impl Probe {
    /// A vector of numbers between ½ and 1 of either sign.
    pub fn new(size: usize) -> Self {
        let entry = |i: usize| {
            let u = unit_uniform(SEED, i as u64);
            if u < 0.5 { u - 1.0 } else { u }
        };
        Self::of((0..size).map(entry).collect())
    }

    /// The same over the roots of a diagonal, so that all unknowns count alike.
    pub fn scaled(diagonal: impl ExactSizeIterator<Item = f64>) -> Self {
        let mut probe = Self::new(diagonal.len());
        probe.value.iter_mut().zip(diagonal).for_each(|(p, d)| *p /= if d > 0.0 { d.sqrt() } else { 1.0 });
        Self::of(probe.value)
    }

    /// A vector as it is.
    pub fn of(value: Vec<f64>) -> Self {
        Self { terms: value.iter().map(|v| v.abs()).collect(), value }
    }

    /// The entries.
    pub fn values(&self) -> &[f64] {
        &self.value
    }

    fn zeros(size: usize) -> Self {
        Self { value: vec![0.0; size], terms: vec![0.0; size] }
    }

    /// The sum of what the columns of a matrix give.
    fn sum(size: usize, columns: usize, of: impl Fn(&mut Self, usize)) -> Self {
        let mut result = Self::zeros(size);
        pulp::Arch::new().dispatch(|| (0..columns).for_each(|j| of(&mut result, j)));
        result
    }

    /// A p.
    pub fn times(&self, a: MatRef<'_, f64>) -> Self {
        if a.row_stride() == 1 {
            let gain = |sum: &mut Self, j: usize| sum.gain(0, column(a, j), (self.value[j], self.terms[j]));
            Self::sum(a.nrows(), a.ncols(), gain)
        } else if a.col_stride() == 1 {
            let rows = a.transpose();
            let along = |sum: &mut Self, i: usize| (sum.value[i], sum.terms[i]) = self.along(0, column(rows, i));
            Self::sum(a.nrows(), a.nrows(), along)
        } else {
            self.times(a.to_owned().as_ref())
        }
    }

    /// Lᵀ p.
    pub(crate) fn times_transposed_lower(&self, l: MatRef<'_, f64>) -> Self {
        let along = |sum: &mut Self, j: usize| (sum.value[j], sum.terms[j]) = self.along(j, &column(l, j)[j..]);
        Self::sum(l.ncols(), l.ncols(), along)
    }

    /// A p of one triangle of A, whose diagonal is given apart.
    fn times_part(&self, a: MatRef<'_, f64>, part: Part, diagonal: impl Fn(usize) -> f64) -> Self {
        let add = |sum: &mut Self, j: usize| {
            let own = (self.value[j], self.terms[j]);
            let (first, entries) = match part {
                Part::Lower | Part::Symmetric(Side::Lower) => (j + 1, &column(a, j)[j + 1..]),
                Part::Symmetric(Side::Upper) => (0, &column(a, j)[..j]),
            };
            sum.gain(first, entries, own);
            sum.gain(j, &[diagonal(j)], own);
            if let Part::Symmetric(_) = part {
                let (value, terms) = self.along(first, entries);
                sum.value[j] += value;
                sum.terms[j] += terms;
            }
        };
        Self::sum(a.nrows(), a.ncols(), add)
    }

    /// L p.
    pub fn times_lower(&self, l: MatRef<'_, f64>) -> Self {
        self.times_part(l, Part::Lower, |j| l[(j, j)])
    }

    /// A p of the lower triangle of a symmetric A.
    pub fn times_symmetric(&self, a: MatRef<'_, f64>) -> Self {
        self.times_part(a, Part::Symmetric(Side::Lower), |j| a[(j, j)])
    }

    /// A p of a symmetric A whose lower triangle is another matrix, and whose diagonal is given apart.
    pub(crate) fn times_upper(&self, a: MatRef<'_, f64>, diagonal: &[f64]) -> Self {
        self.times_part(a, Part::Symmetric(Side::Upper), |j| diagonal[j])
    }

    /// A p of the lower triangle of a sparse symmetric A, column by column, diagonal entries first.
    pub fn times_sparse(&self, start: &[usize], rows: &[usize], entries: &[f64]) -> Self {
        let mut result = Self::zeros(self.value.len());
        for j in 0..self.value.len() {
            for k in start[j]..start[j + 1] {
                let (i, a) = (rows[k], entries[k]);
                result.value[i] += a * self.value[j];
                result.terms[i] += a.abs() * self.terms[j];
                if i != j {
                    result.value[j] += a * self.value[i];
                    result.terms[j] += a.abs() * self.terms[i];
                }
            }
        }
        result
    }

    /// Adds a multiple of another vector.
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.value.iter_mut().zip(&other.value).for_each(|(a, b)| *a += factor * b);
        self.terms.iter_mut().zip(&other.terms).for_each(|(a, b)| *a += factor.abs() * b);
    }

    /// That two ways lead to the same vector, entry by entry.
    ///
    /// # Errors
    /// [`Fault`] where they differ by more than rounding, or are no numbers.
    pub fn same(&self, other: &Self, what: &'static str) -> Result<(), Fault> {
        let difference = |i: usize| {
            let (difference, terms) = ((self.value[i] - other.value[i]).abs(), self.terms[i] + other.terms[i]);
            match difference / terms {
                _ if is_rounding(difference, terms) => 0.0,
                part if part > 0.0 => part,
                _ => f64::NAN,
            }
        };
        let size = self.value.len();
        let error = (0..size).map(difference).fold(0.0, |m: f64, d| if d > m || d.is_nan() { d } else { m });
        if error == 0.0 { Ok(()) } else { Err(Fault { what, size, error }) }
    }

    /// x += c, from row `first`.
    #[inline(always)]
    fn gain(&mut self, first: usize, entries: &[f64], (value, terms): (f64, f64)) {
        let to = self.value[first..].iter_mut().zip(&mut self.terms[first..]);
        for ((v, t), a) in to.zip(entries) {
            *v += a * value;
            *t += a.abs() * terms;
        }
    }

    /// c · x, from row `first`.
    #[inline(always)]
    fn along(&self, first: usize, entries: &[f64]) -> (f64, f64) {
        let (mut value, mut terms) = ([0.0; LANES], [0.0; LANES]);
        let of = |x: &[f64]| -> usize { x.len() / LANES * LANES };
        let (whole, rest) = entries.split_at(of(entries));
        let (x, t) = (&self.value[first..first + entries.len()], &self.terms[first..first + entries.len()]);
        let blocks = whole.chunks_exact(LANES).zip(x.chunks_exact(LANES)).zip(t.chunks_exact(LANES));
        for ((a, x), t) in blocks {
            for k in 0..LANES {
                value[k] += a[k] * x[k];
                terms[k] += a[k].abs() * t[k];
            }
        }
        let mut sums = (value.iter().sum(), terms.iter().sum());
        for ((a, x), t) in rest.iter().zip(&x[whole.len()..]).zip(&t[whole.len()..]) {
            sums = (sums.0 + a * x, sums.1 + a.abs() * t);
        }
        sums
    }
}

/// Whether a difference is one of rounding; never where a number is not finite. What is below all numbers has no digits.
fn is_rounding(difference: f64, terms: f64) -> bool {
    difference <= ROUNDING * terms + f64::MIN_POSITIVE && difference.is_finite() && terms.is_finite()
}

#[inline(always)]
fn column(a: MatRef<'_, f64>, j: usize) -> &[f64] {
    a.col(j).try_as_col_major().map_or(&[], |column| column.as_slice())
}

/// That L Lᵀ = A, of the lower triangles of both.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_cholesky(a: MatRef<'_, f64>, l: MatRef<'_, f64>) -> Result<(), Fault> {
    let probe = Probe::scaled((0..a.nrows()).map(|i| a[(i, i)]));
    same_as_factor(&probe, &probe.times_symmetric(a), l)
}

/// That L Lᵀ p is what A p was.
pub(crate) fn same_as_factor(probe: &Probe, wanted: &Probe, l: MatRef<'_, f64>) -> Result<(), Fault> {
    probe.times_transposed_lower(l).times_lower(l).same(wanted, "a Cholesky factor")
}

/// That A x = b for a square A, relative to the largest rows: the backward error of a solution.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_solution(a: MatRef<'_, f64>, x: &[f64], b: &[f64]) -> Result<(), Fault> {
    let size = b.len();
    let product = Probe::of(x.to_vec()).times(a);
    let largest = |v: &mut dyn Iterator<Item = f64>| v.fold(0.0f64, |m, x| if x > m || x.is_nan() { x } else { m });
    let difference = largest(&mut product.value.iter().zip(b).map(|(a, b)| (a - b).abs()));
    let scale = largest(&mut product.terms.iter().copied()) + largest(&mut b.iter().map(|b| b.abs()));
    if is_rounding(difference, scale) {
        return Ok(());
    }
    Err(Fault { what: "the solution of a system", size, error: difference / scale })
}

/// That A V = U Σ of vectors of length 1, relative to the largest value.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_spectrum(
    a: MatRef<'_, f64>,
    (right, left): (MatRef<'_, f64>, MatRef<'_, f64>),
    values: &[f64],
) -> Result<(), Fault> {
    let size = values.len();
    let probe = Probe::new(size);
    let scaled = Probe::of(probe.value.iter().zip(values).map(|(p, value)| p * value).collect());
    let mut product = probe.times(right).times(a);
    // rounding of the values is that of the largest one
    let largest = values.iter().fold(0.0f64, |m, v| if v.abs() > m || v.is_nan() { v.abs() } else { m });
    product.terms.iter_mut().for_each(|t| *t += size as f64 * largest);
    product.same(&scaled.times(left), "a spectrum")
}

/// That A X = 1 of a factor A = L Lᵀ.
///
/// # Errors
/// [`Fault`] where rounding does not explain the difference.
pub fn check_inverse(l: MatRef<'_, f64>, inverse: MatRef<'_, f64>) -> Result<(), Fault> {
    let probe = Probe::new(l.nrows());
    probe.times(inverse).times_transposed_lower(l).times_lower(l).same(&probe, "an inverse")
}
