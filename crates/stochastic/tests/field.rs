//! Random fields: values and variances.

use proptest::prelude::*;
use steklov_stochastic::Kernel::{Exponential, Gaussian};
use steklov_stochastic::{Covariance, Field, Kernel, Truncation};

fn covariance(kernel: steklov_stochastic::Kernel, ell: f64) -> Covariance {
    Covariance { kernel, correlation: [ell; 2] }
}

fn fields(ell: f64) -> Vec<(Field, [f64; 2])> {
    let sides = [2.0, 1.0];
    let mut out = Vec::new();
    for kernel in [Exponential, Gaussian, Kernel::MATERN_32] {
        let c = covariance(kernel, ell);
        out.push((Field::interval(&c, sides[0], Truncation::Modes(5)).unwrap(), [sides[0], 0.0]));
        out.push((Field::rectangle(&c, sides, Truncation::Modes(5)).unwrap(), sides));
    }
    out
}

/// Of the truncated field at a point.
fn variance(field: &Field, x: [f64; 2]) -> f64 {
    field.modes(x).iter().map(|b| b * b).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn value_is_linear_and_the_variance_at_most_one(
        ell in 0.3..3.0f64, s in 0.0..1.0f64, t in 0.0..1.0f64, germs in prop::collection::vec(-3.0..3.0f64, 5),
    ) {
        for (field, sides) in fields(ell) {
            let x = [s * sides[0], t * sides[1]];
            let sum: f64 = field.modes(x).iter().zip(&germs).map(|(b, xi)| b * xi).sum();
            prop_assert!((field.value(x, &germs) - sum).abs() < 1e-12);
            prop_assert!(variance(&field, x) <= 1.0 + 1e-5);
        }
    }
}

/// The share captured is the mean of the variance.
#[test]
fn captured_share_is_the_mean_variance() {
    let rule = steklov_quadrature::gauss_legendre(50);
    for (field, sides) in fields(0.6) {
        let (x, y) = (rule.mapped(0.0, 1.0), rule.mapped(0.0, 1.0));
        let along = |s: f64| y.integrate(|t| variance(&field, [s * sides[0], t * sides[1]]));
        assert!((x.integrate(along) - field.captured()).abs() < 1e-12);
    }
}
