//! Rules for integrands with a logarithmic or algebraic singularity at an end of the interval.

use crate::{Rule, gauss_legendre};

/// The end or ends of [-1,1] towards which a rule is graded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// x = -1.
    Left,
    /// x = 1.
    Right,
    /// Both, each half of the interval on its own.
    Both,
}

/// Largest number below 1: graded points stay strictly inside (-1,1).
const LAST_INSIDE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// Composite rule on [-1,1] with geometric panels towards the singular end or ends.
///
/// Each graded piece ((-1,1) for one end, each half for [`End::Both`]) of length l is cut at l·ratio^layers, ..,
/// l·ratio², l·ratio from its singular end, which gives layers+1 panels, and `base` (a rule on [-1,1]) is used on each.
/// Smooth functions keep the degree of `base`; for x^a log x the error falls like ratio^((1+a) layers).
///
/// Near ±1 a number cannot hold a small distance to the end: points are kept inside (-1,1), but their distance to ±1 is
/// rounded to multiples of 1e-16. Where the integrand needs that distance, take it from [`graded_unit`], whose points
/// *are* the distances.
///
/// # Panics
/// If ratio is not in (0,1).
///
/// Source: Schwab (1994), with one rule on all panels.
pub fn graded(base: &Rule, layers: usize, ratio: f64, end: End) -> Rule {
    let unit = graded_unit(base, layers, ratio);
    let length = if end == End::Both { 1.0 } else { 2.0 };
    let from_left = unit.points.iter().map(|s| (length * s - 1.0).max(-LAST_INSIDE));
    let from_right = unit.points.iter().rev().map(|s| (1.0 - length * s).min(LAST_INSIDE));
    let left = unit.weights.iter().map(|w| length * w);
    let right = unit.weights.iter().rev().map(|w| length * w);
    let (points, weights) = match end {
        End::Left => (from_left.collect(), left.collect()),
        End::Right => (from_right.collect(), right.collect()),
        End::Both => (from_left.chain(from_right).collect(), left.chain(right).collect()),
    };
    Rule { points, weights, degree: base.degree }
}

/// Composite rule on `[0,1]` with panels cut at ratio^layers, .., ratio², ratio: graded towards 0.
///
/// The points are the distances to the singular end, with full relative accuracy. `base` is a rule on [-1,1].
///
/// # Panics
/// If ratio is not in (0,1).
pub fn graded_unit(base: &Rule, layers: usize, ratio: f64) -> Rule {
    assert!(0.0 < ratio && ratio < 1.0, "the grading ratio must be in (0,1), got {ratio}");
    let mut rule = Rule { points: Vec::new(), weights: Vec::new(), degree: base.degree };
    let mut start = 0.0;
    for k in (0..=layers).rev() {
        let stop = ratio.powi(k as i32);
        let panel = base.mapped(start, stop);
        rule.points.extend(panel.points);
        rule.weights.extend(panel.weights);
        start = stop;
    }
    rule
}

/// Rule on `[0,1]` for f(σ) = A(σ) + B(σ) log σ with smooth A and B: σ = τ^power and n Gauss-Legendre points in τ.
///
/// ∫_0^1 f dσ = ∫_0^1 f(τ^power) power τ^(power-1) dτ; the factor τ^(power-1) tames the logarithm. Points keep full
/// relative accuracy next to 0. Degree in σ: ⌊2n/power⌋ - 1 without logarithm; powers 5 and 7 are of use.
///
/// # Panics
/// If power = 0 or 2n < power (constants would not be exact).
pub fn substituted(n: usize, power: u32) -> Rule {
    assert!(power > 0 && 2 * n >= power as usize, "power must be 1 to 2n, got {power} with n = {n}");
    let gauss = gauss_legendre(n).mapped(0.0, 1.0);
    let weight = |(t, w): (&f64, &f64)| w * f64::from(power) * t.powi(power as i32 - 1);
    Rule {
        points: gauss.points.iter().map(|t| t.powi(power as i32)).collect(),
        weights: gauss.points.iter().zip(&gauss.weights).map(weight).collect(),
        degree: 2 * n / power as usize - 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::LN_2;

    /// ∫_0^1 σ^k log σ dσ = -1/(k+1)².
    fn log_error(rule: &Rule, k: i32) -> f64 {
        (rule.integrate(|s| s.powi(k) * s.ln()) + 1.0 / f64::from((k + 1) * (k + 1))).abs()
    }

    #[test]
    fn each_layer_divides_the_logarithmic_error_by_the_ratio() {
        let base = gauss_legendre(12);
        for ratio in [0.15, 0.3, 0.5] {
            for (k, layers) in [(0, 3), (0, 6), (1, 2)] {
                let error = |l: usize| log_error(&graded_unit(&base, l, ratio), k);
                let expected = ratio.powi(k + 1);
                let (coarse, fine) = (error(layers), error(layers + 1));
                assert!((fine / coarse / expected - 1.0).abs() < 0.02, "{ratio} {k}: {coarse:e} to {fine:e}");
            }
        }
        let base = gauss_legendre(24);
        // 20 layers reach rounding where plain Gauss is wrong in the third digit.
        assert!(log_error(&graded_unit(&base, 20, 0.15), 0) < 1e-15);
        assert!(log_error(&base.mapped(0.0, 1.0), 0) > 1e-4);
    }

    #[test]
    fn smooth_degree_is_that_of_the_base() {
        let base = gauss_legendre(4);
        for end in [End::Left, End::Right, End::Both] {
            for layers in [0, 3] {
                let rule = graded(&base, layers, 0.3, end);
                assert_eq!((rule.degree, rule.len()), (7, 4 * (layers + 1) * if end == End::Both { 2 } else { 1 }));
                assert!(rule.points.windows(2).all(|x| x[0] < x[1]));
                let error = |k: i32| {
                    (rule.integrate(|x| x.powi(k)) - if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 }).abs()
                };
                assert!((0..=7).all(|k| error(k) < 1e-15), "{end:?} {layers}");
                assert!(error(8) > 1e-7, "{end:?} {layers}: {:e}", error(8));
            }
        }
    }

    #[test]
    fn grading_is_towards_the_named_end() {
        let base = gauss_legendre(24);
        let rule = |end| graded(&base, 20, 0.15, end);
        let exact = 2.0 * LN_2 - 2.0; // ∫ log(1 ± x) dx
        let left = |end| (rule(end).integrate(|x| (1.0 + x).ln()) - exact).abs();
        let right = |end| (rule(end).integrate(|x| (1.0 - x).ln()) - exact).abs();
        assert!(left(End::Left) < 2e-15 && right(End::Right) < 2e-15);
        assert!(left(End::Both) < 2e-15 && right(End::Both) < 2e-15);
        assert!(left(End::Right) > 1e-4 && right(End::Left) > 1e-4);
    }

    #[test]
    fn points_stay_inside_and_distances_keep_their_digits() {
        let base = gauss_legendre(3);
        for end in [End::Left, End::Right, End::Both] {
            let rule = graded(&base, 40, 0.15, end);
            assert!(rule.points.iter().all(|x| x.abs() < 1.0));
            assert!((rule.weights.iter().sum::<f64>() - 2.0).abs() < 1e-15);
        }
        // The panels are images of each other: point i+3 is point i divided by the ratio.
        let distances = graded_unit(&base, 40, 0.15).points;
        assert!(distances[0] > 0.0 && distances[0] < 1e-33);
        for i in 3..distances.len() - 3 {
            assert!((distances[i] / distances[i + 3] / 0.15 - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn substitution_has_its_degree_and_no_higher() {
        for power in [1, 2, 5, 7] {
            for n in (power as usize).div_ceil(2)..=40 {
                let rule = substituted(n, power);
                assert_eq!(rule.degree, 2 * n / power as usize - 1);
                let error = |k: usize| (rule.integrate(|s| s.powi(k as i32)) * (k + 1) as f64 - 1.0).abs();
                assert!((0..=rule.degree).all(|k| error(k) < 2e-14), "{power} {n}");
                if n <= 6 {
                    assert!(error(rule.degree + 1) > 1e-9, "{power} {n}: {:e}", error(rule.degree + 1));
                }
            }
        }
    }

    #[test]
    fn substitution_tames_the_logarithm_at_its_rate() {
        // In τ the integrand is τ^a log τ with a = power-1 (+ power for a factor σ): error of order n^-(2a+2).
        for (power, k, n) in [(1, 0, 16), (2, 0, 16), (3, 0, 12), (2, 1, 8)] {
            let error = |n: usize| log_error(&substituted(n, power), k);
            let order = (error(n) / error(2 * n)).log2();
            let expected = f64::from(2 * power) * f64::from(k + 1);
            assert!((order - expected).abs() < 0.3, "power {power}: order {order}, not {expected}");
        }
        assert!(log_error(&substituted(40, 5), 1) < 1e-15 && log_error(&substituted(40, 5), 0) < 1e-14);
        assert!(log_error(&substituted(64, 7), 0) < 1e-15);
        assert!(log_error(&substituted(40, 1), 0) > 1e-5);
    }
}
