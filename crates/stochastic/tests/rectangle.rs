//! Expansions on rectangles.

use proptest::prelude::*;
use steklov_quadrature::gauss_legendre;
use steklov_stochastic::Kernel::{Exponential, Gaussian};
use steklov_stochastic::{Covariance, KarhunenLoeve, Kernel, RectangleKarhunenLoeve, StochasticError, Truncation};

fn expansion(kernel: Kernel, ell: [f64; 2], sides: [f64; 2], truncation: Truncation) -> RectangleKarhunenLoeve {
    RectangleKarhunenLoeve::new(&Covariance { kernel, correlation: ell }, sides, truncation).unwrap()
}

fn modes(kl: &RectangleKarhunenLoeve, x: [f64; 2]) -> Vec<f64> {
    let mut out = vec![0.0; kl.len()];
    kl.modes(x, &mut out);
    out
}

#[test]
fn six_by_one_is_that_of_the_reference() {
    let expected = [
        1.276016896,
        0.8847923691,
        0.5657370768,
        0.3655102346,
        0.2465303911,
        0.2383494486,
        0.1742607675,
        0.1652719286,
        0.1284184726,
        0.1056750273,
    ];
    let of = |share| expansion(Exponential, [1.0; 2], [6.0, 1.0], Truncation::Captured(share));
    for (m, lambda) in expected.into_iter().enumerate() {
        assert!((of(0.9).eigenvalue(m) / lambda - 1.0).abs() < 1e-9);
    }
    assert_eq!([of(0.5).len(), of(0.9).len(), of(0.95).len()], [4, 62, 168]);
}

/// Most eigenvalues of a square come twice.
#[test]
fn equal_products_have_a_fixed_order() {
    let one = KarhunenLoeve::new(&Covariance { kernel: Exponential, correlation: [0.5; 2] }, 1.0, Truncation::Modes(3));
    let (one, y) = (one.unwrap(), 0.3);
    // the same ratio up to rounding, either way
    for ell in [[0.5, 0.5], [0.5 * (1.0 + 1e-15), 0.5], [0.5, 0.5 * (1.0 + 1e-15)]] {
        let square = expansion(Exponential, ell, [1.0, 1.0], Truncation::Modes(3));
        assert!((square.eigenvalue(1) / square.eigenvalue(2) - 1.0).abs() < 1e-13);
        let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
        one.modes(0.1, &mut a);
        one.modes(y, &mut b);
        let found = modes(&square, [0.1, y]);
        assert!((found[1] - a[0] * b[1]).abs() < 1e-12 && (found[2] - a[1] * b[0]).abs() < 1e-12);
    }
}

#[test]
fn modes_are_orthonormal() {
    for kernel in [Exponential, Gaussian, Kernel::MATERN_32] {
        let kl = expansion(kernel, [0.8, 0.5], [2.0, 1.0], Truncation::Modes(12));
        let (x, y) = (gauss_legendre(60).mapped(0.0, 2.0), gauss_legendre(60).mapped(0.0, 1.0));
        let mut gram = [[0.0; 12]; 12];
        for (&x, &wx) in x.points.iter().zip(&x.weights) {
            for (&y, &wy) in y.points.iter().zip(&y.weights) {
                let b = modes(&kl, [x, y]);
                for m in 0..12 {
                    for n in 0..12 {
                        gram[m][n] += wx * wy * b[m] * b[n];
                    }
                }
            }
        }
        for m in 0..12 {
            for n in 0..12 {
                let exact = if m == n { 1.0 } else { 0.0 };
                assert!((gram[m][n] - exact).abs() < 1e-12, "{kernel:?} {m} {n}");
            }
        }
    }
}

/// ∫∫ C b_m b_m by a rule that has nothing to do with the points of the method.
#[test]
fn matern_modes_have_their_eigenvalues() {
    let covariance = Covariance { kernel: Kernel::MATERN_32, correlation: [1.0, 0.5] };
    let kl = RectangleKarhunenLoeve::new(&covariance, [1.5, 1.0], Truncation::Modes(6)).unwrap();
    let (x, y) = (gauss_legendre(37).mapped(0.0, 1.5), gauss_legendre(31).mapped(0.0, 1.0));
    let points: Vec<_> = x.points.iter().flat_map(|&x| y.points.iter().map(move |&y| [x, y])).collect();
    let weights: Vec<f64> = x.weights.iter().flat_map(|a| y.weights.iter().map(move |b| a * b)).collect();
    let values: Vec<_> = points.iter().map(|&p| modes(&kl, p)).collect();
    let mut energy = [0.0; 6];
    for (i, p) in points.iter().enumerate() {
        for (j, q) in points.iter().enumerate() {
            let c = weights[i] * weights[j] * covariance.on_rectangle(p[0] - q[0], p[1] - q[1]);
            (0..6).for_each(|m| energy[m] += c * values[i][m] * values[j][m]);
        }
    }
    for (m, energy) in energy.into_iter().enumerate() {
        assert!((energy - kl.eigenvalue(m)).abs() < 2e-6 * kl.eigenvalue(0), "{energy} {}", kl.eigenvalue(m));
    }
}

#[test]
fn thin_matern_rectangle_is_an_interval() {
    let covariance = Covariance { kernel: Kernel::MATERN_32, correlation: [0.5, 0.5] };
    let line = KarhunenLoeve::new(&covariance, 1.0, Truncation::Modes(4)).unwrap();
    let thin = RectangleKarhunenLoeve::new(&covariance, [1.0, 1e-4], Truncation::Modes(4)).unwrap();
    for m in 0..4 {
        assert!((thin.eigenvalue(m) / 1e-4 - line.eigenvalue(m)).abs() < 2e-6);
    }
}

/// The square's modes of one eigenvalue are told apart by their parities, whatever the rounding.
#[test]
fn matern_modes_of_a_square_are_even_or_odd() {
    let kl = expansion(Kernel::MATERN_32, [1.0, 1.0], [1.0, 1.0], Truncation::Modes(8));
    let (a, b) = (modes(&kl, [0.2, 0.3]), modes(&kl, [0.8, 0.3]));
    assert!((kl.eigenvalue(1) / kl.eigenvalue(2) - 1.0).abs() < 1e-12);
    for m in 0..8 {
        assert!((a[m] - b[m]).abs() < 1e-11 || (a[m] + b[m]).abs() < 1e-11, "{m}");
    }
    assert!((a[1] + b[1]).abs() < 1e-11 || (a[2] + b[2]).abs() < 1e-11);
}

#[test]
fn impossible_wishes_are_refused_with_numbers() {
    let new = |kernel, ell, truncation| {
        RectangleKarhunenLoeve::new(&Covariance { kernel, correlation: ell }, [1.0, 1.0], truncation).map(|kl| kl.len())
    };
    for kernel in [Exponential, Gaussian, Kernel::MATERN_32] {
        for ell in [[0.0, 1.0], [1.0, -1.0], [f64::NAN, 1.0]] {
            assert!(matches!(new(kernel, ell, Truncation::Modes(1)), Err(StochasticError::Number { .. })));
        }
        let all = new(kernel, [1.0; 2], Truncation::Captured(1.0));
        assert!(matches!(all, Err(StochasticError::Number { .. })));
    }
    assert!(matches!(new(Exponential, [0.01; 2], Truncation::Captured(0.99)), Err(StochasticError::Captured { .. })));
    assert!(matches!(new(Gaussian, [1.0; 2], Truncation::Modes(9999)), Err(StochasticError::Modes { .. })));
    assert!(matches!(
        new(Kernel::MATERN_32, [0.001; 2], Truncation::Modes(3)),
        Err(StochasticError::Unconverged { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Brute force: all products of long expansions of the sides.
    #[test]
    fn products_are_sorted_and_complete(a in 0.1..3.0f64, b in 0.1..3.0f64, share in 0.3..0.9f64) {
        let kl = expansion(Exponential, [a, b], [1.0, 2.0], Truncation::Captured(share));
        let side = |ell: f64, length: f64| {
            let covariance = Covariance { kernel: Exponential, correlation: [ell; 2] };
            let kl = KarhunenLoeve::new(&covariance, length, Truncation::Modes(kl.len())).unwrap();
            (0..kl.len()).map(|m| kl.eigenvalue(m)).collect::<Vec<_>>()
        };
        let (x, y) = (side(a, 1.0), side(b, 2.0));
        let mut all: Vec<f64> = x.iter().flat_map(|x| y.iter().map(move |y| x * y)).collect();
        all.sort_by(|p, q| q.total_cmp(p));
        for m in 0..kl.len() {
            prop_assert!((kl.eigenvalue(m) / all[m] - 1.0).abs() < 1e-11);
        }
        prop_assert!(kl.captured() >= share);
        prop_assert!(kl.captured() - kl.eigenvalue(kl.len() - 1) / 2.0 < share);
        prop_assert!(modes(&kl, [0.0, 0.0]).iter().all(|&b| b > 0.0));
    }
}
