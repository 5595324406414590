//! Gauss-Legendre, Gauss-Jacobi and Gauss-Lobatto rules.

use crate::{Rule, legendre_p};
use faer::{Mat, Side};
use gauss_quad::{FiniteAboveNegOneF64, GaussJacobi, GaussLegendre};
use std::num::NonZeroUsize;

/// Gauss-Legendre rule of n points: ∫_{-1}^1 f dx, exact to degree 2n-1.
///
/// Exactly symmetric, the middle point of an odd rule is exactly 0. Cost O(n).
///
/// # Panics
/// If n = 0.
///
/// Source: Bogaert (2014).
pub fn gauss_legendre(n: usize) -> Rule {
    let n = NonZeroUsize::new(n).expect("a Gauss rule needs at least one point");
    let (points, weights) = GaussLegendre::new(n).into_iter().unzip();
    symmetric(points, weights, 2 * n.get() - 1)
}

/// Gauss-Jacobi rule of n points: ∫_{-1}^1 f(x) (1-x)^alpha (1+x)^beta dx, exact for f of degree 2n-1.
///
/// Points are the zeros of the orthonormal polynomial p_n (eigenvalues of the Jacobi matrix, refined by Newton steps),
/// weights 1/Σ_{k<n} p_k(x_i)². Exactly symmetric if alpha = beta. Cost O(n³): meant for n to a few hundred.
///
/// # Panics
/// If n = 0, or if alpha or beta is not a finite number above -1.
///
/// Source: Golub and Welsch (1969); Gautschi, *Orthogonal Polynomials* (2004), table 1.1.
pub fn gauss_jacobi(n: usize, alpha: f64, beta: f64) -> Rule {
    assert!(n > 0, "a Gauss rule needs at least one point");
    let (diagonal, off) = jacobi_recurrence(n, alpha, beta);
    let matrix = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => off[i.max(j)],
        _ => 0.0,
    });
    let mut points = matrix.self_adjoint_eigenvalues(Side::Lower).expect("the Jacobi matrix is finite and symmetric");
    let mut weights = vec![0.0; n];
    for (x, w) in points.iter_mut().zip(&mut weights) {
        for _ in 0..3 {
            let (value, derivative, _) = orthonormal(&diagonal, &off, *x);
            *x -= value / derivative;
        }
        *w = 1.0 / orthonormal(&diagonal, &off, *x).2;
    }
    if alpha == beta { symmetric(points, weights, 2 * n - 1) } else { Rule { points, weights, degree: 2 * n - 1 } }
}

/// Gauss-Lobatto rule of n points with both ends ±1 among them: ∫_{-1}^1 f dx, exact to degree 2n-3.
///
/// Interior points are the zeros of P'_{n-1}, weights 2/(n(n-1) P_{n-1}(x_i)²). Exactly symmetric. Cost O(n³).
///
/// # Panics
/// If n < 2.
///
/// Source: Abramowitz and Stegun (1964), 25.4.32.
pub fn gauss_lobatto(n: usize) -> Rule {
    assert!(n >= 2, "a Gauss-Lobatto rule needs its two ends, got n = {n}");
    let mut points = vec![-1.0];
    if n > 2 {
        // P'_{n-1} is a multiple of the Jacobi polynomial of degree n-2 for the weight 1-x².
        points.extend(gauss_jacobi(n - 2, 1.0, 1.0).points);
    }
    points.push(1.0);
    let mut p = vec![0.0; n];
    let weight = |x: &f64| {
        legendre_p(*x, &mut p);
        2.0 / ((n * (n - 1)) as f64 * p[n - 1] * p[n - 1])
    };
    let weights = points.iter().map(weight).collect();
    symmetric(points, weights, 2 * n - 3)
}

/// Rule with point i and point n-1-i made exact mirror images, sorted upwards.
fn symmetric(mut points: Vec<f64>, mut weights: Vec<f64>, degree: usize) -> Rule {
    let n = points.len();
    for i in 0..n.div_ceil(2) {
        let j = n - 1 - i;
        let x = 0.5 * (points[i] - points[j]).abs();
        (points[i], points[j]) = (-x, x);
        let w = 0.5 * (weights[i] + weights[j]);
        (weights[i], weights[j]) = (w, w);
    }
    Rule { points, weights, degree }
}

/// Coefficients of the orthonormal Jacobi polynomials,
/// x p_k = off[k+1] p_{k+1} + diagonal[k] p_k + off[k] p_{k-1}, p_0 = 1/off[0]; `diagonal` has n, `off` n+1 entries.
fn jacobi_recurrence(n: usize, alpha: f64, beta: f64) -> (Vec<f64>, Vec<f64>) {
    let exponent = |x: f64| {
        FiniteAboveNegOneF64::new(x).unwrap_or_else(|| panic!("Jacobi exponents must be finite and above -1, got {x}"))
    };
    // The one-point rule's weight is the total mass 2^(s+1) B(alpha+1, beta+1).
    let one_point = GaussJacobi::new(NonZeroUsize::MIN, exponent(alpha), exponent(beta));
    let mass = one_point.as_node_weight_pairs()[0].1;
    let s = alpha + beta;
    let diagonal = |k: usize| match k {
        0 => (beta - alpha) / (s + 2.0),
        _ => {
            let m = 2.0 * k as f64 + s;
            (beta - alpha) * s / (m * (m + 2.0))
        }
    };
    let off = |k: usize| match k {
        0 => mass.sqrt(),
        // The general term is 0/0 here for s = -1.
        1 => (4.0 * (1.0 + alpha) * (1.0 + beta) / ((2.0 + s) * (2.0 + s) * (3.0 + s))).sqrt(),
        _ => {
            let (k, m) = (k as f64, 2.0 * k as f64 + s);
            (4.0 * k * (k + alpha) * (k + beta) * (k + s) / (m * m * (m + 1.0) * (m - 1.0))).sqrt()
        }
    };
    ((0..n).map(diagonal).collect(), (0..=n).map(off).collect())
}

/// p_n(x), p_n'(x) and Σ_{k<n} p_k(x)² of the orthonormal polynomials of a recurrence with n = `diagonal.len()`.
fn orthonormal(diagonal: &[f64], off: &[f64], x: f64) -> (f64, f64, f64) {
    let (mut p, mut before) = (1.0 / off[0], 0.0);
    let (mut dp, mut dbefore) = (0.0, 0.0);
    let mut squares = 0.0;
    for k in 0..diagonal.len() {
        squares += p * p;
        let back = if k > 0 { off[k] } else { 0.0 };
        let next = ((x - diagonal[k]) * p - back * before) / off[k + 1];
        let dnext = (p + (x - diagonal[k]) * dp - back * dbefore) / off[k + 1];
        (before, p, dbefore, dp) = (p, next, dp, dnext);
    }
    (p, dp, squares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Series;
    use std::f64::consts::{PI, SQRT_2};

    /// ∫_{-1}^1 P_k P_l dx - quadrature, for one k and l.
    fn defect(rule: &Rule, k: usize, l: usize) -> f64 {
        let p = |n: usize| Series { coefficients: (0..=n).map(|m| if m == n { 1.0 } else { 0.0 }).collect() };
        let (pk, pl) = (p(k), p(l));
        let exact = if k == l { 2.0 / (2 * k + 1) as f64 } else { 0.0 };
        rule.integrate(|x| pk.eval(x) * pl.eval(x)) - exact
    }

    fn check_symmetry(rule: &Rule) {
        let n = rule.len();
        for i in 0..n {
            assert_eq!((rule.points[i], rule.weights[i]), (-rule.points[n - 1 - i], rule.weights[n - 1 - i]));
            assert!(rule.weights[i] > 0.0);
            assert!(i == 0 || rule.points[i - 1] < rule.points[i]);
        }
        assert!(n.is_multiple_of(2) || rule.points[n / 2] == 0.0);
    }

    #[test]
    fn legendre_degree_is_exact_and_no_higher() {
        for n in 1..=64 {
            let rule = gauss_legendre(n);
            assert_eq!((rule.len(), rule.degree), (n, 2 * n - 1));
            check_symmetry(&rule);
            for k in 0..=rule.degree {
                assert!(defect(&rule, k, 0).abs() < 3e-15, "n {n}, P_{k}: {:e}", defect(&rule, k, 0));
            }
            // The rule sees nothing of P_n²; one point of degree 2n is wrong by all of it.
            assert!((defect(&rule, n, n) + 2.0 / (2 * n + 1) as f64).abs() < 1e-15);
        }
    }

    #[test]
    fn legendre_of_thousands_of_points() {
        for n in [257, 1000, 4096] {
            let rule = gauss_legendre(n);
            check_symmetry(&rule);
            let a = n as f64; // half of the resolvable wave number
            assert!((rule.integrate(|x| (a * x).cos()) - 2.0 * a.sin() / a).abs() < 1e-14);
            assert!((rule.integrate(|x| 1.0 / (1.0 + x * x)) - PI / 2.0).abs() < 2e-14);
        }
    }

    #[test]
    fn lobatto_degree_is_exact_and_no_higher() {
        for n in 2..=65 {
            let rule = gauss_lobatto(n);
            assert_eq!((rule.len(), rule.degree), (n, 2 * n - 3));
            check_symmetry(&rule);
            assert_eq!((rule.points[0], rule.points[n - 1]), (-1.0, 1.0));
            for k in 0..=rule.degree {
                assert!(defect(&rule, k, 0).abs() < 3e-15, "n {n}, P_{k}: {:e}", defect(&rule, k, 0));
            }
            // The rule gives 2/(n-1) for ∫ P_{n-1}² = 2/(2n-1).
            let expected = 2.0 / (n - 1) as f64 - 2.0 / (2 * n - 1) as f64;
            assert!((defect(&rule, n - 1, n - 1) - expected).abs() < 2e-15);
            // Zeros of P'_{n-1}: Newton's step is below the rounding of a point.
            let (mut p, mut dp) = (vec![0.0; n], vec![0.0; n]);
            for &x in &rule.points[1..n - 1] {
                crate::legendre_dp(x, &mut p, &mut dp);
                let second = (2.0 * x * dp[n - 1] - (n * (n - 1)) as f64 * p[n - 1]) / (1.0 - x * x);
                assert!((dp[n - 1] / second).abs() < 2e-16, "n {n}, x {x}: {:e}", dp[n - 1] / second);
            }
        }
    }

    /// Exponents with total masses in closed form: ∫ (1-x)^α dx, B(α+1, -α) = π/sin(π(α+1)) and products.
    fn masses() -> Vec<(f64, f64, f64)> {
        let mut cases = vec![(1.0, 1.0, 4.0 / 3.0), (2.0, 1.0, 4.0 / 3.0), (0.5, -0.5, PI), (0.5, 0.5, PI / 2.0)];
        cases.push((-0.5, -0.5, PI));
        cases.push((-0.25, -0.75, PI * SQRT_2));
        cases.extend([-0.9, -0.5, 0.0, 0.3, 2.5].map(|a: f64| (a, 0.0, 2f64.powf(a + 1.0) / (a + 1.0))));
        cases
    }

    #[test]
    fn jacobi_degree_is_exact_and_no_higher() {
        for (a, b, mass) in masses().into_iter().flat_map(|(a, b, m)| [(a, b, m), (b, a, m)]) {
            for n in 1..=64 {
                let rule = gauss_jacobi(n, a, b);
                assert_eq!((rule.len(), rule.degree), (n, 2 * n - 1));
                assert!(rule.points.windows(2).all(|x| x[0] < x[1]) && rule.weights.iter().all(|&w| w > 0.0));
                // m_{k+1}/m_k = 2 (b+k+1)/(a+b+k+2) for m_k = ∫ (1-x)^a (1+x)^(b+k) dx
                let mut exact = mass;
                for k in 0..=2 * n {
                    let error = rule.integrate(|x| (1.0 + x).powi(k as i32)) / exact - 1.0;
                    if k <= rule.degree {
                        // The last weights are (1-x²)^-1 times as sensitive as the rounded points.
                        assert!(error.abs() < 2e-13, "({a}, {b}), n {n}, k {k}: {error:e}");
                    } else if n <= 6 {
                        assert!(error < -1e-9, "({a}, {b}), n {n}: degree {k} must fail: {error:e}");
                    }
                    exact *= 2.0 * (b + k as f64 + 1.0) / (a + b + k as f64 + 2.0);
                }
            }
        }
    }

    #[test]
    fn jacobi_with_zero_exponents_is_legendre() {
        for n in [1, 2, 5, 33, 64] {
            let (a, b) = (gauss_jacobi(n, 0.0, 0.0), gauss_legendre(n));
            for i in 0..n {
                assert!((a.points[i] - b.points[i]).abs() < 3e-16 && (a.weights[i] - b.weights[i]).abs() < 3e-15);
            }
        }
    }

    #[test]
    #[should_panic(expected = "above -1, got -1")]
    fn jacobi_refuses_a_weight_without_mass() {
        gauss_jacobi(3, 0.0, -1.0);
    }
}
