//! Products of dense matrices with the sparse ones of the trace, and dense symmetric systems.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};
use rayon::prelude::*;
use sprs::CsMat;

/// X E with E stored by columns.
pub(crate) fn times(x: MatRef<'_, f64>, e: &CsMat<f64>) -> Mat<f64> {
    let columns: Vec<Vec<f64>> = (0..e.cols())
        .into_par_iter()
        .map(|j| {
            let mut sum = vec![0.0; x.nrows()];
            let column = e.outer_view(j).unwrap_or_else(|| unreachable!("stored by columns"));
            for (i, &value) in column.iter() {
                sum.iter_mut().zip(x.col(i).iter()).for_each(|(s, x)| *s += value * x);
            }
            sum
        })
        .collect();
    Mat::from_fn(x.nrows(), e.cols(), |i, j| columns[j][i])
}

/// Eᵀ X E.
pub(crate) fn congruence(x: MatRef<'_, f64>, e: &CsMat<f64>) -> Mat<f64> {
    let right = times(x, e);
    times(right.transpose(), e).transpose().to_owned()
}

/// E x with E stored by columns.
pub(crate) fn apply(e: &CsMat<f64>, x: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; e.rows()];
    for (column, x) in e.outer_iterator().zip(x) {
        column.iter().for_each(|(i, value)| sum[i] += value * x);
    }
    sum
}

/// Eᵀ y with E stored by columns.
pub(crate) fn apply_transposed(e: &CsMat<f64>, y: &[f64]) -> Vec<f64> {
    e.outer_iterator().map(|column| column.iter().map(|(i, value)| value * y[i]).sum()).collect()
}

/// X y.
pub(crate) fn product(x: MatRef<'_, f64>, y: &[f64]) -> Vec<f64> {
    let y = faer::Col::from_fn(y.len(), |i| y[i]);
    (x * y).iter().copied().collect()
}

/// The solution of a symmetric system, of which the lower triangle is read; None where it is not finite.
pub(crate) fn solve_indefinite(matrix: MatRef<'_, f64>, right: &[f64]) -> Option<Vec<f64>> {
    let b = Mat::from_fn(right.len(), 1, |i, _| right[i]);
    finite(&matrix.lblt(Side::Lower).solve(&b))
}

/// The same for a positive definite one; None where it is not.
pub(crate) fn solve_definite(matrix: MatRef<'_, f64>, right: &[f64]) -> Option<Vec<f64>> {
    let b = Mat::from_fn(right.len(), 1, |i, _| right[i]);
    finite(&matrix.llt(Side::Lower).ok()?.solve(&b))
}

fn finite(x: &Mat<f64>) -> Option<Vec<f64>> {
    let x = x.col_as_slice(0);
    x.iter().all(|x| x.is_finite()).then(|| x.to_vec())
}
