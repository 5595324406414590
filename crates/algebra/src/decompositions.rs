//! Decompositions of real dense matrices that are compiled once, here.
//!
//! The library behind them is generic, so a crate that calls it compiles all of it again. These functions are not: a caller
//! links them. Each copies its matrix first. Where the matrix is symmetric, only its lower triangle is read.
//!
//! None of them checks its result; [`llt`](crate::llt) and the functions `check_*` do.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::solvers::{DenseSolveCore, Llt, PartialPivLu};
use faer::prelude::*;
use faer::{Mat, MatRef, Par, Side, c64};

/// An iteration for eigenvalues or singular values that did not end: of a finite matrix it always has; entries are not
/// finite, or the processor is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("no spectrum was found: the entries of the matrix are not finite, or the iteration did not end")]
pub struct NoSpectrum;

/// The factor L of A = L Lᵀ, for symmetric positive definite A: half the work of [`Lu`].
#[derive(Debug, Clone)]
pub struct Cholesky(Llt<f64>);

impl Cholesky {
    /// Factorises in n³/3 operations; fails when A is not positive definite to rounding.
    ///
    /// # Errors
    /// The index of the first pivot that is not positive.
    ///
    /// # Panics
    /// When A is not square.
    #[inline(never)]
    pub fn new(a: MatRef<'_, f64>) -> Result<Self, usize> {
        a.llt(Side::Lower).map(Self).map_err(|LltError::NonPositivePivot { index }| index)
    }

    /// L, with zeros above its diagonal.
    pub fn lower(&self) -> MatRef<'_, f64> {
        self.0.L()
    }

    /// X = A⁻¹ B in 2 n² operations for each column.
    ///
    /// # Panics
    /// When B has not as many rows as A.
    #[inline(never)]
    pub fn solve(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        self.0.solve(b)
    }

    /// A⁻¹, symmetric, in 2 n³/3 operations; to apply it once, [`Self::solve`] is cheaper.
    #[inline(never)]
    pub fn inverse(&self) -> Mat<f64> {
        self.0.inverse()
    }
}

/// The factors of P A = L U with rows exchanged, for square A that is well away from singular.
#[derive(Debug, Clone)]
pub struct Lu(PartialPivLu<f64>);

impl Lu {
    /// Factorises in 2 n³/3 operations; for singular A there are pivots that vanish or are rounding.
    ///
    /// # Panics
    /// When A is not square.
    #[inline(never)]
    pub fn new(a: MatRef<'_, f64>) -> Self {
        assert_eq!(a.nrows(), a.ncols(), "the matrix is not square");
        Self(a.partial_piv_lu())
    }

    /// The diagonal of U, whose product is ± the determinant of A.
    pub fn pivots(&self) -> Vec<f64> {
        let u = self.0.U();
        (0..u.nrows()).map(|i| u[(i, i)]).collect()
    }

    /// X = A⁻¹ B in 2 n² operations for each column; not finite, or rounding, where A is singular.
    ///
    /// # Panics
    /// When B has not as many rows as A.
    #[inline(never)]
    pub fn solve(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        self.0.solve(b)
    }

    /// A⁻¹ in 4 n³/3 operations; not finite, or rounding, where A is singular.
    #[inline(never)]
    pub fn inverse(&self) -> Mat<f64> {
        self.0.inverse()
    }
}

/// X = A⁻¹ B by P A Q = L U with rows and columns exchanged: 2 n³/3 operations and as many comparisons, several times slower than
/// [`Lu`]; for small A of rows that differ in size. Not finite, or rounding, where A is singular.
///
/// # Panics
/// When A is not square, or B has not as many rows.
#[inline(never)]
pub fn solve_full_lu(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    assert_eq!(a.nrows(), a.ncols(), "the matrix is not square");
    a.full_piv_lu().solve(b)
}

/// X of least ‖A X - B‖, column by column, by A = Q R: 2 m n² operations for m rows and n columns, m ≥ n. For A of full rank;
/// otherwise X is not finite, or rounding.
///
/// # Panics
/// When A has fewer rows than columns, or B has not as many rows.
#[inline(never)]
pub fn least_squares(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    a.qr().solve_lstsq(b)
}

/// A = V Λ Vᵀ for symmetric A.
#[derive(Debug, Clone)]
pub struct SymmetricEigen {
    /// Λ, ascending.
    pub values: Vec<f64>,
    /// V, orthogonal; column by column the vectors of `values`.
    pub vectors: Mat<f64>,
}

/// A = V Λ Vᵀ for symmetric A in about 9 n³ operations. Values are accurate to rounding of the largest; vectors of values that
/// are close together may be any of their span.
///
/// # Errors
/// [`NoSpectrum`].
///
/// # Panics
/// When A is not square.
#[inline(never)]
pub fn symmetric_eigen(a: MatRef<'_, f64>) -> Result<SymmetricEigen, NoSpectrum> {
    let eigen = a.self_adjoint_eigen(Side::Lower).map_err(|_| NoSpectrum)?;
    let values = eigen.S().column_vector().iter().copied().collect();
    Ok(SymmetricEigen { values, vectors: eigen.U().to_owned() })
}

/// [`symmetric_eigen`] on one thread: the same bits for any number of them.
///
/// # Errors
/// [`NoSpectrum`].
///
/// # Panics
/// When A is not square.
#[inline(never)]
pub fn symmetric_eigen_on_one_thread(a: MatRef<'_, f64>) -> Result<SymmetricEigen, NoSpectrum> {
    let n = a.nrows();
    let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    let request = self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(request);
    let stack = MemStack::new(&mut memory);
    self_adjoint_evd(a, values.as_mut(), Some(vectors.as_mut()), Par::Seq, stack, Default::default())
        .map_err(|_| NoSpectrum)?;
    Ok(SymmetricEigen { values: values.column_vector().iter().copied().collect(), vectors })
}

/// Λ of [`symmetric_eigen`], ascending, without the vectors: 4 n³/3 operations.
///
/// # Errors
/// [`NoSpectrum`].
///
/// # Panics
/// When A is not square.
#[inline(never)]
pub fn symmetric_eigenvalues(a: MatRef<'_, f64>) -> Result<Vec<f64>, NoSpectrum> {
    a.self_adjoint_eigenvalues(Side::Lower).map_err(|_| NoSpectrum)
}

/// The zeros λ of det(A - λ) of a square A, conjugate where complex, in no order: about 10 n³ operations. For symmetric A
/// [`symmetric_eigenvalues`] is cheaper; where A lacks eigenvectors, a multiple λ keeps only a part of its digits.
///
/// # Errors
/// [`NoSpectrum`].
///
/// # Panics
/// When A is not square.
#[inline(never)]
pub fn eigenvalues(a: MatRef<'_, f64>) -> Result<Vec<c64>, NoSpectrum> {
    a.eigenvalues().map_err(|_| NoSpectrum)
}

/// A = U Σ Vᵀ.
#[derive(Debug, Clone)]
pub struct Svd {
    /// U, orthogonal and square.
    pub left: Mat<f64>,
    /// The diagonal of Σ, not negative, descending.
    pub values: Vec<f64>,
    /// V, orthogonal and square.
    pub right: Mat<f64>,
}

/// A = U Σ Vᵀ of any A, singular ones too: about 20 n³ operations for n rows and columns.
///
/// # Errors
/// [`NoSpectrum`].
#[inline(never)]
pub fn svd(a: MatRef<'_, f64>) -> Result<Svd, NoSpectrum> {
    let svd = a.svd().map_err(|_| NoSpectrum)?;
    let values = svd.S().column_vector().iter().copied().collect();
    Ok(Svd { left: svd.U().to_owned(), values, right: svd.V().to_owned() })
}

/// The diagonal of Σ of [`svd`], descending, without the vectors: 8 n³/3 operations.
///
/// # Errors
/// [`NoSpectrum`].
#[inline(never)]
pub fn singular_values(a: MatRef<'_, f64>) -> Result<Vec<f64>, NoSpectrum> {
    a.singular_values().map_err(|_| NoSpectrum)
}
