//! The largest eigenvalue of a dense symmetric matrix.

use faer::{Col, Mat, Scale};
use steklov_algebra::{symmetric_eigen, symmetric_eigenvalues};

/// Relative residual at which the largest eigenvalue is known well enough, and Lanczos steps at most. With many equal elements
/// the largest eigenvalues lie close together: the vector is then any of theirs, and the value is found long before.
const ACCURACY: f64 = 1e-3;
const STEPS: usize = 120;

/// The largest eigenvalue of a symmetric matrix without negative ones, by Lanczos' method with all vectors kept orthogonal;
/// where that takes too many steps by a full decomposition.
///
/// Source: Lanczos (1950).
pub(crate) fn largest_eigenvalue(a: &Mat<f64>) -> Option<f64> {
    let n = a.nrows();
    // a start without symmetries
    let start = Col::from_fn(n, |i| 1.0 + 0.5 * (1.3 * i as f64 + 0.7 * (i as f64).sqrt()).sin());
    let mut basis = vec![&start * Scale(1.0 / start.norm_l2())];
    let mut projected = Mat::zeros(STEPS, STEPS);
    for k in 0..n.min(STEPS) {
        let mut w = a * &basis[k];
        for pass in 0..2 {
            for (i, q) in basis.iter().enumerate() {
                let part = q.transpose() * &w;
                w -= q * Scale(part);
                if i == k && pass == 0 {
                    projected[(k, k)] = part;
                }
            }
        }
        let rest = w.norm_l2();
        let eigen = symmetric_eigen(projected.submatrix(0, 0, k + 1, k + 1)).ok()?;
        let value = eigen.values[k];
        if rest * eigen.vectors[(k, k)].abs() <= ACCURACY * value || k + 1 == n {
            return Some(value);
        }
        if k + 1 < STEPS {
            (projected[(k + 1, k)], projected[(k, k + 1)]) = (rest, rest);
        }
        basis.push(w * Scale(1.0 / rest));
    }
    // a cluster at the end of the spectrum
    symmetric_eigenvalues(a.as_ref()).ok()?.last().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_spectrum_isolated_or_in_a_cluster() {
        for (n, top) in [(1, 3.0), (7, 3.0), (200, 3.0), (200, 1.0)] {
            // eigenvalues 1 - 1e-4 k and the top one, turned by a reflection
            let v = Col::from_fn(n, |i| (0.3 + i as f64).cos());
            let v = &v * Scale(1.0 / v.norm_l2());
            let reflect = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 } - 2.0 * v[i] * v[j];
            let q = Mat::from_fn(n, n, reflect);
            let d = Mat::from_fn(n, n, |i, j| match i == j {
                false => 0.0,
                true if i + 1 == n => top,
                true => 1.0 - 1e-4 * (i + 1) as f64,
            });
            let found = largest_eigenvalue(&(&q * &d * &q)).expect("a value");
            assert!((found / top - 1.0).abs() < 2e-3, "{n}, {top}: {found}");
        }
    }
}
