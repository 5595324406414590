//! Identities that decompositions fulfil: both sides of each, for seeded matrices of several sizes.

use faer::{Mat, MatRef};
use steklov_algebra::{
    Cholesky, Lu, NoFactor, NoSpectrum, SymmetricEigen, eigenvalues, least_squares, llt, singular_values,
    solve_full_lu, svd, symmetric_eigen, symmetric_eigen_on_one_thread, symmetric_eigenvalues,
};
use steklov_quadrature::unit_uniform;

const SIZES: [usize; 6] = [1, 2, 7, 33, 100, 260];

/// Entries between -½ and ½.
fn random(seed: u64, rows: usize, columns: usize) -> Mat<f64> {
    Mat::from_fn(rows, columns, |i, j| unit_uniform(seed, (i + rows * j) as u64) - 0.5)
}

/// A random matrix with √n added on the diagonal, which leaves its singular values away from 0.
fn regular(n: usize) -> Mat<f64> {
    let mut a = random(n as u64, n, n);
    (0..n).for_each(|i| a[(i, i)] += (n as f64).sqrt());
    a
}

/// R Rᵀ/n + ½ of a random R.
fn definite(n: usize) -> Mat<f64> {
    let r = random(40 + n as u64, n, n);
    let mut a = &r * r.transpose();
    for j in 0..n {
        (0..n).for_each(|i| a[(i, j)] = a[(i, j)] / n as f64 + if i == j { 0.5 } else { 0.0 });
    }
    a
}

fn identity(n: usize) -> Mat<f64> {
    Mat::identity(n, n)
}

fn diagonal(values: &[f64], rows: usize, columns: usize) -> Mat<f64> {
    Mat::from_fn(rows, columns, |i, j| if i == j { values[i] } else { 0.0 })
}

/// Largest difference of two matrices, over the largest entry of the second.
fn apart(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    assert_eq!((a.nrows(), a.ncols()), (b.nrows(), b.ncols()));
    (a - b).norm_max() / b.norm_max()
}

/// The same matrix without its strict upper triangle.
fn lower_of(a: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| if i >= j { a[(i, j)] } else { f64::NAN })
}

#[test]
fn factors_solve_and_invert_from_either_side() {
    for n in SIZES {
        let (a, spd, b) = (regular(n), definite(n), random(7, n, 3));
        let (lu, cholesky) = (Lu::new(a.as_ref()), Cholesky::new(lower_of(spd.as_ref()).as_ref()).expect("a factor"));
        for (x, matrix) in [
            (lu.solve(b.as_ref()), &a),
            (solve_full_lu(a.as_ref(), b.as_ref()), &a),
            (cholesky.solve(b.as_ref()), &spd),
        ] {
            assert!(apart(&(matrix * &x), &b) < 1e-11, "{n}");
        }
        for (inverse, matrix) in [(lu.inverse(), &a), (cholesky.inverse(), &spd)] {
            assert!(apart(&(matrix * &inverse), &identity(n)) < 1e-11, "{n}");
            assert!(apart(&(&inverse * matrix), &identity(n)) < 1e-11, "{n}");
        }
        let l = cholesky.lower();
        assert!(apart(&(l * l.transpose()), &spd) < 1e-13, "{n}");
        assert!((0..n).all(|j| l[(j, j)] > 0.0 && (0..j).all(|i| l[(i, j)] == 0.0)), "{n}");
        let checked = llt(&spd).expect("a factor");
        assert!((0..n).all(|j| (0..n).all(|i| checked.lower()[(i, j)] == l[(i, j)])), "{n}");
        // |det A| by the pivots and by the singular values
        let size = |values: &[f64]| values.iter().map(|v| v.abs().ln()).sum::<f64>();
        let difference = size(&lu.pivots()) - size(&singular_values(a.as_ref()).expect("values"));
        assert!(difference.abs() < 1e-12 * (1.0 + n as f64), "{n}: {difference:e}");
    }
}

#[test]
fn a_matrix_that_is_not_definite_is_told_by_its_pivot() {
    for n in SIZES {
        let mut a = definite(n);
        let last = n - 1;
        a[(last, last)] = -1.0;
        assert_eq!(Cholesky::new(a.as_ref()).err(), Some(last));
        assert_eq!(llt(&a).err(), Some(NoFactor::Pivot(last)));
    }
}

#[test]
fn least_squares_leave_a_residual_that_no_column_sees() {
    for (m, n) in [(1, 1), (5, 2), (40, 40), (200, 33)] {
        let (a, b) = (random(3, m, n), random(4, m, 2));
        let x = least_squares(a.as_ref(), b.as_ref());
        assert_eq!((x.nrows(), x.ncols()), (n, 2));
        let residual = &a * &x - &b;
        let seen = (a.transpose() * &residual).norm_max();
        assert!(seen < 1e-11 * (1.0 + x.norm_max()), "{m} {n}: {seen:e}");
        assert!(m == n || residual.norm_max() > 1e-2, "{m} {n}: {}", residual.norm_max());
    }
}

#[test]
fn symmetric_spectra_are_orthogonal_and_give_the_matrix_back() {
    for n in SIZES {
        let r = random(60 + n as u64, n, n);
        let a = &r + r.transpose(); // of eigenvalues of both signs
        let lower = lower_of(a.as_ref());
        let [eigen, on_one] = [symmetric_eigen, symmetric_eigen_on_one_thread].map(|eigen| eigen(lower.as_ref()));
        let (eigen, on_one) = (eigen.expect("a spectrum"), on_one.expect("a spectrum"));
        for SymmetricEigen { values, vectors: v } in [&eigen, &on_one] {
            assert!(apart(&(&a * v), &(v * diagonal(values, n, n))) < 1e-12, "{n}");
            assert!(apart(&(v * diagonal(values, n, n) * v.transpose()), &a) < 1e-12, "{n}");
            assert!(apart(&(v.transpose() * v), &identity(n)) < 1e-13, "{n}");
            assert!(values.is_sorted() && (n < 7 || values[0] * values[n - 1] < 0.0), "{n}");
        }
        let values = &eigen.values;
        let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let alone = symmetric_eigenvalues(lower_of(a.as_ref()).as_ref()).expect("eigenvalues");
        assert!(alone.len() == n && alone.iter().zip(values).all(|(a, b)| (a - b).abs() < 1e-13 * largest), "{n}");
        // the same zeros of det(A - λ), found without the symmetry
        let mut general: Vec<f64> = eigenvalues(a.as_ref()).expect("eigenvalues").iter().map(|z| z.re).collect();
        general.sort_by(f64::total_cmp);
        assert!(general.iter().zip(values).all(|(a, b)| (a - b).abs() < 1e-12 * largest), "{n}");
    }
}

/// Tr Aᵏ = Σ λᵏ, which tells the imaginary parts too, and complex λ come in pairs.
#[test]
fn eigenvalues_have_the_traces_of_powers() {
    for n in SIZES {
        let a = random(80 + n as u64, n, n);
        let values = eigenvalues(a.as_ref()).expect("eigenvalues");
        assert_eq!(values.len(), n);
        let largest = values.iter().fold(0.0f64, |m, z| m.max(z.norm()));
        let mut power = identity(n);
        for k in 1..4 {
            power = &power * &a;
            let trace: f64 = (0..n).map(|i| power[(i, i)]).sum();
            let (re, im) = values.iter().map(|z| z.powi(k)).fold((0.0, 0.0), |(re, im), z| (re + z.re, im + z.im));
            let scale = n as f64 * largest.powi(k);
            assert!((re - trace).abs() < 1e-12 * scale && im.abs() < 1e-12 * scale, "{n} {k}: {re} {im} {trace}");
        }
        assert!(n < 7 || values.iter().any(|z| z.im > 1e-3 * largest), "{n}");
    }
    // a quarter turn: ± i
    let turn = Mat::from_fn(2, 2, |i, j| if i == j { 0.0 } else { i as f64 - j as f64 });
    let values = eigenvalues(turn.as_ref()).expect("eigenvalues");
    assert!(values.iter().all(|z| z.re.abs() < 1e-15 && (z.im.abs() - 1.0).abs() < 1e-15), "{values:?}");
    assert!(values[0].im * values[1].im < 0.0);
}

#[test]
fn singular_values_and_their_vectors_give_the_matrix_back() {
    for (m, n, rank) in [(1, 1, 1), (7, 7, 3), (33, 33, 33), (20, 50, 20), (100, 60, 60)] {
        let a = random(5, m, rank) * random(6, rank, n);
        let svd = svd(a.as_ref()).expect("a decomposition");
        let (u, v, values) = (&svd.left, &svd.right, &svd.values);
        assert!(apart(&(u * diagonal(values, m, n) * v.transpose()), &a) < 1e-12, "{m} {n}");
        assert!(apart(&(u.transpose() * u), &identity(m)) < 1e-13, "{m} {n}");
        assert!(apart(&(v.transpose() * v), &identity(n)) < 1e-13, "{m} {n}");
        assert!(values.is_sorted_by(|a, b| a >= b) && *values.last().unwrap() >= 0.0, "{values:?}");
        assert_eq!(values.iter().filter(|s| **s > 1e-12 * values[0]).count(), rank);
        let alone = singular_values(a.as_ref()).expect("values");
        assert!(alone.iter().zip(values).all(|(a, b)| (a - b).abs() < 1e-13 * values[0]), "{m} {n}");
        assert_eq!(alone.len(), m.min(n));
    }
}

#[test]
fn numbers_that_are_not_finite_have_no_spectrum() {
    let mut a = definite(20);
    a[(12, 5)] = f64::NAN;
    assert!(symmetric_eigen(a.as_ref()).is_err() && symmetric_eigen_on_one_thread(a.as_ref()).is_err());
    assert_eq!(symmetric_eigenvalues(a.as_ref()).err(), Some(NoSpectrum));
    assert_eq!(eigenvalues(a.as_ref()).err(), Some(NoSpectrum));
    assert_eq!(svd(a.as_ref()).err().map(|e| e.to_string()), Some(NoSpectrum.to_string()));
    assert_eq!(singular_values(a.as_ref()).err(), Some(NoSpectrum));
}
