//! Random fields: values, variances, bounds, positivity, lognormal fields.

use proptest::prelude::*;
use steklov_stochastic::Kernel::{Exponential, Gaussian, Matern32};
use steklov_stochastic::{Covariance, Field, StochasticError, Truncation, lognormal};

fn covariance(kernel: steklov_stochastic::Kernel, ell: f64) -> Covariance {
    Covariance { kernel, correlation: [ell; 2] }
}

fn fields(ell: f64) -> Vec<(Field, [f64; 2])> {
    let sides = [2.0, 1.0];
    let mut out = Vec::new();
    for kernel in [Exponential, Gaussian, Matern32] {
        let c = covariance(kernel, ell);
        out.push((Field::interval(&c, sides[0], Truncation::Modes(5)).unwrap(), [sides[0], 0.0]));
        out.push((Field::rectangle(&c, sides, Truncation::Modes(5)).unwrap(), sides));
    }
    out
}

fn total(field: &Field, x: [f64; 2]) -> f64 {
    3f64.sqrt() * field.modes(x).iter().map(|b| b.abs()).sum::<f64>()
}

#[test]
fn bound_is_that_of_the_reference() {
    let field = Field::interval(&covariance(Exponential, 0.5), 1.0, Truncation::Modes(6)).unwrap();
    // the reference has four digits
    assert!((1.0 / field.bound() - 0.2675).abs() < 5e-5, "{}", 1.0 / field.bound());
    let brute = (0..=200_000).map(|i| total(&field, [i as f64 / 200_000.0, 0.0])).fold(0.0, f64::max);
    assert!(field.bound() >= brute && field.bound() < brute * (1.0 + 1e-9));
}

#[test]
fn bound_of_many_modes_is_found() {
    let field = Field::interval(&covariance(Exponential, 0.1), 1.0, Truncation::Modes(60)).unwrap();
    let brute = (0..=100_000).map(|i| total(&field, [i as f64 / 100_000.0, 0.0])).fold(0.0, f64::max);
    assert!(field.bound() >= brute && field.bound() < brute * (1.0 + 1e-4));
}

#[test]
fn coefficient_below_the_largest_is_taken_and_above_refused() {
    for (field, _) in fields(0.7) {
        let Err(StochasticError::NotPositive { coefficient, largest }) = field.check_positive(1e9) else { panic!() };
        assert_eq!(coefficient, 1e9);
        for sign in [-1.0, 1.0] {
            assert!(field.check_positive(sign * largest * (1.0 - 1e-12)).is_ok());
            assert!(field.check_positive(sign * largest * (1.0 + 1e-12)).is_err());
        }
        assert!(matches!(field.check_positive(f64::NAN), Err(StochasticError::Number { .. })));
    }
}

/// Points and weights of ∫ f(t) exp(-t²/2)/√(2π) dt, by the trapezoidal rule on the line: errors exp(-2π²/h²).
fn normal() -> Vec<(f64, f64)> {
    let h = 0.25;
    let density = |t: f64| (-0.5 * t * t).exp() / (2.0 * std::f64::consts::PI).sqrt();
    (-44..=44).map(|i| (i as f64 * h, h * density(i as f64 * h))).collect()
}

#[test]
fn lognormal_field_has_its_mean_and_variance() {
    let (mean, variation) = (2000.0, 0.3);
    let (mu, sigma) = lognormal(mean, variation).unwrap();
    // all of the variance is in two modes
    let complete = Field::interval(&covariance(Gaussian, 1e4), 1.0, Truncation::Captured(1.0 - 1e-15)).unwrap();
    let short = Field::interval(&covariance(Exponential, 1.0), 1.0, Truncation::Modes(2)).unwrap();
    for (field, full) in [(complete, true), (short, false)] {
        for x in [0.0, 0.4, 1.0].map(|x| [x, 0.0]) {
            let (mut first, mut second) = (0.0, 0.0);
            for &(s, a) in &normal() {
                for &(t, b) in &normal() {
                    let germs = [s, t];
                    let e = (mu + sigma * field.value(x, &germs[..field.len()])).exp();
                    assert!(e > 0.0);
                    first += a * b * e;
                    second += a * b * e * e;
                }
            }
            let d2 = field.deviation(x).powi(2);
            let expected = mean * (0.5 * sigma * sigma * (d2 - 1.0)).exp();
            assert!((first / expected - 1.0).abs() < 1e-12);
            let relative = (second / (first * first) - 1.0).sqrt();
            let v = ((1.0 + variation * variation).powf(d2) - 1.0).sqrt();
            assert!((relative / v - 1.0).abs() < 1e-11);
            if full {
                assert!((first / mean - 1.0).abs() < 1e-10 && (relative / variation - 1.0).abs() < 1e-9);
            } else {
                assert!(d2 < 0.99 && first < mean * (1.0 - 1e-4));
            }
        }
    }
}

#[test]
fn senseless_lognormal_is_refused() {
    for (mean, variation) in [(0.0, 0.1), (-1.0, 0.1), (f64::NAN, 0.1), (1.0, -0.1), (1.0, f64::NAN), (1.0, 1e200)] {
        assert!(matches!(lognormal(mean, variation), Err(StochasticError::Number { .. })));
    }
    assert_eq!(lognormal(1.0, 0.0).unwrap(), (0.0, 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn no_germs_reach_the_bound_and_some_come_near(ell in 0.5..3.0f64, s in 0.0..1.0f64, t in 0.0..1.0f64) {
        for (field, sides) in fields(ell) {
            let x = [s * sides[0], t * sides[1]];
            let bound = field.bound();
            let germs: Vec<f64> = field.modes(x).iter().map(|b| 3f64.sqrt() * b.signum()).collect();
            prop_assert!(field.value(x, &germs) <= bound * (1.0 + 1e-12));
            let n = 100;
            let grid = |k: usize| [(k % n) as f64 * sides[0] / (n - 1) as f64, (k / n) as f64 * sides[1] / (n - 1) as f64];
            let count = if sides[1] > 0.0 { n * n } else { n };
            let brute = (0..count).map(|k| total(&field, grid(k))).fold(0.0, f64::max);
            prop_assert!(brute <= bound * (1.0 + 1e-12) && bound <= 1.01 * brute, "{brute} and {bound}");
        }
    }

    #[test]
    fn value_is_linear_and_the_variance_is_that_of_the_modes(
        ell in 0.3..3.0f64, s in 0.0..1.0f64, t in 0.0..1.0f64, germs in prop::collection::vec(-3.0..3.0f64, 5),
    ) {
        for (field, sides) in fields(ell) {
            let x = [s * sides[0], t * sides[1]];
            let sum: f64 = (0..5).map(|m| field.mode(m, x) * germs[m]).sum();
            prop_assert!((field.value(x, &germs) - sum).abs() < 1e-12);
            let deviation = field.deviation(x);
            prop_assert!(deviation <= 1.0 + 1e-5);
            let squares: f64 = (0..5).map(|m| field.mode(m, x).powi(2)).sum();
            prop_assert!((deviation * deviation - squares).abs() < 1e-12);
        }
    }
}

/// The share captured is the mean of the variance.
#[test]
fn captured_share_is_the_mean_variance() {
    let rule = steklov_quadrature::gauss_legendre(50);
    for (field, sides) in fields(0.6) {
        let (x, y) = (rule.mapped(0.0, 1.0), rule.mapped(0.0, 1.0));
        let along = |s: f64| y.integrate(|t| field.deviation([s * sides[0], t * sides[1]]).powi(2));
        assert!((x.integrate(along) - field.captured()).abs() < 1e-12);
    }
}
