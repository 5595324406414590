//! Matrices, or triangles of them, as they act on vectors.
//!
//! A product reads each entry once, some columns at a time: that is what a check costs.

use std::ops::Range;

use faer::{MatRef, Side};
use pulp::{Simd, WithSimd};

/// Columns that are read together.
const PANEL: usize = 4;

/// Which part of a matrix is used, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    Whole,
    Lower,
    Symmetric(Side),
}

/// A matrix of contiguous columns, or its transpose.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Operand<'a> {
    columns: MatRef<'a, f64>,
    part: Part,
    transposed: bool,
    /// The diagonal, if it differs from that of the matrix.
    diagonal: Option<&'a [f64]>,
}

/// A of contiguous columns or rows.
///
/// # Panics
/// When it has neither.
pub(crate) fn whole(a: MatRef<'_, f64>) -> Operand<'_> {
    let transposed = a.row_stride() != 1;
    assert!(!transposed || a.col_stride() == 1, "a matrix of contiguous columns or rows");
    Operand { columns: if transposed { a.transpose() } else { a }, part: Part::Whole, transposed, diagonal: None }
}

/// L.
pub(crate) fn lower(l: MatRef<'_, f64>) -> Operand<'_> {
    Operand { columns: l, part: Part::Lower, transposed: false, diagonal: None }
}

/// Lᵀ.
pub(crate) fn lower_transposed(l: MatRef<'_, f64>) -> Operand<'_> {
    Operand { transposed: true, ..lower(l) }
}

/// A symmetric matrix by its lower triangle.
pub(crate) fn symmetric(a: MatRef<'_, f64>) -> Operand<'_> {
    Operand { part: Part::Symmetric(Side::Lower), ..lower(a) }
}

/// A symmetric matrix by its strict upper triangle and its diagonal.
pub(crate) fn symmetric_upper<'a>(a: MatRef<'a, f64>, diagonal: &'a [f64]) -> Operand<'a> {
    Operand { part: Part::Symmetric(Side::Upper), diagonal: Some(diagonal), ..lower(a) }
}

impl<'a> Operand<'a> {
    fn rows(&self) -> usize {
        if self.transposed { self.columns.ncols() } else { self.columns.nrows() }
    }

    /// A x.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.rows()];
        pulp::Arch::new().dispatch(Pass { of: *self, x, sum: &mut sum });
        sum
    }

    /// Adds the columns times entries of x to the sum (GIVE), and the products of the columns with x (TAKE).
    #[inline(always)]
    fn add_panels<S: Simd, const GIVE: bool, const TAKE: bool>(&self, simd: S, x: &[f64], sum: &mut [f64]) {
        let (n, whole) = (self.columns.ncols(), self.part == Part::Whole);
        for start in (0..n).step_by(PANEL) {
            let end = n.min(start + PANEL);
            let rows = match self.part {
                Part::Whole => 0..self.columns.nrows(),
                Part::Lower | Part::Symmetric(Side::Lower) => end..self.columns.nrows(),
                Part::Symmetric(Side::Upper) => 0..start,
            };
            // the last panel is filled up by its last column, times 0
            let panel: [&[f64]; PANEL] = std::array::from_fn(|k| &self.column((start + k).min(n - 1))[rows.clone()]);
            if GIVE {
                let factors = std::array::from_fn(|k| if start + k < n { x[start + k] } else { 0.0 });
                give(simd, panel, factors, &mut sum[rows.clone()]);
            }
            if TAKE {
                let taken = take(simd, panel, &x[rows]);
                sum[start..end].iter_mut().zip(taken).for_each(|(s, t)| *s += t);
            }
            if !whole {
                self.corner::<GIVE, TAKE>(start..end, &x[start..end], &mut sum[start..end]);
            }
        }
    }

    /// The entries of a triangle in these columns and the same rows, with their parts of x and of the sum.
    #[inline(always)]
    fn corner<const GIVE: bool, const TAKE: bool>(&self, at: Range<usize>, x: &[f64], sum: &mut [f64]) {
        for j in 0..x.len() {
            let column = &self.column(at.start + j)[at.clone()];
            let diagonal = self.diagonal.map_or(column[j], |diagonal| diagonal[at.start + j]);
            sum[j] += diagonal * x[j];
            let rest = if self.part == Part::Symmetric(Side::Upper) { 0..j } else { j + 1..x.len() };
            for i in rest {
                if GIVE {
                    sum[i] += column[i] * x[j];
                }
                if TAKE {
                    sum[j] += column[i] * x[i];
                }
            }
        }
    }

    /// The sums of |A| |x|, entry by entry.
    pub fn terms(&self, x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.rows()];
        for j in 0..self.columns.ncols() {
            for i in self.counted(j) {
                let a = self.entry(i, j).abs();
                if self.transposed {
                    sum[j] += a * x[i].abs();
                } else {
                    sum[i] += a * x[j].abs();
                }
                if i != j && matches!(self.part, Part::Symmetric(_)) {
                    sum[j] += a * x[i].abs();
                }
            }
        }
        sum
    }

    /// The entry of |A| |x| in one row.
    pub fn terms_of(&self, row: usize, x: &[f64]) -> f64 {
        let term = |k: usize| {
            let (i, j) = if self.transposed { (k, row) } else { (row, k) };
            match self.part {
                _ if self.counted(j).contains(&i) => self.entry(i, j).abs() * x[k].abs(),
                Part::Symmetric(_) => self.entry(j, i).abs() * x[k].abs(),
                _ => 0.0,
            }
        };
        (0..x.len()).map(term).sum()
    }

    /// Rows that count in a column.
    fn counted(&self, j: usize) -> Range<usize> {
        match self.part {
            Part::Whole => 0..self.columns.nrows(),
            Part::Lower | Part::Symmetric(Side::Lower) => j..self.columns.nrows(),
            Part::Symmetric(Side::Upper) => 0..j + 1,
        }
    }

    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> f64 {
        match self.diagonal {
            Some(diagonal) if i == j => diagonal[i],
            _ => self.columns[(i, j)],
        }
    }

    #[inline(always)]
    fn column(&self, j: usize) -> &'a [f64] {
        self.columns.col(j).try_as_col_major().expect("contiguous columns").as_slice()
    }
}

/// A product with a vector, by the widest vectors of the processor.
struct Pass<'a> {
    of: Operand<'a>,
    x: &'a [f64],
    sum: &'a mut [f64],
}

impl WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { of, x, sum } = self;
        match (of.part, of.transposed) {
            (Part::Symmetric(_), _) => of.add_panels::<S, true, true>(simd, x, sum),
            (_, false) => of.add_panels::<S, true, false>(simd, x, sum),
            (_, true) => of.add_panels::<S, false, true>(simd, x, sum),
        }
    }
}

/// sum += Σ a_k x_k.
#[inline(always)]
fn give<S: Simd>(simd: S, a: [&[f64]; PANEL], x: [f64; PANEL], sum: &mut [f64]) {
    let (sums, rest) = S::as_mut_simd_f64s(sum);
    let [(a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)] = a.map(S::as_simd_f64s);
    let factors = x.map(|x| simd.splat_f64s(x));
    for ((((sum, &a), &b), &c), &d) in sums.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        let two = simd.mul_add_e_f64s(b, factors[1], simd.mul_add_e_f64s(a, factors[0], *sum));
        *sum = simd.mul_add_e_f64s(d, factors[3], simd.mul_add_e_f64s(c, factors[2], two));
    }
    for ((((sum, a), b), c), d) in rest.iter_mut().zip(a_rest).zip(b_rest).zip(c_rest).zip(d_rest) {
        *sum += (a * x[0] + b * x[1]) + (c * x[2] + d * x[3]);
    }
}

/// a_k · x.
#[inline(always)]
fn take<S: Simd>(simd: S, a: [&[f64]; PANEL], x: &[f64]) -> [f64; PANEL] {
    let (x, x_rest) = S::as_simd_f64s(x);
    let [(a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)] = a.map(S::as_simd_f64s);
    let mut sums = [simd.splat_f64s(0.0); PANEL];
    for ((((&x, &a), &b), &c), &d) in x.iter().zip(a).zip(b).zip(c).zip(d) {
        sums[0] = simd.mul_add_e_f64s(a, x, sums[0]);
        sums[1] = simd.mul_add_e_f64s(b, x, sums[1]);
        sums[2] = simd.mul_add_e_f64s(c, x, sums[2]);
        sums[3] = simd.mul_add_e_f64s(d, x, sums[3]);
    }
    let mut taken = sums.map(|sum| simd.reduce_sum_f64s(sum));
    for ((((x, a), b), c), d) in x_rest.iter().zip(a_rest).zip(b_rest).zip(c_rest).zip(d_rest) {
        taken.iter_mut().zip([a, b, c, d]).for_each(|(taken, a)| *taken += a * x);
    }
    taken
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    /// Every kind of operand of these sizes, with its full matrix.
    fn operands(a: &Mat<f64>, diagonal: &[f64], of: impl Fn(Operand<'_>, Mat<f64>)) {
        let (m, n) = (a.nrows(), a.ncols());
        of(whole(a.as_ref()), a.clone());
        of(whole(a.transpose()), a.transpose().to_owned());
        if m == n {
            let l = Mat::from_fn(n, n, |i, j| if i >= j { a[(i, j)] } else { 0.0 });
            of(lower(a.as_ref()), l.clone());
            of(lower_transposed(a.as_ref()), l.transpose().to_owned());
            of(symmetric(a.as_ref()), Mat::from_fn(n, n, |i, j| a[(i.max(j), i.min(j))]));
            let upper = |i: usize, j: usize| if i == j { diagonal[i] } else { a[(i.min(j), i.max(j))] };
            of(symmetric_upper(a.as_ref(), diagonal), Mat::from_fn(n, n, upper));
        }
    }

    #[test]
    fn products_and_terms_are_those_of_the_matrix() {
        for (m, n) in [(1, 1), (1, 5), (5, 1), (3, 3), (4, 4), (7, 7), (8, 8), (33, 33), (34, 34), (19, 70), (66, 9)] {
            let a = Mat::from_fn(m, n, |i, j| ((7 * i + 3 * j) as f64).sin());
            let diagonal: Vec<f64> = (0..n).map(|i| 2.0 + (i as f64).cos()).collect();
            operands(&a, &diagonal, |operand, full| {
                let x: Vec<f64> = (0..full.ncols()).map(|j| (5.0 * j as f64).cos()).collect();
                let (values, terms) = (operand.times(&x), operand.terms(&x));
                assert_eq!((values.len(), terms.len()), (full.nrows(), full.nrows()));
                for i in 0..full.nrows() {
                    let wanted: f64 = (0..full.ncols()).map(|j| full[(i, j)] * x[j]).sum();
                    let of_terms: f64 = (0..full.ncols()).map(|j| (full[(i, j)] * x[j]).abs()).sum();
                    let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * of_terms;
                    assert!(near(values[i], wanted), "{operand:?}, {i}: {} {wanted}", values[i]);
                    assert!(near(terms[i], of_terms) && near(operand.terms_of(i, &x), of_terms), "{operand:?}, {i}");
                }
            });
        }
    }
}
