//! Random numbers as functions of their place: samples do not depend on the order in which they are drawn.

use steklov_quadrature::splitmix64;

use crate::Variable;

/// Uniform random number in (0, 1), one of 2^52 equally spaced ones, the same for the same three arguments.
///
/// Each direction has a generator of its own, seeded by number `direction` of the generator of `seed`.
pub fn uniform(seed: u64, sample: u64, direction: u64) -> f64 {
    let bits = splitmix64(splitmix64(seed, direction), sample) >> 12;
    (bits as f64 + 0.5) * 2f64.powi(-52)
}

/// Germs of a sample of independent variables: their quantiles at [`uniform`] numbers.
///
/// A further variable does not change the germs of those before it.
pub fn sample(variables: &[Variable], seed: u64, index: u64) -> Vec<f64> {
    variables.iter().zip(0..).map(|(variable, d)| variable.quantile(uniform(seed, index, d))).collect()
}

/// Germs of `count` samples of a Latin hypercube: each variable has one sample in every `count`-th part of its probability.
/// Means of sums of functions of one variable have an error like count^-3/2.
///
/// Source: McKay, Beckman and Conover, Technometrics 21 (1979).
pub fn latin_hypercube(variables: &[Variable], count: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut points = vec![Vec::with_capacity(variables.len()); count];
    for (variable, d) in variables.iter().zip(0..) {
        // a permutation of the parts, and a place in each
        let key = |i: &usize| uniform(seed, *i as u64, 2 * d);
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| key(a).total_cmp(&key(b)));
        for (part, sample) in order.into_iter().enumerate() {
            let place = uniform(seed, sample as u64, 2 * d + 1);
            points[sample].push(variable.quantile((part as f64 + place) / count as f64));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each part of each variable has one sample, other seeds have others, and the mean of a function of one variable is much better
    /// than that of independent samples, 1/(12 n)^½.
    #[test]
    fn latin_hypercubes_have_a_sample_in_every_part() {
        let unit = Variable::uniform(0.0, 1.0).unwrap();
        let variables = [unit.clone(), unit, Variable::normal(1.0, 2.0).unwrap()];
        for (count, seed) in [(1, 5), (8, 1), (50, 7)] {
            let points = latin_hypercube(&variables, count, seed);
            assert_eq!(points, latin_hypercube(&variables, count, seed));
            for d in 0..2 {
                let mut parts: Vec<usize> = points.iter().map(|x| (x[d] * count as f64) as usize).collect();
                let mean = points.iter().map(|x| x[d]).sum::<f64>() / count as f64;
                assert!((mean - 0.5).abs() < 2.0 * (count as f64).powf(-1.5), "{count}, {d}: {mean}");
                parts.sort_unstable();
                assert_eq!(parts, (0..count).collect::<Vec<_>>(), "{count}, {d}");
            }
            assert!(points.iter().all(|x| x[2].is_finite() && x[0] != x[1]));
            assert_ne!(points, latin_hypercube(&variables, count, seed + 1));
        }
    }

    #[test]
    fn samples_have_the_moments_of_their_variables_and_do_not_correlate() {
        let variables = [
            Variable::uniform(-1.0, 1.0).unwrap(),
            Variable::normal(3.0, 2.0).unwrap(),
            Variable::beta(2.0, 5.0, 0.0, 1.0).unwrap(),
        ];
        let n = 20_000;
        let all: Vec<Vec<f64>> = (0..n).map(|i| sample(&variables, 2014, i)).collect();
        let average = |f: &dyn Fn(&[f64]) -> f64| all.iter().map(|x| f(x)).sum::<f64>() / n as f64;
        // five standard errors; 1/√n is that of a correlation
        let error = 5.0 / (n as f64).sqrt();
        for (d, v) in variables.iter().enumerate() {
            let unit = |x: &[f64], d: usize| (x[d] - variables[d].mean()) / variables[d].variance().sqrt();
            assert!(average(&|x| unit(x, d)).abs() < error);
            assert!((average(&|x| unit(x, d).powi(2)) - 1.0).abs() < 1.5 * error);
            for e in 0..d {
                assert!(average(&|x| unit(x, d) * unit(x, e)).abs() < error, "{d}, {e}");
            }
            // successive samples
            let pairs = all.windows(2).map(|x| unit(&x[0], d) * unit(&x[1], d)).sum::<f64>() / n as f64;
            assert!(pairs.abs() < error);
            assert!(all.iter().all(|x| v.density(x[d]) > 0.0));
        }
    }

    #[test]
    fn a_sample_depends_on_seed_index_and_direction_only() {
        let v = Variable::normal(0.0, 1.0).unwrap();
        let three = vec![v.clone(), v.clone(), v];
        let x = sample(&three, 5, 1000);
        assert_eq!(sample(&three, 5, 1000), x);
        assert_eq!(sample(&three[..2], 5, 1000), x[..2]);
        assert!(x[0] != x[1] && x[1] != x[2] && sample(&three, 6, 1000) != x && sample(&three, 5, 1001) != x);
        for i in 0..1000 {
            let u = uniform(u64::MAX, u64::MAX - i, i);
            assert!(0.0 < u && u < 1.0);
        }
    }
}
