//! Gauss-Lobatto rules: n points on [-1, 1], both ends among them, the others zeros of P'_(n-1), with the weights
//! wᵢ = 2 / (n(n-1) P_(n-1)(tᵢ)²). They are exact up to degree 2n-3, and
//!
//! ∫ f dt - Σ wᵢ f(tᵢ) = -n (n-1)³ 2^(2n-1) ((n-2)!)⁴ / ((2n-1) ((2n-2)!)³) f^(2n-2)(τ)   (Abramowitz and Stegun, 25.4.32)
//!
//! so that the error of t^(2n-2), whose derivative of that order is (2n-2)!, is known too.

use steklov_quadrature::{gauss_lobatto, legendre_p};

fn main() {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    for n in 2..=12 {
        let rule = gauss_lobatto(n);
        let exact = |degree: usize| if degree.is_multiple_of(2) { 2.0 / (degree + 1) as f64 } else { 0.0 };
        let error = |degree: usize| exact(degree) - rule.integrate(|t| t.powi(degree as i32));
        let worst = (0..=2 * n - 3).map(|degree| error(degree).abs()).fold(0.0, f64::max);

        let m = n as f64;
        let powers = m * (m - 1.0).powi(3) * 2f64.powi(2 * n as i32 - 1) * factorial(n - 2).powi(4);
        let next = -powers / ((2.0 * m - 1.0) * factorial(2 * n - 2).powi(2));
        println!(
            "{n:2} points: {worst:.1e} up to degree {}, then {:.6e}, by the formula {next:.6e}",
            2 * n - 3,
            error(2 * n - 2)
        );

        assert_eq!((rule.points[0], rule.points[n - 1], rule.degree), (-1.0, 1.0, 2 * n - 3));
        assert!(worst < 1e-14 && (error(2 * n - 2) - next).abs() < 1e-14);
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            let mut p = vec![0.0; n];
            legendre_p(t, &mut p);
            assert!((w * m * (m - 1.0) * p[n - 1].powi(2) / 2.0 - 1.0).abs() < 1e-12);
        }
    }
}
