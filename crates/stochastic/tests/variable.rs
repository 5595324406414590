//! Variables: probabilities, quantiles and moments against closed forms and numbers of forty digits.

use proptest::prelude::*;
use std::f64::consts::PI;
use steklov_stochastic::{Distribution, StochasticError, Variable};

const INFINITE: f64 = f64::INFINITY;

#[track_caller]
fn close(got: f64, wanted: f64, tolerance: f64) {
    assert!((got / wanted - 1.0).abs() <= tolerance, "{got:e}, wanted {wanted:e}: {:e}", got / wanted - 1.0);
}

#[test]
fn probabilities_of_the_normal_distribution_keep_their_digits_in_tails_and_narrow_intervals() {
    let x = Variable::normal(0.0, 1.0).unwrap();
    close(x.probability([10.0, 11.0]), 7.619_661_958_203_076e-24, 2e-14);
    close(x.probability([-11.0, -10.0]), 7.619_661_958_203_076e-24, 2e-14);
    close(x.probability([30.0, INFINITE]), 4.906_713_927_148_187e-198, 2e-13);
    close(x.probability([-1.0, 2.0]), 0.818_594_614_120_363_7, 1e-15);
    close(x.probability([5.0, 5.0009765625]), 1.448_335_442_835_082_5e-9, 3e-15);
    close(x.probability([-38.0, -1.0]), 0.158_655_253_931_457_05, 1e-15);
    assert_eq!(x.probability([2.0, 2.0]), 0.0);
    assert_eq!(x.probability([3.0, 2.0]), 0.0);
    assert_eq!(x.probability([f64::NAN, 2.0]), 0.0);
    assert_eq!(x.probability([-INFINITE, INFINITE]), 1.0);
}

#[test]
fn probabilities_of_beta_distributions() {
    let below = [
        (2.5, 0.5, 0.875, 0.436_588_061_020_381_8, 0.563_411_938_979_618_2),
        (0.25, 3.0, 2f64.powi(-20), 0.043_945_295_736_198_1, 0.956_054_704_263_801_9),
        (40.0, 60.0, 0.25, 5.415_414_913_047_472e-4, 0.999_458_458_508_695_3),
        (500.0, 700.0, 0.5, 0.999_999_996_460_364_6, 3.539_635_367_307_762_4e-9),
        (1.0, 1000.0, 0.03125, 0.999_999_999_999_983_7, 1.628_229_107_882_376e-14),
    ];
    for (alpha, beta, x, low, high) in below {
        let v = Variable::beta(alpha, beta, 0.0, 1.0).unwrap();
        close(v.probability([0.0, x]), low, 2e-13);
        close(v.probability([x, 1.0]), high, 2e-13);
        // a rounded p near 1 fixes its quantile less well
        assert!((v.quantile(low) - x).abs() < 1e-13 + f64::EPSILON * low / v.density(x), "{:e}", v.quantile(low) - x);
    }
    let wide = Variable::beta(2.0, 2.0, 0.0, 1e10).unwrap();
    assert_eq!(wide.probability([0.0, 5e-324]), 0.0);
    // so skew that the median is next to 0: it keeps its digits there
    let skew = Variable::beta(0.01, 1000.0, 0.0, 1.0).unwrap();
    close(skew.quantile(0.538_814_312_772_750_3), 2f64.powi(-100), 2e-11);
    // F(x) = 2/π arcsin √x
    let arcsine = Variable::beta(0.5, 0.5, 0.0, 1.0).unwrap();
    for x in [1e-12f64, 1e-3, 0.3, 0.5, 0.9] {
        let wanted = 2.0 / PI * x.sqrt().asin();
        close(arcsine.probability([0.0, x]), wanted, 1e-14);
        close(arcsine.quantile(wanted), x, 1e-13);
        close(arcsine.density(x), 1.0 / (PI * (x * (1.0 - x)).sqrt()), 1e-14);
    }
}

#[test]
fn restricted_variables_have_the_moments_of_their_conditioned_density() {
    let x = Variable::new(Distribution::Normal { mean: 200.0, deviation: 30.0 }, 150.0, 320.0).unwrap();
    close(x.mean(), 203.129_981_296_154_63, 1e-14);
    close(x.variance(), 732.987_338_648_336_9, 1e-13);
    close(x.lost(), 0.047_822_023_514_647_78, 1e-14);
    let law = Distribution::Lognormal { mean: 2000.0, deviation: 600.0 };
    let tail = Variable::new(law, 1500.0, INFINITE).unwrap();
    close(tail.mean(), 2_181.648_439_504_656_5, 1e-14);
    close(tail.variance(), 281_546.845_481_124_5, 1e-13);
    close(tail.lost(), 0.202_367_204_132_021_57, 1e-14);
    let middle = Variable::new(law, 1500.0, 2500.0).unwrap();
    close(middle.mean(), 1_950.760_499_429_550_8, 1e-14);
    close(middle.variance(), 74_699.327_250_173_63, 1e-13);
    close(middle.lost(), 0.384_594_800_418_080_6, 1e-14);
    // so narrow that the density is flat: mean of the interval, variance of a uniform variable
    let narrow = Variable::new(Distribution::Normal { mean: 0.0, deviation: 1.0 }, 1.0, 1.0 + 1e-7).unwrap();
    close(narrow.variance(), (narrow.interval()[1] - 1.0).powi(2) / 12.0, 1e-12);
}

#[test]
fn whole_variables_have_the_moments_asked_for() {
    let steel = Variable::normal(200e9, 1e9).unwrap();
    assert_eq!((steel.mean(), steel.variance(), steel.lost()), (200e9, 1e18, 0.0));
    let e = Variable::lognormal(2000.0, 200.0).unwrap();
    assert_eq!((e.mean(), e.variance(), e.lost()), (2000.0, 40_000.0, 0.0));
    assert!(!e.is_affine() && steel.is_affine());
    // the germ is the logarithm: its deviation is √ln(1 + 0.01), the median is below the mean
    close(e.value(e.quantile(0.5)), 2000.0 / 1.01f64.sqrt(), 1e-14);
    let b = Variable::beta(2.0, 3.0, -1.0, 4.0).unwrap();
    close(b.mean(), 1.0, 1e-15);
    close(b.variance(), 25.0 * 0.04, 1e-15);
    let u = Variable::uniform(1800.0, 2200.0).unwrap();
    assert_eq!((u.mean(), u.quantile(0.25), u.density(1900.0), u.density(2300.0)), (2000.0, 1900.0, 1.0 / 400.0, 0.0));
    close(u.variance(), 160_000.0 / 12.0, 1e-15);
}

#[test]
fn input_that_is_no_distribution_is_refused_with_its_number() {
    let normal = |mean, deviation| Distribution::Normal { mean, deviation };
    let lognormal = |mean, deviation| Distribution::Lognormal { mean, deviation };
    let refused = [
        (Distribution::Uniform, 1.0, 1.0),
        (Distribution::Uniform, 2.0, 1.0),
        (Distribution::Uniform, 0.0, INFINITE),
        (Distribution::Uniform, f64::NAN, 1.0),
        (Distribution::Uniform, -1e308, 1e308),
        (Distribution::Uniform, 1e15, 1e15 + 1.0),
        (normal(0.0, 0.0), -1.0, 1.0),
        (normal(0.0, -1.0), -1.0, 1.0),
        (normal(f64::NAN, 1.0), -1.0, 1.0),
        (normal(1.0, 1e-14), -1.0, 2.0),
        (normal(0.0, 1.0), INFINITE, INFINITE),
        (lognormal(1.0, 0.1), -1.0, 2.0),
        (lognormal(-1.0, 0.1), 0.0, 2.0),
        (lognormal(1.0, 0.0), 0.0, 2.0),
        (Distribution::Beta { alpha: 0.0, beta: 1.0 }, 0.0, 1.0),
        (Distribution::Beta { alpha: 1.0, beta: 1e9 }, 0.0, 1.0),
        (Distribution::Beta { alpha: 1.0, beta: 1.0 }, 0.0, INFINITE),
    ];
    for (law, low, high) in refused {
        let got = Variable::new(law, low, high);
        assert!(matches!(got, Err(StochasticError::Number { .. })), "{law:?} on [{low}, {high}]: {got:?}");
    }
    let empty = |a, b| Variable::new(normal(0.0, 1.0), a, b);
    assert!(matches!(empty(40.0, 41.0), Err(StochasticError::NoProbability { .. })));
    assert!(matches!(empty(-INFINITE, -40.0), Err(StochasticError::NoProbability { .. })));
    assert!(empty(36.0, 37.0).is_ok(), "1e-283 is little, but something");
}

fn any() -> impl Strategy<Value = Variable> {
    let span = (-5.0..5.0f64, 0.1..6.0f64);
    prop_oneof![
        span.clone().prop_map(|(a, h)| Variable::uniform(a, a + h).unwrap()),
        (span.clone(), -1.0..1.0f64, 0.2..4.0f64).prop_map(|((a, h), mean, deviation)| Variable::new(
            Distribution::Normal { mean, deviation },
            a,
            a + h
        )
        .unwrap()),
        (0.0..3.0f64, 0.05..2.0f64).prop_map(|(low, deviation)| Variable::new(
            Distribution::Lognormal { mean: 1.0, deviation },
            low,
            INFINITE
        )
        .unwrap()),
        (span, 0.1..30.0f64, 0.1..30.0f64)
            .prop_map(|((a, h), alpha, beta)| Variable::beta(alpha, beta, a, a + h).unwrap()),
    ]
}

proptest! {
    #[test]
    fn the_quantile_is_the_inverse_of_the_probability(v in any(), p in prop_oneof![0.0..1.0f64, (-9.0..-1.0f64).prop_map(|e| 10f64.powf(e))]) {
        let x = v.quantile(p);
        let [low, high] = v.germ_support();
        let (below, above) = (v.probability([low, x]), v.probability([x, high]));
        prop_assert!((below + above - 1.0).abs() < 1e-13, "{}", below + above - 1.0);
        // a germ is rounded: that moves the probability by the density times the rounding
        let rounding = 4.0 * f64::EPSILON * v.density(x) * x.abs().max(low.abs().min(1e3)).max(high.abs().min(1e3));
        prop_assert!((below - p).abs() <= 2e-13 * p + rounding, "{v:?} {p}: {below}");
    }

    #[test]
    fn the_density_is_the_derivative_of_the_probability(v in any(), p in 0.05..0.95f64) {
        let (a, b) = (v.quantile(p - 1e-3), v.quantile(p + 1e-3));
        // quantiles next to the end of a beta variable can be the same number
        prop_assume!(b - a > 1e-6);
        let rule = steklov_quadrature::gauss_legendre(30).mapped(a, b);
        let integral = rule.integrate(|x| v.density(x));
        prop_assert!((integral / 2e-3 - 1.0).abs() < 1e-9, "{v:?} {p}: {integral}");
    }
}

#[test]
fn quantiles_end_at_the_ends() {
    let x = Variable::new(Distribution::Normal { mean: 1.0, deviation: 2.0 }, 0.0, INFINITE).unwrap();
    assert_eq!((x.quantile(0.0), x.quantile(-1.0), x.quantile(1.0)), (0.0, 0.0, INFINITE));
    // in a tail of the normal distribution the quantile still divides it
    let tail = Variable::new(Distribution::Normal { mean: 0.0, deviation: 1.0 }, 30.0, INFINITE).unwrap();
    close(tail.probability([30.0, tail.quantile(0.5)]), 0.5, 1e-12);
    close(tail.lost(), 1.0, 1e-15);
}
