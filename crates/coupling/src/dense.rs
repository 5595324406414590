//! Products of dense matrices with the sparse ones of the trace, and dense symmetric systems.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::linalg::cholesky::{lblt, llt};
use faer::{Mat, MatMut, MatRef, Par};
use rayon::prelude::*;
use sprs::CsMat;
use steklov_algebra::{Fault, PARTS, check_cholesky, check_solution, spoil, threads};

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
    let mut sum = vec![0.0; x.nrows()];
    for (column, y) in x.col_iter().zip(y) {
        sum.iter_mut().zip(column.iter()).for_each(|(s, x)| *s += y * x);
    }
    sum
}

/// Parallelism of dense algebra: cut into the same parts whatever the number of threads, for the same bits.
fn parts() -> Par {
    threads(Par::rayon(PARTS))
}

/// Solves a symmetric system in place, reading its lower triangle; None if the solution is not finite.
///
/// # Errors
/// A result that does not solve the system.
pub(crate) fn solve_indefinite(mut matrix: Mat<f64>, mut right: Vec<f64>) -> Result<Option<Vec<f64>>, Fault> {
    let (n, par) = (right.len(), parts());
    let (whole, load) = (mirrored(&matrix), right.clone());
    let mut below = Diag::zeros(n);
    let (mut forward, mut backward) = (vec![0usize; n], vec![0usize; n]);
    let scratch = lblt::factor::cholesky_in_place_scratch::<usize, f64>(n, par, Default::default());
    let mut memory = MemBuffer::new(scratch.or(lblt::solve::solve_in_place_scratch::<usize, f64>(n, 1, par)));
    let stack = MemStack::new(&mut memory);
    let (_, permutation) = lblt::factor::cholesky_in_place(
        matrix.as_mut(),
        below.as_mut(),
        &mut forward,
        &mut backward,
        par,
        stack,
        Default::default(),
    );
    let diagonal = matrix.diagonal().to_owned();
    let stack = MemStack::new(&mut memory);
    let solution = MatMut::from_column_major_slice_mut(&mut right, n, 1);
    lblt::solve::solve_in_place(matrix.as_ref(), diagonal.as_ref(), below.as_ref(), permutation, solution, par, stack);
    if !right.iter().all(|x| x.is_finite()) {
        return Ok(None);
    }
    spoil(MatMut::from_column_major_slice_mut(&mut right, n, 1), false);
    check_solution(whole.as_ref(), &right, &load)?;
    Ok(Some(right))
}

/// A symmetric matrix by its lower triangle.
fn mirrored(a: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i.max(j), i.min(j))])
}

/// The Cholesky factor of a positive definite matrix.
#[derive(Debug, Clone)]
pub(crate) struct Definite(Mat<f64>);

impl Definite {
    /// Factorises in place, reading the lower triangle; None if the matrix is not definite.
    ///
    /// # Errors
    /// A wrong factor.
    pub fn new(mut matrix: Mat<f64>) -> Result<Option<Self>, Fault> {
        let par = parts();
        let whole = mirrored(&matrix);
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(matrix.nrows(), par, Default::default());
        let (mut memory, regular) = (MemBuffer::new(scratch), LltRegularization::default());
        let stack = MemStack::new(&mut memory);
        if llt::factor::cholesky_in_place(matrix.as_mut(), regular, par, stack, Default::default()).is_err() {
            return Ok(None);
        }
        spoil(matrix.as_mut(), true);
        check_cholesky(whole.as_ref(), matrix.as_ref())?;
        Ok(Some(Self(matrix)))
    }

    /// The solutions for these columns; None if one is not finite.
    pub fn solve(&self, mut right: Mat<f64>) -> Option<Mat<f64>> {
        let par = parts();
        let scratch = llt::solve::solve_in_place_scratch::<f64>(self.0.nrows(), right.ncols(), par);
        let mut memory = MemBuffer::new(scratch);
        llt::solve::solve_in_place(self.0.as_ref(), right.as_mut(), par, MemStack::new(&mut memory));
        right.is_all_finite().then_some(right)
    }
}
