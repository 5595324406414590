//! Expansions on intervals: eigenvalues against closed forms, modes against what defines them.

use proptest::prelude::*;
use std::f64::consts::PI;
use steklov_quadrature::{Rule, gauss_legendre};
use steklov_stochastic::Kernel::{Exponential, Gaussian};
use steklov_stochastic::{Covariance, KarhunenLoeve, Kernel, StochasticError, Truncation};

fn expansion(kernel: Kernel, ell: f64, length: f64, truncation: Truncation) -> KarhunenLoeve {
    KarhunenLoeve::new(&Covariance { kernel, correlation: [ell, f64::NAN] }, length, truncation).unwrap()
}

fn modes(kl: &KarhunenLoeve, x: f64) -> Vec<f64> {
    let mut out = vec![0.0; kl.len()];
    kl.modes(x, &mut out);
    out
}

/// Gauss points on `pieces` parts of [0, length].
fn composite(length: f64, pieces: usize, points: usize) -> Rule {
    let base = gauss_legendre(points);
    let h = length / pieces as f64;
    let parts: Vec<Rule> = (0..pieces).map(|i| base.mapped(i as f64 * h, (i + 1) as f64 * h)).collect();
    let gather = |f: fn(&Rule) -> &Vec<f64>| parts.iter().flat_map(f).copied().collect();
    Rule { points: gather(|r| &r.points), weights: gather(|r| &r.weights), degree: base.degree }
}

/// Largest entry of ∫ b_m b_n dx - δ_mn.
fn orthonormality(kl: &KarhunenLoeve, pieces: usize) -> f64 {
    let rule = composite(kl.length(), pieces, 20);
    let mut gram = vec![0.0; kl.len() * kl.len()];
    for (&x, &w) in rule.points.iter().zip(&rule.weights) {
        let b = modes(kl, x);
        for m in 0..b.len() {
            for n in 0..b.len() {
                gram[m * b.len() + n] += w * b[m] * b[n];
            }
        }
    }
    let defect = |(k, g): (usize, &f64)| (g - if k % (kl.len() + 1) == 0 { 1.0 } else { 0.0 }).abs();
    gram.iter().enumerate().map(defect).fold(0.0, f64::max)
}

/// Largest |∫ C(x-y) b_m(y) dy - λ_m b_m(x)| √L/λ_1 at some points; the integral is cut at the kink.
fn residual(kl: &KarhunenLoeve, covariance: impl Fn(f64) -> f64, pieces: usize) -> f64 {
    let length = kl.length();
    let mut worst = 0f64;
    for x in [0.0, 0.123 * length, 0.5 * length, 0.77 * length, length] {
        let mut applied = vec![0.0; kl.len()];
        for (from, size) in [(0.0, x), (x, length - x)] {
            let rule = composite(size, pieces, 20);
            for (&y, &w) in rule.points.iter().zip(&rule.weights).filter(|_| size > 0.0) {
                let value = w * covariance(x - from - y);
                applied.iter_mut().zip(modes(kl, from + y)).for_each(|(a, b)| *a += value * b);
            }
        }
        let expected = modes(kl, x);
        for m in 0..kl.len() {
            let error = (applied[m] - kl.eigenvalue(m) * expected[m]).abs();
            worst = worst.max(error * length.sqrt() / kl.eigenvalue(0));
        }
    }
    worst
}

/// Defect of the classical equation c = w tan(wa) or w = -c tan(wa) of mode m, w from its eigenvalue, which must lie in the
/// m-th interval: no root is lost and none is found twice.
fn classical(kl: &KarhunenLoeve, ell: f64, m: usize) -> f64 {
    let (a, c) = (0.5 * kl.length(), 1.0 / ell);
    let w = (2.0 * c / kl.eigenvalue(m) - c * c).sqrt();
    let place = w * a / (0.5 * PI);
    assert!(place > m as f64 * (1.0 - 1e-9) && place < (m + 1) as f64 * (1.0 + 1e-9), "{place} of mode {m}");
    let (sin, cos) = (w * a).sin_cos();
    if m.is_multiple_of(2) { (c * cos - w * sin) / c.hypot(w) } else { (w * cos + c * sin) / c.hypot(w) }
}

#[test]
fn exponential_eigenvalues_are_those_of_the_reference() {
    let table: [(f64, f64, [f64; 8]); 4] = [
        (
            1.0,
            1.0,
            [
                0.7388108094,
                0.1380037754,
                0.04508848729,
                0.02132893129,
                0.01227891385,
                0.007945371034,
                0.005551069348,
                0.004093330454,
            ],
        ),
        (
            1.0,
            0.5,
            [
                0.5746552163,
                0.1954706187,
                0.0785246054,
                0.0397782885,
                0.02356333862,
                0.01546572561,
                0.01089227155,
                0.0080717311,
            ],
        ),
        (
            1.0,
            0.1,
            [
                0.1870825519,
                0.1560455602,
                0.1211543515,
                0.09132424281,
                0.0687355952,
                0.05240283773,
                0.04069455735,
                0.03222547331,
            ],
        ),
        (
            6.0,
            1.0,
            [
                1.727122667,
                1.197589908,
                0.7657401186,
                0.4947277841,
                0.3336854144,
                0.2358665646,
                0.1738178042,
                0.1326470036,
            ],
        ),
    ];
    for (length, ell, expected) in table {
        let kl = expansion(Exponential, ell, length, Truncation::Modes(8));
        for (m, lambda) in expected.into_iter().enumerate() {
            // printed with ten digits
            assert!((kl.eigenvalue(m) / lambda - 1.0).abs() < 1e-9, "{} is not {lambda}", kl.eigenvalue(m));
        }
    }
}

#[test]
fn fewest_modes_carry_the_share() {
    let table = [(1.0, [3, 5, 21]), (0.5, [5, 9, 42]), (0.1, [21, 41, 204])];
    for (ell, counts) in table {
        for (share, count) in [0.9, 0.95, 0.99].into_iter().zip(counts) {
            let kl = expansion(Exponential, ell, 1.0, Truncation::Captured(share));
            assert_eq!(kl.len(), count);
            assert!(kl.captured() >= share);
            let fewer = expansion(Exponential, ell, 1.0, Truncation::Modes(count - 1));
            assert!(fewer.captured() < share);
        }
    }
}

#[test]
fn exponential_roots_solve_the_classical_equations_at_any_length() {
    for exponent in -3..=3 {
        let ell = 10f64.powi(exponent);
        let kl = expansion(Exponential, ell, 1.0, Truncation::Modes(200));
        for m in 0..200 {
            // the frequency comes back from λ with the error of a difference
            let lost = 1.0 / (1.0 - 0.5 * kl.eigenvalue(m) / ell);
            let defect = classical(&kl, ell, m).abs();
            assert!(defect < 1e-12 * (1.0 + m as f64) * lost.min(1e6), "{defect} of mode {m} at {ell}");
        }
    }
}

#[test]
fn trace_is_complete_up_to_the_tail() {
    // the tail is 2/(π² ℓ m) up to O(1/m²), and roots cannot be missing in it
    for ell in [0.1, 1.0, 10.0] {
        let kl = expansion(Exponential, ell, 1.0, Truncation::Modes(10_000));
        let tail = 2.0 / (PI * PI * ell * 10_000.0);
        assert!(((1.0 - kl.captured()) / tail - 1.0).abs() < 1e-3, "{}", (1.0 - kl.captured()) / tail);
    }
}

#[test]
fn galerkin_finds_the_exponential_eigenvalues() {
    for ell in [0.1, 0.5, 1.0, 5.0] {
        let exact = expansion(Exponential, ell, 1.0, Truncation::Modes(20));
        let kernel = |r: f64| Exponential.value(r / ell);
        let cubic = KarhunenLoeve::galerkin(kernel, 1.0, 100, 3, Truncation::Modes(20)).unwrap();
        let high = KarhunenLoeve::galerkin(kernel, 1.0, 10, 15, Truncation::Modes(20)).unwrap();
        for m in 0..20 {
            let error = |kl: &KarhunenLoeve| kl.eigenvalue(m) / exact.eigenvalue(m) - 1.0;
            // eigenvalues of a Galerkin method are lower bounds
            assert!(error(&cubic) < 1e-13 && error(&cubic) > -1e-8, "{} of {m} at {ell}", error(&cubic));
            assert!(error(&high).abs() < 1e-9, "{} of {m} at {ell}", error(&high));
        }
        for x in [0.0, 0.31, 0.5, 0.999] {
            for (m, (a, b)) in modes(&high, x).into_iter().zip(modes(&exact, x)).enumerate() {
                assert!((a - b).abs() < 1e-4, "mode {m} at {x}: {a} and {b}");
            }
        }
    }
}

#[test]
fn low_degree_converges_at_the_order_of_the_degree() {
    let exact = expansion(Exponential, 0.5, 1.0, Truncation::Modes(6)).eigenvalue(5);
    let error = |elements, degree| {
        let kernel = |r: f64| Exponential.value(r / 0.5);
        1.0 - KarhunenLoeve::galerkin(kernel, 1.0, elements, degree, Truncation::Modes(6)).unwrap().eigenvalue(5)
            / exact
    };
    for degree in 0..3 {
        let order = (error(16, degree) / error(32, degree)).log2();
        assert!((order - (2 * degree + 2) as f64).abs() < 0.3, "{order} at degree {degree}");
    }
}

#[test]
fn gaussian_and_matern_eigenvalues_are_those_of_the_reference() {
    let gaussian = [
        0.6520966477,
        0.2679786588,
        0.06697521233,
        0.01135538928,
        0.001436307204,
        0.0001447315628,
        1.212581435e-5,
        8.696239843e-7,
    ];
    let kl = expansion(Gaussian, 0.5, 1.0, Truncation::Modes(8));
    for (m, lambda) in gaussian.into_iter().enumerate() {
        assert!((kl.eigenvalue(m) / lambda - 1.0).abs() < 1e-9);
    }
    let matern = [0.6971879794, 0.2136530351, 0.05768281482, 0.01798721373, 0.006749766309, 0.002964319726];
    let kl = expansion(Kernel::MATERN_32, 0.5, 1.0, Truncation::Modes(6));
    for (m, lambda) in matern.into_iter().enumerate() {
        // Nyström's method with 400 points, h⁴ away
        assert!((kl.eigenvalue(m) / lambda - 1.0).abs() < 1e-7);
    }
}

/// Frequencies of the Matérn covariance: its modes solve (d²/dx² - a²)² b = 4 a³ b/λ with a = √3/ℓ.
#[test]
fn matern_modes_solve_their_differential_equation() {
    let (ell, h) = (0.5f64, 0.01);
    let a = 3f64.sqrt() / ell;
    let kl = expansion(Kernel::MATERN_32, ell, 1.0, Truncation::Modes(4));
    let x = [0.3 - 2.0 * h, 0.3 - h, 0.3, 0.3 + h, 0.3 + 2.0 * h].map(|x| modes(&kl, x));
    for m in 0..4 {
        let b: Vec<f64> = x.iter().map(|b| b[m]).collect();
        let second = (-b[0] + 16.0 * b[1] - 30.0 * b[2] + 16.0 * b[3] - b[4]) / (12.0 * h * h);
        let fourth = (b[0] - 4.0 * b[1] + 6.0 * b[2] - 4.0 * b[3] + b[4]) / h.powi(4);
        let (left, right) =
            (fourth - 2.0 * a * a * second + a.powi(4) * b[2], 4.0 * a.powi(3) / kl.eigenvalue(m) * b[2]);
        let size = (4.0 * a.powi(3) / kl.eigenvalue(m)) * b[2].abs().max(0.1);
        assert!((left - right).abs() < 2e-3 * size, "{left} and {right} of mode {m}");
    }
}

/// A field of any smoothness has the eigenvalues that four times as many elements have.
#[test]
fn rough_kernels_are_resolved() {
    for (smoothness, tolerance) in [(0.5, 1e-12), (0.6, 3e-8), (1.0, 3e-10), (2.2, 1e-12), (7.0, 1e-12)] {
        let kernel = Kernel::Matern { smoothness };
        let own = expansion(kernel, 0.5, 1.0, Truncation::Modes(12));
        let value = |r: f64| kernel.value(r / 0.5);
        let fine = KarhunenLoeve::galerkin(value, 1.0, 32, 15, Truncation::Modes(12)).unwrap();
        for m in 0..12 {
            let off = (own.eigenvalue(m) - fine.eigenvalue(m)).abs();
            assert!(off < tolerance * own.eigenvalue(0), "{smoothness}: {off:e} of mode {m}");
        }
    }
}

#[test]
fn modes_are_orthonormal_and_satisfy_their_equation() {
    for (kernel, ell, count) in [(Exponential, 0.3, 30), (Gaussian, 0.3, 10), (Kernel::MATERN_32, 0.3, 30)] {
        let kl = expansion(kernel, ell, 2.0, Truncation::Modes(count));
        let defect = orthonormality(&kl, 48);
        assert!(defect < 1e-12, "{kernel:?}: {defect}");
        let covariance = Covariance { kernel, correlation: [ell; 2] };
        let error = residual(&kl, |r| covariance.on_interval(r), 48);
        assert!(error < 1e-10, "{kernel:?}: {error}");
    }
}

#[test]
fn long_correlation_leaves_one_mode_and_short_correlation_none() {
    let matern = [1.0, 1.5, 2.5].map(|smoothness| Kernel::Matern { smoothness });
    for kernel in [Exponential, Gaussian].into_iter().chain(matern) {
        for length in [1.0, 7.0] {
            let kl = expansion(kernel, 1e6 * length, length, Truncation::Modes(1));
            assert!((kl.eigenvalue(0) / length - 1.0).abs() < 1e-6);
            assert!((modes(&kl, 0.2 * length)[0] - length.sqrt().recip()).abs() < 1e-5);
        }
        // λ_m → ∫ C over the line, the density of the spectrum at 0
        let density = match kernel {
            Exponential => 2.0,
            Gaussian => PI.sqrt(),
            Kernel::Matern { smoothness: 1.0 } => PI / 2f64.sqrt(),
            Kernel::Matern { smoothness: 2.5 } => 16.0 / (3.0 * 5f64.sqrt()),
            Kernel::Matern { .. } => 4.0 / 3f64.sqrt(),
        };
        let ell = 1.0 / 200.0;
        let kl = expansion(kernel, ell, 1.0, Truncation::Modes(2));
        assert!((kl.eigenvalue(0) / (density * ell) - 1.0).abs() < 1e-3, "{kernel:?}");
        assert!(kl.eigenvalue(0) < density * ell);
    }
}

#[test]
fn impossible_wishes_are_refused_with_numbers() {
    let new = |kernel, ell: f64, length: f64, truncation| {
        KarhunenLoeve::new(&Covariance { kernel, correlation: [ell; 2] }, length, truncation).map(|kl| kl.len())
    };
    for kernel in [Exponential, Gaussian, Kernel::MATERN_32] {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(new(kernel, bad, 1.0, Truncation::Modes(1)), Err(StochasticError::Number { .. })));
            assert!(matches!(new(kernel, 1.0, bad, Truncation::Modes(1)), Err(StochasticError::Number { .. })));
        }
        for share in [0.0, 1.0, 1.5, f64::NAN] {
            assert!(matches!(new(kernel, 1.0, 1.0, Truncation::Captured(share)), Err(StochasticError::Number { .. })));
        }
        assert!(matches!(new(kernel, 1.0, 1.0, Truncation::Modes(0)), Err(StochasticError::Number { .. })));
        let many = new(kernel, 1.0, 1.0, Truncation::Modes(10_001));
        assert!(matches!(many, Err(StochasticError::Modes { wanted: 10_001, available }) if available > 3));
    }
    let rough = new(Exponential, 1e-3, 1.0, Truncation::Captured(0.99));
    assert!(matches!(rough, Err(StochasticError::Captured { modes: 10_000, captured, .. }) if captured > 0.97));
    assert!(matches!(new(Gaussian, 1e-3, 1.0, Truncation::Modes(1)), Err(StochasticError::Unresolved { .. })));
    let own = |kernel: fn(f64) -> f64| KarhunenLoeve::galerkin(kernel, 1.0, 8, 3, Truncation::Modes(2)).err();
    assert!(matches!(own(|r| 2.0 - r), Some(StochasticError::Number { .. })));
    assert!(matches!(own(|r| if r == 0.0 { 1.0 } else { f64::NAN }), Some(StochasticError::Decomposition { .. })));
    assert!(matches!(own(|r| 1.0 - 2.0 * r * r), Some(StochasticError::Number { .. })), "not positive semi-definite");
}

fn kernels() -> impl Strategy<Value = Kernel> {
    prop_oneof![Just(Exponential), Just(Gaussian), Just(Kernel::MATERN_32)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn lengths_scale(kernel in kernels(), ratio in 0.1..20.0f64, length in 1e-3..1e3f64, x in 0.0..1.0f64) {
        let truncation = Truncation::Captured(0.8);
        let (unit, scaled) = (expansion(kernel, ratio, 1.0, truncation), expansion(kernel, ratio * length, length, truncation));
        prop_assert_eq!(unit.len(), scaled.len());
        let (a, b) = (modes(&unit, x), modes(&scaled, x * length));
        for m in 0..unit.len() {
            prop_assert!((scaled.eigenvalue(m) / (length * unit.eigenvalue(m)) - 1.0).abs() < 1e-9);
            prop_assert!((b[m] * length.sqrt() - a[m]).abs() < 1e-8);
        }
    }

    #[test]
    fn eigenvalues_descend_and_modes_are_what_they_should_be(
        kernel in kernels(), ell in 0.1..50.0f64, length in 0.1..10.0f64, share in 0.3..0.95f64,
    ) {
        let kl = expansion(kernel, ell, length, Truncation::Captured(share));
        prop_assert!((1..kl.len()).all(|m| kl.eigenvalue(m) < kl.eigenvalue(m - 1) && kl.eigenvalue(m) > 0.0));
        prop_assert!(kl.captured() >= share && kl.captured() <= 1.0);
        let start = modes(&kl, 0.0);
        let end = modes(&kl, length);
        for m in 0..kl.len() {
            prop_assert!(start[m] > 0.0);
            let parity = if m % 2 == 0 { 1.0 } else { -1.0 };
            prop_assert!((end[m] - parity * start[m]).abs() < 1e-11 / length.sqrt());
        }
        if kl.len() <= 40 {
            prop_assert!(orthonormality(&kl, 32) < 1e-12);
        }
    }

    /// Mercer's theorem: Σ λ_m b_m(x)² → 1 from below, and Σ λ_m b_m(x) b_m(y) → C(x-y).
    #[test]
    fn expansion_converges_to_the_covariance(ell in 0.2..5.0f64, x in 0.05..0.95f64, y in 0.05..0.95f64) {
        for (kernel, share, error) in [(Gaussian, 1.0 - 1e-10, 1e-7), (Kernel::MATERN_32, 0.9999, 2e-3)] {
            let kl = expansion(kernel, ell, 1.0, Truncation::Captured(share));
            let (a, b) = (modes(&kl, x), modes(&kl, y));
            let sum = |a: &[f64], b: &[f64]| (0..kl.len()).map(|m| kl.eigenvalue(m) * a[m] * b[m]).sum::<f64>();
            prop_assert!(sum(&a, &a) <= 1.0 + 1e-9 && sum(&a, &a) > 1.0 - error);
            let exact = Covariance { kernel, correlation: [ell; 2] }.on_interval(x - y);
            prop_assert!((sum(&a, &b) - exact).abs() < error);
        }
        let kl = expansion(Exponential, ell, 1.0, Truncation::Modes(2000));
        let b = modes(&kl, x);
        let variance: f64 = (0..2000).map(|m| kl.eigenvalue(m) * b[m] * b[m]).sum();
        // inside, the tail is 1 - captured, up to oscillations of its order
        prop_assert!(variance <= 1.0 + 1e-12 && 1.0 - variance < 3.0 * (1.0 - kl.captured()));
    }
}
