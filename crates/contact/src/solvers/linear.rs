//! Linear systems that may be singular.

use faer::{ColMut, Mat, Par};
use steklov_algebra::{
    Cholesky, Lu, NoFactor, NoSparseFactor, Sparse, SparseCholesky, SparseSymmetric, Structure, Symmetric,
    check_solution, check_spectrum, llt, spoil, svd, symmetric_eigen,
};

use crate::ContactError;

/// Squared Cholesky pivot over diagonal entry, or relative pivot of a triangular factor, below which a matrix is not
/// trusted to be regular and its spectrum decides.
const PIVOT: f64 = 1e-10;
/// Eigenvalues and singular values below this part of the largest count as zero.
const CUTOFF: f64 = 1e-13;

/// A factorised symmetric, positive semi-definite matrix.
pub(crate) enum Semidefinite {
    /// Regular: its Cholesky factor.
    Regular(Cholesky),
    /// The same of a sparse matrix.
    Sparse(SparseCholesky),
    /// Numerically singular: its spectrum, the negligible part zero.
    Singular { vectors: Mat<f64>, inverse: Vec<f64> },
}

impl Semidefinite {
    pub(crate) fn new(k: &Symmetric) -> Result<Self, ContactError> {
        match k {
            Symmetric::Full(full) => Self::of_full(full),
            Symmetric::Sparse(sparse) => match sparse_factor(sparse)? {
                Some(factor) => Ok(Self::Sparse(factor)),
                None => Self::of_full(&k.full()),
            },
        }
    }

    fn of_full(k: &Mat<f64>) -> Result<Self, ContactError> {
        let n = k.nrows();
        match llt(k) {
            Ok(factor) if (0..n).all(|i| factor.lower()[(i, i)].powi(2) > PIVOT * k[(i, i)]) => {
                return Ok(Self::Regular(factor));
            }
            Err(NoFactor::Fault(fault)) => return Err(fault.into()),
            Ok(_) | Err(NoFactor::Pivot(_)) => {}
        }
        let eigen = symmetric_eigen(k.as_ref()).map_err(|_| ContactError::Decomposition { size: n })?;
        let (s, vectors) = (eigen.values, eigen.vectors);
        check_spectrum(k.as_ref(), vectors.as_ref(), vectors.as_ref(), &s)?;
        let largest = (0..n).fold(0.0f64, |m, j| m.max(s[j].abs()));
        let inverse = (0..n).map(|j| if s[j].abs() > CUTOFF * largest { 1.0 / s[j] } else { 0.0 }).collect();
        Ok(Self::Singular { vectors, inverse })
    }

    /// If the matrix is singular, of the solutions (of least residual when b is outside the range) the one nearest to
    /// `near`.
    pub(crate) fn solve(&self, b: &[f64], near: &[f64]) -> Vec<f64> {
        match self {
            Self::Regular(factor) => column(&factor.solve(to_matrix(b).as_ref())),
            Self::Sparse(factor) => {
                let mut x = b.to_vec();
                factor.solve(ColMut::from_slice_mut(&mut x).as_mat_mut(), Par::Seq);
                x
            }
            Self::Singular { vectors, inverse } => {
                let (mut coefficients, kept) =
                    (vectors.transpose() * to_matrix(b), vectors.transpose() * to_matrix(near));
                for (j, &inverse) in inverse.iter().enumerate() {
                    coefficients[(j, 0)] = if inverse == 0.0 { kept[(j, 0)] } else { inverse * coefficients[(j, 0)] };
                }
                column(&(vectors * coefficients))
            }
        }
    }
}

/// The Cholesky factor of a sparse matrix that is well away from singular.
fn sparse_factor(k: &SparseSymmetric) -> Result<Option<SparseCholesky>, ContactError> {
    let (pattern, entries) = k.lower();
    let size = pattern.size();
    let factor = Structure::new(pattern, &k.order).and_then(|structure| {
        let diagonal: Vec<f64> = structure.pattern.start[..size].iter().map(|&first| entries[first]).collect();
        Ok((structure.factorise_checked(&entries, Par::Seq)?, diagonal))
    });
    match factor {
        Ok((factor, diagonal)) => {
            let regular = factor.diagonal().iter().zip(diagonal).all(|(l, k)| l.powi(2) > PIVOT * k);
            Ok(regular.then_some(factor))
        }
        Err(NoSparseFactor::Pivot(_)) => Ok(None),
        Err(NoSparseFactor::Memory) => Err(ContactError::Decomposition { size }),
        Err(NoSparseFactor::Fault(fault)) => Err(fault.into()),
    }
}

/// Solves K x = b with K symmetric and positive semi-definite, as [`Semidefinite`].
pub(crate) fn solve_semidefinite(k: &Symmetric, b: &[f64], near: &[f64]) -> Result<Vec<f64>, ContactError> {
    if b.is_empty() {
        return Ok(Vec::new());
    }
    let factor = Semidefinite::new(k)?;
    let mut x = factor.solve(b, near);
    spoil(ColMut::from_slice_mut(&mut x).as_mat_mut(), false);
    match (k, factor) {
        (_, Semidefinite::Singular { .. }) => {}
        (Symmetric::Full(k), _) => check_solution(k.as_ref(), &x, b)?,
        (Symmetric::Sparse(k), _) => {
            let (pattern, entries) = k.lower();
            Sparse { start: &pattern.start, rows: &pattern.rows, entries: &entries }.check(&x, b)?;
        }
    }
    Ok(x)
}

/// Solves A x = b with A square; the least-squares solution of least norm if A is numerically singular.
pub(crate) fn solve_general(a: &Mat<f64>, b: &[f64]) -> Result<Vec<f64>, ContactError> {
    let n = b.len();
    let factor = Lu::new(a.as_ref());
    if is_regular(&factor) {
        let mut x = factor.solve(to_matrix(b).as_ref());
        spoil(x.as_mut(), false);
        let x = column(&x);
        check_solution(a.as_ref(), &x, b)?;
        return Ok(x);
    }
    let svd = svd(a.as_ref()).map_err(|_| ContactError::Decomposition { size: n })?;
    let s = &svd.values;
    check_spectrum(a.as_ref(), svd.right.as_ref(), svd.left.as_ref(), s)?;
    let mut coefficients = svd.left.transpose() * to_matrix(b);
    for j in 0..n {
        coefficients[(j, 0)] = if s[j] > CUTOFF * s[0] { coefficients[(j, 0)] / s[j] } else { 0.0 };
    }
    Ok(column(&(svd.right * coefficients)))
}

/// Whether no pivot is negligible.
pub(crate) fn is_regular(factor: &Lu) -> bool {
    let pivots = factor.pivots();
    let largest = pivots.iter().fold(0.0f64, |m, u| m.max(u.abs()));
    pivots.iter().all(|u| u.abs() > PIVOT * largest)
}

/// A⁻¹ b of a regular A.
pub(crate) fn solve_with(factor: &Lu, b: &[f64]) -> Vec<f64> {
    column(&factor.solve(to_matrix(b).as_ref()))
}

/// S v, with the sums in the order of the columns.
pub(crate) fn product(s: &Mat<f64>, v: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; s.nrows()];
    for (j, x) in v.iter().enumerate() {
        sum.iter_mut().zip(s.col_as_slice(j)).for_each(|(sum, s)| *sum += s * x);
    }
    sum
}

/// Largest absolute value, 0 of nothing, NaN if there is one.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, |m, x| if x > m || x.is_nan() { x } else { m })
}

fn to_matrix(b: &[f64]) -> Mat<f64> {
    Mat::from_fn(b.len(), 1, |i, _| b[i])
}

fn column(x: &Mat<f64>) -> Vec<f64> {
    (0..x.nrows()).map(|i| x[(i, 0)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_matrix_gives_the_nearest_solution() {
        // K = [1 -1; -1 1]: K x = (1, -1) has the solutions (s, s - 1); the nearest to the origin is (1/2, -1/2)
        let k = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { -1.0 });
        let solve = |b: &[f64], near: &[f64]| solve_semidefinite(&k.clone().into(), b, near).unwrap();
        let zero = [0.0; 2];
        // and the nearest to (5, 2) is (4, 3), (2, 0) having the part (1, -1) in the range
        for b in [[1.0, -1.0], [2.0, 0.0]] {
            let x = solve(&b, &[5.0, 2.0]);
            assert!((x[0] - 4.0).abs() < 1e-14 && (x[1] - 3.0).abs() < 1e-14, "{x:?}");
        }
        for x in [solve(&[1.0, -1.0], &zero), solve_general(&k, &[1.0, -1.0]).unwrap()] {
            assert!((x[0] - 0.5).abs() < 1e-15 && (x[1] + 0.5).abs() < 1e-15, "{x:?}");
        }
        // a part outside the range is left alone, never divided by roundoff
        for x in [solve(&[2.0, 0.0], &zero), solve_general(&k, &[2.0, 0.0]).unwrap()] {
            assert!((x[0] - 0.5).abs() < 1e-15 && (x[1] + 0.5).abs() < 1e-15, "{x:?}");
        }
    }

    #[test]
    fn a_regular_matrix_is_solved() {
        let k = Mat::from_fn(3, 3, |i, j| if i == j { 2.0 } else { 1.0 / (1.0 + (i + j) as f64) });
        let x = [1.0, -2.0, 3.0];
        let b = product(&k, &x);
        for y in [solve_semidefinite(&k.clone().into(), &b, &[7.0; 3]).unwrap(), solve_general(&k, &b).unwrap()] {
            assert!(largest((0..3).map(|i| x[i] - y[i])) < 1e-14);
        }
    }

    #[test]
    fn a_nan_is_not_hidden() {
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan());
        assert_eq!(largest([1.0, -3.0, 2.0]), 3.0);
    }
}
