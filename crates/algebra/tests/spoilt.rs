//! Factors, products and solutions with one wrong entry are told from those that are only rounded.

use faer::Mat;
use steklov_algebra::{
    Fault, add_product, add_to_lower, check_cholesky, check_inverse, check_solution, check_spectrum, cholesky,
    is_fault, llt, once_more, scaled_probe, solve_lower, solve_lower_transposed, symmetric_eigen, threads,
};
use steklov_quadrature::unit_uniform;

const SIZES: [usize; 5] = [8, 33, 100, 257, 600];

/// Symmetric, positive definite, of condition 1e6 or more, whose rows differ in size by 1e12.
fn graded(n: usize) -> Mat<f64> {
    let scale = |i: usize| 10f64.powf(-6.0 * i as f64 / n as f64);
    let u = Mat::from_fn(n, 6, |i, k| unit_uniform(n as u64, (6 * i + k) as u64) - 0.5);
    let low = &u * u.transpose();
    Mat::from_fn(n, n, |i, j| scale(i) * scale(j) * (1e4 * low[(i, j)] + if i == j { 1e-2 } else { 0.0 }))
}

fn entry(seed: u64, n: usize) -> (usize, usize) {
    let at = |k: u64| (unit_uniform(seed, k) * n as f64) as usize;
    (at(0).max(at(1)), at(0).min(at(1)))
}

/// With a bit of an entry flipped, NaN, or zeros from there on in its column.
fn spoilt(a: &Mat<f64>, (i, j): (usize, usize), kind: u32) -> Mat<f64> {
    let mut a = a.clone();
    match kind {
        64 => (i..a.nrows()).for_each(|i| a[(i, j)] = 0.0),
        63 => a[(i, j)] = f64::NAN,
        bit => a[(i, j)] = f64::from_bits(a[(i, j)].to_bits() ^ 1 << bit),
    }
    a
}

const KINDS: [u32; 9] = [48, 51, 52, 55, 60, 61, 62, 63, 64];

#[test]
fn rounding_is_no_fault() {
    for n in SIZES {
        let a = graded(n);
        let factor = llt(&a).expect("a factor");
        let mut whole = a.clone();
        cholesky(whole.as_mut()).expect("a factor");
        let mut b = a.clone();
        solve_lower(factor.lower(), b.as_mut(), None).expect("a solution");
        solve_lower_transposed(factor.lower(), b.as_mut(), None).expect("a solution");
        let mut c = a.clone();
        add_product(c.as_mut(), a.as_ref(), b.as_ref(), -2.0, None).expect("a product");
        let eigen = symmetric_eigen(a.as_ref()).expect("a spectrum");
        let values = &eigen.values;
        check_spectrum(a.as_ref(), eigen.vectors.as_ref(), eigen.vectors.as_ref(), values).expect("a spectrum");
    }
}

/// Rows that the probe does not see but for rounding, in which values tell no terms, are no fault.
#[test]
fn rows_that_the_probe_cancels_are_judged_by_their_terms() {
    for n in SIZES {
        let p = scaled_probe(vec![1.0; n].into_iter());
        // of entries of both signs: (B p)_i = 0 but for rounding
        let b = Mat::from_fn(n, n, |i, j| {
            let (k, size) = (n / 2 * 2, 10f64.powi(-(i as i32 % 9)) / (3.0 + i as f64));
            if j >= k { 0.0 } else { size * if j % 2 == 0 { p[j + 1] } else { -p[j - 1] } }
        });
        let l = Mat::from_fn(n, n, |i, j| if i == j { 3.0 + (i as f64).sin() } else { 0.0 });
        let mut x = b.clone();
        solve_lower(l.as_ref(), x.as_mut(), None).expect("a solution");
        let mut c = Mat::zeros(n, n);
        add_product(c.as_mut(), l.as_ref(), x.as_ref(), 1.0, None).expect("a product");
        let reached = (0..n).any(|i| {
            let of = |m: &Mat<f64>| (0..n).map(|j| m[(i, j)] * p[j]).sum::<f64>();
            let (one, other) = (of(&b), l[(i, i)] * of(&x));
            (one - other).abs() > 1e-12 * (one.abs() + other.abs())
        });
        assert!(reached, "{n}: values tell all rows");
    }
}

#[test]
fn diagonal_entries_of_factors_are_seen_however_small_their_rows() {
    for n in SIZES {
        let a = graded(n);
        let l = llt(&a).expect("a factor").lower().to_owned();
        for i in (0..n).step_by(7) {
            for kind in KINDS {
                let fault = check_cholesky(a.as_ref(), spoilt(&l, (i, i), kind).as_ref());
                let fault = fault.expect_err(&format!("{n}: entry {i}, {kind}, {:e} of {:e}", l[(i, i)], a[(i, i)]));
                assert!(fault.error.is_nan() || fault.error > 1e-12, "{fault}");
                assert_eq!((fault.what, fault.size), ("a Cholesky factor", n));
            }
        }
    }
}

#[test]
fn wrong_solutions_inverses_and_spectra_are_seen() {
    for n in SIZES {
        let a = Mat::from_fn(n, n, |i, j| if i == j { 3.0 } else { 1.0 / (1.0 + i.abs_diff(j) as f64).powi(2) });
        let factor = llt(&a).expect("a factor");
        let inverse = Mat::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 });
        let mut inverse = inverse;
        solve_lower(factor.lower(), inverse.as_mut(), None).expect("a solution");
        solve_lower_transposed(factor.lower(), inverse.as_mut(), None).expect("a solution");
        check_inverse(factor.lower(), inverse.as_ref()).expect("an inverse");
        let eigen = symmetric_eigen(a.as_ref()).expect("a spectrum");
        let values = &eigen.values;
        for (seed, kind) in KINDS.into_iter().enumerate() {
            let (i, _) = entry(seed as u64, n);
            assert!(check_inverse(factor.lower(), spoilt(&inverse, (i, i), kind).as_ref()).is_err(), "{n} {kind}");
            let x = inverse.col_as_slice(i).to_vec();
            let b: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k == i))).collect();
            check_solution(a.as_ref(), &x, &b).expect("a solution");
            let wrong = spoilt(&inverse, (i, i), kind).col_as_slice(i).to_vec();
            assert!(check_solution(a.as_ref(), &wrong, &b).is_err(), "{n} {kind}");
            let mut wrong = values.clone();
            wrong[i] = f64::from_bits(wrong[i].to_bits() ^ 1 << 48);
            assert!(check_spectrum(a.as_ref(), eigen.vectors.as_ref(), eigen.vectors.as_ref(), &wrong).is_err());
        }
    }
}

/// The image of a result is that of the matrix: what is known of it and what is read of it agree, until the matrix changes.
#[test]
fn what_changes_after_its_check_is_seen_by_the_next_one() {
    for n in SIZES {
        let a = Mat::from_fn(n, n, |i, j| if i == j { 3.0 } else { 1.0 / (1.0 + i.abs_diff(j) as f64).powi(2) });
        let l = llt(&a).expect("a factor").lower().to_owned();
        let b = Mat::from_fn(n, n + 3, |i, j| unit_uniform(n as u64, (i + n * j) as u64) - 0.5);
        let mut x = b.clone();
        let of_x = solve_lower(l.as_ref(), x.as_mut(), None).expect("a solution");
        let mut c = b.clone();
        let of_c = add_product(c.as_mut(), a.as_ref(), x.as_ref(), -1.0, Some(&of_x)).expect("a product");
        let mut lower = Mat::zeros(n + 3, n + 3);
        add_to_lower(lower.as_mut(), x.transpose(), x.as_ref(), 1.0, Some(&of_x)).expect("a symmetric product");
        solve_lower(l.as_ref(), c.clone().as_mut(), Some(&of_c)).expect("a solution");
        solve_lower_transposed(l.as_ref(), c.clone().as_mut(), Some(&of_c)).expect("a solution");
        for (seed, kind) in KINDS.into_iter().enumerate() {
            let at = entry(seed as u64, n);
            let wrong = spoilt(&x, at, kind);
            let product = add_product(b.clone().as_mut(), a.as_ref(), wrong.as_ref(), -1.0, Some(&of_x));
            assert_eq!(product.expect_err(&format!("{n} {kind}")).what, "a product");
            let symmetric = add_to_lower(lower.clone().as_mut(), x.transpose(), wrong.as_ref(), 1.0, Some(&of_x));
            assert_eq!(symmetric.expect_err(&format!("{n} {kind}")).what, "a symmetric product");
            for solve in [solve_lower, solve_lower_transposed] {
                let solution = solve(l.as_ref(), spoilt(&c, at, kind).as_mut(), Some(&of_c));
                assert_eq!(solution.expect_err(&format!("{n} {kind}")).what, "a triangular solve");
            }
        }
    }
}

#[test]
fn a_fault_is_tried_once_more_on_one_thread_and_other_errors_are_not() {
    let fault = || Fault { what: "a product", size: 40, error: f64::NAN };
    let usual = faer::Par::rayon(16);
    for lasting in [false, true] {
        let mut ways = Vec::new();
        let result = once_more(|| {
            ways.push(threads(usual) == faer::Par::Seq);
            if ways.len() == 1 || lasting { Err(fault()) } else { Ok(7) }
        });
        assert_eq!((ways, result.is_err()), (vec![false, true], lasting));
        assert!(threads(usual) == usual);
    }
    let mut tries = 0;
    let other = once_more(|| {
        tries += 1;
        Err::<(), _>(std::io::Error::other("no fault"))
    });
    assert!(other.is_err() && tries == 1 && is_fault(&fault()) && !is_fault(&std::io::Error::other("no fault")));
}
